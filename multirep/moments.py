"""Moments of a session, and what differs between two neighbours, which makes one of the other.

A state shares with its neighbours all that did not change, but in blocks: a thousand steps that
move a vertex each would keep a thousand blocks. Nobody looks at a moment far away, and whoever goes
there passes all between: so of a far one nothing is kept but what makes it of the next one on the
way. Passed, that is turned around: it makes the next one of this one (Baker's trick, H. Baker,
"Shallow binding makes functional arrays fast", 1991).
"""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter, is_
from typing import Any, Final, Literal, TypeAlias
from weakref import ref

import attrs

from multirep.authors import AuthorMap
from multirep.framework import CurveState
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.runs import shared_ends
from multirep.splices import SpliceList
from multirep.state import Held, Look

__all__ = ["EARLIER", "LATER", "Between", "Faded", "Moment", "Side", "between", "faded", "together"]

#: One of two neighbours; pairs below are in this order.
Side: TypeAlias = Literal[0, 1]
EARLIER: Final = 0
LATER: Final = 1


@attrs.frozen(eq=False)
class Moment:
    """Which curves there were, and their states."""

    curves: Mapping[str, MultiRepresentation]
    states: Mapping[str, CurveState]

    def is_same(self, other: Moment) -> bool:
        """Whether both have the same objects."""
        return _same(self.curves, other.curves) and all(
            one.state is two.state and _same(one.constraints, two.constraints)
            for one, two in zip(self.states.values(), other.states.values(), strict=True)
        )


@attrs.frozen(eq=False, weakref_slot=False)
class CurveBetween:
    """What differs between the states of a curve in two moments; None for what is the same."""

    curve: str
    held: tuple[_HeldBetween | None, ...]
    authors: _AuthorsBetween | tuple[AuthorMap, AuthorMap] | None
    #: Other fields of the state: name, and both.
    others: tuple[tuple[str, Any, Any], ...]
    constraints: tuple[Mapping[str, Any], Mapping[str, Any]] | None


@attrs.frozen(eq=False, weakref_slot=False)
class _HeldBetween:
    """What differs between two held values of a kind."""

    #: Makes one of the other; None where both are the same, empty where nothing is in common.
    patch: bytes | None
    stale: tuple[SpliceList, SpliceList] | None


@attrs.frozen(eq=False, weakref_slot=False)
class _AuthorsBetween:
    """Two maps, the same but for the stretches from number ``low`` on: those of either."""

    low: int
    stretches: tuple[_Stretches, _Stretches]


_Stretches: TypeAlias = tuple[tuple[float, ...], tuple[str, ...]]


@attrs.frozen(eq=False, weakref_slot=False)
class Between:
    """What differs between two neighbours, and which of them it makes of the other."""

    makes: Side
    #: Those that differ.
    curves: tuple[CurveBetween, ...]


#: What is left of a moment far away, for each of the curves that differ and each kind: the value as
#: long as somebody else holds it, or itself where nothing makes it of the other.
Faded: TypeAlias = tuple[tuple["ref[Representation] | Held | None", ...], ...]


def between(earlier: Moment, later: Moment, makes: Side) -> Between | None:
    """Return what makes one of two neighbours of the other; None where there are other curves.

    O(what changed).
    """
    if not _same(earlier.curves, later.curves):
        return None
    states = zip(earlier.states.items(), later.states.values(), strict=True)
    curves = [
        _curve_between(name, one, two, makes)
        for (name, one), two in states
        if one.state is not two.state or not _same(one.constraints, two.constraints)
    ]
    return Between(makes, tuple(curves))


def faded(moment: Moment, apart: Between) -> Faded:
    """Return what must be kept of a moment beside what makes it of its neighbour."""
    return tuple(
        [
            tuple(map(_left, moment.states[one.curve].state.held.values(), one.held))
            for one in apart.curves
        ]
    )


def together(apart: Between, left: Faded, neighbour: Moment) -> tuple[Moment, Between]:
    """Return a moment, made of its neighbour bit for bit, and what makes that one of it."""
    states, turned = dict(neighbour.states), []
    for one, kept in zip(apart.curves, left, strict=True):
        state, back = _state_together(one, kept, states[one.curve], apart.makes)
        states[one.curve] = state
        turned.append(back)
    return Moment(neighbour.curves, states), Between(_other(apart.makes), tuple(turned))


def _other(side: Side) -> Side:
    return LATER if side == EARLIER else EARLIER


def _same(one: Mapping[str, object], two: Mapping[str, object]) -> bool:
    """Whether two mappings have the same objects in the same order."""
    return tuple(one) == tuple(two) and all(map(is_, one.values(), two.values()))


# -- states ----------------------------------------------------------------------------------------

