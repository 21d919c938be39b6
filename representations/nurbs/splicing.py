"""Following a polyline on a part of T while everything outside stays as it is (Grimm-Ayers 6.2).

Instead of pinning the outside by interpolation conditions as the paper does, the control points
that reach outside are computed (`joining`) and only the others are unknown, so the system stays
banded. Knots: the old ones inside to begin with, more where the fit fails (`refinement`), fewer and
better placed ones when there are clearly too many (`equalizing`), so that repeated edits of one
place accumulate nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.representations.nurbs.joining import WeightError, Window
from multirep.representations.nurbs.problem import Breakpoints, Course, Problem, Trial
from multirep.representations.nurbs.refinement import window_breakpoints
from multirep.representations.nurbs.search import check_tolerance, searched
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")


def spliced(curve: N, sampled: SampledSplice, tolerance: float) -> Edit[N]:
    """Return the curve that follows ``sampled`` on its interval."""
    if sampled.dimension != curve.dimension:
        raise InvalidCurveError(
            f"a curve in {curve.dimension} coordinates cannot follow samples in {sampled.dimension}"
        )
    start, stop = float(sampled.t[0]), float(sampled.t[-1])
    domain = curve.domain
    if start < domain.start or stop > domain.stop:
        raise ParameterError(f"the splice {sampled.interval} leaves the domain {domain}")
    course = Course.from_sampled(sampled, tolerance)
    check_tolerance(course, curve.degree, tolerance)
    _check_gaps(curve, course, tolerance)
    window = Window.of(curve, start, stop, course.points)
    problem = Problem(curve.degree, course, window)
    forced, begin = _beginning(curve, window, course, start, stop)
    try:
        trial, bound = searched(problem, begin, forced, tolerance)
    except WeightError:
        # With full multiplicity at both ends the weights outside need not be continued inside.
        times = begin.times.copy()
        times[[0, -1]] = np.maximum(times[[0, -1]], curve.degree)
        trial, bound = searched(problem, Breakpoints(begin.at, times), forced, tolerance)
    return _assembled(curve, window, trial, bound)


def _check_gaps(curve: Nurbs, course: Course, tolerance: float) -> None:
    """Refuse at once when the curve outside does not meet the course within the allowance."""
    domain = curve.domain
    for i, end in ((0, domain.start), (-1, domain.stop)):
        at = float(course.t[i])
        if at == end:
            continue
        gap = math.dist(curve(at).tolist(), course.points[i].tolist())
        if gap > course.allowance[i]:
            raise ToleranceError(
                f"the curve outside is {gap:.3g} away from the samples at t = {at!r}, "
                f"more than the allowed {float(course.allowance[i]):.3g}",
                tolerance=tolerance,
                reachable=gap,
                where=at,
            )


def _beginning(
    curve: Nurbs, window: Window, course: Course, start: float, stop: float
) -> tuple[Array, Breakpoints]:
    """Return knots that must stay inside, and breakpoints to begin with.

    Where the window ends at a knot, the p knots from there on stay, if they can: then nothing
    changes outside, not by a bit. Rational curves keep p knots in any case: their weights are
    continued from outside.
    """
    p = curve.degree
    open_left, open_right = window.start is not None, window.stop is not None
    low = p + 1 if open_left else window.first + 1
    high = curve.size if open_right else window.last + 1
    inside = curve._knots.window(low, max(high, low))
    count = len(inside)
    first = int(inside.searchsorted(start, "right"))
    last = int(inside.searchsorted(stop, "left"))
    times = p + 1 if open_left else max(first, 1), p + 1 if open_right else max(count - last, 1)
    left, right = first, last  # of the p knots at either end those stay that lie between
    if not open_left and (first or window.rational):
        left = min(p, last)
    if not open_right and (count > last or window.rational):
        right = max(count - p, first, left)
    forced = np.concatenate((inside[first:left], inside[right:last]))
    return forced, window_breakpoints(inside[first:last], times, p, course)


def _assembled(curve: N, window: Window, trial: Trial, bound: float) -> Edit[N]:
    """Put the window into the curve, and say where it changed."""
    p, domain = curve.degree, curve.domain
    left, right = window.kept(trial.knots)
    count = trial.size
    points, weights = trial.points, trial.weights
    knots, rows, bottoms = curve._knots, curve._points, curve._weights
    low_knot, low = (window.first + 1, window.first - p + 1) if window.start is None else (0, 0)
    high_knot, high = (
        (window.last + 1, window.last) if window.stop is None else (len(knots), len(rows))
    )
    inner = trial.knots[len(window.outer_left) : len(trial.knots) - len(window.outer_right)]
    # Put only what did change into the arrays. The kept rows of both sides overlap where the window
    # is shorter than an old span.
    skip = min(right, high - low - left)
    begin, end = left, count - skip
    new_weights = None
    if bottoms is not None:
        if weights is None:
            weights = np.full(count, bottoms[low])
        if skip < right:  # products with weights were divided again: take the old bits
            points[count - right :] = rows.window(high - right, high)
            weights[count - right :] = bottoms.window(high - right, high)
        new_weights = bottoms.replaced(low + left, high - skip, weights[begin:end])
    new_knots = knots.replaced(low_knot, high_knot, inner)
    new_rows = rows.replaced(low + left, high - skip, points[begin:end])
    value = curve._with(knots=new_knots, points=new_rows, weights=new_weights)
    at = trial.breakpoints.at
    start, stop = float(at[0]), float(at[-1])
    if window.start is None and left < p:
        start = max(float(trial.knots[left]), domain.start)
    if window.stop is None and right < p:
        stop = min(float(trial.knots[count - right + p]), domain.stop)
    return Edit(value, SpliceList([(start, stop)]), bound=bound)
