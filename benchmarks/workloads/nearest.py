"""The nearest point of a curve: one query and a thousand, and how right the answers are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.curves import spline, vertices
from benchmarks.peers import imported, occ_curve, optional, splinepy_curve
from benchmarks.workload import Case, Contestant, Counted, Timed, Workload, sweep
from multirep.arrays import Array
from multirep.representation import Representation
from multirep.representations import Polyline

MANY = 1000
#: Samples of a peer's tree for each control point, and of the truth.
TREE, TRUTH = 4, 64


def queries(count: int) -> Array:
    """Return points around the curve."""
    return np.random.default_rng(3).uniform(-1.2, 1.2, (count, 2))


def one(case: Case) -> Iterator[Contestant]:
    """One query after another."""
    points = queries(16)
    for name, curve in ours(case).items():
        yield Timed(name, asking(curve, points), ours=True)
    yield optional("splinepy", "splinepy, tree kept", lambda m: by_splinepy(m, case, points[:1]))
    yield optional("OCP", "OpenCASCADE", lambda m: by_occ(case, points))


def many(case: Case) -> Iterator[Contestant]:
    """A thousand queries at once, as far as there is a call for it."""
    points = queries(MANY)
    for name, curve in ours(case).items():
        yield Timed(name, asking_all(curve, points), ours=True)
    yield optional("splinepy", "splinepy, tree kept", lambda m: by_splinepy(m, case, points))


def wrong(case: Case) -> Iterator[Contestant]:
    """How much farther than the true place the worst answer to a thousand queries is."""
    points = queries(MANY)
    for name, curve in ours(case).items():
        there = curve(np.linspace(0, 1, TRUTH * case.size))
        found = [curve.nearest(point).distance for point in points]
        yield Counted(name, excess(there, points, np.array(found)), "length", ours=True)
    try:
        splinepy = imported("splinepy")
    except ImportError:
        return
    plain = spline(case.curve, case.size)
    curve = splinepy_curve(splinepy, np.asarray(plain.knots), np.asarray(plain.points))
    at = curve.proximities(points, [TREE * case.size], nthreads=1)
    found = np.linalg.norm(plain(np.clip(at[:, 0], 0, 1)) - points, axis=1)
    there = plain(np.linspace(0, 1, TRUTH * case.size))
    yield Counted("splinepy, tree kept", excess(there, points, found), "length", ours=False)


def ours(case: Case) -> dict[str, Representation]:
    """Return our curves."""
    return {
        "nurbs": spline(case.curve, case.size),
        "polyline": Polyline.from_points(vertices(case.curve, case.size)),
    }


def asking(curve: Representation, points: Array) -> Callable[[int], object]:
    """Return single queries, in turn; what they look at is made before, as the peer's tree is."""
    for point in points:
        curve.nearest(point)
    return lambda k: curve.nearest(points[k % len(points)])


def asking_all(curve: Representation, points: Array) -> Callable[[int], object]:
    """Return all queries at once."""
    return lambda k: curve.nearest(points)


def by_splinepy(module: Any, case: Case, points: Array) -> Callable[[int], object]:
    """Return splinepy's queries, the tree made before."""
    plain = spline(case.curve, case.size)
    curve = splinepy_curve(module, np.asarray(plain.knots), np.asarray(plain.points))
    curve.proximities(points, [TREE * case.size], nthreads=1)
    return lambda k: curve.proximities(points, [-1], nthreads=1)


def by_occ(case: Case, points: Array) -> Callable[[int], object]:
    """Return OpenCASCADE's queries; it knows orthogonal feet only."""
    from OCP.GeomAPI import GeomAPI_ProjectPointOnCurve
    from OCP.gp import gp_Pnt

    plain = spline(case.curve, case.size)
    curve = occ_curve(np.asarray(plain.knots), np.asarray(plain.points))
    there = [gp_Pnt(x, y, 0.0) for x, y in points.tolist()]
    projection = GeomAPI_ProjectPointOnCurve(there[0], curve)
    return lambda k: projection.Perform(there[k % len(there)])


def excess(there: Array, points: Array, found: Array) -> float:
    """Return by how much the worst distance exceeds that of the nearest of many points."""
    from scipy.spatial import cKDTree

    return max(float((found - cKDTree(there).query(points)[0]).max()), 0.0)


NEAREST_ONE = Workload(
    "nearest-one",
    "Nearest point, one query",
    sweep(),
    one,
    checked=sweep(sizes=[1000, 100_000], full=[]),
)
NEAREST_MANY = Workload(
    "nearest-1000",
    "Nearest points, 1 000 queries",
    sweep(sizes=[100, 1000, 10_000]),
    many,
    checked=sweep(sizes=[1000], full=[]),
)
NEAREST_WRONG = Workload(
    "nearest-error",
    "Nearest points: how much farther than the true one, at worst",
    sweep(sizes=[100, 1000], full=[]),
    wrong,
)
