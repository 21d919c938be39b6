"""Undo of a drag step in a session, all views brought up to date; of many; a snapshot restored."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import STEP, VERTEX
from benchmarks.workload import Case, Contestant, Counted, Timed, Workload, sweep
from benchmarks.workloads.memory import stepped
from multirep.representations import Polyline
from multirep.tools import MoveVertex

#: Steps that are undone one after the other, then redone, so many times; on so many vertices.
CHAIN, ROUNDS, FEW = 100, 3, 50


def contestants(case: Case) -> Iterator[Contestant]:
    """Undo, redo, alone and in a chain of many; and what the kernel alone takes."""
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
    yield from in_a_chain(case, vertex)


def in_a_chain(case: Case, vertex: int) -> Iterator[Contestant]:
    """Undo many drag steps, on vertices here and there, one after the other, and redo them."""
    vertices = vertex // 2 + np.arange(CHAIN) % min(FEW, case.size // 4)
    session = stepped(viewed(case), vertices, case.tolerance)
    times: dict[str, list[float]] = {"undo": [], "redo": []}
    for _ in range(ROUNDS):
        for name, travel in (("undo", session.undo), ("redo", session.redo)):
            for _ in range(CHAIN):
                begin = process_time()
                travel()
                times[name].append(process_time() - begin)
    for name, samples in times.items():
        yield Counted(f"{name}, one of {CHAIN}", float(np.median(samples)), "s", ours=True)


UNDO = Workload(
    "undo",
    "Undo of a drag step",
    sweep("smooth"),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]),
)
