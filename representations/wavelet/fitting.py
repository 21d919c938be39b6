"""Fit a cubic spline on graded dyadic knots to a polyline on one stretch, with a proof.

Attempt, halve the spans on which the proof fails, repeat. What is found is then thinned: knots of
which the curve hardly takes notice are taken out, many at a time, as long as the proof holds; a
third of them on real outlines.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.errors import ToleranceError
from multirep.representations.wavelet.attempt import Attempt, Problem
from multirep.representations.wavelet.dyadic import halves
from multirep.representations.wavelet.prediction import predict
from multirep.representations.wavelet.target import Target
from multirep.splines import compiled

__all__ = ["fit_stretch", "thinned"]

Mask: TypeAlias = npt.NDArray[np.bool_]

#: Of the spans that fail, only those are halved that are off by this part of the worst of their two
#: neighbours: what a corner does to its surroundings goes away with it. Smaller halves in vain,
#: larger takes more rounds.
_HALVED = 0.6
#: More rounds than there are levels mean that halving does not help.
_ROUNDS = 64
#: Rounds of thinning; each takes out up to a third of the knots, and later ones find little.
_THINNINGS = 12
#: Thinning ends when a round takes out less than this part of the knots.
_WORTHWHILE = 0.02
#: The deviation that taking a knot out is expected to leave: half of what is there, and this part
#: of the jump of the third derivative in terms of that of the B-spline around the knot. (1/8 on
#: even knots.)
_JUMP_SHARE = 0.15


def fit_stretch(problem: Problem, u: Array, *, shortest: float) -> Attempt:
    """Fit a stretch within the allowances of the target.

    Parameters
    ----------
    problem : Problem
    u : (n + 1,) array
        Dyadic knots to begin with, the ends of the stretch first and last; at least three spans if
        an end is joined.
    shortest : float
        Spans not longer than this (as dyadic numbers) are not halved.

    Returns
    -------
    Attempt
        No ratio exceeds 1.

    Raises
    ------
    ToleranceError
        When halving down to the shortest spans does not help; it says what was reached.

    Notes
    -----
    Linear in rows (vertices and four a span) and rounds; 1 to 4 rounds are usual.
    """
    for _ in range(_ROUNDS):
        found = problem.attempt(u)
        if found.ratios.max() <= 1.0:
            return found
        u = _halve(problem, found, shortest)
    raise _unreachable(problem.target, found)


def _halve(problem: Problem, found: Attempt, shortest: float) -> Array:
    """Halve the spans that fail, unless a neighbour fails much more; and as the prediction says."""
    u, ratios = found.u, found.ratios
    around = ratios.copy()
    np.maximum(around[1:], ratios[:-1], out=around[1:])
    np.maximum(around[:-1], ratios[1:], out=around[:-1])
    lengths = u[1:] - u[:-1]
    failing = np.flatnonzero((ratios > 1.0) & (ratios >= _HALVED * around) & (lengths > shortest))
    if not len(failing):
        # The worst cannot be halved: perhaps its neighbours can make room.
        failing = np.flatnonzero((ratios > 1.0) & (lengths > shortest))
        if not len(failing):
            raise _unreachable(problem.target, found)
    starts, stops = u.take(failing), u.take(failing + 1)
    middles = halves(starts, stops)
    more = predict(
        problem.target,
        np.concatenate((starts, middles)),
        np.concatenate((middles, stops)),
        shortest,
        problem.domain,
    )
    finer: Array = np.concatenate((u, middles, more))
    finer.sort()
    return finer


def _unreachable(target: Target, found: Attempt) -> ToleranceError:
    worst = int(found.ratios.argmax())
    where = 0.5 * float(found.x[worst] + found.x[worst + 1])
    tolerance = float(target.allowances.min())
    return ToleranceError(
        f"cannot prove a tolerance of {tolerance:.3g} near t = {where:.6g} with the finest knots "
        f"there are; {found.bound:.3g} is reachable",
        tolerance=tolerance,
        reachable=found.bound,
        where=where,
    )


def thinned(
    problem: Problem, found: Attempt, *, kept: tuple[int, int] = (0, 0), rounds: int = _THINNINGS
) -> Attempt:
    """Take out knots as long as the proof holds.

    Parameters
    ----------
    problem : Problem
    found : Attempt
        Within the limits; at least three spans remain if an end is joined.
    kept : pair of int, keyword-only
        So many knots beside either end stay.
    rounds : int, keyword-only
        At most; each takes out up to a third of the knots.

    Returns
    -------
    Attempt
        Within the limits, with as many knots or fewer.

    Notes
    -----
    Each round takes out the knots that promise to cost least among the two on either side, then
    puts back those near which the proof fails. 10 to 20 attempts in all, within a few per cent of
    taking out one knot at a time.
    """
    if compiled.active:
        return _thinned_at_once(problem, found, kept, rounds)
    needed = np.zeros(len(found.u) - 2, dtype=bool)
    needed[: kept[0]] = needed[len(needed) - kept[1] :] = True
    for _ in range(rounds):
        spared = _sparable(found, problem.limits.min(), needed)
        if not spared.any():
            break
        for _ in range(2):
            trial = problem.attempt(np.delete(found.u, np.flatnonzero(spared) + 1))
            failing = np.flatnonzero(trial.ratios > 1.0)
            if not len(failing):
                enough = _WORTHWHILE * len(needed) > np.count_nonzero(spared)
                found, needed = trial, needed[~spared]
                if enough:
                    return found
                break
            back = spared & _near(found.u[1:-1], trial.u, failing)
            needed |= back if back.any() else spared
            spared &= ~needed
            if not spared.any():
                break
        else:
            needed |= spared
    return found


def _thinned_at_once(
    problem: Problem, found: Attempt, kept: tuple[int, int], rounds: int
) -> Attempt:
    """Thin in the compiled core."""
    made = compiled.core.spare(*problem.arrays, found.x, found.nets, found.ratios, *kept, rounds)
    if made is None:
        return found
    stay, (points, nets, ratios) = np.frombuffer(made[0], np.intp), map(np.frombuffer, made[1:4])
    dimension, count = len(found.points), len(stay) - 1
    return Attempt(
        found.u.take(stay),
        found.x.take(stay),
        points.reshape(dimension, count + 3),
        nets.reshape(4, dimension, count),
        ratios,
        made[4] + problem.slack,
    )


def _sparable(found: Attempt, limit: float, needed: Mask) -> Mask:
    """Choose interior knots, (n - 1,) booleans, that promise to be spared without failing."""
    count = len(needed)
    if count < 3:
        return np.zeros(count, dtype=bool)
    x, nets = found.x, found.nets
    third = 6.0 * (nets[3] - nets[0] + 3.0 * (nets[1] - nets[2])) / (x[1:] - x[:-1]) ** 3
    jumps = np.sqrt(np.square(third[:, 1:] - third[:, :-1]).sum(axis=0))
    around = np.concatenate((x[:1], x, x[-1:]))
    here = around[2:-2]
    product = (here - around[:-4]) * (here - around[1:-3])
    product *= (around[3:-1] - here) * (around[4:] - here)
    product /= 6.0 * (around[4:] - around[:-4])
    cost = _JUMP_SHARE * jumps * product / limit
    cost += 0.5 * np.maximum(found.ratios[:-1], found.ratios[1:])
    cost[needed] = np.inf
    padded = np.concatenate(([np.inf, np.inf], cost, [np.inf, np.inf]))
    least = np.lib.stride_tricks.sliding_window_view(padded, 5).argmin(axis=1) == 2
    spared: Mask = least & (cost <= 1.0)
    return spared


def _near(knots: Array, u: Array, failing: Indices) -> Mask:
    """Whether each of the knots lies within two spans of ``u`` from one that fails."""
    last = len(u) - 1
    low, high = u[np.maximum(failing - 2, 0)], u[np.minimum(failing + 3, last)]
    # Both ends ascend: a knot is near if more ranges have begun before it than have ended.
    begun, ended = low.searchsorted(knots), high.searchsorted(knots, "right")
    near: Mask = begun > ended
    return near
