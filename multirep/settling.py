"""Re-establishing constraints after a change, by groups, in bounded rounds (Grimm-Ayers 4.1).

A change wakes the constraints whose region it touches. Those that do not hold are grouped:
constraints of one family whose regions overlap are enforced by one call, anything else by itself;
groups go from high to low priority. What that changes wakes others, and so on, until a round finds
nothing broken. Every "re-establishing X broke Y" becomes an edge of a graph; a constraint that has
to be enforced again although it lies on a cycle, and is not at least halving what it is off by, is
in conflict with those on the cycle.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import attrs
import numpy as np

from multirep.aim import TURNED, misses, turns
from multirep.asking import guarded, region_of, residual_of
from multirep.conflicts import conflict, opposed, shortest_cycle
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import (
    ConflictError,
    FrozenError,
    MultirepError,
    PluginError,
)
from multirep.events import Event, Fitted
from multirep.frozen_borders import clear_of_ice
from multirep.interval import Interval
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.synchronization import check_edit

if TYPE_CHECKING:
    import networkx

#: A condition holds when its residual is below this part of the size of the curve, plus rounding.
HOLDS = 1e-9
#: Rounding of a residual in terms of the largest coordinate: 64 units in the last place.
ROUNDING = 2.0**-46
#: Rounds before giving up. Larger only delays the report of a conflict that is not a plain cycle.
MAX_ROUNDS = 32
#: A constraint on a cycle may go on while what it is off by shrinks to this part in each lap.
SHRINKS = 0.5


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
    *,
    kind: type[Representation] | None = None,
    by: str = "the edit",
) -> Settlement:
    """Re-establish the constraints that ``change`` touches, again and again until all hold.

    Parameters
    ----------
    curve : MultiRepresentation
        Changed in place; the caller takes it back when this raises.
    constraints : mapping of str to Constraint
        Those that keep a stretch frozen are left out: nothing can disturb them.
    change : SpliceList
    scene : Scene
        Its ``aims`` are what the tool asked for and has reached; they must be reached in the end.
    kind : Representation class, optional
        The one on which the aims are looked at.
    by : str
        Who made the change, for messages.

    Raises
    ------
    ConflictError
        With the constraints on the cycle (or all that do not hold after the last round), or those
        that undid what the tool asked for, and what each was off by.
    PluginError
        When a constraint raises or breaks its contract.
    """
    claims = curve.claims
    constraints = {name: c for name, c in constraints.items() if name not in claims}
    if not constraints:
        return Settlement(0, (), change)
    loop = _Loop(curve, constraints, change, scene)
    with curve.listening() as loop.events:
        settlement = loop.run()
        if settlement.rounds and kind is not None:
            loop.check_aims(kind, by)
    return settlement


@attrs.define(eq=False)
class _Loop:
    """The state of one settlement."""

    curve: MultiRepresentation
    constraints: Mapping[str, Constraint[Any]]
    changed: SpliceList
    scene: Scene
    events: list[Event] = attrs.field(factory=list)
    #: What synchronisation changed in each kind: it wakes the constraints on that kind alone.
    fitted: dict[str, SpliceList] = attrs.field(factory=dict)
    #: What each enforced constraint was off by, at first and when it was last enforced.
    first: dict[str, float] = attrs.field(factory=dict)
    last: dict[str, float] = attrs.field(factory=dict)
    thresholds: dict[str, float] = attrs.field(factory=dict)
    #: What a constraint said of a value; values are immutable, so it is asked once for each.
    regions: dict[str, tuple[Representation, Interval]] = attrs.field(factory=dict)
    residuals: dict[str, tuple[Representation, float]] = attrs.field(factory=dict)
    _broke: networkx.DiGraph[str] | None = None

    def run(self) -> Settlement:
        order = sorted(self.constraints, key=lambda n: (-self.constraints[n].priority, n))
        for rounds in range(MAX_ROUNDS + 1):
            touched = {n: self.residual(n) for n in order if self.touched(n, self.changed)}
            broken = {n: r for n, r in touched.items() if r > self.threshold(n)}
            if not broken:
                settled = tuple(Settled(n, r) for n, r in touched.items())
                return Settlement(rounds, settled, self.changed)
            self.check_progress(broken, rounds)
            for group in self.groups(order, broken):
                self.enforce(group, touched)
        raise AssertionError("unreachable")

    # -- one constraint ----------------------------------------------------------------------------

    def value(self, name: str) -> Representation:
        value = self.curve.view(self.constraints[name].needs)
        for event in self.events:
            if isinstance(event, Fitted):
                before = self.fitted.get(event.kind, SpliceList.EMPTY)
                self.fitted[event.kind] = before | event.splices
        self.events.clear()
        return value

    def region(self, name: str) -> Interval:
        value = self.value(name)
        if name not in self.regions or self.regions[name][0] is not value:
            self.regions[name] = value, region_of(name, self.constraints[name], value)
        return self.regions[name][1]

    def touched(self, name: str, changed: SpliceList) -> bool:
        region = self.region(name)
        fitted = self.fitted.get(self.constraints[name].needs.name, SpliceList.EMPTY)
        return _meet(changed, region) or _meet(fitted, region)

    def residual(self, name: str) -> float:
        value = self.value(name)
        if name in self.residuals and self.residuals[name][0] is value:
            return self.residuals[name][1]
        residual = residual_of(name, self.constraints[name], value)
        self.residuals[name] = value, residual
        return residual

    def threshold(self, name: str) -> float:
        kind = self.constraints[name].needs.name
        if kind not in self.thresholds:
            value = self.value(name)
            # A few points give a lower bound of the size: what is too small is only stricter.
            points = value(np.linspace(value.domain.start, value.domain.stop, 9))
            size = float(np.ptp(points, axis=0).max())
            self.thresholds[kind] = HOLDS * size + ROUNDING * value.magnitude
        return self.thresholds[kind]

    def holds(self, name: str) -> bool:
        return self.residual(name) <= self.threshold(name)

    # -- groups ------------------------------------------------------------------------------------

    def groups(self, order: Sequence[str], broken: Iterable[str]) -> list[list[str]]:
        """Broken constraints with those of their family whose claims overlap, in order."""
        groups: list[list[str]] = []
        taken: set[str] = set()
        for name in broken:
            if name in taken:
                continue
            group = self.overlapping(name, order)
            taken.update(group)
            groups.append(group)
        return groups

    def overlapping(self, name: str, order: Sequence[str]) -> list[str]:
        """``name`` and all that hang together with it through overlapping claims."""
        constraint = self.constraints[name]
        if constraint.family is None:
            return [name]
        claims = sorted(
            (self.region(other), other)
            for other in order
            if self.constraints[other].family == constraint.family
            and self.constraints[other].needs is constraint.needs
        )
        chain: list[str] = []
        reach = -np.inf
        for claim, other in claims:
            if claim.start > reach:
                if name in chain:
                    break
                chain = []
            chain.append(other)
            reach = max(reach, claim.stop)
        members = set(chain)
        return [other for other in order if other in members]

    def enforce(self, group: list[str], touched: Mapping[str, float]) -> None:
        """Let one group re-establish itself and note whom that broke."""
        broken = {n: r for n in group if (r := self.residual(n)) > self.threshold(n)}
        if not broken:
            return  # another group of this round has mended it
        for name, residual in broken.items():
            self.first.setdefault(name, residual)
            self.last[name] = residual
        held = [n for n in touched if n not in broken and self.holds(n)]
        edit = self.edit_of(group, broken)
        for other in dict.fromkeys([*held, *group]):
            if self.touched(other, edit.splices) and not self.holds(other):
                for name in broken:
                    if other not in broken or other == name:
                        self.broke.add_edge(name, other)
        if not edit.splices and any(not self.holds(name) for name in broken):
            raise conflict(
                "do not hold and change nothing to hold again", self.claims(broken), broken
            )

    def edit_of(self, group: list[str], broken: Mapping[str, float]) -> Edit[Representation]:
        first = self.constraints[group[0]]
        value = self.value(group[0])
        label = " and ".join(map(repr, group))
        try:
            edit: Edit[Representation]
            if first.family is None:
                edit = guarded(group[0], first.enforce, value, self.changed, self.scene)
            else:
                members = {name: self.constraints[name] for name in group}
                edit = guarded(
                    label, type(first).enforce_together, members, value, self.changed, self.scene
                )
        except ConflictError as error:
            raise self.told(error, group) from error
        except PluginError:
            raise
        except MultirepError as error:
            raise conflict(
                f"cannot be re-established: {error}", self.claims(broken), broken
            ) from error
        if self.curve.frozen:
            check_edit(value, edit, label)
            edit = clear_of_ice(self.curve, value, edit, f"re-establishing {label}")
        self.curve.commit(first.needs, edit, by=f"constraint {label}")
        self.changed = self.changed | edit.splices
        self.retain(value, edit)
        return edit

    def retain(self, before: Representation, edit: Edit[Representation]) -> None:
        """Keep what was said of constraints whose claim an edit leaves alone."""
        for name, (value, region) in self.regions.items():
            if value is before and not _meet(edit.splices, region):
                self.regions[name] = edit.value, region
                known = self.residuals.get(name)
                if known is not None and known[0] is before:
                    self.residuals[name] = edit.value, known[1]

    # -- conflicts ---------------------------------------------------------------------------------

    @property
    def broke(self) -> networkx.DiGraph[str]:
        if self._broke is None:
            import networkx  # half a second; most edits break nothing

            self._broke = networkx.DiGraph()
        return self._broke

    def check_progress(self, broken: Mapping[str, float], rounds: int) -> None:
        """Raise when a broken constraint goes round in circles, or after the last round."""
        for name, residual in broken.items():
            if self._broke is None or name not in self.last:
                continue
            cycle = shortest_cycle(self._broke, name)
            if cycle and not residual <= SHRINKS * self.last[name]:
                residuals = {n: broken.get(n, self.last[n]) for n in cycle}
                how = (
                    "break each other in a cycle"
                    if len(cycle) > 1
                    else "does not hold after it has re-established itself"
                )
                raise conflict(how, self.claims(cycle), residuals, cycle=cycle)
        if rounds == MAX_ROUNDS:
            how = f"do not settle in {MAX_ROUNDS} rounds"
            raise conflict(how, self.claims(broken), broken)

    def claims(self, names: Iterable[str]) -> dict[str, SpliceList]:
        return {name: SpliceList([self.region(name)]) for name in names}

    def told(self, error: ConflictError, group: Sequence[str]) -> ConflictError:
        """Complete what a plugin says about a conflict: names, where, residuals."""
        frozen = self.curve.claims
        names = error.constraints or tuple(group)
        if isinstance(error, FrozenError):
            hit = SpliceList(self.region(n) for n in names if n in self.constraints)
            names += tuple(n for n, c in frozen.items() if c.intersects(hit) and n not in names)
        where = {
            name: frozen[name] if name in frozen else SpliceList([self.region(name)])
            for name in names
            if name in frozen or name in self.constraints
        }
        residuals = {name: self.last.get(name, 0.0) for name in names}
        return type(error)(
            str(error.args[0]),
            constraints=names,
            residuals={**residuals, **error.residuals},
            cycle=error.cycle,
            where={**where, **error.where},
        )

    def check_aims(self, kind: type[Representation], by: str) -> None:
        """Raise when the constraints have undone what the tool asked for."""
        value = self.curve.view(kind)
        for aim in self.scene.aims:
            missed = misses(aim, value)
            own = any(n == kind.name for part, n in self.curve.authors if part.contains(aim.t))
            turned = turns(aim, value) if own else 0.0
            if missed > self.curve.tolerance or turned > TURNED:
                near = [n for n in self.first if self.region(n).contains(aim.t)]
                names = near or list(self.first)
                residuals = {n: self.first[n] for n in names}
                raise opposed(by, aim, missed, turned, self.claims(names), residuals)


def _meet(splices: SpliceList, region: Interval) -> bool:
    """Whether a change reaches what a constraint claims, be it a single parameter."""
    return splices.intersects(SpliceList([region])) if region.length else splices.contains(region)
