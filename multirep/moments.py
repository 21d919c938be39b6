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
class _CurveBetween:
    """What differs between the states of a curve beside the values; None for what is the same."""

    curve: str
    #: Of each kind.
    stale: tuple[tuple[SpliceList, SpliceList] | None, ...]
    authors: _AuthorsBetween | tuple[AuthorMap, AuthorMap] | None
    #: Other fields of the state: name, and both.
    others: tuple[tuple[str, Any, Any], ...]
    constraints: tuple[Mapping[str, Any], Mapping[str, Any]] | None


@attrs.frozen(eq=False, weakref_slot=False)
class _AuthorsBetween:
    """Two maps, the same but for the stretches from number ``low`` on: those of either."""

    low: int
    stretches: tuple[_Stretches, _Stretches]


_Stretches: TypeAlias = tuple[tuple[float, ...], tuple[str, ...]]

#: What makes the value of each kind of that of the neighbour: None where both are the same object,
#: empty where nothing does.
_Patches: TypeAlias = tuple[bytes | None, ...]


@attrs.frozen(eq=False, weakref_slot=False)
class Between:
    """What differs between two neighbours, and what makes the values of one of the other's."""

    makes: Side
    #: Those that differ.
    curves: tuple[_CurveBetween, ...]
    patches: tuple[_Patches, ...]


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
    pairs = [
        (name, one, two)
        for (name, one), two in states
        if one.state is not two.state or not _same(one.constraints, two.constraints)
    ]
    curves = tuple([_curve_between(*pair) for pair in pairs])
    patches = [
        _patches(two, one) if makes == LATER else _patches(one, two) for _, one, two in pairs
    ]
    return Between(makes, curves, tuple(patches))


def faded(moment: Moment, apart: Between) -> Faded:
    """Return what must be kept of a moment beside what makes it of its neighbour."""
    return tuple(
        [
            tuple(map(_left, moment.states[one.curve].state.held.values(), patches))
            for one, patches in zip(apart.curves, apart.patches, strict=True)
        ]
    )


def together(apart: Between, left: Faded, neighbour: Moment) -> tuple[Moment, Between]:
    """Return a moment, made of its neighbour bit for bit, and what makes that one of it."""
    states, turned = dict(neighbour.states), []
    for one, patches, kept in zip(apart.curves, apart.patches, left, strict=True):
        there = states[one.curve]
        held, back = _held_together(one, patches, kept, there.state.held, apart.makes)
        states[one.curve] = _state_together(one, held, there, apart.makes)
        turned.append(back)
    side: Side = LATER if apart.makes == EARLIER else EARLIER
    return Moment(neighbour.curves, states), Between(side, apart.curves, tuple(turned))


def _same(one: Mapping[str, object], two: Mapping[str, object]) -> bool:
    """Whether two mappings have the same objects in the same order."""
    return tuple(one) == tuple(two) and all(map(is_, one.values(), two.values()))


# -- states ----------------------------------------------------------------------------------------

#: Fields of a state beside what is held and the authors. The looks last: those of two states may
#: say the same though they are not the same.
_OTHERS = ("tolerance", "claims", "frozen", "added", "preparations", "looks")
_others_of = attrgetter(*_OTHERS)


def _curve_between(curve: str, earlier: CurveState, later: CurveState) -> _CurveBetween:
    one, two = earlier.state, later.state
    stale = [
        None if mine.stale == theirs.stale else (mine.stale, theirs.stale)
        for mine, theirs in zip(one.held.values(), two.held.values(), strict=True)
    ]
    authors = _authors_between(one.authors, two.authors)
    fields = zip(_OTHERS, _others_of(one), _others_of(two), strict=True)
    others = tuple([field for field in fields if field[1] is not field[2]])
    if others and others[-1][0] == "looks" and _as_data(one.looks) == _as_data(two.looks):
        others = others[:-1]
    same = _same(earlier.constraints, later.constraints)
    constraints = None if same else (earlier.constraints, later.constraints)
    return _CurveBetween(curve, tuple(stale), authors, others, constraints)


def _state_together(
    apart: _CurveBetween, held: Mapping[str, Held], neighbour: CurveState, side: Side
) -> CurveState:
    there, pair = neighbour.state, apart.constraints
    state = there.with_values(held, _authors_together(apart.authors, there.authors, side))
    if apart.others:
        state = attrs.evolve(state, **{name: values[side] for name, *values in apart.others})
    return CurveState(state, neighbour.constraints if pair is None else pair[side])


def _as_data(looks: tuple[Look, ...]) -> list[tuple[str, SpliceList | None]]:
    """Return looks as what they say: they have no equality of their own."""
    return [(look.kind, look.where) for look in looks]


# -- what is held ----------------------------------------------------------------------------------


def _patches(mine: CurveState, other: CurveState) -> _Patches:
    pairs = zip(mine.state.held.values(), other.state.held.values(), strict=True)
    return tuple([_patch(one.value, two.value) for one, two in pairs])


def _patch(value: Representation | None, other: Representation | None) -> bytes | None:
    if value is other:
        return None
    if value is None or other is None or type(value) is not type(other):
        return b""
    return value.patch(other) or b""


def _left(held: Held, patch: bytes | None) -> ref[Representation] | Held | None:
    if patch is None:
        return None
    return ref(held.value) if patch and held.value is not None else held


def _held_together(
    apart: _CurveBetween,
    patches: _Patches,
    left: tuple[ref[Representation] | Held | None, ...],
    neighbour: Mapping[str, Held],
    side: Side,
) -> tuple[dict[str, Held], _Patches]:
    """Return what was held, made of what the neighbour holds, and the patches back."""
    made: dict[str, Held] = {}
    turned: list[bytes | None] = []
    kinds = zip(neighbour.items(), apart.stale, patches, left, strict=True)
    for (name, there), stale, patch, kept in kinds:
        back = patch
        if isinstance(kept, Held):
            made[name] = kept
        elif stale is None and patch is None:
            made[name] = there
        else:
            value = there.value
            if patch and value is not None and kept is not None:
                value, small = value.patched(patch)
                back = small or b""
                known = kept()
                value = value if known is None else known
            made[name] = Held(value, there.stale if stale is None else stale[side])
        turned.append(back)
    return made, tuple(turned)


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
