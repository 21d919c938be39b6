"""Memory of a multi-representation with all views beside its flat arrays; of 1 000 undo steps."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Iterator
from typing import Any

import numpy as np

import multirep as mr
from benchmarks.curves import CURVES, vertices
from benchmarks.drags import STEP
from benchmarks.workload import Case, Contestant, Counted, Workload, sweep
from multirep.arrays import Indices
from multirep.representations import Polyline
from multirep.tools import MoveVertex

#: Undo steps.
STEPS = 1000
#: Vertices that a local gesture works on.
FEW = 100


def everything(case: Case) -> Iterator[Contestant]:
    """What stays, what it took while fitting, and the numbers themselves."""
    points = vertices(case.curve, case.size)
    make(points[: case.size // 10], case.tolerance)  # imports and factors that are kept
    with traced() as bytes_of:
        curve = make(points, case.tolerance)
    flat = sum(array.nbytes for kind in curve.kinds for array in arrays(curve.view(kind)))
    yield Counted("all views", bytes_of["kept"], "bytes", ours=True)
    yield Counted("the most while fitting", bytes_of["peak"], "bytes", True)
    yield Counted("flat arrays", flat, "bytes")


def history(case: Case) -> Iterator[Contestant]:
    """What a thousand undo steps add, in one place and all over."""
    points = vertices(case.curve, case.size)
    small = make(points[: case.size // 10], case.tolerance)
    stepped(small, np.arange(3) + 5, case.tolerance)
    places = {
        f"{STEPS} steps on {FEW} vertices": case.size // 5 + np.arange(STEPS) % FEW,
        f"{STEPS} steps all over": np.linspace(1, case.size - 2, STEPS).astype(int),
    }
    added = {}
    with traced():  # the curve too: of what a step replaces, the history keeps less
        curve = make(points, case.tolerance)
        whole = held()
        for name, indices in places.items():
            before = held()
            session = stepped(curve, indices, case.tolerance)
            added[name] = held() - before
            session.undo(len(indices))
            del session
    for name, kept in added.items():
        yield Counted(name, kept, "bytes", ours=True)
    yield Counted("all views", whole, "bytes")


def stepped(curve: mr.MultiRepresentation, indices: Indices, tolerance: float) -> mr.Session:
    """Move vertices, each as a step of a session, and look at everything after each."""
    session = mr.Session()
    session.add("curve", curve)
    for index in indices.tolist():
        point = curve.view(Polyline).points[index]
        session.apply("curve", MoveVertex(index=index, to=(point[0], point[1] + STEP * tolerance)))
        for kind in curve.kinds:
            curve.view(kind)
    return session


def make(points: Any, tolerance: float) -> mr.MultiRepresentation:
    """Bring all views up to date."""
    curve = mr.MultiRepresentation.from_points(points, tolerance=tolerance)
    for kind in curve.kinds:
        curve.view(kind)
    return curve


def arrays(value: Any) -> Iterator[np.ndarray]:
    """Yield the flat arrays of a representation."""
    yield np.asarray(value.t if isinstance(value, Polyline) else value.knots)
    yield np.asarray(value.points)


class traced:
    """Bytes that the block keeps allocated, and the most it had."""

    def __enter__(self) -> dict[str, float]:
        gc.collect()
        tracemalloc.start()
        self.found: dict[str, float] = {}
        return self.found

    def __exit__(self, *_: object) -> None:
        gc.collect()
        self.found["kept"], self.found["peak"] = tracemalloc.get_traced_memory()
        tracemalloc.stop()


def held() -> int:
    """Bytes that are allocated now, of those that are traced."""
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


MEMORY = Workload(
    "memory",
    "Memory of a multi-representation, all views",
    sweep(*CURVES, sizes=[10_000, 100_000]),
    everything,
    checked=sweep(*CURVES, sizes=[10_000], full=[]),
)
HISTORY = Workload(
    "history",
    f"Memory that {STEPS} undo steps add",
    sweep("smooth", sizes=[1_000_000], full=[]),
    history,
)
