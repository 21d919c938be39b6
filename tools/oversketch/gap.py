"""Which stretch of the curve a stroke is meant to replace."""

from __future__ import annotations

from typing import NamedTuple

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.polyline import Polyline
from multirep.sampled import interpolate
from multirep.spacing import room
from multirep.strokes.arc_length import arc_lengths

#: A stroke whose ends are farther from the curve than this part of its own length was meant for
#: something else.
FARTHEST = 1 / 4
#: An end of the curve that is at most so many times as far from the stroke's end as the nearest
#: place is what the hand aimed at.
AIMED = 1.5
#: Places along the stroke that are asked which side of a curve whose ends meet it follows.
WITNESSES = 7
#: A place so close to a vertex, in terms of its segment, is that vertex.
SAME_VERTEX = 1e-9


@attrs.frozen
class Gap:
    """The stretch of T that a stroke replaces.

    Parameters
    ----------
    start, stop : float
        start < stop.
    free_start, free_stop : bool
        Whether that end is an end of T, where the curve goes wherever the stroke does.
    far_start, far_stop : float
        How far the stroke's ends are from the curve.
    backwards : bool
        Whether the stroke was drawn from stop to start.
    """

    start: float
    stop: float
    free_start: bool
    free_stop: bool
    far_start: float
    far_stop: float
    backwards: bool

    @property
    def stretch(self) -> Interval:
        """The stretch as an interval."""
        return Interval(self.start, self.stop)


class _Place(NamedTuple):
    """Where an end of the stroke lies on the curve."""

    t: float
    distance: float


def find_gaps(polyline: Polyline, drawn: Array, reach: float | None) -> list[tuple[Gap, Array]]:
    """Find what a stroke replaces: a stretch, or both ends of a curve whose ends meet.

    Parameters
    ----------
    polyline, drawn, reach
        See :func:`find_gap`.

    Returns
    -------
    list of (Gap, (k, d) array)
        From the last to the first, each with its part of the stroke in the direction of the curve.
    """
    gap = find_gap(polyline, drawn, reach)
    drawn = drawn[::-1] if gap.backwards else drawn
    lengths = arc_lengths(drawn)
    inner = not (gap.free_start or gap.free_stop)
    # a wide reach is about the stroke's ends, and makes no open curve a closed one
    close = min(_allowed(lengths, reach), _allowed(lengths, None))
    closes = inner and _closes(polyline, close)
    if not (closes and _goes_round(polyline, drawn, gap)):
        return [(gap, drawn)]
    a, b = polyline.domain
    way = Polyline(lengths, drawn)
    s = way.nearest(0.5 * (polyline(a) + polyline(b))).t
    if not 0.0 < s < lengths[-1]:
        return [(gap, drawn)]
    k, seam = lengths.searchsorted(s), way(s)[None]
    to_start = np.concatenate([seam, drawn[:k][::-1]])
    from_stop = np.concatenate([drawn[lengths > s][::-1], seam])
    return [
        (Gap(gap.stop, b, False, True, gap.far_stop, 0.0, False), from_stop),
        (Gap(a, gap.start, True, False, 0.0, gap.far_start, False), to_start),
    ]


def find_gap(polyline: Polyline, drawn: Array, reach: float | None) -> Gap:
    """Find the stretch between the places nearest to the ends of a stroke.

    Parameters
    ----------
    polyline : Polyline
    drawn : (n, d) array
        The stroke.
    reach : float or None
        How far its ends may be from the curve; None: a quarter of its length. An end that lies
        beyond an end of the curve may be anywhere, if the other is within reach.

    Raises
    ------
    EditError
        When the stroke is far from the curve or both its ends mean one place. Says the distances
        and what is allowed.
    """
    lengths = arc_lengths(drawn)
    allowed = _allowed(lengths, reach)
    first, last = _place(polyline, drawn[0]), _place(polyline, drawn[-1])
    ends = (polyline.domain.start, polyline.domain.stop)
    distances = [first.distance, last.distance]
    far = [p for p in (first, last) if p.distance > allowed]
    if len(far) == 2 or (far and far[0].t not in ends):
        raise EditError(
            f"the stroke is too far from the curve: it begins {first.distance:.3g} from it and "
            f"ends {last.distance:.3g} from it, allowed is {allowed:.3g}"
            + (" (a quarter of its length)" if reach is None else "")
            + "; begin and end it on the curve, or give a larger reach"
        )
    t = [first.t, last.t]
    if _closes(polyline, allowed):
        t = _resolved(polyline, drawn, lengths, t)
    if t[0] == t[1]:
        hint = (
            "; to extend the curve, begin the stroke on the curve before its end"
            if t[0] in ends
            else ""
        )
        raise EditError(
            f"both ends of the stroke mean one place of the curve, t = {t[0]:.6g}: there is no "
            f"stretch to replace{hint}"
        )
    backwards = t[0] > t[1]
    if backwards:
        t.reverse()
        distances.reverse()
    free = t[0] == ends[0], t[1] == ends[1]
    return Gap(t[0], t[1], *free, distances[0], distances[1], backwards)


def _allowed(lengths: Array, reach: float | None) -> float:
    return FARTHEST * float(lengths[-1]) if reach is None else reach


def _place(polyline: Polyline, point: Array) -> _Place:
    """Nearest place, or the end of the curve, or the vertex, that was meant."""
    nearest = polyline.nearest(point)
    for end in polyline.domain:
        if float(np.linalg.norm(polyline(end) - point)) <= AIMED * nearest.distance:
            return _Place(end, nearest.distance)
    return _Place(_snapped(polyline, nearest.t), nearest.distance)


def _snapped(polyline: Polyline, t: float) -> float:
    """Return the vertex that is as good as at ``t``; else t."""
    k = max(polyline.t.searchsorted(t), 1)
    low, high = float(polyline.t[k - 1]), float(polyline.t[k])
    close = max(SAME_VERTEX * (high - low), room(low, high))
    if t - low <= close or high - t <= close:
        return low if t - low <= high - t else high
    return t


def _closes(polyline: Polyline, allowed: float) -> bool:
    """Whether the ends of the curve meet, as far as the stroke can tell."""
    a, b = polyline.domain
    return float(np.linalg.norm(polyline(a) - polyline(b))) <= allowed


def _resolved(polyline: Polyline, drawn: Array, lengths: Array, t: list[float]) -> list[float]:
    """Choose among the two ends of a curve that meet: the one on the side where the stroke runs."""
    ends = tuple(polyline.domain)
    at_end = [value in ends for value in t]
    if at_end[0] == at_end[1]:
        return list(ends) if at_end[0] and t[0] != t[1] else t
    other = t[1] if at_end[0] else t[0]
    votes = sum(1 if t < other else -1 for t in _witnesses(polyline, drawn, lengths))
    end = ends[0] if votes > 0 else ends[1]
    return [end, other] if at_end[0] else [other, end]


def _goes_round(polyline: Polyline, drawn: Array, gap: Gap) -> bool:
    """Whether a stroke runs along the rest of a curve whose ends meet, not along the gap."""
    places = _witnesses(polyline, drawn, arc_lengths(drawn))
    return sum(1 if gap.stretch.contains(t) else -1 for t in places) < 0


def _witnesses(polyline: Polyline, drawn: Array, lengths: Array) -> list[float]:
    """Parameters of the places nearest to some stations of a stroke."""
    along = lengths[-1] * np.linspace(0, 1, WITNESSES + 2)[1:-1]
    return [polyline.nearest(station).t for station in interpolate(lengths, drawn, along)]
