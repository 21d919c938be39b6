"""A spline from nothing: few knots, found by cutting what fails and by equalising what does not."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.errors import InvalidCurveError
from multirep.representations.nurbs.equalizing import equalized, relieved
from multirep.representations.nurbs.problem import Breakpoints, Course, Problem, Trial
from multirep.representations.nurbs.refinement import CORNER_RATIO, merged_breakpoints, refined
from multirep.representations.nurbs.search import check_tolerance, evened, passed, proved
from multirep.representations.nurbs.validation import LARGEST_DEGREE
from multirep.sampled import SampledSplice
from multirep.splines import simplified

#: Part of the allowance that leaving vertices out of the polyline may use. Larger saves time and
#: costs control points (their number goes with the 1 / (p + 1)-th power of what is left).
SIMPLIFYING_SHARE = 0.1
#: From so many chords on, vertices are left out first.
MANY_CHORDS = 64
#: Vertices of the (simplified) polyline for each span to begin with.
VERTICES_PER_SPAN = 24
#: Spans are cut until no more than this part of them fails, and none so much that it may hide a
#: corner; then they are laid out anew.
FAILING_SHARE = 1 / 4
CUTTING_PASSES = 8
#: Rounds of laying the spans out anew, passes in each, and passes of relieving what fails then.
#: Measured on curves of all sorts: more rounds leave 1 to 5 per cent fewer, and long polylines have
#: no time for them.
EQUALIZING_ROUNDS = 3
EQUALIZING_PASSES = 4
RELIEVING_PASSES = 12
#: Polylines with more chords than this are long: they get one round.
LONG = 500


@attrs.frozen(eq=False)
class OpenEnds:
    """Both ends of T: fully multiple knots; the curve begins and ends where the polyline does."""

    degree: int
    start: Array
    stop: Array

    def knots(self, breakpoints: Breakpoints) -> Array:
        """Return the clamped knot vector."""
        return breakpoints.at.repeat(breakpoints.times)

    def fixed(self, knots: Array, breakpoints: Breakpoints) -> tuple[Array, slice, Array | None]:
        """Fix the first and the last control point."""
        points = np.zeros((len(knots) - self.degree - 1, len(self.start)))
        points[0], points[-1] = self.start, self.stop
        return points, slice(1, len(points) - 1), None

    def roomy(self, breakpoints: Breakpoints) -> Breakpoints:
        """Return the breakpoints as they are: one row is fixed at each end."""
        return breakpoints


def fitted_arrays(sampled: SampledSplice, tolerance: float, degree: int) -> tuple[Array, Array]:
    """Return knots and control points of a spline that follows ``sampled`` over all of T.

    Vertices that hardly matter are left out first (`simplified`), and their deviation is taken
    off the allowance: so the proof against what is left holds for the whole polyline. Then spans
    are cut until the fit passes, and laid out anew a few times (`equalizing`). The fewest control
    points that pass are proved.

    Raises
    ------
    ToleranceError
        When no fit can be proved.
    """
    if isinstance(degree, bool) or not isinstance(degree, int | np.integer):
        raise InvalidCurveError(f"the degree must be a whole number, got {degree!r}")
    if not 1 <= degree <= LARGEST_DEGREE:
        raise InvalidCurveError(f"the degree must be between 1 and {LARGEST_DEGREE}, got {degree}")
    p = int(degree)
    course = Course.from_sampled(sampled, tolerance)
    check_tolerance(course, p, tolerance)
    course = _simpler(course)
    problem = Problem(p, course, OpenEnds(p, course.points[0], course.points[-1]))
    begin = _beginning(problem)
    trial = _fewest(problem, begin) or passed(problem, begin, tolerance)
    trial, _ = proved(problem, trial, tolerance)
    return trial.knots, trial.points


def _simpler(course: Course) -> Course:
    if len(course.allowance) <= MANY_CHORDS:
        return course
    kept, deviation = simplified(course.t, course.points, SIMPLIFYING_SHARE * course.allowance)
    if len(kept) == len(course.t):
        return course
    allowance = np.minimum.reduceat(course.allowance, kept[:-1]) - deviation
    return Course.of(course.t[kept], course.points[kept], allowance)


def _beginning(problem: Problem) -> Breakpoints:
    """Return evenly filled spans, with a corner at each vertex that stands out far."""
    p, t = problem.degree, problem.course.t
    ends = Breakpoints(t[[0, -1]], np.array([p + 1, p + 1], dtype=np.intp))
    inner = t[VERTICES_PER_SPAN : len(t) - 1 - VERTICES_PER_SPAN // 2 : VERTICES_PER_SPAN]
    corners = problem.course.corners
    if not len(inner) and not len(corners):
        return ends
    return merged_breakpoints(ends, np.concatenate((inner, corners)), [corners], p)


def _fewest(problem: Problem, begin: Breakpoints) -> Trial | None:
    """Cut spans, lay them out anew and relieve what fails, some rounds.

    Returns
    -------
    Trial or None
        That with the fewest control points that passed, if any did.
    """
    best = None
    rounds = 1 if len(problem.course.allowance) > LONG else EQUALIZING_ROUNDS
    try:
        trial = _cut(problem, begin)
        for _ in range(rounds):
            for _ in range(EQUALIZING_PASSES):
                trial = problem.tried(equalized(problem.degree, trial))
            trial = _relieved(problem, trial)
            if float(trial.worst.max()) <= 1.0 and (best is None or trial.size < best.size):
                best = trial
    except np.linalg.LinAlgError:
        pass  # the knots got too close; what passed before counts
    return best


def _cut(problem: Problem, begin: Breakpoints) -> Trial:
    """Cut failing spans until most pass."""
    trial = problem.tried(begin)
    for _ in range(CUTTING_PASSES):
        failing = np.flatnonzero(trial.worst > 1.0)
        most = float(trial.worst.max())
        if most <= CORNER_RATIO and len(failing) <= FAILING_SHARE * len(trial.worst):
            break
        trial = problem.tried(refined(problem.degree, problem.course, trial, failing))
    return trial


def _relieved(problem: Problem, trial: Trial) -> Trial:
    """Relieve failing spans until all pass, or some times in vain."""
    for _ in range(RELIEVING_PASSES):
        if float(trial.worst.max()) <= 1.0:
            break
        better = evened(problem, trial)
        if better is not None:
            return better
        trial = problem.tried(relieved(problem.degree, trial))
    return trial
