"""What one would write with scipy alone: move a vertex, then refit both splines from the polyline.

Both fits are least squares (``make_lsq_spline`` by normal equations, the fastest that scipy has)
against samples of the polyline, verified between its vertices too, and repeated with more knots
until they are within the tolerance: the free spline splits the spans that fail, the uniform one
doubles its knots. Nothing is kept from one step to the next.
"""

from __future__ import annotations

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


@frozen
class Refit:
    """Control points of both splines, and how far each was seen from the polyline."""

    free: int
    uniform: int
    free_error: float
    uniform_error: float


def refit(t: Array, points: Array, tolerance: float) -> Refit:
    """Fit a spline with free knots and one with uniform dyadic knots, both within ``tolerance``."""
    free, free_error = _fit(t, points, tolerance, uniform=False)
    uniform, uniform_error = _fit(t, points, tolerance, uniform=True)
    return Refit(free, uniform, free_error, uniform_error)


def _fit(t: Array, points: Array, tolerance: float, *, uniform: bool) -> tuple[int, float]:
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

    knots = np.concatenate(
        [marks[:1], marks[:1], marks[:1], marks, marks[-1:], marks[-1:], marks[-1:]]
    )
    try:
        return make_lsq_spline(x, y, knots, k=3, method="norm-eq")
    except TypeError:  # an older scipy knows one method only
        return make_lsq_spline(x, y, knots, k=3)


def _on(t: Array, points: Array, at: Array) -> Array:
    return np.stack([np.interp(at, t, column) for column in points.T], axis=1)
