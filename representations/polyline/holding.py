"""Vertices at the borders of a stretch, so that it stays bit by bit whatever happens beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from multirep.edit import Edit
from multirep.interval import Interval
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.polyline.curve import Polyline

P = TypeVar("P", bound="Polyline")

NOTHING = SpliceList.EMPTY
#: A vertex this close to the line between its neighbours is on it, in terms of the coordinates.
ROUNDING = 2.0**-48


def held(curve: P, interval: Interval, keep: SpliceList) -> tuple[Edit[P], Interval]:
    """Insert vertices at the ends; where ``keep`` forbids it, go on to the next vertex.

    A segment that is cut evaluates to other last bits, so none may be cut of which a part is kept.
    Cost: two insertions.
    """
    value, splices = curve, SpliceList.EMPTY
    ends = []
    for t, outward in ((interval.start, -1), (interval.stop, 1)):
        k = value.t.searchsorted(t)
        after = float(value.t[k])
        if after != t:
            segment = Interval(float(value.t[k - 1]), after)
            if keep.intersects(SpliceList([segment])):
                t = segment.start if outward < 0 else segment.stop
            else:
                edit = value.insert_vertex(t)
                value, splices = edit.value, splices | edit.splices
        ends.append(t)
    return Edit(value, splices), Interval(*ends)


def released(curve: P, t: float) -> Edit[P]:
    """Delete the vertex at ``t`` if the line between its neighbours passes it at ``t``."""
    k = curve.t.searchsorted(t)
    if not 0 < k < curve.size - 1 or float(curve.t[k]) != t:
        return Edit(curve, SpliceList.EMPTY)
    around, points = curve.t.window(k - 1, k + 2), curve.points.window(k - 1, k + 2)
    share = (around[1] - around[0]) / (around[2] - around[0])
    off = points[0] + share * (points[2] - points[0]) - points[1]
    if float(abs(off).max()) > ROUNDING * curve.magnitude:
        return Edit(curve, SpliceList.EMPTY)
    return curve.delete_vertex(k)
