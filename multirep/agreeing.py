"""Borders of frozen stretches at which all representations agree more closely than they must.

A representation follows its author within a hop. Where it may never be fitted again, the author
beside the border may change, and the new one is only within another hop of the old one: too far for
a splice that must meet what stands. So a border is put where all representations are within three
quarters of a hop of each other: it moves outward a little, or, if there is no such place near, they
are fitted more closely there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.errors import ToleranceError
from multirep.events import Event
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.synchronization import bring_up_to_date, hop

#: How far apart any two may be at a border, in terms of the hop. What is left of it is for the
#: samples and the fit of whoever has to meet the border. Smaller moves more borders.
APART = 3 / 4
#: What the closer fits are asked for, in terms of the tolerance: two of them may be twice as far
#: apart, each from an author.
CLOSER = APART / 2
#: How far a border may move before the representations are fitted more closely, in terms of T.
NEAR = 1 / 128
#: Half the width of the stretch that is fitted more closely, in terms of T.
WINDOW = 1 / 256
#: How many places are looked at for a border that has to move.
CANDIDATES = 32


def apart(values: Mapping[str, Representation], t: Array) -> Array:
    """How far any two of the representations are from each other at parameters (m,), (m,)."""
    rows = [value(t) for value in values.values()]
    worst: Array = np.zeros(len(t))
    for one, other in combinations(rows, 2):
        worst = np.maximum(worst, np.linalg.norm(one - other, axis=1))
    return worst


def fitted_closely(
    state: State, end: float, keep: SpliceList, emit: Callable[[Event], None]
) -> State:
    """Return the state in which every kind is fitted more closely around a border.

    Nothing of ``keep`` changes, nor what a kind authored itself; who cannot get closer stays.
    """
    domain = state.authors.domain
    width = WINDOW * domain.length
    window = Interval(end - width, end + width).clipped(domain)
    parts = SpliceList([window]) - keep
    close = parts & SpliceList(part for part in parts if part.contains(end))
    for name, held in state.held.items():
        assert held.value is not None
        stale = close - state.authors.where(name)
        if not stale:
            continue
        task = attrs.evolve(
            state.with_held(name, Held(held.value, stale)),
            tolerance=CLOSER * state.tolerance,
            frozen=keep | state.frozen,
        )
        try:
            done = bring_up_to_date(task, type(held.value), stale, emit)
        except ToleranceError:
            continue
        state = state.with_held(name, Held(done.value, held.stale))
    return state


def agreeing_end(
    values: Mapping[str, Representation], end: float, limit: float, *, tolerance: float
) -> float | None:
    """Return the first place from ``end`` to ``limit``, out of 33, at which all agree; or None."""
    candidates = np.linspace(end, limit, CANDIDATES + 1)
    fine = apart(values, candidates) <= APART * hop(tolerance)
    return float(candidates[fine.argmax()]) if fine.any() else None
