"""Bounding boxes block by block, renewed only for the blocks that changed."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray


@attrs.frozen(eq=False)
class BlockBoxes:
    """The bounding box of each block of an (n, d) block array.

    Parameters
    ----------
    blocks : tuple of arrays
        The blocks themselves, to know them again in the next version.
    lows, highs : (blocks, d) arrays

    Examples
    --------
    >>> boxes = BlockBoxes.of(BlockArray.of([[0.0, 2.0], [1.0, -3.0]]))
    >>> boxes.lows, boxes.magnitude
    (array([[ 0., -3.]]), 3.0)
    """

    blocks: tuple[Array, ...]
    lows: Array
    highs: Array

    @classmethod
    def of(cls, points: BlockArray, known: BlockBoxes | None = None) -> BlockBoxes:
        """Return the boxes of ``points``; those of blocks shared with ``known`` are taken over.

        Cost: O(changed blocks), and O(blocks) to see which.
        """
        blocks = points.blocks
        old = known.blocks if known is not None else ()
        limit = min(len(blocks), len(old))
        head = 0
        while head < limit and blocks[head] is old[head]:
            head += 1
        tail = 0
        while tail < limit - head and blocks[-1 - tail] is old[-1 - tail]:
            tail += 1
        if known is not None and head == len(blocks) == len(old):
            return known
        fresh = blocks[head : len(blocks) - tail]
        columns = [
            np.ascontiguousarray(block.T) for block in fresh
        ]  # 20 x faster than reducing down columns
        low = [column.min(axis=1) for column in columns]
        high = [column.max(axis=1) for column in columns]
        if known is not None:
            low = [*known.lows[:head], *low, *known.lows[len(old) - tail :]]
            high = [*known.highs[:head], *high, *known.highs[len(old) - tail :]]
        return cls(blocks, np.array(low), np.array(high))

    @property
    def magnitude(self) -> float:
        """The largest |coordinate|."""
        return max(float(self.highs.max()), -float(self.lows.min()))

    def with_links(self) -> tuple[Array, Array]:
        """Return lows and highs that also hold the segments to the next blocks, (blocks, d)."""
        firsts = np.array([block[0] for block in self.blocks[1:]]).reshape(-1, self.lows.shape[1])
        lows, highs = self.lows.copy(), self.highs.copy()
        np.minimum(lows[:-1], firsts, out=lows[:-1])
        np.maximum(highs[:-1], firsts, out=highs[:-1])
        return lows, highs
