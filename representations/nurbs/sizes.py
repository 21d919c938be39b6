"""How large the control points are, measured a block at a time."""

from __future__ import annotations

import math

import attrs

from multirep.arrays import Array
from multirep.blocks import BlockArray


@attrs.frozen(eq=False)
class Sizes:
    """The largest |coordinate| in each block of control points.

    Parameters
    ----------
    blocks : tuple of (rows, d) arrays
        What was measured.
    sizes : tuple of float
        Of each block.

    Examples
    --------
    >>> Sizes.of(BlockArray.of([[0.0, 2.0], [1.0, -3.0]])).magnitude
    3.0
    """

    blocks: tuple[Array, ...]
    sizes: tuple[float, ...]

    @classmethod
    def of(cls, points: BlockArray, known: Sizes | None = None) -> Sizes:
        """Measure the blocks that are not those of ``known``, an earlier or a later version."""
        new = points.blocks
        if known is None:
            return cls(new, tuple(map(_size, new)))
        old = known.blocks
        if new is old:
            return known
        most = min(len(old), len(new))
        head = 0
        while head < most and old[head] is new[head]:
            head += 1
        tail = 0
        while tail < most - head and old[-1 - tail] is new[-1 - tail]:
            tail += 1
        fresh = map(_size, new[head : len(new) - tail])
        return cls(new, (*known.sizes[:head], *fresh, *known.sizes[len(old) - tail :]))

    @property
    def magnitude(self) -> float:
        """Largest |coordinate|."""
        return max(self.sizes)


def _size(block: Array) -> float:
    size = max(float(block.max()), -float(block.min()))
    return size if math.isfinite(size) else math.inf  # NaN would get lost in comparisons
