"""Bounding boxes in two levels, blocks and leaves, renewed only for the blocks that changed."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import attrs
import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray

#: Segments in a leaf. Larger: more rows to look at around a hit; smaller: more boxes to make after
#: an edit.
LEAF = 64


@attrs.frozen(eq=False, slots=False)
class Leaves:
    """Boxes of the runs of :data:`LEAF` segments of an (n, d) block, made when first asked for."""

    block: Array

    @cached_property
    def boxes(self) -> tuple[Array, Array]:
        """Lows and highs, (k, d), links between the leaves included; O(n) once."""
        columns = np.ascontiguousarray(self.block.T)  # much faster than down the columns
        starts = np.arange(0, columns.shape[1], LEAF)
        low = np.minimum.reduceat(columns, starts, axis=1)
        high = np.maximum.reduceat(columns, starts, axis=1)
        links = columns[:, starts[1:]]
        np.minimum(low[:, :-1], links, out=low[:, :-1])
        np.maximum(high[:, :-1], links, out=high[:, :-1])
        return low.T, high.T


@attrs.frozen(eq=False, slots=False)
class BlockBoxes:
    """The bounding boxes of the segments of a polyline in an (n, d) block array.

    Parameters
    ----------
    blocks : tuple of arrays
        The blocks themselves, to know them again in the next version.
    leaves : tuple of Leaves
        One a block.
    lows, highs : (blocks, d) arrays
        The boxes of the blocks' vertices.

    Examples
    --------
    >>> boxes = BlockBoxes.of(BlockArray.of([[0.0, 2.0], [1.0, -3.0]]))
    >>> boxes.lows, boxes.magnitude
    (array([[ 0., -3.]]), 3.0)
    """

    blocks: tuple[Array, ...]
    leaves: tuple[Leaves, ...]
    lows: Array
    highs: Array

    @classmethod
    def of(cls, points: BlockArray, known: BlockBoxes | None = None) -> BlockBoxes:
        """Return the boxes of ``points``; those of blocks shared with ``known`` are taken over.

        Cost: O(changed blocks), and O(blocks) to see which.
        """
        blocks = points.blocks
        old = known.blocks if known is not None else ()
        if known is not None and blocks is old:
            return known
        limit = min(len(blocks), len(old))
        head = 0
        while head < limit and blocks[head] is old[head]:
            head += 1
        tail = 0
        while tail < limit - head and blocks[-1 - tail] is old[-1 - tail]:
            tail += 1
        changed = blocks[head : len(blocks) - tail]
        fresh = tuple(map(Leaves, changed))
        columns = [np.ascontiguousarray(block.T) for block in changed]  # as in Leaves
        shape = len(changed), points.shape[1]
        low: Array = np.array([column.min(axis=1) for column in columns]).reshape(shape)
        high: Array = np.array([column.max(axis=1) for column in columns]).reshape(shape)
        if known is None:
            return cls(blocks, fresh, low, high)
        after = len(old) - tail
        return cls(
            blocks,
            (*known.leaves[:head], *fresh, *known.leaves[after:]),
            np.concatenate([known.lows[:head], low, known.lows[after:]]),
            np.concatenate([known.highs[:head], high, known.highs[after:]]),
        )

    @property
    def magnitude(self) -> float:
        """The largest |coordinate|."""
        return max(float(self.highs.max()), -float(self.lows.min()))

    @cached_property
    def starts(self) -> Indices:
        """The first row of each block."""
        lengths = np.array([len(block) for block in self.blocks])
        starts: Indices = lengths.cumsum() - lengths
        return starts

    @cached_property
    def linked(self) -> tuple[Array, Array]:
        """Lows and highs, (blocks, d), of boxes that also hold the segment to the next block."""
        firsts = np.array([block[0] for block in self.blocks[1:]]).reshape(-1, self.lows.shape[1])
        lows, highs = self.lows.copy(), self.highs.copy()
        np.minimum(lows[:-1], firsts, out=lows[:-1])
        np.maximum(highs[:-1], firsts, out=highs[:-1])
        return lows, highs

    def leaf_boxes(self, block: int) -> tuple[Array, Array]:
        """Lows and highs, (k, d), of a block's leaves, the link to the next block included."""
        lows, highs = self.leaves[block].boxes
        if block + 1 == len(self.blocks):
            return lows, highs
        lows, highs = lows.copy(), highs.copy()
        link = self.blocks[block + 1][0]
        np.minimum(lows[-1], link, out=lows[-1])
        np.maximum(highs[-1], link, out=highs[-1])
        return lows, highs

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
            Cost: O(blocks), and O(leaves) of the blocks that are hit.
        """
        count = int(self.starts[-1]) + len(self.blocks[-1])
        runs: list[tuple[int, int]] = []
        for block in np.flatnonzero(hit(*self.linked)).tolist():
            base, rows = int(self.starts[block]), len(self.blocks[block])
            for leaf in np.flatnonzero(hit(*self.leaf_boxes(block))).tolist():
                start = base + leaf * LEAF
                stop = min(base + min((leaf + 1) * LEAF, rows) + 1, count)
                if runs and start < runs[-1][1]:
                    runs[-1] = (runs[-1][0], stop)
                elif stop - start > 1:
                    runs.append((start, stop))
        return runs
