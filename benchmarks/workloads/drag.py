"""One drag step through each representation, both others brought up to date; two eager programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

import multirep as mr
from benchmarks.curves import CURVES, vertices, viewed
from benchmarks.drags import STEP, VERTEX, drag_step, drags
from benchmarks.eager import PROGRAMS, Refit
from benchmarks.workload import Absent, Case, Contestant, Timed, Workload, sweep
from multirep.arrays import Array
from multirep.representations import Polyline

#: Size at which tolerances are swept.
SWEPT_SIZE = 1000
#: Finest tolerance that the eager programs are asked for: below it they take half a minute.
EAGER = 1e-4
#: Steps that are not measured: things settle to and fro.
SETTLING = 20


def contestants(case: Case) -> Iterator[Contestant]:
    """Ours by the representation that is edited, and the eager programs."""
    yield from dragging(case)
    for name, program in PROGRAMS.items():
        if case.tolerance < EAGER:
            yield Absent(name, f"left out at tolerances below {EAGER:g}")
            continue
        yield Timed(name, eager_step(program, vertices(case.curve, case.size), case.tolerance))


def dragging(case: Case) -> Iterator[Timed]:
    """The three drag steps, each on a curve of its own that has settled."""
    for number in range(3):
        curve = viewed(case)
        drag = drags(curve)[number]
        for k in range(-SETTLING, 0):
            drag_step(curve, drag, k)
        yield Timed(drag.what, stepping(curve, number), ours=True)


def stepping(curve: mr.MultiRepresentation, number: int) -> Callable[[int], None]:
    """Return the drag step of a curve through one representation."""
    drag = drags(curve)[number]
    return lambda k: drag_step(curve, drag, k)


def eager_step(
    program: Callable[[Array, Array, float], Refit], points: Array, tolerance: float
) -> Callable[[int], Refit]:
    """Return the step of an eager program: move the same vertex and refit everything."""
    polyline = Polyline.from_points(points)
    t, rows = np.array(polyline.t), np.array(polyline.points)
    vertex = int(t.searchsorted(VERTEX))
    at = rows[vertex].copy()

    def step(k: int) -> Refit:
        rows[vertex] = at
        rows[vertex, k % 2] += STEP * tolerance
        return program(t, rows, tolerance)

    return step


DRAG = Workload(
    "drag",
    "One drag step, all views brought up to date",
    (
        *sweep(*CURVES),
        *sweep(sizes=[SWEPT_SIZE], full=[], tolerances=[1e-2, 1e-4, 1e-5, 1e-6]),
    ),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]) + sweep("coast", sizes=[1000], full=[]),
)
