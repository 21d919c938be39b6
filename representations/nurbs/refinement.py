"""More knots where a fit fails: spans are cut, and corners become knots of full multiplicity."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Flags, Indices
from multirep.representations.nurbs.problem import (
    CORNER_HEIGHT,
    KINK_HEIGHT,
    Breakpoints,
    Course,
    Trial,
)
from multirep.splines import compiled

#: A span with at most CORNER_VERTICES vertices of the polyline inside gets a corner when its
#: residual exceeds the allowance this many times: smooth knots around a kink of height H need
#: about log(H / allowance) of them, a corner p.
CORNER_RATIO = 3.0
CORNER_VERTICES = 2
#: Only a vertex that stands out so many times as far as those beside it is a corner of a curve that
#: is smooth otherwise. Along a fractal line a knot at each vertex serves all its kinks.
PROMINENCE = 3.0
#: When the span at an end of the window fails though it is shorter than this part of the first
#: chord, the join there gives up its smoothness.
APPROACH = 1 / 16
#: A span is cut in at most so many parts at once.
MOST_PARTS = 8
#: Breakpoints nearer to each other than this part of the window are one: a cut in the middle of a
#: span may fall one ulp beside a vertex that becomes a corner later.
NEAREST = 2.0**-40


def refined(
    degree: int, course: Course, trial: Trial, failing: Indices, *, corners_only: bool = False
) -> Breakpoints:
    """Return breakpoints with the failing spans cut.

    Parameters
    ----------
    degree : int
    course : Course
    trial : Trial
        The fit that fails.
    failing : indices of spans
    corners_only : bool
        The last resort: every vertex in a failing span becomes a corner, so that the polyline
        itself is in the space of splines.

    Returns
    -------
    Breakpoints
    """
    p, at, t = degree, trial.breakpoints.at, course.t
    times = trial.breakpoints.times.copy()
    low = t.searchsorted(at[failing], "right")
    high = t.searchsorted(at[failing + 1], "left")
    inside = high - low
    ratio = trial.worst[failing]
    new: list[Array] = []
    corners: list[Array] = []
    kinked = kinks(course) if bool((inside <= CORNER_VERTICES).any()) else np.empty(0, dtype=bool)
    if corners_only:
        new.append(_between(t, low, high))
        corners.append(new[-1])
        for end in (failing, failing + 1):
            times[end] = np.maximum(times[end], p)
        # Varying weights bend a chord between two corners; shorter spans bend it less.
        bare = failing[inside == 0]
        for share in (0.25, 0.5, 0.75):
            new.append((1 - share) * at[bare] + share * at[bare + 1])
    else:
        peak = _peaks(trial, failing)
        # A vertex nearest to the peak, inside the span where there is one.
        near = t.searchsorted(peak)
        near = near - (
            (near > 0)
            & (peak - t[np.maximum(near - 1, 0)] < t[np.minimum(near, len(t) - 1)] - peak)
        )
        near = np.clip(near, low, np.maximum(high - 1, low))
        vertex = t[near]
        few = (inside > 0) & (inside <= CORNER_VERTICES)
        new.append(vertex[few])
        if few.any():
            sharp = few & (ratio > CORNER_RATIO)
            corners.append(vertex[sharp][kinked[near[sharp]]])
        many = np.flatnonzero(inside > CORNER_VERTICES)
        parts = np.clip(np.ceil(0.9 * ratio[many] ** (1 / (p + 1))), 2, MOST_PARTS).astype(np.intp)
        parts = np.minimum(parts, inside[many] + 1)
        new.append(_quantiles(t, low[many], inside[many], parts))
        none = np.flatnonzero(inside == 0)
        if len(none):
            new.append(_cut_bare(p, course, trial, failing[none], kinked, times))
    return merged_breakpoints(Breakpoints(at, times), np.concatenate(new), corners, p)


def kinks(course: Course) -> Flags:
    """Which vertices, (m + 1,), may become corners; the first and the last may not."""
    heights, found = course.heights, np.zeros(len(course.t), dtype=bool)
    least = np.full(len(heights), KINK_HEIGHT)
    least[1:] = np.maximum(least[1:], PROMINENCE * heights[:-1])
    least[:-1] = np.maximum(least[:-1], PROMINENCE * heights[1:])
    found[1:-1] = heights > np.minimum(least, CORNER_HEIGHT)
    return found


def _cut_bare(
    p: int, course: Course, trial: Trial, spans: Indices, kinked: Flags, times: Indices
) -> Array:
    """Cut spans without a vertex inside; return where.

    At a kinked end a corner; at an end of the window that was approached in vain for a while, a
    knot of full multiplicity, so that only the point there is fixed: these are put into ``times``.
    Else in the middle.
    """
    at, t = trial.breakpoints.at, course.t
    begins, ends = at[spans], at[spans + 1]
    first, last = trial.ratios[trial.firsts[spans]], trial.ratios[trial.firsts[spans + 1]]
    where = np.where(first > last, spans, spans + 1)
    place = np.minimum(t.searchsorted(at[where]), len(t) - 1)
    raised = (t[place] == at[where]) & kinked[place] & (times[where] < p)
    times[where[raised]] = p
    for end, chord in ((0, 0), (len(at) - 1, len(t) - 2)):
        span = end if end == 0 else end - 1
        short = at[span + 1] - at[span] < APPROACH * (t[chord + 1] - t[chord])
        if short and times[end] < p:
            hit = spans == span
            times[end] = max(int(times[end]), p) if hit.any() else times[end]
            raised |= hit
    rest = ~raised
    return np.asarray(0.5 * (begins[rest] + ends[rest]))


def _peaks(trial: Trial, spans: Indices) -> Array:
    """Return the parameter of the largest ratio on each of some spans."""
    starts, stops = trial.firsts[spans], trial.firsts[spans + 1]
    if len(spans) <= 4:
        return np.array(
            [
                trial.rows[a + int(trial.ratios[a : b + 1].argmax())]
                for a, b in zip(starts.tolist(), stops.tolist(), strict=True)
            ]
        )
    counts = stops - starts + 1
    ends = counts.cumsum()
    rows = np.arange(ends[-1]) + (starts - (ends - counts)).repeat(counts)
    largest = np.flatnonzero(trial.ratios[rows] == trial.worst[spans].repeat(counts))
    return np.asarray(trial.rows[rows[largest[largest.searchsorted(ends - counts)]]])


def _between(t: Array, low: Indices, high: Indices) -> Array:
    counts = np.maximum(high - low, 0)
    ends = counts.cumsum()
    if not ends[-1]:
        return np.empty(0)
    return np.asarray(t[np.arange(ends[-1]) + (low - (ends - counts)).repeat(counts)])


def _quantiles(t: Array, low: Indices, inside: Indices, parts: Indices) -> Array:
    """Return vertices that divide the vertices inside each span into equal shares."""
    if not len(low):
        return np.empty(0)
    cuts = parts - 1
    ends = cuts.cumsum()
    number = np.arange(ends[-1]) - (ends - cuts).repeat(cuts) + 1
    share = number * ((inside + 1) / parts).repeat(cuts)
    index = low.repeat(cuts) + np.clip(np.rint(share).astype(np.intp), 1, inside.repeat(cuts)) - 1
    return t[index]


def window_breakpoints(
    inner: Array, times: tuple[int, int], degree: int, course: Course
) -> Breakpoints:
    """Return the breakpoints that a spliced window begins with.

    Parameters
    ----------
    inner : (k,) array
        Non-decreasing: the old knots between both ends of the course.
    times : pair of int
        How often these ends are knots.
    degree : int
    course : Course

    Returns
    -------
    Breakpoints
        The old knots, once each, and corners: where the course needs them, and old ones where it
        has a kink to speak of.
    """
    start, stop = float(course.t[0]), float(course.t[-1])
    if compiled.active:
        limits = CORNER_HEIGHT, KINK_HEIGHT, NEAREST
        numbers, counts = compiled.core.breakpoints(
            inner, start, stop, *times, degree, course.t, course.heights, *limits
        )
        return Breakpoints(np.frombuffer(numbers), np.frombuffer(counts, dtype=np.intp))
    distinct, counted = np.unique(inner, return_counts=True)
    at = np.concatenate(([start], distinct, [stop]))
    found = Breakpoints(at, np.ones(len(at), dtype=np.intp))
    found.times[[0, -1]] = times
    kinked = course.t[1:-1][course.heights > KINK_HEIGHT]
    corners = np.union1d(course.corners, np.intersect1d(distinct[counted >= degree], kinked))
    return merged_breakpoints(found, corners, [corners], degree) if len(corners) else found


def merged_breakpoints(
    old: Breakpoints, new: Array, corners: list[Array], degree: int
) -> Breakpoints:
    """Add simple breakpoints, and raise some to full multiplicity."""
    at = np.concatenate((old.at, new))
    at.sort()
    at = at[np.concatenate(([True], at[1:] > at[:-1]))]
    times = np.ones(len(at), dtype=np.intp)
    times[at.searchsorted(old.at)] = old.times
    for values in corners:
        places = at.searchsorted(values)
        times[places] = np.maximum(times[places], degree)
    return _apart(Breakpoints(at, times))


def _apart(found: Breakpoints) -> Breakpoints:
    """Drop the lesser of two breakpoints between which no curve can be told from a corner."""
    at, times = found.at, found.times
    least = NEAREST * (at[-1] - at[0]) + 8 * np.spacing(max(abs(at[0]), abs(at[-1])))
    close = (at[1:] - at[:-1] < least).nonzero()[0]
    if not len(close):
        return found
    lesser = np.where(times[close] < times[close + 1], close, close + 1)
    inner = np.where(lesser == len(at) - 1, close, lesser)  # the ends of the window stay
    inner = inner[(inner > 0) & (inner < len(at) - 1)]
    return Breakpoints(np.delete(at, inner), np.delete(times, inner))
