"""What one would write with scipy alone: move a vertex, then refit both splines from the polyline.

Two programs. Both fit a spline with uniform dyadic knots by least squares (``make_lsq_spline`` by
normal equations, the fastest that scipy has), doubling the knots. For the spline with free knots
the *quick* one does likewise and halves the spans that fail, which takes twice the control points;
the *frugal* one calls ``splprep`` with less and less smoothing. Every fit is verified against the
polyline between its vertices, too, and against more samples of it if need be. Nothing is kept from
one step to the next.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen

from multirep.arrays import Array

#: Level (log2 of the number of spans) that is tried first.
FIRST_LEVEL = 4
#: Samples in each span, at least: a span with too little data makes the system singular.
SAMPLES = 6
#: Attempts; a smooth curve takes about ten.
ATTEMPTS = 40
#: Root mean square distances that the frugal program tries, in tolerances.
SMOOTHING = (1 / 3, 1 / 4, 1 / 6, 1 / 9)
#: Samples between vertices that it tries.
BETWEEN = (0, 1, 3, 7)


@frozen
class Refit:
    """Control points of both splines, and how far each was seen from the polyline."""

    free: int
    uniform: int
    free_error: float
    uniform_error: float


def quick(t: Array, points: Array, tolerance: float) -> Refit:
    """Split spans for the free spline."""
    return Refit(*_pairs(_split(t, points, tolerance), _split(t, points, tolerance, uniform=True)))


def frugal(t: Array, points: Array, tolerance: float) -> Refit:
    """Call ``splprep`` for the free spline; if nothing reaches the tolerance, the best that did."""
    free = _smoothed(t, points, tolerance)
    return Refit(*_pairs(free, _split(t, points, tolerance, uniform=True)))


PROGRAMS: dict[str, Callable[[Array, Array, float], Refit]] = {
    "eager, quick": quick,
    "eager, frugal": frugal,
}


def _pairs(free: tuple[int, float], uniform: tuple[int, float]) -> tuple[int, int, float, float]:
    return free[0], uniform[0], free[1], uniform[1]


def _split(
    t: Array, points: Array, tolerance: float, *, uniform: bool = False
) -> tuple[int, float]:
    marks = np.linspace(t[0], t[-1], 2**FIRST_LEVEL + 1)
    for _ in range(ATTEMPTS):
        steps = np.arange(SAMPLES) / SAMPLES
        between = (marks[:-1, None] + steps * np.diff(marks)[:, None]).ravel()
        x = np.union1d(t, between)
        y = _on(t, points, x)
        spline = _least_squares(x, y, marks)
        # half way between the samples, too: they hold all corners of the polyline
        middles = 0.5 * (x[1:] + x[:-1])
        error = np.linalg.norm(spline(x) - y, axis=1)
        inner = np.linalg.norm(spline(middles) - 0.5 * (y[1:] + y[:-1]), axis=1)
        error[:-1] = np.maximum(error[:-1], inner)
        if error.max() <= tolerance:
            return len(marks) + 2, float(error.max())
        if uniform:
            marks = np.linspace(t[0], t[-1], 2 * len(marks) - 1)
            continue
        worst = np.maximum.reduceat(error, x.searchsorted(marks[:-1]))
        halves = 0.5 * (marks[1:] + marks[:-1])
        marks = np.union1d(marks, halves[worst > tolerance])
    raise ArithmeticError("the eager program does not reach the tolerance")


def _least_squares(x: Array, y: Array, marks: Array) -> Any:
    from scipy.interpolate import make_lsq_spline

    knots = np.concatenate([[marks[0]] * 3, marks, [marks[-1]] * 3])
    try:
        return make_lsq_spline(x, y, knots, k=3, method="norm-eq")
    except TypeError:  # an older scipy knows one method only
        return make_lsq_spline(x, y, knots, k=3)


def _smoothed(t: Array, points: Array, tolerance: float) -> tuple[int, float]:
    from scipy.interpolate import splev, splprep

    best = (0, np.inf)
    for between in BETWEEN:
        x = subdivided(t, between)
        y = _on(t, points, x)
        middles = 0.5 * (x[1:] + x[:-1])
        for part in SMOOTHING:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                tck, _ = splprep(y.T, u=x, s=len(x) * (part * tolerance) ** 2, k=3)
            seen = np.stack(splev(x, tck), axis=1) - y
            inner = np.stack(splev(middles, tck), axis=1) - 0.5 * (y[1:] + y[:-1])
            error = float(np.sqrt(max((seen**2).sum(1).max(), (inner**2).sum(1).max())))
            if error < best[1]:
                best = len(tck[0]) - 4, error
            if error <= tolerance:
                return best
    return best


def subdivided(t: Array, between: int) -> Array:
    steps = np.arange(between + 1) / (between + 1)
    return np.append((t[:-1, None] + steps * np.diff(t)[:, None]).ravel(), t[-1])


def _on(t: Array, points: Array, at: Array) -> Array:
    return np.stack([np.interp(at, t, column) for column in points.T], axis=1)
