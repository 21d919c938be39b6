"""Several strokes over each other become one: their mean ("home in", Grimm-Ayers 2.2.3).

Strokes are averaged one after another. Every stroke counts once: over a place that k strokes
passed, the result is their mean, whatever their speed and their number of samples. Places
correspond by arc length, from end to end of what two strokes share, and from corner to corner where
both turn; between these they slide to where the strokes are closest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import attrs
import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.errors import EditError
from multirep.sampled import interpolate
from multirep.strokes.arc_length import arc_lengths, norms
from multirep.strokes.cleaning import Stroke
from multirep.strokes.parting import ROUND, parted
from multirep.strokes.places import STATIONS, nearest_lengths, runs_backwards
from multirep.strokes.sliding import slid

Mask: TypeAlias = npt.NDArray[np.bool_]

#: Strokes that keep farther from each other than this part of their size are not one curve.
FARTHEST = 0.2
#: Ends closer than this part of the shorter stroke are the same end. Larger takes what was meant to
#: refine a part near an end for a whole new stroke; smaller leaves stubs where hands began anew.
SAME_END = 0.08
#: Where a stroke begins or ends beside another it is faded in over this many times their distance
#: there, at most this part of what they share: a slope of one in ten is not seen as a step.
FADE, LONGEST_FADE = 10.0, 1 / 3
#: Corners correspond when arc length puts them closer than this part of what the strokes share, and
#: they are no farther apart than so many times the strokes themselves.
SAME_CORNER, CORNERS_APART = 0.1, 4.0
#: Stations closer than this part of the mean's length are one.
SAME_STATION = 1e-12


@attrs.frozen(eq=False)
class _Mean:
    """The mean so far: vertices, how many strokes each stands for, and which are corners."""

    points: Array
    weights: Array
    corner: Mask

    @property
    def lengths(self) -> Array:
        return arc_lengths(self.points)


@attrs.frozen
class _Shared:
    """What two strokes share: [start, stop] on the mean, [first, last] on the new stroke.

    ``distance`` is how far apart they are there, on the median; more than ``allowed`` is too far.
    """

    start: float
    stop: float
    first: float
    last: float
    distance: float
    allowed: float


def average_strokes(strokes: Sequence[Stroke]) -> Stroke:
    """Return the mean of strokes over each other.

    A stroke drawn the other way round is reversed first. One that covers only a part of what is
    there refines that part, faded in at its ends; one that goes beyond an end extends it. Over an
    outline whose ends meet a stroke may begin anywhere.

    Parameters
    ----------
    strokes : sequence of Stroke
        One or more, of the same dimension; the first gives the direction.

    Returns
    -------
    Stroke
        With the vertices of all strokes: n strokes with independent errors leave an error sqrt(n)
        times smaller. Cost: linear in the samples of all strokes, for each stroke.

    Raises
    ------
    EditError
        When there are none; when dimensions differ; when a stroke is far from those before it or
        covers none of them (with the distance and what is allowed).

    Examples
    --------
    >>> from multirep.strokes import clean_stroke
    >>> low = clean_stroke([[0, 0], [1, 0], [2, 0]])
    >>> high = clean_stroke([[2, 0.2], [0, 0.2]])  # drawn back
    >>> average_strokes([low, high]).points.tolist()
    [[0.0, 0.1], [1.0, 0.1], [2.0, 0.1]]
    """
    if not strokes:
        raise EditError("there are no strokes; draw at least one")
    first = strokes[0]
    mean = _Mean(first.points, np.ones(len(first.points)), _marked(first))
    for number, stroke in enumerate(strokes[1:], start=2):
        if stroke.points.shape[1] != first.points.shape[1]:
            raise EditError(
                f"stroke {number} has {stroke.points.shape[1]} coordinates, "
                f"the first has {first.points.shape[1]}"
            )
        mean = _joined(mean, stroke, number)
    points = mean.points
    points.setflags(write=False)
    noise = max(stroke.noise for stroke in strokes)
    merged = sum(stroke.merged for stroke in strokes)
    return Stroke(points, np.flatnonzero(mean.corner), noise, merged)


def _marked(stroke: Stroke) -> Mask:
    """Which points of a stroke are corners, (n,)."""
    corner = np.zeros(len(stroke.points), dtype=bool)
    corner[stroke.corners] = True
    return corner


def _joined(mean: _Mean, stroke: Stroke, number: int) -> _Mean:
    """Return the mean with one more stroke in it."""
    u = mean.lengths
    if runs_backwards(mean.points, u, stroke.points, arc_lengths(stroke.points)):
        stroke = stroke.reversed()
    for part in parted(mean.points, u, stroke, SAME_END):
        mean = _averaged(mean, part, number)
    return mean


def _averaged(mean: _Mean, stroke: Stroke, number: int) -> _Mean:
    """Return the mean with a stroke in it that runs along it in its direction."""
    u, s = mean.lengths, arc_lengths(stroke.points)
    shared = _shared(mean.points, u, stroke.points, s, number)
    at, there = _anchors(
        _Corners(u[mean.corner], mean.points[mean.corner]),
        _Corners(s[stroke.corners], stroke.points[stroke.corners]),
        shared,
    )
    at, there = slid(mean.points, u, stroke.points, s, at, there)
    # stations: all vertices of both, as lengths along the mean
    ours_inside = u[(u > shared.start) & (u < shared.stop)]
    theirs_inside = np.interp(s[(s > shared.first) & (s < shared.last)], there, at)
    ends = np.array([shared.start, shared.stop])
    stations = np.unique(np.concatenate([ends, ours_inside, theirs_inside]))
    other = np.diff(stations) > SAME_STATION * u[-1]  # corresponding vertices are one station
    stations = stations[np.concatenate([[True], other])]
    stations[-1] = shared.stop
    ours = interpolate(u, mean.points, stations)
    theirs = interpolate(s, stroke.points, np.interp(stations, at, there))
    apart = norms(theirs - ours)
    if float(np.median(apart)) > shared.allowed:
        raise _elsewhere(number, float(np.median(apart)), shared.allowed)
    old, new = _weights(mean, u, stations, shared, s, apart)
    points = ours + (new / (old + new))[:, None] * (theirs - ours)
    turns = u[mean.corner]
    turns = turns[(turns >= shared.start) & (turns <= shared.stop)]
    corner = np.zeros(len(stations), dtype=bool)
    corner[np.rint(np.interp(turns, stations, np.arange(len(stations)))).astype(np.intp)] = True
    # what only one of them has goes before and after
    lead, trail = s < shared.first, s > shared.last
    head, tail = u < shared.start, u > shared.stop
    drawn, ones = _marked(stroke), np.ones(len(s))
    pieces = [
        (stroke.points[lead], ones[lead], drawn[lead]),
        (mean.points[head], mean.weights[head], mean.corner[head]),
        (points, old + new, corner),
        (mean.points[tail], mean.weights[tail], mean.corner[tail]),
        (stroke.points[trail], ones[trail], drawn[trail]),
    ]
    points, weights, corner = (np.concatenate(column) for column in zip(*pieces, strict=True))
    return _distinct(points, weights, corner, number)


def _shared(points: Array, u: Array, other: Array, s: Array, number: int) -> _Shared:
    """Find what two strokes of the same direction share."""
    asked = np.linspace(0.0, s[-1], STATIONS)
    where, far = nearest_lengths(points, u, interpolate(s, other, asked))
    size = float(norms(np.ptp(points, axis=0)[None])[0])
    distance, allowed = float(np.median(far)), FARTHEST * size
    close = SAME_END * min(u[-1], s[-1])
    meets = norms(other[[0, -1]] - points[[0, -1]]) <= close
    if 0.5 < u[-1] / s[-1] < 2 and meets.all():
        shared = _Shared(0.0, float(u[-1]), 0.0, float(s[-1]), distance, allowed)
    else:
        ends, _ = nearest_lengths(points, u, other[[0, -1]])
        beyond, _ = nearest_lengths(other, s, points[[0, -1]])
        jumps = np.flatnonzero(where[1:] - where[:-1] < -ROUND * u[-1])
        if len(jumps) == 1:  # what is beside the one end of a bow goes beyond the other
            late = int(2 * jumps[0] >= STATIONS - 2)
            ends[late] = u[-late]
        start, first = _end(ends[0], beyond[0], 0.0, 0.0, bool(meets[0]), close)
        stop, last = _end(ends[1], beyond[1], float(u[-1]), float(s[-1]), bool(meets[1]), close)
        within = (asked >= first) & (asked <= last)
        if within.any():  # what goes beyond an end may be anywhere
            distance = float(np.median(far[within]))
        shared = _Shared(start, stop, first, last, distance, allowed)
    if not (shared.start < shared.stop and shared.first < shared.last) or distance > allowed:
        raise _elsewhere(number, distance, allowed)
    return shared


def _elsewhere(number: int, distance: float, allowed: float) -> EditError:
    return EditError(
        f"stroke {number} is not drawn over the ones before: it keeps {distance:.3g} from "
        f"them, allowed is {allowed:.3g} ({FARTHEST:g} of their size), and it must run along a "
        "part of them"
    )


def _end(
    place: float, beyond: float, end: float, other_end: float, meets: bool, close: float
) -> tuple[float, float]:
    """Where the shared part begins (or ends): (on the mean, on the stroke).

    ``place`` is where the stroke's end lies on the mean, ``beyond`` where the mean's end lies on
    the stroke.
    """
    if meets or (abs(place - end) <= close and abs(beyond - other_end) <= close):
        return end, other_end
    if place == end:  # the stroke goes beyond the end of the mean
        return end, beyond
    return place, other_end


class _Corners(NamedTuple):
    """Corners of a stroke: lengths along it (k,), and places (k, d)."""

    lengths: Array
    points: Array

    def between(self, start: float, stop: float) -> _Corners:
        inside = (self.lengths > start) & (self.lengths < stop)
        return _Corners(self.lengths[inside], self.points[inside])


def _anchors(ours: _Corners, theirs: _Corners, shared: _Shared) -> tuple[Array, Array]:
    """Corresponding lengths on the mean and on the stroke: ends, and corners that both have."""
    ours = ours.between(shared.start, shared.stop)
    theirs = theirs.between(shared.first, shared.last)
    span, length = shared.stop - shared.start, shared.last - shared.first
    at = there = np.empty(0)
    if len(ours.lengths) and len(theirs.lengths):
        expected = shared.start + (theirs.lengths - shared.first) * (span / length)
        nearest, back = _nearest(expected, ours.lengths), _nearest(ours.lengths, expected)
        common = back[nearest] == np.arange(len(expected))
        common &= np.abs(expected - ours.lengths[nearest]) <= SAME_CORNER * span
        apart = norms(theirs.points - ours.points[nearest])
        common &= apart <= CORNERS_APART * shared.distance + SAME_STATION * span
        at, there = ours.lengths[nearest[common]], theirs.lengths[common]
    at = np.concatenate([[shared.start], at, [shared.stop]])
    there = np.concatenate([[shared.first], there, [shared.last]])
    return at, there


def _nearest(values: Array, others: Array) -> Indices:
    """Index of the nearest of increasing ``others`` for each value, (m,)."""
    k = np.clip(others.searchsorted(values), 1, max(len(others) - 1, 1))
    after = np.minimum(k, len(others) - 1)
    nearest: Indices = np.where(values - others[k - 1] <= others[after] - values, k - 1, after)
    return nearest


def _weights(
    mean: _Mean, u: Array, stations: Array, shared: _Shared, s: Array, apart: Array
) -> tuple[Array, Array]:
    """How much the mean and the new stroke count at each station, (m,) and (m,).

    Where only one of them goes on, the other is faded out towards that end.
    """
    old = np.interp(stations, u, mean.weights)
    new = np.ones(len(stations))
    longest = LONGEST_FADE * (shared.stop - shared.start)
    start = min(FADE * float(apart[0]), longest)
    stop = min(FADE * float(apart[-1]), longest)
    fade_in, fade_out = stations - shared.start, shared.stop - stations
    if shared.start > 0:
        new *= _ramp(fade_in, start)
    elif shared.first > 0:
        old *= _ramp(fade_in, start)
    if shared.stop < u[-1]:
        new *= _ramp(fade_out, stop)
    elif shared.last < s[-1]:
        old *= _ramp(fade_out, stop)
    return old, new


def _ramp(distance: Array, apron: float) -> Array:
    """Rise smoothly from 0 at the end of the apron to 1 beyond it."""
    if apron == 0.0:
        return np.ones(len(distance))
    x = np.clip(distance / apron, 0.0, 1.0)
    ramp: Array = x * x * (3 - 2 * x)
    return ramp


def _distinct(points: Array, weights: Array, corner: Mask, number: int) -> _Mean:
    """Drop repeated points."""
    keep = np.concatenate([[True], (points[1:] != points[:-1]).any(axis=1)])
    if keep.sum() < 2:
        raise EditError(f"stroke {number} cancels those before: their mean has no length")
    return _Mean(points[keep], weights[keep], corner[keep])
