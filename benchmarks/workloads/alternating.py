"""A thousand edits through all representations in turn: neither times nor sizes may creep up."""

from __future__ import annotations

from collections.abc import Iterator
from time import process_time

import numpy as np

from benchmarks.curves import CURVES, viewed
from benchmarks.drags import drag_step, drags
from benchmarks.workload import Case, Contestant, Counted, Workload, sweep

STEPS, PARTS = 1000, 5
#: Where no drag reaches.
UNTOUCHED = np.linspace(0.6, 0.9, 1001)


def contestants(case: Case) -> Iterator[Contestant]:
    """Times and sizes, part by part, and how far an untouched stretch moved."""
    curve = viewed(case)
    turns = drags(curve)
    before = [curve.view(kind)(UNTOUCHED) for kind in curve.kinds]
    sizes = {kind: [curve.view(kind).size] for kind in curve.kinds}
    medians = []
    for part in range(PARTS):
        times = []
        for k in range(part * STEPS // PARTS, (part + 1) * STEPS // PARTS):
            begin = process_time()
            drag_step(curve, turns[k % 3], k // 3)
            times.append(process_time() - begin)
        medians.append(float(np.median(times)))
        for kind in curve.kinds:
            sizes[kind].append(curve.view(kind).size)
    after = [curve.view(kind)(UNTOUCHED) for kind in curve.kinds]
    moved = max(float(np.abs(a - b).max()) for a, b in zip(before, after, strict=True))
    for part, seconds in enumerate(medians):
        first, last = part * STEPS // PARTS + 1, (part + 1) * STEPS // PARTS
        yield Counted(f"a step, number {first} to {last}", seconds, "s", ours=True)
    for kind, counts in sizes.items():
        yield Counted(f"{kind}, before", counts[0], "controls", ours=True)
        yield Counted(f"{kind}, after {STEPS // PARTS}", counts[1], "controls", ours=True)
        yield Counted(f"{kind}, after {STEPS}", counts[-1], "controls", ours=True)
    yield Counted("drift of an untouched stretch", moved, "length", ours=True)


ALTERNATING = Workload(
    "alternating",
    "1 000 alternating edits",
    sweep(*CURVES, sizes=[1000], full=[]),
    contestants,
)
