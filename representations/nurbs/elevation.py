"""Degree elevation: the same curve, one degree higher, with the same smoothness."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.representations.nurbs.validation import LARGEST_DEGREE
from multirep.splices import SpliceList
from multirep.splines import blossom
from multirep.splines.rational import homogeneous

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


def elevated(curve: N, times: int) -> Edit[N]:
    """Raise the degree ``times`` times."""
    if curve.degree + times > LARGEST_DEGREE:
        raise EditError(
            f"degree {curve.degree} + {times} exceeds {LARGEST_DEGREE}, the highest supported"
        )
    knots, rows = np.asarray(curve._knots), np.asarray(curve._points)
    bottoms: Array | None = None
    if curve._weights is not None:
        bottoms = np.asarray(curve._weights)
        rows = homogeneous(rows, bottoms)
    for degree in range(curve.degree, curve.degree + times):
        knots, rows = elevated_once(knots, rows, degree)
    if bottoms is not None:
        bottoms = rows[:, -1].copy()
        rows = rows[:, :-1] / rows[:, -1:]
    value = curve._with(
        degree=curve.degree + times,
        knots=BlockArray.of(knots),
        points=BlockArray.of(rows),
        weights=None if bottoms is None else BlockArray.of(bottoms),
    )
    return Edit(value, SpliceList([curve.domain]))


def elevated_once(knots: Array, rows: Array, degree: int) -> tuple[Array, Array]:
    """Raise the degree p by one.

    Each knot is repeated once more. The blossom of degree p + 1 is the mean of the old one over the
    p + 1 ways to leave an argument out; a control point is its value at p + 1 inner knots.
    """
    count = len(rows)
    values, firsts = np.unique(knots, return_index=True)
    times = np.diff(np.append(firsts, len(knots))) + 1
    new = values.repeat(times)
    p, q = degree, degree + 1
    low = int(new.searchsorted(knots[p], "right")) - q - 1
    high = int(new.searchsorted(knots[count], "left")) + q + 1
    new = new[max(low, 0) : high]
    total = len(new) - q - 1
    index = np.arange(total)
    # The nonempty span nearest to the middle of each support, in new and in old numbers.
    filled = np.flatnonzero(new[q:total] < new[q + 1 : total + 1]) + q
    middle = index + q // 2
    after = np.minimum(filled.searchsorted(middle), len(filled) - 1)
    right, left = filled[after], filled[np.maximum(after - 1, 0)]
    chosen = np.where(right - middle <= middle - left, right, left)
    spans = knots.searchsorted(new[chosen], "right") - 1
    inner = new[index[:, None] + np.arange(1, q + 1)]
    mean = np.zeros((total, rows.shape[1]))
    for left_out in range(q):
        arguments = np.delete(inner, left_out, axis=1)
        mean += blossom(knots, rows, p, np.asarray(spans), arguments)
    return new, mean / q
