"""One drag step that nobody looks at: the edit, the commit that checks it, marking the others.

Marking the other representations stale, and who is the author where, is all synchronisation that
takes place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import multirep as mr
from benchmarks.curves import viewed
from benchmarks.drags import Drag, drags
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from benchmarks.workloads.windows import going_back
from multirep.splices import SpliceList
from multirep.state import Held
from multirep.synchronization import evolve_stale


def contestants(case: Case) -> Iterator[Contestant]:
    """What marks the others stale; with the checks of the commit; with the edit, too."""
    for number in range(3):
        curve = viewed(case)
        drag = drags(curve)[number]
        edit = drag.step(curve.view(drag.kind), 0)
        changed, state = Held(edit.value, SpliceList.EMPTY), curve.snapshot()
        yield Timed(
            f"{drag.what}: synchronisation",
            lambda k, what=(state, drag.kind.name, changed, edit.splices): evolve_stale(*what),
            True,
        )
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
