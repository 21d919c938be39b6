"""Undo of a drag step in a session, all views brought up to date; and a snapshot restored."""

from __future__ import annotations

from collections.abc import Iterator

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import STEP, VERTEX
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from multirep.representations import Polyline
from multirep.tools import MoveVertex


def contestants(case: Case) -> Iterator[Contestant]:
    """Undo, redo, and what the kernel alone takes."""
    session = mr.Session()
    session.add("curve", viewed(case))
    curve = session.curve("curve")
    vertex = int(curve.view(Polyline).t.searchsorted(VERTEX))

    def drag(k: int) -> None:
        point = curve.view(Polyline).points[vertex]
        point = (point[0], point[1] + STEP * case.tolerance * (-1) ** k)
        session.apply("curve", MoveVertex(index=vertex, to=point))
        for kind in curve.kinds:
            curve.view(kind)

    def drag_and_undo(k: int) -> None:
        drag(k)
        session.undo()

    drag(0)
    yield Timed("undo", lambda k: session.undo(), True, before=drag)
    yield Timed("redo", lambda k: session.redo(), True, before=drag_and_undo)
    state = curve.snapshot()
    yield Timed("restore a snapshot", lambda k: curve.restore(state), True)


UNDO = Workload(
    "undo",
    "Undo of a drag step",
    sweep("smooth"),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]),
)
