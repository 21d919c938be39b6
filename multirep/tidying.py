"""Taking back what representations needed for a stretch to be frozen, once it is not any more."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import attrs

from multirep.events import Event, Prepared
from multirep.state import Held, Preparation, State


def from_before(state: State) -> Mapping[str, Preparation]:
    """Return what each kind was before it was prepared for what is frozen, as far as that is known.

    A kind that was edited or fitted since then begins anew with what it is.
    """
    found: dict[str, Preparation] = {}
    for kind, held in state.held.items():
        assert held.value is not None, f"{kind} has no value to freeze"
        known = _standing(state, kind)
        found[kind] = known or Preparation(held.value, held.value, state.tolerance)
    return found


def _standing(state: State, kind: str) -> Preparation | None:
    """Return the preparation of a kind if the value from before could stand in its place."""
    known = state.preparations.get(kind)
    if known is None or known.value is not state.held[kind].value:
        return None
    return known if known.tolerance <= state.tolerance else None


def tidied(state: State, emit: Callable[[Event], None]) -> State:
    """Take back the controls at ends of stretches that are frozen no more.

    When nothing is frozen any more, a kind that was neither edited nor fitted since it was prepared
    becomes what it was before, bit for bit.
    """
    if state.frozen:
        return _without_helpers(state, emit)
    for kind, held in state.held.items():
        known = _standing(state, kind)
        if known is not None and known.value is not known.before:
            emit(Prepared(kind, known.value.changes(known.before)))
            state = state.with_held(kind, Held(known.before, held.stale))
            state = attrs.evolve(state, added={**state.added, kind: {}})
    return attrs.evolve(_without_helpers(state, emit), preparations={})


def _without_helpers(state: State, emit: Callable[[Event], None]) -> State:
    """Release the ends, kind by kind, as far as that changes nothing that is frozen."""
    ends = {end for part in state.frozen for end in part}
    added: dict[str, dict[float, int]] = {}
    preparations = dict(state.preparations)
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
        if kind in preparations and preparations[kind].value is before:
            preparations[kind] = attrs.evolve(preparations[kind], value=value)
    return attrs.evolve(state, added=added, preparations=preparations)
