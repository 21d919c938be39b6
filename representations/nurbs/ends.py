"""Adding and removing control points at an end of the curve, with T kept (Grimm-Ayers 6.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import ArrayLike
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.nurbs.validation import point_of, weight_of
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


def control_point_added(curve: N, point: ArrayLike, end: str, weight: float) -> Edit[N]:
    """Add a control point beyond the first or the last one.

    The paper moves the last o + 3 knots to make room; one knot in the middle of the end span does
    it with less change. All control points stay. The first changed knot is number n (it was B), so
    the spans n - p .. n - 1 read it: [u_(n-p), B] is touched, and likewise at the start.
    """
    at_start = _is_start(end)
    p, n, knots = curve.degree, curve.size, curve._knots
    row = point_of(point, curve.dimension)[None]
    new_weight = weight_of(weight)
    weights = curve._weights
    if weights is None and new_weight != 1.0:
        weights = curve.weights
    if at_start:
        middle = _between(float(knots[p]), float(knots[p + 1]))
        touched = Interval(curve.domain.start, min(float(knots[2 * p]), curve.domain.stop))
        at, where = p + 1, 0
    else:
        middle = _between(float(knots[n - 1]), float(knots[n]))
        touched = Interval(max(float(knots[n - p]), curve.domain.start), curve.domain.stop)
        at, where = n, n
    value = curve._with(
        knots=knots.replaced(at, at, [middle]),
        points=curve._points.replaced(where, where, row),
        weights=None if weights is None else weights.replaced(where, where, [new_weight]),
    )
    return Edit(value, SpliceList([touched]))


def control_point_removed(curve: N, end: str) -> Edit[N]:
    """Remove the first or the last control point, and the interior knot nearest to it.

    The spans that read knot n - 1 are n - 1 - p .. n - 1: [u_(n-1-p), B] is touched, and likewise
    at the start.
    """
    at_start = _is_start(end)
    p, n, knots = curve.degree, curve.size, curve._knots
    if n == p + 1:
        raise EditError(
            f"a curve of degree {p} needs its last {p + 1} control points; none can be removed"
        )
    if at_start:
        touched = Interval(curve.domain.start, min(float(knots[2 * p + 1]), curve.domain.stop))
        at, where = p + 1, 0
    else:
        touched = Interval(max(float(knots[n - 1 - p]), curve.domain.start), curve.domain.stop)
        at, where = n - 1, n - 1
    nothing = np.empty((0, curve.dimension))
    value = curve._with(
        knots=knots.replaced(at, at + 1, []),
        points=curve._points.replaced(where, where + 1, nothing),
        weights=None if curve._weights is None else curve._weights.replaced(where, where + 1, []),
    )
    return Edit(value, SpliceList([touched]))


def _is_start(end: str) -> bool:
    if end not in ("start", "stop"):
        raise EditError(f"the end must be 'start' or 'stop', got {end!r}")
    return end == "start"


def _between(low: float, high: float) -> float:
    middle = 0.5 * low + 0.5 * high
    if not low < middle < high:
        raise EditError(f"there is no room for a knot between {low!r} and {high!r}")
    return middle
