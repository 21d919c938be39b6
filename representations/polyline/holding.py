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
