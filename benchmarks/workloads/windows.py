"""Many edits, or one long one; then only a window of the other views is looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import multirep as mr
from benchmarks.curves import CURVES, viewed
from benchmarks.drags import STEP
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from multirep.interval import Interval
from multirep.representations import Polyline

#: Where single vertices are moved, and the stretch that is moved as a whole.
PLACES, STRETCH = (np.arange(20) + 0.5) / 20, Interval(0.3, 0.7)


def contestants(case: Case) -> Iterator[Contestant]:
    """What the look costs, by where one looks."""
    for what, edit, looks in (
        (
            "20 vertices moved",
            move_vertices,
            {
                "a window between them": Interval(0.49, 0.51),
                "a window with one of them": Interval(0.5, 0.55),
                "everything": Interval(0.0, 1.0),
            },
        ),
        (
            "two fifths moved",
            move_stretch,
            {
                "a window inside": Interval(0.5, 0.51),
                "everything": Interval(0.0, 1.0),
            },
        ),
    ):
        for where, interval in looks.items():
            curve = viewed(case)
            edit(curve)
            yield Timed(
                f"{what}: {where}", looking(curve, interval), True, before=going_back(curve)
            )


def looking(curve: mr.MultiRepresentation, where: Interval) -> Callable[[int], None]:
    """Return a look at every representation."""

    def look(k: int) -> None:
        for kind in curve.kinds:
            curve.view(kind, where)

    return look


def going_back(curve: mr.MultiRepresentation) -> Callable[[int], None]:
    """Return what restores the present state."""
    state = curve.snapshot()
    return lambda k: curve.restore(state)


def move_vertices(curve: mr.MultiRepresentation) -> None:
    """Move a vertex at each place, and look at nothing."""
    for place in PLACES.tolist():
        polyline = curve.view(Polyline)
        vertex = min(max(polyline.t.searchsorted(place), 1), polyline.size - 2)
        to = polyline.points[vertex] + [0.0, STEP * curve.tolerance]
        curve.commit(Polyline, polyline.move_vertex(vertex, to))


def move_stretch(curve: mr.MultiRepresentation) -> None:
    """Move a long stretch as a spatula would, and look at nothing."""
    polyline = curve.view(Polyline)
    first, last = (polyline.t.searchsorted(end) for end in STRETCH)
    t = polyline.t[first:last]
    bump = np.sin(np.pi * (t - t[0]) / (t[-1] - t[0])) ** 2
    rows = polyline.points[first:last] + STEP * curve.tolerance * bump[:, None]
    curve.commit(Polyline, polyline.move_vertices(first, rows))


WINDOWS = Workload(
    "window",
    "Edits all over or a long one, then a window of the other views looked at",
    sweep(*CURVES, sizes=[1000, 10_000, 100_000]),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]),
)
