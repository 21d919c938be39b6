"""Bounding boxes in three levels, runs of blocks, blocks and leaves; renewed where they changed."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import attrs
import numpy as np
import numpy.typing as npt

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.runs import rows_of
from multirep.summaries import Summaries

#: Segments in a leaf. Larger: more rows to look at around a hit; smaller: more boxes to make after
#: an edit.
LEAF = 64


@attrs.frozen(eq=False, slots=False)
class BlockBox:
    """The box of the vertices of a block, (d,) each, and those of its leaves when asked for."""

    block: Array
    low: Array
    high: Array
    #: The largest |coordinate|; infinite if one is NaN, which would get lost in comparisons.
    magnitude: float

    @classmethod
    def of(cls, block: Array) -> BlockBox:
        """Measure a block."""
        columns = np.ascontiguousarray(block.T)  # much faster than down the columns
        low, high = columns.min(axis=1), columns.max(axis=1)
        size = max(float(high.max()), -float(low.min()))
        return cls(block, low, high, size if math.isfinite(size) else math.inf)

    @cached_property
    def leaves(self) -> tuple[Array, Array]:
        """Lows and highs, (k, d), of the runs of :data:`LEAF` segments, with the links between.

        O(n) once.
        """
        columns = np.ascontiguousarray(self.block.T)
        starts = np.arange(0, columns.shape[1], LEAF)
        low = np.minimum.reduceat(columns, starts, axis=1)
        high = np.maximum.reduceat(columns, starts, axis=1)
        links = columns[:, starts[1:]]
        np.minimum(low[:, :-1], links, out=low[:, :-1])
        np.maximum(high[:, :-1], links, out=high[:, :-1])
        return low.T, high.T


@attrs.frozen(eq=False, slots=False)
class RunBoxes:
    """The boxes of some neighbouring blocks, and the largest |coordinate| in them."""

    boxes: tuple[BlockBox, ...]
    magnitude: float

    @classmethod
    def of(cls, boxes: tuple[BlockBox, ...]) -> RunBoxes:
        """Join the boxes of blocks."""
        return cls(boxes, max([box.magnitude for box in boxes]))

    @cached_property
    def lows(self) -> Array:
        """Of each block, (k, d)."""
        return np.array([box.low for box in self.boxes])

    @cached_property
    def highs(self) -> Array:
        """Of each block, (k, d)."""
        return np.array([box.high for box in self.boxes])


@attrs.frozen(eq=False)
class BlockBoxes:
    """The bounding boxes of the segments of a polyline in an (n, d) block array.

    Parameters
    ----------
    of_blocks : Summaries
        The boxes of the vertices of each block, and of the blocks of each run.

    Examples
    --------
    >>> boxes = BlockBoxes.of(BlockArray.of([[0.0, 2.0], [1.0, -3.0]]))
    >>> boxes.magnitude, boxes.runs(lambda lows, highs: lows[:, 1] < -2.0)
    (3.0, [(0, 2)])
    """

    of_blocks: Summaries[BlockBox, RunBoxes]

    @classmethod
    def of(cls, points: BlockArray, known: BlockBoxes | None = None) -> BlockBoxes:
        """Return the boxes of ``points``; those of blocks shared with ``known`` are taken over.

        Cost: O(changed blocks), and O(runs) to see which.
        """
        before = Summaries() if known is None else known.of_blocks
        after = before.renewed(points, BlockBox.of, RunBoxes.of)
        return known if known is not None and after is before else cls(after)

    @property
    def magnitude(self) -> float:
        """The largest |coordinate|; infinite if one is NaN."""
        return max([run.magnitude for run in self.of_blocks.wholes])

    def runs(self, hit: Callable[[Array, Array], npt.NDArray[np.bool_]]) -> list[tuple[int, int]]:
        """Return the vertices whose segments lie in leaves that are hit.

        Parameters
        ----------
        hit : callable
            (lows, highs), (k, d) each, to (k,) booleans; a box that holds a hit box must be hit.

        Returns
        -------
        list of (start, stop)
            Rows start .. stop - 1 with the last vertex of the last segment, disjoint, in order.
            Cost: O(runs), O(blocks) of the runs that are hit, O(leaves) of the blocks that are.
        """
        of = self.of_blocks
        rows = (0, *of.ends)
        lows = np.array([boxes.lows.min(axis=0) for boxes in of.wholes])
        highs = np.array([boxes.highs.max(axis=0) for boxes in of.wholes])
        firsts = [run[0][:1] for run in of.runs]
        found: list[tuple[int, int]] = []
        for k in np.flatnonzero(hit(*_linked(lows, highs, firsts[1:]))).tolist():
            run, boxes = of.runs[k], of.wholes[k]
            links = [block[:1] for block in run[1:]] + firsts[k + 1 : k + 2]
            for b in np.flatnonzero(hit(*_linked(boxes.lows, boxes.highs, links))).tolist():
                start = rows[k] + rows_of(run[:b])
                stop = start + len(run[b])
                low, high = of.blocks[k][b].leaves
                ended = _linked(low[::-1], high[::-1], links[b : b + 1])  # the last leaf
                for leaf in np.flatnonzero(hit(*ended)[::-1]).tolist():
                    at = start + leaf * LEAF
                    end = min(min(at + LEAF, stop) + 1, rows[-1])
                    if found and at < found[-1][1]:
                        found[-1] = found[-1][0], end
                    elif end - at > 1:
                        found.append((at, end))
        return found


def _linked(lows: Array, highs: Array, links: list[Array]) -> tuple[Array, Array]:
    """Boxes, (k, d), of which the first ones also hold a link each, (1, d) in a list."""
    if not links:
        return lows, highs
    joined = np.concatenate(links)
    lows, highs = lows.copy(), highs.copy()
    np.minimum(lows[: len(joined)], joined, out=lows[: len(joined)])
    np.maximum(highs[: len(joined)], joined, out=highs[: len(joined)])
    return lows, highs