#: Fields of a state beside what is held and the authors. The looks last: those of two states may
#: say the same though they are not the same.
_OTHERS = ("tolerance", "claims", "frozen", "added", "preparations", "looks")
_others_of = attrgetter(*_OTHERS)


def _curve_between(curve: str, earlier: CurveState, later: CurveState, makes: Side) -> CurveBetween:
    one, two = earlier.state, later.state
    pairs = zip(one.held.values(), two.held.values(), strict=True)
    held = tuple([_held_between(*pair, makes) for pair in pairs])
    fields = zip(_OTHERS, _others_of(one), _others_of(two), strict=True)
    others = tuple([field for field in fields if field[1] is not field[2]])
    if others and others[-1][0] == "looks" and _as_data(one.looks) == _as_data(two.looks):
        others = others[:-1]
    same = _same(earlier.constraints, later.constraints)
    constraints = None if same else (earlier.constraints, later.constraints)
    return CurveBetween(
        curve, held, _authors_between(one.authors, two.authors), others, constraints
    )


def _state_together(
    apart: CurveBetween,
    left: tuple[ref[Representation] | Held | None, ...],
    neighbour: CurveState,
    side: Side,
) -> tuple[CurveState, CurveBetween]:
    state = neighbour.state
    held, turned = {}, []
    for one, kept, (name, there) in zip(apart.held, left, state.held.items(), strict=True):
        held[name], back = _held_together(one, kept, there, side)
        turned.append(back)
    state = state.with_values(held, _authors_together(apart.authors, state.authors, side))
    if apart.others:
        state = attrs.evolve(state, **{name: values[side] for name, *values in apart.others})
    pair = apart.constraints
    made = CurveState(state, neighbour.constraints if pair is None else pair[side])
    return made, CurveBetween(
        apart.curve, tuple(turned), apart.authors, apart.others, apart.constraints
    )


def _as_data(looks: tuple[Look, ...]) -> list[tuple[str, SpliceList | None]]:
    """Return looks as what they say: they have no equality of their own."""
    return [(look.kind, look.where) for look in looks]


# -- what is held ----------------------------------------------------------------------------------


def _held_between(earlier: Held, later: Held, makes: Side) -> _HeldBetween | None:
    one, two = earlier.value, later.value
    stale = None if earlier.stale == later.stale else (earlier.stale, later.stale)
    if one is two:
        return None if stale is None else _HeldBetween(None, stale)
    if one is None or two is None or type(one) is not type(two):
        return _HeldBetween(b"", stale)
    patch = one.patch(two) if makes == EARLIER else two.patch(one)
    return _HeldBetween(patch or b"", stale)


def _left(held: Held, apart: _HeldBetween | None) -> ref[Representation] | Held | None:
    if apart is None or apart.patch is None:
        return None
    return ref(held.value) if apart.patch and held.value is not None else held


def _held_together(
    apart: _HeldBetween | None,
    left: ref[Representation] | Held | None,
    neighbour: Held,
    side: Side,
) -> tuple[Held, _HeldBetween | None]:
    if apart is None:
        return neighbour, None
    if isinstance(left, Held):
        return left, apart
    stale = neighbour.stale if apart.stale is None else apart.stale[side]
    there = neighbour.value
    if left is None:
        return Held(there, stale), apart
    assert there is not None
    assert apart.patch is not None
    made, back = there.patched(apart.patch)
    known = left()
    return Held(made if known is None else known, stale), _HeldBetween(back or b"", apart.stale)


# -- authors ---------------------------------------------------------------------------------------


def _authors_between(
    earlier: AuthorMap, later: AuthorMap
) -> _AuthorsBetween | tuple[AuthorMap, AuthorMap] | None:
    if earlier == later:
        return None
    if earlier.domain != later.domain:
        return earlier, later
    ends = [shared_ends(earlier.starts, later.starts), shared_ends(earlier.names, later.names)]
    low, tail = map(min, zip(*ends, strict=True))
    one, two = (slice(low, len(authors.starts) - tail) for authors in (earlier, later))
    stretches = (earlier.starts[one], earlier.names[one]), (later.starts[two], later.names[two])
    return _AuthorsBetween(low, stretches)


def _authors_together(
    apart: _AuthorsBetween | tuple[AuthorMap, AuthorMap] | None, neighbour: AuthorMap, side: Side
) -> AuthorMap:
    if apart is None:
        return neighbour
    if isinstance(apart, tuple):
        return apart[side]
    low, (starts, names) = apart.low, apart.stretches[side]
    high = low + len(apart.stretches[1 - side][0])
    return AuthorMap(
        neighbour.domain,
        (*neighbour.starts[:low], *starts, *neighbour.starts[high:]),
        (*neighbour.names[:low], *names, *neighbour.names[high:]),
    )
