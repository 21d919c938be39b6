"""First views of a polyline beside one call of ``splprep``, and control points at equal error."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
from attrs import evolve, frozen

import multirep as mr
from benchmarks.curves import CURVES, vertices
from benchmarks.eager import subdivided
from benchmarks.workload import Case, Contestant, Counted, Timed, Workload, sweep
from multirep.arrays import Array
from multirep.representations import Nurbs, Polyline, WaveletBSpline

#: Root mean square distances that are tried, in tolerances: from far too smooth to far too rough.
PARTS = tuple(np.geomspace(1, 1 / 64, 25).tolist())
#: Samples of each chord that the searched fit may be given: it must keep to the chords, too.
BETWEEN = (0, 1, 3, 7, 15)
#: Size from which the smoothing is not searched again.
SEARCHED = 10_000


def contestants(case: Case) -> Iterator[Contestant]:
    """Ours by representation; ``splprep`` with the smoothing that meets the tolerance."""
    polyline = Polyline.from_points(vertices(case.curve, case.size))
    for kind in (Nurbs, WaveletBSpline):
        yield Timed(f"{kind.name} view", viewing(polyline, kind, case.tolerance), ours=True)
    part = searched(case.curve, min(case.size, SEARCHED), case.tolerance, -1).smoothing
    t, points = np.asarray(polyline.t), np.asarray(polyline.points)
    yield Timed("splprep, one call", lambda k: smoothed(t, points, part * case.tolerance))


def viewing(polyline: Polyline, kind: type[Any], tolerance: float) -> Callable[[int], object]:
    """Return the first view of a kind."""
    return lambda k: mr.MultiRepresentation(polyline, tolerance=tolerance).view(kind)


def smoothed(t: Array, points: Array, distance: float) -> Any:
    """Call ``splprep`` with a root mean square distance."""
    from scipy.interpolate import splprep

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return splprep(points.T, u=t, s=len(t) * distance**2, k=3)[0]


@frozen
class Search:
    """What bisecting the smoothing of ``splprep`` gave."""

    smoothing: float
    control_points: int
    #: Largest distance seen from the polyline, its chords included, in tolerances.
    error: float


def control_points(case: Case) -> Iterator[Contestant]:
    """How many control points ours take, and ``splprep`` at best."""
    curve = mr.MultiRepresentation.from_points(
        vertices(case.curve, case.size), tolerance=case.tolerance
    )
    for kind in (Nurbs, WaveletBSpline):
        yield Counted(f"{kind.name} view", curve.view(kind).size, "controls", ours=True)
    whole = curve.view(Polyline).sample(curve.domain, tolerance=case.tolerance)
    fitted = Nurbs.fit(whole, tolerance=case.tolerance)
    yield Counted("nurbs fit, all of the tolerance", fitted.size, "controls", ours=True)
    for name, search in searches(case).items():
        yield Counted(name, search.control_points, "controls")


def distances(case: Case) -> Iterator[Contestant]:
    """How far from the polyline: proved of ours, seen of ``splprep``."""
    curve = mr.MultiRepresentation.from_points(
        vertices(case.curve, case.size), tolerance=case.tolerance
    )
    for kind in (Nurbs, WaveletBSpline):
        upper = curve.deviation(Polyline, kind).upper / case.tolerance
        yield Counted(f"{kind.name} view, proved", upper, "tolerances", ours=True)
    for name, search in searches(case).items():
        yield Counted(f"{name}, seen", search.error, "tolerances")


def searches(case: Case) -> dict[str, Search]:
    """Return the searched ``splprep``: at the vertices; on the chords, too; and to half of it.

    A view is proved to be within half the tolerance of its author, so the last one is its equal.
    """
    found = {"splprep, vertices only": searched(case.curve, case.size, case.tolerance, -1)}
    for name, share in (("splprep", 1.0), ("splprep, half the tolerance", 0.5)):
        for between in BETWEEN:
            search = searched(case.curve, case.size, share * case.tolerance, between)
            if search.error <= 1:
                found[name] = evolve(search, error=share * search.error)
                break
    return found


@cache
def searched(curve: str, n: int, tolerance: float, between: int) -> Search:
    """Bisect the smoothing: the largest one with which ``splprep`` meets the tolerance.

    ``between`` samples of each chord are given as data, and the chords must be met, too; with -1
    the vertices are all that is given and met. Without success the least smoothing is returned.
    """
    polyline = Polyline.from_points(vertices(curve, n))
    corners, points = np.asarray(polyline.t), np.asarray(polyline.points)
    t = subdivided(corners, max(between, 0))
    data = np.stack([np.interp(t, corners, column) for column in points.T], axis=1)
    low, high, found, search = 0, len(PARTS), None, None
    while low < high:
        middle = (low + high) // 2
        tck = smoothed(t, data, PARTS[middle] * tolerance)
        at, inside = (error / tolerance for error in errors(tck, t, data))
        search = Search(PARTS[middle], len(tck[0]) - 4, max(at, inside))
        if (at if between < 0 else search.error) <= 1:
            high, found = middle, search
        else:
            low = middle + 1
    assert search is not None
    return found or search


def errors(tck: Any, t: Array, points: Array) -> tuple[float, float]:
    """Return the largest distances seen at data points and between them."""
    from scipy.interpolate import splev

    inner = t[:-1, None] + np.diff(t)[:, None] * np.array([0.25, 0.5, 0.75])
    chords = points[:-1, None] + np.diff(points, axis=0)[:, None] * [[0.25], [0.5], [0.75]]
    at = np.stack(splev(t, tck), axis=1) - points
    inside = np.stack(splev(inner.ravel(), tck), axis=1) - chords.reshape(-1, points.shape[1])
    return tuple(float(np.linalg.norm(x, axis=1).max()) for x in (at, inside))  # type: ignore


FIRST_VIEWS = Workload(
    "first-view",
    "First view of a polyline",
    sweep(*CURVES, sizes=[1000, 10_000, 100_000]),
    contestants,
    checked=sweep(*CURVES, sizes=[1000, 10_000], full=[]),
)
CASES = sweep(*CURVES, sizes=[100, 1000, 10_000], full=[])
CONTROL_POINTS = Workload(
    "control-points",
    "Control points of a first view",
    CASES,
    control_points,
    checked=sweep("smooth", sizes=[1000], full=[]),
)
DISTANCES = Workload(
    "first-view-error",
    "Distance of a first view from the polyline, in tolerances",
    CASES,
    distances,
)
