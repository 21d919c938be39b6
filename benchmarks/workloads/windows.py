"""Twenty vertices moved all over the curve; then only a window of the other views is looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import STEP
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from multirep.interval import Interval
from multirep.representations import Polyline

#: Where vertices are moved.
PLACES = (np.arange(20) + 0.5) / 20
#: What is looked at.
LOOKS = {
    "a window with one of them": Interval(0.5, 0.55),
    "a window between them": Interval(0.49, 0.51),
    "everything": Interval(0.0, 1.0),
}


def contestants(case: Case) -> Iterator[Contestant]:
    """What the look costs, by where one looks."""
    for name, where in LOOKS.items():
        curve = viewed(case)
        move_vertices(curve)
        state = curve.snapshot()

        def go_back(k: int, curve: mr.MultiRepresentation = curve, state: object = state) -> None:
            curve.restore(state)  # type: ignore[arg-type]

        yield Timed(name, looking(curve, where), ours=True, before=go_back)


def looking(curve: mr.MultiRepresentation, where: Interval) -> Callable[[int], None]:
    """Return a look at every representation."""

    def look(k: int) -> None:
        for kind in curve.kinds:
            curve.view(kind, where)

    return look


def move_vertices(curve: mr.MultiRepresentation) -> None:
    """Move a vertex at each place, and look at nothing."""
    for place in PLACES.tolist():
        polyline = curve.view(Polyline)
        vertex = min(max(polyline.t.searchsorted(place), 1), polyline.size - 2)
        to = polyline.points[vertex] + [0.0, STEP * curve.tolerance]
        curve.commit(Polyline, polyline.move_vertex(vertex, to))


WINDOWS = Workload(
    "window",
    "Twenty vertices moved, then a window of the other views looked at",
    sweep("smooth", sizes=[1000, 10_000, 100_000]),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]),
)
