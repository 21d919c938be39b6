"""The application framework: curves, tools, constraints, and their loop (Grimm-Ayers 4.1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from time import perf_counter
from typing import Any

import attrs

from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import EditRejectedError, MultirepError, PluginError, UnknownNameError
from multirep.events import Event, Fitted, Sampled
from multirep.multirepresentation import MultiRepresentation
from multirep.scene import Scene
from multirep.settling import Settled, settle
from multirep.splices import SpliceList
from multirep.state import State
from multirep.tool import Tool


@attrs.frozen
class Work:
    """What an application cost: samplings, samples taken, fits, seconds."""

    sampled: int
    samples: int
    fitted: int
    seconds: float


@attrs.frozen
class Outcome:
    """What an application of a tool did.

    Parameters
    ----------
    changed : SpliceList
        Where the curve changed, by the tool and by the constraints that answered.
    work : Work
    constraints : tuple of Settled
        The touched constraints with their residuals, in the units of the points.
    rounds : int
        Rounds of re-establishing.
    """

    changed: SpliceList
    work: Work
    constraints: tuple[Settled, ...] = ()
    rounds: int = 0


@attrs.frozen(eq=False)
class CurveState:
    """One curve with its constraints, as a value."""

    state: State
    constraints: Mapping[str, Constraint[Any]]


class Framework:
    """Curves by name, each with its constraints; applies tools, everything or nothing.

    Examples
    --------
    >>> import multirep as mr
    >>> from multirep.tools import MoveVertex
    >>> framework = mr.Framework()
    >>> zigzag = mr.MultiRepresentation.from_points([[0, 0], [1, 1], [2, 0]], tolerance=0.01)
    >>> framework.add("zigzag", zigzag)
    >>> print(framework.apply("zigzag", MoveVertex(index=1, to=(1, 2))).changed)
    [0,1]
    """

    def __init__(self) -> None:
        self._curves: dict[str, MultiRepresentation] = {}
        self._constraints: dict[str, dict[str, Constraint[Any]]] = {}

    # -- curves ------------------------------------------------------------------------------------

    @property
    def curves(self) -> Mapping[str, MultiRepresentation]:
        """The curves by name, as a copy of the mapping."""
        return dict(self._curves)

    @property
    def scene(self) -> Scene:
        """Read-only views of all curves."""
        return Scene(dict(self._curves))

    def add(self, name: str, curve: MultiRepresentation) -> None:
        """Add a curve under a new name."""
        if name in self._curves:
            raise MultirepError(f"there is a curve named {name!r} already")
        self._curves[name] = curve
        self._constraints[name] = {}

    def curve(self, name: str) -> MultiRepresentation:
        """Return a curve by name."""
        if name not in self._curves:
            raise UnknownNameError("curve", name, self._curves)
        return self._curves[name]

    # -- constraints -------------------------------------------------------------------------------

    def constraints(self, curve: str) -> Mapping[str, Constraint[Any]]:
        """Return the constraints of a curve by name, as a copy."""
        self.curve(curve)
        return dict(self._constraints[curve])

    def constrain(
        self, curve: str, constraint: Constraint[Any], *, name: str | None = None
    ) -> tuple[str, Outcome]:
        """Add a constraint and establish it; returns its name and what that did.

        Raises
        ------
        ConflictError
            When it cannot hold together with the others; it is not added then.
        """
        target = self.curve(curve)
        held = self._constraints[curve]
        name = name or _fresh(constraint.name, held)
        if name in held:
            raise MultirepError(f"curve {curve!r} has a constraint named {name!r} already")
        with self._everything_or_nothing(curve), _measured(target) as measured:
            held[name] = constraint
            region = SpliceList([constraint.region(target.view(constraint.needs))])
            settlement = settle(target, held, region, self.scene)
        changed = settlement.changed if settlement.rounds else SpliceList.EMPTY
        return name, Outcome(changed, measured.work, settlement.constraints, settlement.rounds)

    def release(self, curve: str, name: str) -> None:
        """Remove a constraint."""
        self.curve(curve)
        if name not in self._constraints[curve]:
            raise UnknownNameError("constraint", name, self._constraints[curve])
        del self._constraints[curve][name]

    # -- the loop ----------------------------------------------------------------------------------

    def apply(self, curve: str, tool: Tool[Any]) -> Outcome:
        """Apply a tool: view, edit, commit, re-establish constraints, bring the view up to date.

        Raises
        ------
        EditRejectedError
            When the tool refuses; the message names it and says why.
        PluginError
            When the tool fails or breaks its contract.
        ConflictError
            When the constraints cannot be re-established.

        Whatever is raised, the curve is as it was.
        """
        target = self.curve(curve)
        with self._everything_or_nothing(curve), _measured(target) as measured:
            edit = self._edit(target, tool)
            settlement = settle(target, self._constraints[curve], edit.splices, self.scene)
            if settlement.rounds:
                target.view(tool.edits)
        return Outcome(settlement.changed, measured.work, settlement.constraints, settlement.rounds)

    def _edit(self, target: MultiRepresentation, tool: Tool[Any]) -> Edit[Any]:
        value = target.view(tool.edits)
        try:
            edit: Edit[Any] = tool.edit(value, self.scene)
            target.commit(tool.edits, edit, by=f"tool {tool.name}")
        except PluginError:
            raise
        except MultirepError as error:
            raise EditRejectedError(f"tool {tool.name!r}: {error}", tool.name) from error
        except Exception as error:
            raise PluginError(
                f"tool {tool.name!r} failed with {type(error).__name__}: {error}", tool.name
            ) from error
        return edit

    # -- snapshots ---------------------------------------------------------------------------------

    def snapshot(self) -> Mapping[str, CurveState]:
        """Return the state of everything; references only."""
        return {
            name: CurveState(curve.snapshot(), dict(self._constraints[name]))
            for name, curve in self._curves.items()
        }

    def restore(self, snapshot: Mapping[str, CurveState]) -> None:
        """Go to a snapshot; curves that were added since stay as they are."""
        for name, saved in snapshot.items():
            self._curves[name].restore(saved.state)
            self._constraints[name] = dict(saved.constraints)

    @contextmanager
    def _everything_or_nothing(self, curve: str) -> Iterator[None]:
        constraints = dict(self._constraints[curve])
        with self._curves[curve].transaction():
            try:
                yield
            except BaseException:
                self._constraints[curve].clear()
                self._constraints[curve].update(constraints)
                raise


class _Measured:
    work: Work


@contextmanager
def _measured(curve: MultiRepresentation) -> Iterator[_Measured]:
    """Count what the block makes a curve do."""
    measured = _Measured()
    begin = perf_counter()
    with curve.listening() as events:
        yield measured
    measured.work = work_of(events, perf_counter() - begin)


def work_of(events: list[Event], seconds: float) -> Work:
    """Sum up events."""
    sampled = [event for event in events if isinstance(event, Sampled)]
    fitted = [event for event in events if isinstance(event, Fitted)]
    return Work(len(sampled), sum(event.samples for event in sampled), len(fitted), seconds)


def _fresh(kind: str, taken: Mapping[str, object]) -> str:
    """Return "point", "point 2", "point 3", ...: the first that is not taken."""
    number, name = 1, kind
    while name in taken:
        number += 1
        name = f"{kind} {number}"
    return name
