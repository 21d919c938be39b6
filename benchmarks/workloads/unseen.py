"""One drag step that nobody looks at: what is left is the edit itself and the commit."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import Drag, drags
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from benchmarks.workloads.windows import going_back


def contestants(case: Case) -> Iterator[Contestant]:
    """The commit, which is all synchronisation that takes place; and the edit before it."""
    for number in range(3):
        curve = viewed(case)
        drag = drags(curve)[number]
        value = curve.view(drag.kind)
        edit = drag.step(value, 0)

        def commit(
            k: int,
            curve: mr.MultiRepresentation = curve,
            drag: Drag = drag,
            edit: mr.Edit[mr.Representation] = edit,
        ) -> None:
            curve.commit(drag.kind, edit)

        yield Timed(f"{drag.what}: commit", commit, True, before=going_back(curve))
    for number in range(3):
        curve = viewed(case)
        yield Timed(f"{drags(curve)[number].what}: edit and commit", blind(curve, number), True)


def blind(curve: mr.MultiRepresentation, number: int) -> Callable[[int], None]:
    """Return a drag step after which no other view is asked for."""
    drag = drags(curve)[number]

    def step(k: int) -> None:
        curve.commit(drag.kind, drag.step(curve.view(drag.kind), k))

    return step


UNSEEN = Workload(
    "unseen",
    "The same, and nobody looks",
    sweep("smooth"),
    contestants,
    checked=sweep("smooth", sizes=[1000, 100_000], full=[]),
)
