"""Points of a spline: one, and many in order and in none."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.curves import spline
from benchmarks.peers import geomdl_curve, occ_curve, optional, splinepy_curve
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from multirep.arrays import Array
from multirep.representation import Representation
from multirep.representations import WaveletBSpline

#: Parameters in bulk, and for the slow reference.
MANY, FEW = 10_000, 100
#: Size from which the slow reference is left out: it copies all control points for every call.
GEOMDL = 1000


def contestants(case: Case, t: Array) -> Iterator[Contestant]:
    """Evaluate at parameters (m,)."""
    for name, curve in ours(case).items():
        yield Timed(name, evaluating(curve, t), ours=True)
    plain = spline(case.curve, case.size)
    scipy, knots, points = plain.to_scipy(), np.asarray(plain.knots), np.asarray(plain.points)
    yield Timed("scipy", evaluating(scipy, t))
    column = t[:, None]

    def splinepy(module: Any) -> Callable[[int], object]:
        curve = splinepy_curve(module, knots, points)
        return lambda k: curve.evaluate(column, nthreads=1)

    yield optional("splinepy", "splinepy", splinepy)
    if len(t) == 1:
        yield optional("OCP", "OpenCASCADE", lambda module: adaptor(knots, points, float(t[0])))
    if len(t) == 1 and case.size <= GEOMDL:

        def geomdl(module: Any) -> Callable[[int], object]:
            curve = geomdl_curve(module, knots, points)
            return lambda k: curve.evaluate_single(float(t[0]))

        yield optional("geomdl", "geomdl", geomdl)


def ours(case: Case) -> dict[str, Representation]:
    """Return our curves: of the same shape; the wavelet has about as many control points."""
    level = max(int(np.log2(case.size)), 1)
    at = np.linspace(0, 1, 2**level + 3)
    plain = spline(case.curve, case.size)
    return {
        "polynomial": plain,
        "rational": spline(case.curve, case.size, rational=True),
        "wavelet": WaveletBSpline(plain(at)),
    }


def evaluating(curve: Any, t: Array) -> Callable[[int], object]:
    """Return the call of a curve; of one parameter as people give it, a number."""
    if len(t) == 1:
        number = float(t[0])
        return lambda k: curve(number)
    return lambda k: curve(t)


def adaptor(knots: Array, points: Array, t: float) -> Callable[[int], object]:
    """Return OpenCASCADE's evaluation of one parameter."""
    from OCP.GeomAdaptor import GeomAdaptor_Curve

    curve = GeomAdaptor_Curve(occ_curve(knots, points))
    return lambda k: curve.Value(t)


def sorted_parameters() -> Array:
    """Return many parameters in order."""
    return np.sort(unsorted_parameters())


def unsorted_parameters() -> Array:
    """Return many parameters in no order."""
    return np.random.default_rng(5).random(MANY)


ONE = Workload(
    "evaluate-one",
    "Evaluation of one point",
    sweep(),
    lambda case: contestants(case, np.array([0.7312])),
    checked=sweep(sizes=[1000, 100_000], full=[]),
)
SORTED = Workload(
    "evaluate-sorted",
    f"Evaluation of {MANY} points in order",
    sweep(),
    lambda case: contestants(case, sorted_parameters()),
    checked=sweep(sizes=[1000, 100_000], full=[]),
)
UNSORTED = Workload(
    "evaluate-unsorted",
    f"Evaluation of {MANY} points in no order",
    sweep(),
    lambda case: contestants(case, unsorted_parameters()),
    checked=sweep(sizes=[1000, 100_000], full=[]),
)
