"""Moving control points and setting weights: the direct ways to shape a NURBS."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import ArrayLike
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.representations.nurbs.changes import supports
from multirep.representations.nurbs.validation import index_of, rows_of, weight_of
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


@lru_cache(maxsize=8)
def ones(count: int) -> BlockArray:
    """Return the weights of a polynomial curve; their blocks are one and the same, O(blocks)."""
    full, rest = divmod(count, BLOCK_ROWS)
    block = np.ones(BLOCK_ROWS)
    block.setflags(write=False)
    return BlockArray([block] * full + ([block[:rest]] if rest else []), ())


def moved_control_points(curve: N, start: int, rows: ArrayLike) -> Edit[N]:
    """Replace control points start .. start + k - 1 by rows (k, d)."""
    new = rows_of(rows, curve.dimension)
    count = len(new)
    if not count:
        return Edit(curve, SpliceList.EMPTY)
    index_of(start, curve.size, "control point")
    index_of(start + count - 1, curve.size, "control point")
    old = curve._points.window(start, start + count)
    changed = np.flatnonzero((old != new).any(axis=1)) + start
    if not len(changed):
        return Edit(curve, SpliceList.EMPTY)
    first, last = int(changed[0]), int(changed[-1]) + 1
    points = curve._points.replaced(first, last, new[first - start : last - start])
    touched = supports(curve._knots, curve.degree, changed, curve.domain)
    return Edit(curve._with(points=points), touched)


def weight_set(curve: N, index: int, weight: float) -> Edit[N]:
    """Set one weight."""
    new = weight_of(weight)
    i = index_of(index, curve.size, "control point")
    weights = curve.weights
    if float(weights[i]) == new:
        return Edit(curve, SpliceList.EMPTY)
    if not np.isfinite(new * curve.magnitude):
        raise EditError(f"a weight of {new!r} times the control points overflows")
    touched = supports(curve._knots, curve.degree, np.array([i]), curve.domain)
    return Edit(curve._with(weights=weights.replaced(i, i + 1, [new])), touched)
