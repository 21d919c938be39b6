"""Moving a knot: a fine control of shape that keeps the curve in its control polygon's hull."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from multirep.edit import Edit
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.nurbs.validation import index_of
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


def knot_moved(curve: N, index: int, to: float) -> Edit[N]:
    """Move interior knot i between its neighbours.

    The basis functions that read knot i have supports from u_(i-p-1) to u_(i+p+1), but only spans
    i - p .. i + p - 1 read it: the arcs of Juhasz-Hoffmann section 2 with order k = p + 1.
    """
    p, n, knots = curve.degree, curve.size, curve._knots
    i = index_of(index, len(knots), "knot")
    if not p < i < n:
        raise EditError(
            f"knot {i} bounds or lies outside the domain {curve.domain}; "
            + (f"knots {p + 1} to {n - 1} can be moved" if n > p + 1 else "no knot can be moved")
        )
    new = float(to)
    near = knots.window(i - p - 1, i + p + 2)
    low, high = float(near[p]), float(near[p + 2])
    # No interior knot may meet an end of T, nor p others.
    low_open = low == curve.domain.start or bool(near[1] == low)
    high_open = high == curve.domain.stop or bool(near[2 * p + 1] == high)
    inside = (low < new if low_open else low <= new) and (new < high if high_open else new <= high)
    if not inside:
        region = f"{'(' if low_open else '['}{low!r}, {high!r}{')' if high_open else ']'}"
        raise EditError(f"knot {i} can move within {region}, not to {to!r}")
    if new == float(near[p + 1]):
        return Edit(curve, SpliceList.EMPTY)
    touched = Interval(float(near[1]), float(near[2 * p + 1])).clipped(curve.domain)
    return Edit(curve._with(knots=knots.replaced(i, i + 1, [new])), SpliceList([touched]))
