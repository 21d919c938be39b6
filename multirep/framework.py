"""The application framework: curves, tools, constraints, and their loop (Grimm-Ayers 4.1)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import attrs

from multirep.aim import TURNED, Aim, misses, turns
from multirep.asking import frozen_of, region_of
from multirep.conflicts import smallest_release
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import (
    ConflictError,
    EditRejectedError,
    MultirepError,
    PluginError,
    UnknownNameError,
)
from multirep.frozen_borders import clear_of_ice, follow_beside_ice
from multirep.memory import Memory
from multirep.multirepresentation import MultiRepresentation
from multirep.outcome import Outcome, measured_work
from multirep.reparameterization import ParameterMap
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.settling import Settlement, settle
from multirep.splices import SpliceList
from multirep.state import State
from multirep.synchronization import check_edit
from multirep.tool import Tool


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
        self._memory: Memory | None = None

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

    def remove(self, name: str) -> None:
        """Take a curve out, with its constraints; UnknownNameError when there is none."""
        self.curve(name)
        del self._curves[name], self._constraints[name]

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

        def add() -> Settlement:
            return self._add(curve, name, constraint)

        with measured_work(target) as measured, self._way_out(curve, add):
            settlement = add()
        changed = settlement.changed if settlement.rounds else SpliceList.EMPTY
        return name, Outcome(changed, measured.work, settlement.constraints, settlement.rounds)

    def release(self, curve: str, name: str) -> None:
        """Remove a constraint; what it kept frozen is free again."""
        self.curve(curve)
        if name not in self._constraints[curve]:
            raise UnknownNameError("constraint", name, self._constraints[curve])
        self._release(curve, name)

    def _release(self, curve: str, name: str, *, tidy: bool = True) -> None:
        target = self._curves[curve]
        with self._everything_or_nothing(curve):
            if name in target.claims:
                target.thaw(name, tidy=tidy)
            del self._constraints[curve][name]

    def _add(self, curve: str, name: str, constraint: Constraint[Any]) -> Settlement:
        target = self._curves[curve]
        with self._everything_or_nothing(curve):
            self._constraints[curve][name] = constraint
            value = target.view(constraint.needs)
            region = SpliceList([region_of(name, constraint, value)])
            settlement = settle(target, self._constraints[curve], region, self._scene(target))
            frozen = frozen_of(name, constraint, target.view(constraint.needs))
            if frozen:
                target.freeze(name, frozen)
        return settlement

    def set_tolerance(self, curve: str, tolerance: float) -> Outcome:
        """Change the tolerance of a curve; constraints that this disturbs are re-established.

        Raises
        ------
        ToleranceError
            When the tolerance is too small.
        ConflictError
            When a frozen stretch does not meet it, or the constraints cannot be re-established.
        """
        target = self.curve(curve)
        with self._everything_or_nothing(curve), measured_work(target) as measured:
            target.tolerance = tolerance
            everywhere = SpliceList([target.domain])
            settlement = settle(target, self._constraints[curve], everywhere, self._scene(target))
        changed = settlement.changed if settlement.rounds else SpliceList.EMPTY
        return Outcome(changed, measured.work, settlement.constraints, settlement.rounds)

    def reparameterize(self, curve: str, mapping: ParameterMap = "even") -> Outcome:
        """Map the parameters of a curve; see :meth:`multirep.MultiRepresentation.reparameterize`.

        Raises
        ------
        EditError
            When the map makes no sense.
        ConflictError
            When the curve has constraints: they stand at parameters, under which the map would move
            the curve away.
        """
        target = self.curve(curve)
        held = self._constraints[curve]
        if held:
            raise ConflictError(
                f"curve {curve!r} cannot be re-parameterised under its constraints "
                f"{', '.join(map(repr, held))}, which stand at parameters of it: release them, and "
                "constrain it anew afterwards",
                constraints=held,
            )
        with self._everything_or_nothing(curve), measured_work(target) as measured:
            changed = target.reparameterize(mapping)
        return Outcome(changed, measured.work)

    # -- the loop ----------------------------------------------------------------------------------

    def apply(self, curve: str, tool: Tool[Any]) -> Outcome:
        """Apply a tool: view, edit, commit, re-establish constraints, bring the view up to date.

        An edit that reaches into a frozen stretch is faded out before it.

        Raises
        ------
        EditRejectedError
            When the tool refuses; the message names it and says why.
        PluginError
            When the tool fails or breaks its contract.
        ConflictError
            When the constraints cannot be re-established or a frozen stretch forbids the edit; it
            says which constraints, where, and which to release.

        Whatever is raised, the curve is as it was.
        """
        target = self.curve(curve)

        def run() -> tuple[Settlement, SpliceList]:
            return self._run(curve, tool)

        with measured_work(target) as measured, self._way_out(curve, run):
            settlement, faded = run()
        return Outcome(
            settlement.changed, measured.work, settlement.constraints, settlement.rounds, faded
        )

    def _run(self, curve: str, tool: Tool[Any]) -> tuple[Settlement, SpliceList]:
        target, constraints = self._curves[curve], self._constraints[curve]
        by = f"tool {tool.name!r}"
        with self._everything_or_nothing(curve):
            edit, aims, faded = self._edit(target, tool, bool(constraints))
            settlement = settle(
                target,
                constraints,
                edit.splices,
                self._scene(target, aims),
                kind=tool.edits,
                by=by,
            )
            if settlement.rounds:
                target.view(tool.edits)
            follow_beside_ice(target, settlement.changed, by)
            self._rearrange(curve, tool)
        return settlement, faded

    def _rearrange(self, curve: str, tool: Tool[Any]) -> None:
        """Add, replace and release the constraints that a tool asks for."""
        target, constraints = self._curves[curve], self._constraints[curve]
        asked = _of_tool(tool, tool.constrains, target.view(tool.edits), dict(constraints))
        if not (
            isinstance(asked, Mapping)
            and all(isinstance(name, str) for name in asked)
            and all(isinstance(one, Constraint | None) for one in asked.values())
        ):
            raise PluginError(
                f"tool {tool.name!r} constrains {asked!r}; it must be a mapping of names to "
                "constraints or None",
                tool.name,
            )
        for name, constraint in asked.items():
            if name in constraints:
                self.release(curve, name)
            if constraint is not None:
                self._add(curve, name, constraint)

    def _edit(
        self, target: MultiRepresentation, tool: Tool[Any], constrained: bool
    ) -> tuple[Edit[Any], tuple[Aim, ...], SpliceList]:
        value: Representation = target.view(tool.edits)
        by = f"tool {tool.name!r}"
        edit: Edit[Any] = _of_tool(tool, tool.edit, value, self._scene(target))
        aims = _aims_of(tool, value) if constrained else ()
        faded = SpliceList.EMPTY
        try:
            if target.frozen:
                check_edit(value, edit, by)
                faded = edit.splices & target.frozen
                edit = clear_of_ice(target, value, edit, by, aims)
            target.commit(tool.edits, edit, by=by)
        except (PluginError, ConflictError):
            raise
        except MultirepError as error:
            raise EditRejectedError(f"{by}: {error}", tool.name) from error
        reached = tuple(aim for aim in aims if _reached(aim, edit.value, target.tolerance))
        return edit, reached, faded

    def _scene(self, target: MultiRepresentation, aims: tuple[Aim, ...] = ()) -> Scene:
        memory = Memory() if self._memory is None else self._memory
        return Scene(dict(self._curves), target.frozen, aims, target.tolerance, memory)

    @contextmanager
    def remembering(self) -> Iterator[None]:
        """Keep factored systems from one application to the next until the block ends.

        For moves that ask for the same with other numbers, as those of a drag: what they solve is
        factored once. The results are the same, bit for bit.
        """
        before = self._memory
        self._memory = Memory()
        try:
            yield
        finally:
            self._memory = before

    @contextmanager
    def _way_out(self, curve: str, attempt: Callable[[], object]) -> Iterator[None]:
        """Add to a conflict the smallest set of constraints whose release lets the attempt through.

        The attempt must leave everything as it was when it raises.
        """
        try:
            yield
        except ConflictError as error:
            names = self._constraints[curve]
            suspects = [name for name in error.constraints if name in names]
            error.release = smallest_release(
                suspects, list(names), lambda chosen: self._goes_through(curve, chosen, attempt)
            )
            raise

    def _goes_through(
        self, curve: str, without: frozenset[str], attempt: Callable[[], object]
    ) -> bool:
        """Whether an attempt succeeds without some constraints; everything is as before then."""
        try:
            with self._everything_or_nothing(curve):
                for name in without:
                    self._release(curve, name, tidy=False)  # the attempt may name a control
                attempt()
                raise _TakeBack
        except _TakeBack:
            return True

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


def _reached(aim: Aim, value: Representation, tolerance: float) -> bool:
    """Whether an edit did what it was about; only that is held against constraints."""
    return misses(aim, value) <= tolerance and turns(aim, value) <= TURNED


class _TakeBack(Exception):
    """Ends a trial that succeeded."""


def _of_tool(tool: Tool[Any], method: Callable[..., Any], *arguments: Any) -> Any:
    """Call a method of a tool; whatever it raises becomes an error that names it."""
    try:
        return method(*arguments)
    except (PluginError, ConflictError):
        raise
    except MultirepError as error:
        raise EditRejectedError(f"tool {tool.name!r}: {error}", tool.name) from error
    except Exception as error:
        raise PluginError(
            f"tool {tool.name!r} failed with {type(error).__name__}: {error}", tool.name
        ) from error


def _aims_of(tool: Tool[Any], value: Representation) -> tuple[Aim, ...]:
    aims = _of_tool(tool, tool.aims, value)
    if isinstance(aims, tuple | list) and all(isinstance(aim, Aim) for aim in aims):
        return tuple(aims)
    raise PluginError(
        f"tool {tool.name!r} has the aims {aims!r}; they must be a tuple of Aim", tool.name
    )


def _fresh(kind: str, taken: Mapping[str, object]) -> str:
    """Return "point", "point 2", "point 3", ...: the first that is not taken."""
    number, name = 1, kind
    while name in taken:
        number += 1
        name = f"{kind} {number}"
    return name
