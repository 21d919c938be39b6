"""How large the control points are, measured a block at a time."""

from __future__ import annotations

import math
from typing import TypeAlias

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.summaries import Summaries

#: The largest |coordinate| in each block of control points, and in each run.
Sizes: TypeAlias = Summaries[float, float]


def sizes_of(points: BlockArray, known: Sizes | None) -> Sizes:
    """Measure the blocks that are not those of ``known``, an earlier or a later version.

    Examples
    --------
    >>> max(sizes_of(BlockArray.of([[0.0, 2.0], [1.0, -3.0]]), None).wholes)
    3.0
    """
    return (Summaries() if known is None else known).renewed(points, _size, max)


def _size(block: Array) -> float:
    size = max(float(block.max()), -float(block.min()))
    return size if math.isfinite(size) else math.inf  # NaN would get lost in comparisons
