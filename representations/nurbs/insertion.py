"""Knot insertion: the same curve on more knots, all at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.representations.nurbs.changes import supports, unmatched_rows
from multirep.representations.nurbs.evaluation import homogeneous
from multirep.splices import SpliceList
from multirep.splines import refine

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


def times_of(times: int) -> int:
    """Return how often, a whole number from 1, or refuse it."""
    if isinstance(times, bool) or not isinstance(times, int | np.integer) or times < 1:
        raise EditError(f"times must be a whole number of 1 or more, got {times!r}")
    return int(times)


def knots_inserted(curve: N, knots: ArrayLike) -> Edit[N]:
    """Insert knots, each strictly inside T, in one pass over the window between the outermost.

    Control points whose p inner knots stay are copied; each other one is the blossom, at its new
    inner knots, of the old piece in the middle of its support (Boehm's and the Oslo algorithm are
    orders in which to compute that).
    """
    new = np.sort(np.asarray(knots, dtype=np.float64).ravel())
    if not len(new):
        return Edit(curve, SpliceList.EMPTY)
    p, domain = curve.degree, curve.domain
    inside = (new > domain.start) & (new < domain.stop)
    if not inside.all():
        wrong = float(new[~inside][0])
        raise EditError(f"a knot can be inserted inside {domain} only, not at {wrong!r}")
    low = curve.span(float(new[0]), "left") - p
    high = curve.span(float(new[-1])) + 1
    old = curve._knots.window(low, high + p + 1)
    union = np.concatenate((old, new))
    union.sort()
    full = union[p + 1 : -p - 1]
    if len(full) > p and bool((full[p:] == full[:-p]).any()):
        wrong = float(full[:-p][full[p:] == full[:-p]][0])
        have = int((old == wrong).sum())
        raise EditError(
            f"{wrong!r} is a knot {have} times already; a curve of degree {p} "
            f"stays in one piece up to {p} times"
        )
    points = curve._points.window(low, high)
    weights = None if curve._weights is None else curve._weights.window(low, high)
    changed, source = unmatched_rows(old, union, p)
    rows, bottoms = refined(old, points, weights, p, union)
    kept = np.ones(len(rows), dtype=bool)
    kept[changed] = False
    rows[kept] = points[source[kept]]
    new_weights = None
    if weights is not None and bottoms is not None:
        bottoms[kept] = weights[source[kept]]
        assert curve._weights is not None
        new_weights = curve._weights.replaced(low, high, bottoms)
    value = curve._with(
        knots=curve._knots.replaced(low, high + p + 1, union),
        points=curve._points.replaced(low, high, rows),
        weights=new_weights,
    )
    return Edit(value, supports(value._knots, p, changed + low, domain))


def refined(
    old: Array, points: Array, weights: Array | None, degree: int, new: Array
) -> tuple[Array, Array | None]:
    """Express a window on more knots: Euclidean points and weights.

    Equal weights stay equal to the last bit.
    """
    if weights is None or bool((weights == weights[0]).all()):
        rows = refine(old, points, degree, new)
        return rows, None if weights is None else np.full(len(rows), weights[0])
    rows = refine(old, homogeneous(points, weights), degree, new)
    return rows[:, :-1] / rows[:, -1:], rows[:, -1].copy()
