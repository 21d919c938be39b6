"""Re-establishing constraints after a change: bounded rounds, and a graph of who broke whom."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import attrs

from multirep.constraint import Constraint
from multirep.errors import ConflictError, MultirepError, PluginError
from multirep.multirepresentation import MultiRepresentation
from multirep.scene import Scene
from multirep.splices import SpliceList

#: A condition holds when its residual is below this part of the largest coordinate.
HOLDS = 1e-9
#: Rounds before giving up. Larger only delays the report of a conflict that is not a plain cycle.
MAX_ROUNDS = 32


@attrs.frozen
class Settled:
    """A constraint after the edit: its name and how far its condition is from holding."""

    name: str
    residual: float


@attrs.frozen
class Settlement:
    """How re-establishing went: rounds, residuals of the touched constraints, all that changed."""

    rounds: int
    constraints: tuple[Settled, ...]
    changed: SpliceList


def settle(
    curve: MultiRepresentation,
    constraints: Mapping[str, Constraint[Any]],
    change: SpliceList,
    scene: Scene,
) -> Settlement:
    """Re-establish the constraints that ``change`` touches, again and again until all hold.

    Each round enforces the broken ones, by priority and then by name. Whenever enforcing X breaks
    Y, the graph gets an edge; a constraint that must be enforced again although it lies on a cycle
    is a conflict.

    Raises
    ------
    ConflictError
        With the constraints on the cycle (or all that do not hold after the last round) and their
        residuals.
    PluginError
        When a constraint raises or breaks its contract.
    """
    if not constraints:
        return Settlement(0, (), change)
    import networkx

    order = sorted(constraints, key=lambda name: (-constraints[name].priority, name))
    broke: networkx.DiGraph[str] = networkx.DiGraph()
    enforced: set[str] = set()
    changed = change
    for rounds in range(MAX_ROUNDS + 1):
        touched = [n for n in order if _touched(curve, n, constraints[n], changed)]
        broken = [n for n in touched if not _holds(curve, n, constraints[n])]
        if not broken:
            residuals = tuple(Settled(n, _residual(curve, n, constraints[n])) for n in touched)
            return Settlement(rounds, residuals, changed)
        cycle = _cycle(broke, [n for n in broken if n in enforced])
        if cycle or rounds == MAX_ROUNDS:
            raise _conflict(curve, constraints, cycle or broken, bool(cycle))
        for name in broken:
            holding = {n for n in touched if n != name and _holds(curve, n, constraints[n])}
            changed = changed | _enforce(curve, name, constraints[name], changed, scene)
            enforced.add(name)
            for other in holding:
                if not _holds(curve, other, constraints[other]):
                    broke.add_edge(name, other)
    raise AssertionError("unreachable")


def _cycle(broke: Any, again: list[str]) -> list[str]:
    import networkx

    for name in again:
        if name in broke:
            for cycle in networkx.simple_cycles(broke):
                if name in cycle:
                    return list(cycle)
    return []


def _conflict(
    curve: MultiRepresentation,
    constraints: Mapping[str, Constraint[Any]],
    names: list[str],
    cyclic: bool,
) -> ConflictError:
    residuals = {n: _residual(curve, n, constraints[n]) for n in names}
    listed = ", ".join(f"{n!r} (off by {r:.3g})" for n, r in residuals.items())
    what = "break each other in a cycle" if cyclic else f"do not settle in {MAX_ROUNDS} rounds"
    return ConflictError(
        f"constraints {listed} {what}; release one of them or move it away",
        constraints=names,
        residuals=residuals,
        cycle=names if cyclic else (),
    )


def _touched(
    curve: MultiRepresentation, name: str, constraint: Constraint[Any], changed: SpliceList
) -> bool:
    region = _guarded(name, constraint.region, curve.view(constraint.needs))
    return changed.intersects(SpliceList([region]))


def _residual(curve: MultiRepresentation, name: str, constraint: Constraint[Any]) -> float:
    return float(_guarded(name, constraint.residual, curve.view(constraint.needs)))


def _holds(curve: MultiRepresentation, name: str, constraint: Constraint[Any]) -> bool:
    value = curve.view(constraint.needs)
    return _residual(curve, name, constraint) <= HOLDS * value.magnitude


def _enforce(
    curve: MultiRepresentation,
    name: str,
    constraint: Constraint[Any],
    changed: SpliceList,
    scene: Scene,
) -> SpliceList:
    value = curve.view(constraint.needs)
    edit = _guarded(name, constraint.enforce, value, changed, scene)
    curve.commit(constraint.needs, edit, by=f"constraint {name}")
    splices: SpliceList = edit.splices
    return splices


def _guarded(name: str, method: Any, *arguments: Any) -> Any:
    try:
        return method(*arguments)
    except MultirepError:
        raise
    except Exception as error:
        raise PluginError(
            f"constraint {name!r} failed with {type(error).__name__}: {error}", name
        ) from error
