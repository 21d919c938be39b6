"""The search for knots: cut until the residuals allow, thin out, prove, cut what is not proved."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import ToleranceError
from multirep.representations.nurbs.equalizing import TARGET, equalized, spans_needed
from multirep.representations.nurbs.problem import Breakpoints, Course, Problem, Trial
from multirep.representations.nurbs.refinement import merged_breakpoints, refined
from multirep.splines.pieces import rounding_unit

#: Rounds of cutting before the last resort, corners at all vertices of what still fails.
ROUNDS = 20
#: The last resort begins earlier when there are so many spans for each vertex and order: cutting
#: does not help then.
MOST_SPANS = 4
LAST_ROUNDS = 4
#: Residuals that exceed their allowance by no more than this may be evened out instead.
EVENING_RATIO = 1.5
EVENING_STEPS = 3
EVENING_FLOOR = 0.1
#: Fewer spans must be this part of the present ones before a spliced window is laid out anew:
#: nearer to 1, a drag would move knots about at every step.
WORTHWHILE = 0.75


def check_tolerance(course: Course, degree: int, tolerance: float) -> None:
    """Refuse a tolerance that the rounding term of the proof alone exceeds.

    Raises
    ------
    ToleranceError
    """
    unit = rounding_unit(degree, course.points.shape[1]) * course.largest
    if not course.tightest > 2 * unit:
        raise ToleranceError(
            f"a tolerance of {tolerance:.3g} is below what rounding allows for coordinates up to "
            f"{course.largest:.3g}; the smallest is about {4 * unit:.3g}",
            tolerance=tolerance,
            reachable=4 * unit,
        )


def searched(
    problem: Problem, begin: Breakpoints, forced: Array, tolerance: float
) -> tuple[Trial, float]:
    """Find knots on which a fit can be proved.

    Parameters
    ----------
    problem : Problem
    begin : Breakpoints
        Knots to begin with.
    forced : (f,) array
        Simple knots that must not be removed.
    tolerance : float
        For the error message.

    Returns
    -------
    trial : Trial
    bound : float
        The largest deviation, certified.

    Raises
    ------
    ToleranceError
        When no fit can be proved.
    """
    trial = passed(problem, problem.ends.roomy(begin), tolerance)
    if _could_be_fewer(problem.degree, trial, len(forced)):
        trial = fewer(problem, trial, forced, tolerance)
    return proved(problem, trial, tolerance)


def _could_be_fewer(degree: int, trial: Trial, forced: int) -> bool:
    """Whether the residuals call for clearly fewer spans than there are."""
    enough = WORTHWHILE * len(trial.worst) - 1 - forced
    if enough <= 0 or int((trial.breakpoints.times[1:-1] >= degree).sum()) >= enough:
        return False
    return float(spans_needed(degree, trial, TARGET).sum()) < enough


def passed(problem: Problem, begin: Breakpoints, tolerance: float) -> Trial:
    """Cut spans until no residual exceeds its allowance.

    They are not evened out on the knots that there are: the next edit would find the same knots,
    and have to do it again.
    """
    trial, attempt = _tried(problem, begin, tolerance), 0
    most = MOST_SPANS * (problem.degree + 1) * len(problem.course.t) + len(begin.at)
    while True:
        failing = (trial.worst > 1.0).nonzero()[0]
        if not len(failing):
            return trial
        if len(trial.worst) > most:
            attempt = max(attempt, ROUNDS)
        if attempt == ROUNDS + LAST_ROUNDS:
            raise _out_of_reach(problem, trial, float(trial.worst.max()), tolerance)
        trial = _tried(problem, _cut(problem, trial, failing, attempt), tolerance)
        attempt += 1


def evened(problem: Problem, trial: Trial) -> Trial | None:
    """Even residuals out on the same knots, if that may suffice; None when it does not.

    Least squares leave the largest residuals up to twice as large as need be. Weighting rows by
    their residuals (Lawson 1961) moves towards the smallest maximum; the first few steps gain most.
    """
    worst = float(trial.worst.max())
    if worst > EVENING_RATIO:
        return None
    emphasis = np.ones(len(trial.rows))
    for _ in range(EVENING_STEPS):
        emphasis *= EVENING_FLOOR + trial.ratios / worst
        try:
            trial = problem.tried(trial.breakpoints, emphasis)
        except np.linalg.LinAlgError:
            return None
        before, worst = worst, float(trial.worst.max())
        if worst <= 1.0:
            return trial
        if worst > before:
            return None
    return None


def _cut(problem: Problem, trial: Trial, failing: Indices, attempt: int) -> Breakpoints:
    """Cut failing spans; when that went on in vain, make corners there and, soon, everywhere.

    A spline with a corner at every vertex is the polyline itself.
    """
    spread = attempt - ROUNDS
    if spread > 0:
        near = np.arange(-(8**spread), 8**spread + 1)
        failing = np.unique(np.clip(failing[:, None] + near, 0, len(trial.worst) - 1))
    if spread == LAST_ROUNDS - 2:
        failing = np.arange(len(trial.worst))
    return refined(problem.degree, problem.course, trial, failing, corners_only=spread >= 0)


def fewer(problem: Problem, trial: Trial, forced: Array, tolerance: float) -> Trial:
    """Lay spans out anew, cut what fails; return the better of before and after."""
    best = trial
    for _ in range(2):
        again = equalized(problem.degree, trial)
        if len(forced):
            again = merged_breakpoints(again, forced, [], problem.degree)
        trial = _tried(problem, problem.ends.roomy(again), tolerance)
    for _ in range(3):
        failing = np.flatnonzero(trial.worst > 1.0)
        better = evened(problem, trial) if len(failing) else trial
        if better is not None:
            return better if better.size < best.size else best
        trial = _tried(problem, refined(problem.degree, problem.course, trial, failing), tolerance)
    return best


def proved(problem: Problem, trial: Trial, tolerance: float) -> tuple[Trial, float]:
    """Prove a trial that passed; where the proof fails, cut and prove again.

    Returns the trial that is proved, and how far it is from the course at most.
    """
    allowance = problem.course.allowance
    attempt = 0
    while True:
        proof = problem.proved(trial)
        chords = (proof > allowance).nonzero()[0]
        if len(chords):
            proof = problem.proved(trial, splits=3)
            chords = np.flatnonzero(proof > allowance)
        if not len(chords):
            return trial, float(proof.max())
        failing = np.union1d(
            _spans_of(trial, problem.course.t, chords), np.flatnonzero(trial.worst > 1.0)
        )
        before, after = trial.breakpoints, _cut(problem, trial, failing, attempt)
        same = len(after.at) == len(before.at) and bool((after.times == before.times).all())
        if same or attempt == ROUNDS + LAST_ROUNDS:
            raise _out_of_reach(problem, trial, float((proof / allowance).max()), tolerance)
        trial = _tried(problem, after, tolerance)
        attempt += 1


def _spans_of(trial: Trial, t: Array, chords: Indices) -> Indices:
    """Return, for each chord, the span that meets it and has the largest residual there."""
    at = trial.breakpoints.at
    low = np.clip(at.searchsorted(t[chords], "right") - 1, 0, len(at) - 2)
    high = np.clip(at.searchsorted(t[chords + 1], "left"), 1, len(at) - 1)
    counts = high - low
    ends = counts.cumsum()
    firsts = ends - counts
    spans = np.arange(ends[-1]) + (low - firsts).repeat(counts)
    worst = trial.worst[spans]
    largest = np.maximum.reduceat(worst, firsts).repeat(counts)
    return np.unique(spans[worst >= largest])


def _tried(problem: Problem, breakpoints: Breakpoints, tolerance: float) -> Trial:
    try:
        return problem.tried(breakpoints)
    except np.linalg.LinAlgError as error:
        raise ToleranceError(
            f"a tolerance of {tolerance:.3g} cannot be met: the knots that it needs are too "
            f"close for floating-point numbers ({error})",
            tolerance=tolerance,
        ) from None


def _out_of_reach(problem: Problem, trial: Trial, ratio: float, tolerance: float) -> ToleranceError:
    worst = int(trial.worst.argmax())
    where = float(trial.breakpoints.at[worst])
    reachable = tolerance * ratio
    return ToleranceError(
        f"a tolerance of {tolerance:.3g} cannot be proved with {trial.size} control points "
        f"near t = {where!r}; {reachable:.3g} can",
        tolerance=tolerance,
        reachable=reachable,
        where=where,
    )
