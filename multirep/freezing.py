"""Frozen stretches: bit-identical in every representation (Grimm-Ayers 5.2).

When a stretch is frozen every representation is brought up to date and *prepared* once: it gets
its own controls at the borders (:meth:`multirep.Representation.held`), so that whatever follows
beside the border leaves the stretch alone bit by bit. That preparation, a change of
representation within rounding, is the last change there. Some representations cannot stop exactly
at a given parameter (dyadic knots); then the frozen stretch grows by the sliver that they need,
for all.

Claims that overlap are one stretch. When one of them is released, a border of another may lie
where nothing was prepared, and may not be prepared any more, for that would change bits; then the
stretch stays frozen up to the next place where every representation can stop. That cannot be less:
a spline that is to keep its bits on a part of a span is the same polynomial on all of it, and reads
p - 1 knots beyond. Releasing the other one too and freezing it anew frees the rest. A border that
lay free when its stretch was frozen was prepared then; it stays where it is, whatever is frozen
over it later.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import attrs
import numpy as np

from multirep.agreeing import APART, NEAR, agreeing_end, apart, fitted_closely
from multirep.errors import EditError, FrozenError, PluginError
from multirep.events import Event, Prepared
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.synchronization import hop
from multirep.tidying import from_before, tidied

#: How often a stretch may grow before every representation can hold it. Two kinds that cannot stop
#: anywhere need two; more only delays the report of two that never agree.
MOST_GROWTHS = 16
#: Of more stretches than this a message gives the hull only.
MOST_SHOWN = 3


def with_claim(state: State, name: str, asked: SpliceList, emit: Callable[[Event], None]) -> State:
    """Return the state in which ``asked`` is frozen under ``name``.

    All kinds must have a value and be up to date. What is expressed anew is emitted.

    Raises
    ------
    EditError
        When nothing is asked for, or something outside T.
    """
    domain = state.authors.domain
    if not asked:
        raise EditError("there is nothing to freeze: the stretch is empty")
    if not domain.contains(asked.hull):
        raise EditError(f"cannot freeze {asked}: the domain is {domain}")
    if name in state.claims:
        raise EditError(f"something is frozen under the name {name!r} already")
    claims = {**state.claims, name: asked}
    return _prepared(state, claims, state.frozen, asked, emit)


def without_claim(
    state: State, name: str, emit: Callable[[Event], None], *, tidy: bool = True
) -> State:
    """Return the state in which what ``name`` froze is free, as far as no other claim holds it.

    With ``tidy``, helper controls at its ends are taken back (:meth:`Representation.released`).
    """
    claims = {other: splices for other, splices in state.claims.items() if other != name}
    keep = claimed(claims.values())
    after = (
        _prepared(state, claims, keep, state.claims[name], emit)
        if claims
        else attrs.evolve(state, claims={}, frozen=SpliceList.EMPTY)
    )
    return tidied(after, emit) if tidy else after


def claimed(claims: Iterable[SpliceList]) -> SpliceList:
    """Return the union."""
    union = SpliceList.EMPTY
    for splices in claims:
        union = union | splices
    return union


def blamed(state: State, splices: SpliceList) -> tuple[str, ...]:
    """Return the names of the freezes that a change of ``splices`` would violate."""
    direct = tuple(name for name, claim in state.claims.items() if claim.intersects(splices))
    if direct:
        return direct
    hit = SpliceList(part for part in state.frozen if SpliceList([part]).intersects(splices))
    return tuple(name for name, claim in state.claims.items() if claim.intersects(hit))


def frozen_error(state: State, splices: SpliceList, who: str) -> FrozenError:
    """Return the error that says which freezes stand in the way of a change of ``splices``."""
    names = blamed(state, splices)
    listed = " and ".join(map(repr, names))
    overlap = (splices & state.frozen) or splices
    shown = overlap if len(overlap) <= MOST_SHOWN else SpliceList([overlap.hull])
    beyond = overlap - claimed(state.claims.values())
    why = ""
    if beyond.length > NEAR * state.authors.domain.length:
        why = (
            f", more than was asked for: with {beyond} changed, representations could not keep the "
            "bits beside it; released and frozen anew, it would leave most of that free"
        )
    return FrozenError(
        f"{who} would change {shown}, which {listed} "
        f"{'keeps' if len(names) == 1 else 'keep'} frozen{why}",
        constraints=names,
        residuals=dict.fromkeys(names, 0.0),
        where={name: state.claims[name] for name in names},
    )


def check_still(before: State, after: State) -> None:
    """Raise FrozenError when another tolerance changed a frozen stretch."""
    if not before.frozen:
        return
    for name, held in after.held.items():
        old = before.held[name].value
        if held.value is None or old is None:
            continue
        moved = held.stale | old.changes(held.value)
        if moved.intersects(before.frozen):
            raise frozen_error(before, moved, f"the tolerance {after.tolerance:g} for {name!r}")


def _prepared(
    state: State,
    claims: Mapping[str, SpliceList],
    keep: SpliceList,
    touched: SpliceList,
    emit: Callable[[Event], None],
) -> State:
    """Hold the union of ``claims`` still in every kind; not a bit of ``keep`` changes.

    Only stretches that meet ``touched`` are looked at anew.
    """
    settled = SpliceList(
        part for part in state.frozen if not SpliceList([part]).intersects(touched)
    )
    preparations = from_before(state)
    state, frozen = _bordered(state, settled, claimed(claims.values()), keep, emit)
    values = _values(state)
    added = {kind: dict(ends) for kind, ends in state.added.items()}
    for part in frozen:
        if settled.contains(part):
            continue
        for kind, value in values.items():
            values[kind], new = _held(kind, value, part, keep, emit)
            counts = added.setdefault(kind, {})
            for end, count in new.items():
                counts[end] = counts.get(end, 0) + count
    kinds = {kind: Held(values[kind], held.stale) for kind, held in state.held.items()}
    return attrs.evolve(
        state,
        held=kinds,
        claims=claims,
        frozen=frozen,
        added=added,
        preparations={
            kind: attrs.evolve(preparation, value=values[kind])
            for kind, preparation in preparations.items()
        },
    )


def _values(state: State) -> dict[str, Representation]:
    values: dict[str, Representation] = {}
    for kind, held in state.held.items():
        assert held.value is not None, f"{kind} has no value to freeze"
        values[kind] = held.value
    return values


def _bordered(
    state: State,
    settled: SpliceList,
    asked: SpliceList,
    keep: SpliceList,
    emit: Callable[[Event], None],
) -> tuple[State, SpliceList]:
    """Find borders that every kind can hold and at which all agree; they may be fitted for that."""
    domain, tried = state.authors.domain, set[float]()
    frozen = settled
    for _ in range(MOST_GROWTHS):
        values = _values(state)
        frozen = _grown(values, settled, asked, keep)
        moved = False
        for part in frozen:
            for end, outward in ((part.start, -1.0), (part.stop, 1.0)):
                if settled.contains(part) or end in domain:
                    continue
                if apart(values, np.array([end]))[0] <= APART * hop(state.tolerance):
                    continue
                limit = _limit(state.frozen, domain, end, outward)
                place = agreeing_end(values, end, limit, tolerance=state.tolerance)
                if place is None and end not in tried:
                    tried.add(end)
                    state, moved = fitted_closely(state, end, keep, emit), True
                elif place is not None:
                    asked, moved = asked | SpliceList([sorted((end, place))]), True
        if not moved:
            return state, frozen
    return state, frozen


def _limit(frozen: SpliceList, domain: Interval, end: float, outward: float) -> float:
    """How far a border may move: to that of what was frozen before, or a little."""
    for part in frozen:
        if part.contains(end):
            return part.start if outward < 0 else part.stop
    return min(max(end + outward * NEAR * domain.length, domain.start), domain.stop)


def _held(
    kind: str,
    value: Representation,
    part: Interval,
    keep: SpliceList,
    emit: Callable[[Event], None],
) -> tuple[Representation, dict[float, int]]:
    """Prepare a value for a stretch, end by end; returns it and how many controls it got where."""
    domain = value.domain
    added: dict[float, int] = {}
    for end, half in (
        (part.start, Interval(part.start, domain.stop)),
        (part.stop, Interval(domain.start, part.stop)),
    ):
        edit, _ = value.held(half, keep)
        if edit.splices.intersects(keep):
            raise PluginError(
                f"{kind!r} changed {edit.splices & keep} while it prepared for {part} to be frozen",
                kind,
            )
        if edit.splices:
            emit(Prepared(kind, edit.splices))
        if edit.value.size > value.size:
            added[end] = edit.value.size - value.size
        value = edit.value
    return value, added


def _grown(
    values: Mapping[str, Representation],
    settled: SpliceList,
    asked: SpliceList,
    keep: SpliceList,
) -> SpliceList:
    """Return the smallest stretches around ``asked`` that every kind can hold still."""
    frozen = settled | asked
    for _ in range(MOST_GROWTHS):
        grown = frozen
        for part in frozen:
            if settled.contains(part):
                continue
            for kind, value in values.items():
                _, guard = value.held(part, keep)
                if not guard.contains(part):
                    raise PluginError(f"{kind!r}.held returned {guard} for {part}", kind)
                grown = grown | SpliceList([guard])
        if grown == frozen:
            return frozen
        frozen = grown
    raise PluginError(
        f"{' and '.join(map(repr, values))} find no common place to stop around {asked}",
        next(iter(values)),
    )
