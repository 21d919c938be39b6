"""How far two curves are apart at equal t: a lower bound seen, an upper bound proved."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, chord_bounds, interpolate
from multirep.splices import SpliceList

#: First sampling tolerance in terms of the scale; the upper bound exceeds the lower one by about
#: twice as much. That is below CLOSE, so most curves need no second round: samples are cheaper by
#: the array than by the stretch.
FIRST_TOLERANCE = 1 / 512
#: Each round samples the undecided chords this much more finely.
TIGHTENING = 1 / 16
#: The bounds are close enough when they differ by this part of the scale.
CLOSE = 1 / 200
#: At most so many rounds; each costs only the undecided chords.
ROUNDS = 3


@attrs.frozen
class Deviation:
    """Bounds of max ``||R1(t) - R2(t)||`` over T (or over the part that was asked for).

    Parameters
    ----------
    lower : float
        A distance that occurs.
    upper : float
        Proved: no t has a larger one.
    """

    lower: float
    upper: float


def deviation(
    one: Representation, two: Representation, where: SpliceList, *, scale: float
) -> Deviation:
    """Bound the largest distance between two curves at equal t, for all t in ``where``.

    Both are sampled with certificates; between samples the difference of two polylines is largest
    at a vertex, so a chord is bounded by its ends plus both certificates. Undecided chords are
    sampled more finely.

    Parameters
    ----------
    one, two : Representation
        On the same domain.
    where : SpliceList
    scale : float
        Differences that are small against it need no finer look (the tolerance, say).

    Returns
    -------
    Deviation
        Cost: as sampling both on ``where``, once coarsely and then near the maximum.
    """
    lower, upper = 0.0, 0.0
    tolerance = FIRST_TOLERANCE * scale
    for round_ in range(ROUNDS):
        starts, stops, bounds = [], [], []
        for splice in where:
            t, seen, proved = chord_deviations(one, two, splice, tolerance=tolerance)
            lower = max(lower, float(seen.max()))
            starts.append(t[:-1])
            stops.append(t[1:])
            bounds.append(proved)
        if not bounds:
            break
        start, stop, bound = np.concatenate(starts), np.concatenate(stops), np.concatenate(bounds)
        undecided = bound > lower + CLOSE * scale
        decided = bound[~undecided]
        upper = max(upper, float(decided.max())) if decided.size else upper
        if not undecided.any() or round_ == ROUNDS - 1:
            upper = max(upper, float(bound[undecided].max())) if undecided.any() else upper
            break
        where = _stretches(start[undecided], stop[undecided])
        tolerance *= TIGHTENING
    return Deviation(lower, max(lower, upper))


def _stretches(start: Array, stop: Array) -> SpliceList:
    """Return intervals as splices; gaps no longer than what stands beside them are closed.

    Each splice costs a call, so many short ones cost more than the gaps between them.
    """
    length = stop - start
    apart = start[1:] - stop[:-1] > length[1:] + length[:-1]
    starts = start[np.concatenate([[True], apart])]
    stops = stop[np.concatenate([apart, [True]])]
    return SpliceList(Interval(a, b) for a, b in zip(starts, stops, strict=True))


def chord_deviations(
    one: Representation, two: Representation, interval: Interval, *, tolerance: float
) -> tuple[Array, Array, Array]:
    """Bounds chord by chord: (t, seen at t, proved between neighbours), m + 1, m + 1 and m long."""
    a, b = one.sample(interval, tolerance=tolerance), two.sample(interval, tolerance=tolerance)
    t = np.union1d(a.t, b.t)
    # distances of the polylines; at a sample of both, of the curves
    apart = np.linalg.norm(interpolate(a.t, a.points, t) - interpolate(b.t, b.points, t), axis=1)
    slack = _on(a, t) + _on(b, t)
    proved: Array = np.maximum(apart[1:], apart[:-1]) + slack
    seen: Array = np.linalg.norm(one(t) - two(t), axis=1)
    return t, seen, proved


def _on(sampled: SampledSplice, t: Array) -> Array:
    """Certificates of the chords that the finer parameters ``t`` cut."""
    bounds = chord_bounds(sampled)
    k = np.clip(sampled.t.searchsorted(t[:-1], side="right") - 1, 0, len(bounds) - 1)
    values: Array = bounds[k]
    return values
