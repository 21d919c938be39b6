"""Knots of full multiplicity at the borders of a stretch, so that it stays bit by bit."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from multirep.edit import Edit
from multirep.errors import EditError, ToleranceError
from multirep.interval import Interval
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")

#: An end that comes so close to a knot outside, in terms of T, takes that knot instead: a span that
#: short would only cost digits.
NEAR = 1e-9
#: A knot is taken back if that is proved to move the curve by no more than this part of its
#: coordinates: rounding, after the knot was inserted and the curve beside it left alone.
ROUNDING = 2.0**-44


def held(curve: N, interval: Interval, keep: SpliceList) -> tuple[Edit[N], Interval]:
    """Raise the ends to p-fold knots: no control point acts on both sides of such a knot.

    That expresses up to 2 p - 1 control points anew around each end. Where one of them acts on
    what is kept, a knot farther out is raised instead: with m the last parameter kept and
    u_k < m <= u_(k+1), what acts before m reads no knot beyond u_(k+p), and raising that one
    changes nothing that does.
    """
    start, stop = _left(curve, interval.start, keep), _right(curve, interval.stop, keep)
    knots = [t for t in (start, stop) for _ in range(_missing(curve, t))]
    return curve.insert_knots(knots), Interval(start, stop)


def released(curve: N, t: float, count: int) -> Edit[N]:
    """Remove the knot at ``t`` up to ``count`` times, as far as that is a matter of rounding."""
    value, splices = curve, SpliceList.EMPTY
    for _ in range(count):
        try:
            edit = value.remove_knot(t, tolerance=ROUNDING * curve.magnitude)
        except (EditError, ToleranceError):
            break
        value, splices = edit.value, splices | edit.splices
    return Edit(value, splices)


def _right(curve: Nurbs, t: float, keep: SpliceList) -> float:
    """Return the knot or place at or after ``t`` that can be raised."""
    knots = curve.knots
    after = float(knots[knots.searchsorted(t)])
    if after - t <= NEAR * curve.domain.length:
        t = after
    kept = [min(part.stop, t) for part in keep if part.start < t]
    if kept:
        reads = knots.searchsorted(kept[-1]) - 1 + curve.degree
        t = max(t, float(knots[min(reads, len(knots) - 1)]))
    return min(t, curve.domain.stop)


def _left(curve: Nurbs, t: float, keep: SpliceList) -> float:
    knots = curve.knots
    before = float(knots[knots.searchsorted(t, "right") - 1])
    if t - before <= NEAR * curve.domain.length:
        t = before
    kept = [max(part.start, t) for part in keep if part.stop > t]
    if kept:
        reads = knots.searchsorted(kept[0], "right") - curve.degree
        t = min(t, float(knots[max(reads, 0)]))
    return max(t, curve.domain.start)


def _missing(curve: Nurbs, t: float) -> int:
    """How often ``t`` must be inserted to be a p-fold knot; not at all at an end of T."""
    if not curve.domain.start < t < curve.domain.stop:
        return 0
    knots = curve.knots
    return curve.degree - (knots.searchsorted(t, "right") - knots.searchsorted(t))
