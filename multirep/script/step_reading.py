"""The steps of a script: tables to values, each against the tool or constraint that it names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from attrs import evolve, field, frozen, validators

from multirep.errors import MultirepError, UnknownNameError
from multirep.interval import Interval
from multirep.script.model import (
    AddStep,
    ConstrainStep,
    CurveSpec,
    GestureStep,
    HistoryStep,
    ReleaseStep,
    ReparameterizeStep,
    Step,
    ToleranceStep,
    ToolStep,
    ViewStep,
)
from multirep.script.strict import (
    Mismatch,
    check_keys,
    check_names,
    quote,
    structure,
    structure_key,
)
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.registry import Registry

#: What makes a step a step; exactly one of them.
STEP_KINDS = (
    "tool", "gesture", "constrain", "release", "tolerance", "reparameterize", "add", "view", "undo",
    "redo",
)  # fmt: skip
#: Which of them may meet with a conflict.
CONFLICTING = ("tool", "gesture", "constrain", "tolerance", "reparameterize")
#: What makes a part of a gesture.
PART_KINDS = ("tool", "view")
#: More steps than anybody does in a day: a bound on what a small file can ask for.
MOST_TIMES = 1_000_000


@frozen
class _Times:
    """How many gestures an undo or redo step covers."""

    times: int = field(validator=[validators.ge(1), validators.le(MOST_TIMES)])


@frozen
class _Tolerance:
    """A tolerance."""

    tolerance: float = field(validator=validators.gt(0))


@frozen
class StepReader:
    """Reads one step after the other; errors are Mismatch, with the key."""

    registry: Registry
    curves: tuple[CurveSpec, ...]

    def read(self, index: int, table: Mapping[str, Any]) -> Step:
        """Read one step.

        Raises
        ------
        Mismatch
            Names the key, what was found and what is allowed.
        """
        kind = _kind(table, STEP_KINDS, "a step")
        if "may_conflict" in table and kind in CONFLICTING:
            lenient = structure_key(table, "may_conflict", bool)
            rest = {key: value for key, value in table.items() if key != "may_conflict"}
            return evolve(self.read(index, rest), may_conflict=lenient)
        if kind in ("undo", "redo"):
            check_keys(table, (kind,), f"an {kind} step" if kind == "undo" else "a redo step")
            return HistoryStep(index, kind, _field({"times": table[kind]}, _Times, kind).times)
        if kind == "add":
            check_keys(table, ("add",), "an add step")
            return AddStep(index, self._curve(table, "add"))
        if "curve" not in table:
            names = ", ".join(repr(curve.name) for curve in self.curves)
            raise Mismatch(f"missing; curves are {names}", "curve")
        curve = self._curve(table, "curve")
        if kind == "tool":
            return self._tool(index, curve, table)
        if kind == "view":
            return self._view(index, curve, table)
        if kind == "constrain":
            return self._constrain(index, curve, table)
        check_keys(table, ("curve", kind), f"a {kind} step")
        if kind == "release":
            return ReleaseStep(index, curve, structure_key(table, kind, str))
        if kind == "tolerance":
            tolerance = _field({"tolerance": table[kind]}, _Tolerance, kind).tolerance
            return ToleranceStep(index, curve, tolerance)
        if kind == "reparameterize":
            return ReparameterizeStep(index, curve, _mapping(table))
        return GestureStep(index, curve, self._parts(index, curve, table["gesture"]))

    def _curve(self, table: Mapping[str, Any], key: str) -> str:
        name: str = structure_key(table, key, str)
        check_names((name,), "curve", [curve.name for curve in self.curves], key)
        return name

    def _tool(self, index: int, curve: str, table: Mapping[str, Any]) -> ToolStep:
        name = structure_key(table, "tool", str)
        parameters = {key: value for key, value in table.items() if key not in ("curve", "tool")}
        try:
            tool = self.registry.tools[name]
        except UnknownNameError as error:
            raise Mismatch(str(error), "tool") from None
        return ToolStep(index, curve, name, structure(parameters, tool))

    def _constrain(self, index: int, curve: str, table: Mapping[str, Any]) -> ConstrainStep:
        kind = structure_key(table, "constrain", str)
        own = ("curve", "constrain", "name")
        parameters = {key: value for key, value in table.items() if key not in own}
        name = structure_key(table, "name", str) if "name" in table else None
        try:
            constraint = self.registry.constraints[kind]
        except UnknownNameError as error:
            raise Mismatch(str(error), "constrain") from None
        return ConstrainStep(index, curve, kind, structure(parameters, constraint), name)

    def _view(self, index: int, curve: str, table: Mapping[str, Any]) -> ViewStep:
        check_keys(table, ("curve", "view", "where"), "a view step")
        value = table["view"]
        kinds = structure_key(table, "view", tuple[str, ...] if isinstance(value, list) else str)
        kinds = kinds if isinstance(kinds, tuple) else (kinds,)
        [spec] = [spec for spec in self.curves if spec.name == curve]
        known = list(spec.representations or self.registry.representations)
        check_names(kinds, "representation", known, "view")
        where = None
        if "where" in table:
            pairs = structure_key(table, "where", tuple[tuple[float, float], ...])
            try:
                where = SpliceList(Interval.of(pair) for pair in pairs)
            except MultirepError as error:
                raise Mismatch(str(error), "where") from None
        return ViewStep(index, curve, kinds, where)

    def _parts(self, index: int, curve: str, tables: object) -> tuple[ToolStep | ViewStep, ...]:
        """Read the tools and views of a gesture, which are on its curve; views may be on others."""
        if not isinstance(tables, list) or not all(isinstance(table, Mapping) for table in tables):
            raise Mismatch(f"expected tables [[step.gesture]], got {quote(tables)}", "gesture")
        parts: list[ToolStep | ViewStep] = []
        for number, table in enumerate(tables):
            try:
                kind = _kind(table, PART_KINDS, "a part of a gesture")
                if kind == "view":
                    looked = self._curve(table, "curve") if "curve" in table else curve
                    parts.append(self._view(index, looked, table))
                    continue
                if "curve" in table:
                    raise Mismatch("a gesture is on one curve, which the step names", "curve")
                parts.append(self._tool(index, curve, table))
            except Mismatch as error:
                raise Mismatch(
                    error.problem, f"gesture[{number}].{error.key}".rstrip(".")
                ) from None
        return tuple(parts)


def _kind(table: Mapping[str, Any], kinds: tuple[str, ...], what: str) -> str:
    found = [kind for kind in kinds if kind in table]
    if len(found) != 1:
        shown = " and ".join(map(repr, found)) or (
            f"only {', '.join(map(repr, table)) or 'nothing'}"
        )
        raise Mismatch(f"{what} has exactly one of {', '.join(kinds)}; got {shown}")
    return found[0]


def _field(value: Mapping[str, object], cls: Any, key: str) -> Any:
    """Make a class of one field; what is wrong with it is wrong with ``key``."""
    try:
        return structure(value, cls)
    except Mismatch as error:
        raise Mismatch(error.problem, key) from None


def _mapping(table: Mapping[str, Any]) -> Any:
    value = table["reparameterize"]
    if value == "even":
        return value
    expected = 'expected "even" or [[old t, ...], [new t, ...]]'
    if not isinstance(value, list) or len(value) != 2:
        raise Mismatch(f"{expected}, got {quote(value)}", "reparameterize")
    return structure_key(table, "reparameterize", tuple[tuple[float, ...], ...])
