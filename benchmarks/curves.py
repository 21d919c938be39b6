"""The curves that are measured: the same two shapes at every size."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

import multirep as mr
from benchmarks.workload import Case
from multirep.arrays import Array
from multirep.representations import Nurbs, Polyline
from multirep.state import State

#: Harmonics of the fractal line: the same coast at every n, ever better surveyed.
HARMONICS = 2**17


def smooth(n: int) -> Array:
    """A wavy outline of size 2: the same shape at every n."""
    t = np.linspace(0, 1, n)
    wave = 0.05 * np.stack([np.cos(40 * np.pi * t), np.sin(34 * np.pi * t)], axis=1)
    return np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1) + wave


def coast(n: int) -> Array:
    """A fractal line of size 1, rough at every scale: finer vertices add finer detail."""
    rng = np.random.default_rng(7)
    k = np.arange(1, HARMONICS + 1)
    waves = (rng.normal(size=(len(k), 2)) + 1j * rng.normal(size=(len(k), 2))) * (k**-1.6)[:, None]
    # seven eighths of a period: an open curve
    fine = np.fft.irfft(np.concatenate([np.zeros((1, 2)), waves]), axis=0)[: 7 * HARMONICS // 4]
    at = np.linspace(0, len(fine) - 1, n)
    rows = np.stack([np.interp(at, np.arange(len(fine)), column) for column in fine.T], axis=1)
    return np.asarray(rows / np.ptp(rows, axis=0).max())


CURVES: dict[str, Callable[[int], Array]] = {"smooth": smooth, "coast": coast}


@cache
def vertices(curve: str, n: int) -> Array:
    """Return the vertices of a named curve."""
    return CURVES[curve](n)


@cache
def _viewed(curve: str, n: int, tolerance: float) -> tuple[Polyline, State]:
    found = mr.MultiRepresentation.from_points(vertices(curve, n), tolerance=tolerance)
    start = found.view(Polyline)
    for kind in found.kinds:
        found.view(kind)
    return start, found.snapshot()


def viewed(case: Case) -> mr.MultiRepresentation:
    """Return a new multi-representation of the case's polyline, all views brought up to date."""
    start, state = _viewed(case.curve, case.size, case.tolerance)
    curve = mr.MultiRepresentation(start, tolerance=case.tolerance)
    curve.restore(state)
    return curve


@cache
def spline(curve: str, n: int, *, rational: bool = False) -> Nurbs:
    """Return a cubic of n control points on uniform knots, in the shape of a named curve."""
    inner = np.linspace(0, 1, n - 2)[1:-1]
    knots = np.concatenate([np.zeros(4), inner, np.ones(4)])
    weights = 1 + 0.5 * np.sin(np.arange(n)) if rational else None
    return Nurbs(degree=3, knots=knots, points=vertices(curve, n), weights=weights)
