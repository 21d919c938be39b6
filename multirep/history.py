"""The moments that a session can go back or forth to: the nearest whole, the others as differences.

A state shares with its neighbours all that did not change, but in blocks: a thousand steps that
move a vertex each would keep a thousand blocks. Nobody looks at a state far away, and whoever goes
there passes all between: so it is kept as what makes it of the next one on the way (Baker's trick,
H. Baker, "Shallow binding makes functional arrays fast", 1991; a zipper of differences).
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter, is_
from typing import Any, TypeAlias
from weakref import ref

import attrs

from multirep.authors import AuthorMap
from multirep.framework import CurveState
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.runs import shared_ends
from multirep.splices import SpliceList
from multirep.state import Held, Look

__all__ = ["Moment", "Trail"]

#: So many moments are kept whole. More take more memory, tens of kilobytes each; fewer make an undo
#: here and there cost more than passing on a reference.
NEAR = 4
#: So many of those that were undone: they will be redone or dropped soon, and undoing more than a
#: few steps need not pay for that.
UNDONE = 64


@attrs.frozen(eq=False)
class Moment:
    """Which curves there were, and their states."""

    curves: Mapping[str, MultiRepresentation]
    states: Mapping[str, CurveState]


class Trail:
    """Moments in one direction of time, the nearest to the present last.

    What comes back is bit-identical to what was put in; a value that somebody still holds comes
    back as the same object.

    Parameters
    ----------
    near : int, optional
        How many moments are kept whole; default `NEAR`.

    Examples
    --------
    >>> trail = Trail()
    >>> for _ in range(9):
    ...     trail.push(Moment({}, {}))
    >>> moment = trail.pop()
    >>> len(trail)
    8
    """

    def __init__(self, near: int | None = None) -> None:
        self._most = NEAR if near is None else near
        self._far: list[Moment | tuple[_Apart, ...]] = []
        self._near: list[Moment] = []

    def __len__(self) -> int:
        return len(self._far) + len(self._near)

    def push(self, moment: Moment) -> None:
        """Put in the moment that is nearest to the present from now on; O(what changed)."""
        self._near.append(moment)
        if len(self._near) > self._most:
            self._far.append(_apart(self._near[0], self._near[1]))
            del self._near[0]

    def pop(self) -> Moment:
        """Take out the moment nearest to the present; O(what changed)."""
        moment = self._near[-1]
        if self._far and len(self._near) == 1:
            self._near.insert(0, _together(self._far[-1], moment))
            del self._far[-1]
        return self._near.pop()

    def farthest(self) -> Moment:
        """Return the moment at the far end; O(all changes on the way)."""
        moment = self._near[0]
        for apart in reversed(self._far):
            moment = _together(apart, moment)
        return moment

    def clear(self) -> None:
        """Forget all moments."""
        self._far.clear()
        self._near.clear()


# -- moments ---------------------------------------------------------------------------------------


@attrs.frozen(eq=False, weakref_slot=False)
class _Apart:
    """What makes the state of a curve of that in the next moment; None for what is the same."""

    curve: str
    held: tuple[_HeldApart | Held | None, ...]
    authors: _AuthorsApart | AuthorMap | None
    #: Other fields of the state, by name.
    others: tuple[tuple[str, Any], ...]
    constraints: Mapping[str, Any] | None


def _apart(moment: Moment, base: Moment) -> Moment | tuple[_Apart, ...]:
    """Return what makes a moment of the next one; itself where there were other curves."""
    if not (_same(moment.curves, base.curves) and tuple(moment.states) == tuple(base.states)):
        return moment
    return tuple(
        _state_apart(name, one, two)
        for (name, one), two in zip(moment.states.items(), base.states.values(), strict=True)
        if one.state is not two.state or not _same(one.constraints, two.constraints)
    )


def _same(one: Mapping[str, object], two: Mapping[str, object]) -> bool:
    """Whether two mappings have the same objects in the same order."""
    return tuple(one) == tuple(two) and all(map(is_, one.values(), two.values()))


def _together(apart: Moment | tuple[_Apart, ...], base: Moment) -> Moment:
    if isinstance(apart, Moment):
        return apart
    states = dict(base.states)
    for one in apart:
        states[one.curve] = _state_together(one, states[one.curve])
    return Moment(base.curves, states)


# -- states ----------------------------------------------------------------------------------------

#: The looks last: those of two states may say the same though they are not the same.
_OTHERS = ("tolerance", "claims", "frozen", "added", "preparations", "looks")
_others_of = attrgetter(*_OTHERS)


def _state_apart(curve: str, one: CurveState, two: CurveState) -> _Apart:
    state, base = one.state, two.state
    held = tuple(map(_held_apart, state.held.values(), base.held.values()))
    authors = _authors_apart(state.authors, base.authors)
    constraints = None if _same(one.constraints, two.constraints) else one.constraints
    fields = zip(_OTHERS, _others_of(state), _others_of(base), strict=True)
    others = tuple((name, mine) for name, mine, theirs in fields if mine is not theirs)
    if others and others[-1][0] == "looks" and _as_data(state.looks) == _as_data(base.looks):
        others = others[:-1]
    return _Apart(curve, held, authors, others, constraints)


def _state_together(apart: _Apart, base: CurveState) -> CurveState:
    state = base.state
    kinds = zip(state.held.items(), apart.held, strict=True)
    held = {name: _held_together(one, two) for (name, two), one in kinds}
    authors = _authors_together(apart.authors, state.authors)
    state = state.with_values(held, authors)
    if apart.others:
        state = attrs.evolve(state, **dict(apart.others))
    constraints = base.constraints if apart.constraints is None else apart.constraints
    return CurveState(state, constraints)


def _as_data(looks: tuple[Look, ...]) -> list[tuple[str, SpliceList | None]]:
    """Return looks as what they say: they have no equality of their own."""
    return [(look.kind, look.where) for look in looks]


# -- what is held ----------------------------------------------------------------------------------


@attrs.frozen(eq=False, weakref_slot=False)
class _HeldApart:
    """What makes one held value of the next one."""

    #: None where the value is that of the next one.
    patch: bytes | None
    #: The value, as long as somebody else holds it.
    value: ref[Representation] | None
    #: None for that of the next one.
    stale: SpliceList | None


def _held_apart(held: Held, base: Held) -> _HeldApart | Held | None:
    value, other = held.value, base.value
    stale = None if held.stale == base.stale else held.stale
    if value is other:  # and not kept from here: the next one has what makes it
        return None if stale is None else _HeldApart(None, None, stale)
    if value is None or other is None or type(value) is not type(other):
        return held
    patch = value.patch(other)
    return held if patch is None else _HeldApart(patch, ref(value), stale)


def _held_together(apart: _HeldApart | Held | None, base: Held) -> Held:
    if apart is None:
        return base
    if isinstance(apart, Held):
        return apart
    value = base.value if apart.value is None else apart.value()
    if value is None and base.value is not None and apart.patch is not None:
        value = base.value.patched(apart.patch)
    return Held(value, base.stale if apart.stale is None else apart.stale)


# -- authors ---------------------------------------------------------------------------------------

_Stretches: TypeAlias = tuple[tuple[float, ...], tuple[str, ...]]


@attrs.frozen(eq=False, weakref_slot=False)
class _AuthorsApart:
    """The stretches that take the place of stretches low .. high - 1 of the next map."""

    low: int
    high: int
    stretches: _Stretches


def _authors_apart(authors: AuthorMap, base: AuthorMap) -> _AuthorsApart | AuthorMap | None:
    if authors == base:
        return None
    if authors.domain != base.domain:
        return authors
    ends = [shared_ends(authors.starts, base.starts), shared_ends(authors.names, base.names)]
    low, tail = map(min, zip(*ends, strict=True))
    part = slice(low, len(authors.starts) - tail)
    return _AuthorsApart(low, len(base.starts) - tail, (authors.starts[part], authors.names[part]))


def _authors_together(apart: _AuthorsApart | AuthorMap | None, base: AuthorMap) -> AuthorMap:
    if apart is None:
        return base
    if isinstance(apart, AuthorMap):
        return apart
    low, high, (starts, names) = apart.low, apart.high, apart.stretches
    return AuthorMap(
        base.domain,
        (*base.starts[:low], *starts, *base.starts[high:]),
        (*base.names[:low], *names, *base.names[high:]),
    )
