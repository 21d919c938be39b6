"""Taking back what representations needed for a stretch to be frozen, once it is not any more."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import attrs

from multirep.events import Event, Prepared
from multirep.representation import Representation
from multirep.state import Held, State


def bare_values(state: State) -> Mapping[str, Representation]:
    """Return what each kind was before it was prepared for what is frozen, as far as that is known.

    A kind that was edited or fitted since then begins anew with what it is.
    """
    values: dict[str, Representation] = {}
    for kind, held in state.held.items():
        prepared, bare = state.bare.get(kind, (None, None))
        value = bare if held.value is prepared else held.value
        assert value is not None, f"{kind} has no value to freeze"
        values[kind] = value
    return values


def tidied(state: State, emit: Callable[[Event], None]) -> State:
    """Take back the controls at ends of stretches that are frozen no more.

    When nothing is frozen any more, a kind that was neither edited nor fitted since it was prepared
    becomes what it was before, bit for bit.
    """
    if state.frozen:
        return _without_helpers(state, emit)
    for kind, (prepared, bare) in state.bare.items():
        held = state.held[kind]
        if held.value is prepared is not bare:
            emit(Prepared(kind, prepared.changes(bare)))
            state = state.with_held(kind, Held(bare, held.stale))
            state = attrs.evolve(state, added={**state.added, kind: {}})
    return attrs.evolve(_without_helpers(state, emit), bare={})


def _without_helpers(state: State, emit: Callable[[Event], None]) -> State:
    """Release the ends, kind by kind, as far as that changes nothing that is frozen."""
    ends = {end for part in state.frozen for end in part}
    added: dict[str, dict[float, int]] = {}
    bare = dict(state.bare)
    for kind, counts in state.added.items():
        before = value = state.held[kind].value
        assert value is not None
        waiting = {end: count for end, count in counts.items() if end in ends}
        for end in sorted(set(counts) - ends):
            edit = value.released(end, counts[end])
            if edit.splices.intersects(state.frozen):
                waiting[end] = counts[end]  # inside of what another one froze
            elif edit.splices:
                value = edit.value
                emit(Prepared(kind, edit.splices))
        added[kind] = waiting
        state = state.with_held(kind, Held(value, state.held[kind].stale))
        if kind in bare and bare[kind][0] is before:
            bare[kind] = value, bare[kind][1]
    return attrs.evolve(state, added=added, bare=bare)
