"""Correspondence of two strokes, bettered: places slide along to where the strokes are closest.

Arc length alone drifts: a hand that trembles draws a longer line through the same places.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.nearest import distance_to_chords
from multirep.sampled import interpolate
from multirep.strokes.arc_length import norms

#: Places that slide, and chords of the other stroke that they may slide to. A thousand chords tell
#: 1/10 of the distance between stations; both are fixed, so that the cost stays linear.
STATIONS, CHORDS = 64, 1024
#: How far a place may slide, in terms of what the strokes share.
FARTHEST = 0.1
#: What sliding costs against distance. Larger trusts arc length more; 0 would let places jump to
#: another branch at a crossing.
RELUCTANCE = 0.25
#: Least speed of the correspondence, in terms of that by arc length: nothing is squeezed together.
SLOWEST = 0.2


def slid(
    points: Array, u: Array, other: Array, s: Array, at: Array, there: Array
) -> tuple[Array, Array]:
    """Refine corresponding lengths along two strokes.

    Parameters
    ----------
    points, u : (n, d) and (n,) arrays
        One stroke, and the length up to each point.
    other, s : (m, d) and (m,) arrays
        The other.
    at, there : (k,) arrays
        Corresponding lengths on the one and on the other, increasing; these stay.

    Returns
    -------
    (j,) and (j,) arrays
        More of them, non-decreasing on the one and increasing on the other.

    Notes
    -----
    A station slides by the x that minimises distance^2 + (RELUCTANCE x)^2; slides are averaged over
    three neighbours.
    """
    span, length = at[-1] - at[0], there[-1] - there[0]
    stations = np.linspace(there[0], there[-1], STATIONS + 2)[1:-1]
    stations = stations[~np.isin(stations, there)]
    expected = np.interp(stations, there, at)
    marks = np.linspace(at[0], at[-1], CHORDS + 1)
    rows = interpolate(u, points, marks)
    places = interpolate(s, other, stations)
    now = norms(places - interpolate(u, points, expected))
    slides = np.zeros(len(stations))
    reach = int(np.ceil(FARTHEST * CHORDS))
    for i, place in enumerate(places):  # a fixed number
        k = int((expected[i] - at[0]) / span * CHORDS)
        low, high = max(k - reach, 0), min(k + reach + 1, CHORDS)
        along, distance = distance_to_chords(rows[low:high], rows[low + 1 : high + 1], place)
        x = marks[low:high] + along * (span / CHORDS) - expected[i]
        cost = distance**2 + (RELUCTANCE * x) ** 2
        best = int(cost.argmin())
        if cost[best] < now[i] ** 2:
            slides[i] = x[best]
    where = np.concatenate([there, stations])
    order = where.argsort(kind="stable")
    expected = np.concatenate([at, expected])[order]
    moved = np.concatenate([np.zeros(len(at)), slides])[order]
    fixed = order < len(at)
    averaged = moved.copy()
    averaged[1:-1] = (moved[:-2] + moved[1:-1] + moved[2:]) / 3
    averaged[fixed] = 0.0
    where = where[order]
    # never back, never much slower than by arc length; fixed places stay
    least = SLOWEST * span / length * where
    result = np.maximum.accumulate(expected + averaged - least) + least
    ceiling = np.minimum.accumulate((np.where(fixed, expected, np.inf) - least)[::-1])[::-1] + least
    return np.minimum(result, ceiling), where
