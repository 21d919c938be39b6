"""Sampling within a tolerance: vertices beside the optimum and the paper's rule, and time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial

import numpy as np

from benchmarks.curves import spline
from benchmarks.workload import Case, Contestant, Counted, Timed, Workload, sweep
from multirep.representations import Nurbs

#: Looks at each span for the integrals.
LOOKS = 16


def vertices(case: Case, *, rational: bool) -> Iterator[Contestant]:
    """How many there are; and the proved bound, which must not exceed the tolerance."""
    curve = spline(case.curve, case.size, rational=rational)
    sampled = curve.sample(curve.domain, tolerance=case.tolerance)
    optimum, length = integrals(case.curve, case.size, rational)
    yield Counted("vertices", len(sampled.t), "vertices", ours=True)
    yield Counted("proved bound", sampled.bound / case.tolerance, "tolerances", ours=True)
    yield Counted("optimum", optimum / np.sqrt(8 * case.tolerance), "vertices")
    yield Counted("spaced by arc length", length / case.tolerance, "vertices")


def times(case: Case) -> Iterator[Contestant]:
    """CPU time of sampling all of the curve."""
    for name, curve in curves(case).items():
        yield Timed(name, sampling(curve, case.tolerance), ours=True)


def curves(case: Case) -> dict[str, Nurbs]:
    """Return the curves that are sampled."""
    return {
        "polynomial": spline(case.curve, case.size),
        "rational": spline(case.curve, case.size, rational=True),
    }


def sampling(curve: Nurbs, tolerance: float) -> Callable[[int], object]:
    """Return the sampling of a whole curve."""
    return lambda k: curve.sample(curve.domain, tolerance=tolerance)


@cache
def integrals(name: str, size: int, rational: bool) -> tuple[float, float]:
    """Return the integrals of sqrt(||S''||) and of ||S'||."""
    curve = spline(name, size, rational=rational)
    breaks = np.unique(np.asarray(curve.knots))
    width = np.diff(breaks)
    t = (breaks[:-1, None] + width[:, None] * ((np.arange(LOOKS) + 0.5) / LOOKS)).ravel()
    weights = (width / LOOKS).repeat(LOOKS)
    bending = np.linalg.norm(curve.derivative(t, 2), axis=1)
    speed = np.linalg.norm(curve.derivative(t, 1), axis=1)
    return float((np.sqrt(bending) * weights).sum()), float((speed * weights).sum())


TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
CASES = sweep(sizes=[100, 1000], full=[], tolerances=TOLERANCES)
VERTICES, RATIONAL_VERTICES = (
    Workload(
        f"sample-vertices{suffix}",
        f"Vertices of a sampling of a {what} curve within a tolerance",
        CASES,
        partial(vertices, rational=rational),
        checked=sweep(sizes=[1000], full=[], tolerances=[1e-3, 1e-6]),
    )
    for suffix, what, rational in (("", "polynomial", False), ("-rational", "rational", True))
)
SAMPLING = Workload(
    "sample",
    "Sampling within a tolerance",
    (*CASES, *sweep(sizes=[10_000, 100_000])),
    times,
)
