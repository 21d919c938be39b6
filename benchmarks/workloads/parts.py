"""Where the time of one drag step goes, and what the floor is."""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from time import perf_counter
from types import FrameType

import numpy as np

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import Drag, drag_step, drags
from benchmarks.workload import Case, Contestant, Counted, Timed, Workload, sweep
from multirep.blocks import BlockArray
from multirep.events import Fitted, Sampled

STEPS = 60
#: Control points of a typical window, and the bands of its normal equations.
WINDOW, BANDS = 16, 4


def contestants(case: Case) -> Iterator[Contestant]:
    """Medians by part, calls, and the floor."""
    for number in range(3):
        curve = viewed(case)
        drag = drags(curve)[number]
        for what, seconds in parts(curve, drag).items():
            yield Counted(f"{drag.what}: {what}", seconds, "s", ours=True)
        python, compiled = calls(curve, drag)
        yield Counted(f"{drag.what}: calls of Python functions", python, "calls", ours=True)
        yield Counted(f"{drag.what}: calls of compiled functions", compiled, "calls", ours=True)
    yield Timed("floor: copy one block", copying_a_block(), ours=True)
    yield Timed("floor: two banded solves", solving_twice(), ours=True)


def parts(curve: mr.MultiRepresentation, drag: Drag) -> dict[str, float]:
    """Return median seconds of the edit, the commit, sampling and fitting by kind, the rest."""
    spent: dict[str, list[float]] = defaultdict(list)
    for k in range(2 * STEPS):
        with curve.listening() as events:
            begin = perf_counter()
            edit = drag.step(curve.view(drag.kind), k)
            edited = perf_counter()
            curve.commit(drag.kind, edit)
            committed = perf_counter()
            for kind in curve.kinds:
                curve.view(kind)
            end = perf_counter()
        if k < STEPS:
            continue
        found: dict[str, float] = defaultdict(float)
        found["whole step"] = end - begin
        found["edit"] = edited - begin
        found["commit"] = committed - edited
        for event in events:
            if isinstance(event, Sampled):
                found[f"sample {event.author}"] += 1e-6 * event.microseconds
            elif isinstance(event, Fitted):
                found[f"fit and prove {event.kind}"] += 1e-6 * event.microseconds
        found["the rest"] = 2 * found["whole step"] - sum(found.values())
        for what, seconds in found.items():
            spent[what].append(seconds)
    return {what: float(np.median(seconds)) for what, seconds in spent.items()}


def calls(curve: mr.MultiRepresentation, drag: Drag) -> tuple[float, float]:
    """Count the calls in a step: of Python functions, of compiled ones (not operators, ufuncs)."""
    counts = {"call": 0, "c_call": 0}

    def count(frame: FrameType, event: str, argument: object) -> None:
        if event in counts:
            counts[event] += 1

    sys.setprofile(count)
    try:
        for k in range(4):
            drag_step(curve, drag, k)
    finally:
        sys.setprofile(None)
    return counts["call"] / 4, counts["c_call"] / 4


def copying_a_block() -> Callable[[int], object]:
    """Return the replacement of a row of a long array."""
    array = BlockArray.of(np.zeros((100_000, 2)))
    row = np.ones((1, 2))
    return lambda k: array.replaced(50_000, 50_001, row)


def solving_twice() -> Callable[[int], object]:
    """Return what two fits cannot do without: the solutions of their normal equations."""
    from scipy.linalg.lapack import dpbsv

    matrix = np.zeros((BANDS, WINDOW))
    matrix[-1] = 1.0
    right = np.ones((WINDOW, 2))

    def step(k: int) -> None:
        dpbsv(matrix, right)
        dpbsv(matrix, right)

    return step


PARTS = Workload(
    "parts",
    "Where the time of one drag step goes",
    sweep("smooth", sizes=[100, 1000, 100_000], full=[]),
    contestants,
)
