"""A script file (TOML, DESIGN section 8) to a checked :class:`~multirep.script.model.Script`.

Everything that can be known without running is checked here: keys, types, ranges, names of curves,
tools, constraints and representations. So a script with a mistake in its last step stops before its
first.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from attrs import evolve, frozen

from multirep.errors import MultirepError, ScriptError
from multirep.script.files import read_bytes
from multirep.script.model import AddStep, CurveSpec, Output, Script, Step, ToleranceStep
from multirep.script.sources import SOURCE_KEYS, read_source
from multirep.script.step_reading import StepReader
from multirep.script.strict import (
    Mismatch,
    check_keys,
    check_names,
    quote,
    structure,
    structure_key,
)

if TYPE_CHECKING:
    from multirep.registry import Registry

#: The format that this program reads and writes.
FORMAT = 1
#: Largest script file. Long point lists belong in a .json file beside it.
LARGEST_SCRIPT = 32 * 2**20
#: More than anybody writes by hand or records in a day; a bound on what a small file can ask for.
MOST_CURVES, MOST_STEPS, MOST_OUTPUTS = 1_000, 1_000_000, 1_000
#: Keys of a curve beside those of its source.
CURVE_KEYS = ("name", "tolerance", "representations")


def read_script(path: Path, registry: Registry, *, tolerance: float | None = None) -> Script:
    """Read and check a script.

    Parameters
    ----------
    path : Path
        The TOML file; input paths in it are relative to it.
    registry : Registry
        Knows the tools, constraints and representations that the script may name.
    tolerance : float, optional
        Replaces the tolerance of every curve, and what later steps would make of it.

    Returns
    -------
    Script

    Raises
    ------
    ScriptError
        With file, line, step and key; says what was found and what is allowed.
    """
    text = _decode(path)
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ScriptError(f"not TOML: {error}", file=str(path)) from None
    except (RecursionError, ValueError, OverflowError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else error
        raise ScriptError(f"not TOML: {reason}", file=str(path)) from None
    reader = _Reader(path, text, registry)
    with reader.at():
        check_keys(table, ("multirep", "curve", "step", "output"), "a script")
        _check_format(table)
        curves = reader.curves(table.get("curve", []), tolerance)
        steps = reader.steps(table.get("step", []), curves)
        if tolerance is not None:
            steps = tuple(
                evolve(step, tolerance=tolerance) if isinstance(step, ToleranceStep) else step
                for step in steps
            )
        late = {step.curve for step in steps if isinstance(step, AddStep)}
        curves = tuple(evolve(curve, added=curve.name in late) for curve in curves)
        outputs = reader.outputs(table.get("output", []), curves, len(steps))
    return Script(path, curves, steps, outputs)


def _decode(path: Path) -> str:
    try:
        return read_bytes(path, largest=LARGEST_SCRIPT).decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError:
        raise ScriptError("not UTF-8 text", file=str(path)) from None


def _check_format(table: Mapping[str, Any]) -> None:
    version = table.get("multirep")
    if version is None:
        raise Mismatch(
            f"missing; a script says which format it has: multirep = {FORMAT}", "multirep"
        )
    if structure(version, int) != FORMAT:
        newer = "; it needs a newer multirep" if version > FORMAT else ""
        raise Mismatch(f"expected format {FORMAT}, got {version}{newer}", "multirep")


@frozen
class _Reader:
    """Reads the tables of one script; knows how to say where an error is."""

    path: Path
    text: str
    registry: Registry

    @contextmanager
    def at(self, table: str = "", index: int = 0, *, total: int = 0) -> Iterator[None]:
        """Turn what goes wrong inside into a ScriptError that says where."""
        try:
            yield
        except ScriptError as error:
            if error.file is not None or not table:
                raise
            raise self._error(error.args[0], error.key or "", table, index, total) from None
        except Mismatch as error:
            raise self._error(error.problem, error.key, table, index, total) from None
        except MultirepError as error:
            raise self._error(str(error), "", table, index, total) from None

    def _error(self, problem: str, key: str, table: str, index: int, total: int) -> ScriptError:
        step = index if table == "step" else None
        if table and table != "step":
            key = f"{table}[{index}].{key}" if key else f"{table}[{index}]"
        line = _line(self.text, table, index, total)
        return ScriptError(problem, file=str(self.path), line=line, step=step, key=key or None)

    def curves(self, tables: object, tolerance: float | None) -> tuple[CurveSpec, ...]:
        """Read the curves; their names must differ."""
        entries = _tables(tables, "curve", MOST_CURVES)
        if not entries:
            raise Mismatch("missing; a script has at least one [[curve]]", "curve")
        curves: dict[str, CurveSpec] = {}
        for index, table in enumerate(entries):
            with self.at("curve", index, total=len(entries)):
                line = _line(self.text, "curve", index, len(entries))
                curve = evolve(self._curve(table, tolerance), line=line)
                if curve.name in curves:
                    raise Mismatch(f"another curve is already called {quote(curve.name)}", "name")
                curves[curve.name] = curve
        return tuple(curves.values())

    def _curve(self, table: Mapping[str, Any], tolerance: float | None) -> CurveSpec:
        check_keys(table, (*CURVE_KEYS, *SOURCE_KEYS), "a curve")
        plain = {key: table[key] for key in CURVE_KEYS if key in table}
        kinds = None
        if "representations" in plain:
            kinds = structure_key(plain, "representations", tuple[str, ...])
        known = list(self.registry.representations)
        if kinds is not None:
            check_names(kinds, "representation", known, "representations")
        source, author, notes = read_source(table, self.path.parent)
        if kinds is not None and author not in kinds:
            raise Mismatch(
                f"must contain {author!r}, which the curve is read as; got {quote(list(kinds))}",
                "representations",
            )
        for key in ("name", "tolerance"):
            if key not in plain:
                raise Mismatch("missing", key)
        epsilon = structure_key(plain, "tolerance", float)
        if tolerance is not None:
            epsilon = tolerance
        name = structure_key(plain, "name", str)
        try:
            return CurveSpec(name, epsilon, source, kinds, notes)
        except ValueError as error:
            key, _, problem = str(error).removeprefix("'").partition("' ")
            raise Mismatch(problem, key) from None

    def steps(self, tables: object, curves: tuple[CurveSpec, ...]) -> tuple[Step, ...]:
        """Read the steps, each against the tool or constraint that it names."""
        entries = _tables(tables, "step", MOST_STEPS)
        reader = StepReader(self.registry, tuple(curves))
        steps = []
        for index, table in enumerate(entries):
            with self.at("step", index, total=len(entries)):
                line = _line(self.text, "step", index, len(entries))
                steps.append(evolve(reader.read(index, table), line=line))
        return tuple(steps)

    def outputs(
        self, tables: object, curves: tuple[CurveSpec, ...], steps: int
    ) -> tuple[Output, ...]:
        """Read the outputs; a file is written once and stays inside the output directory."""
        entries = _tables(tables, "output", MOST_OUTPUTS)
        outputs: list[Output] = []
        for index, table in enumerate(entries):
            with self.at("output", index, total=len(entries)):
                entry = structure(table, Output)
                after = steps if entry.after is None else entry.after
                if after > steps:
                    raise Mismatch(f"there are {steps} steps, got {after}", "after")
                if entry.since > after:
                    raise Mismatch(f"expected at most {after}, got {entry.since}", "since")
                _check_output_path(entry.svg, {output.svg for output in outputs})
                known = list(self.registry.representations)
                check_names(entry.show or (), "representation", known, "show")
                check_names(entry.curves or (), "curve", [c.name for c in curves], "curves")
                for curve in curves:
                    if entry.curves is None or curve.name in entry.curves:
                        kept = known if curve.representations is None else curve.representations
                        what = f"representation of {curve.name!r}"
                        check_names(entry.show or (), what, list(kept), "show")
                outputs.append(entry)
        return tuple(outputs)


def _tables(value: object, name: str, most: int) -> list[Mapping[str, Any]]:
    if isinstance(value, Mapping):
        raise Mismatch(f"expected [[{name}]] with two brackets, got one table", name)
    if not isinstance(value, list) or not all(isinstance(entry, Mapping) for entry in value):
        raise Mismatch(f"expected tables [[{name}]], got {quote(value)}", name)
    if len(value) > most:
        raise Mismatch(f"expected at most {most}, got {len(value)}", name)
    return value


def _check_output_path(name: str, taken: set[str]) -> None:
    path = PurePath(name)
    if (
        path.is_absolute()
        or ".." in path.parts
        or not path.name
        or "\\" in name
        or not name.isprintable()
    ):
        raise Mismatch(f"expected a path inside the output directory, got {quote(name)}", "svg")
    if path.suffix.lower() != ".svg":
        raise Mismatch(f"expected a name that ends in .svg, got {quote(name)}", "svg")
    if str(path) in {str(PurePath(other)) for other in taken}:
        raise Mismatch(f"another output is already written to {quote(name)}", "svg")


def _line(text: str, table: str, index: int, total: int) -> int | None:
    """Return the line of the index-th ``[[table]]`` header; None if the text is not so simple."""
    if not table:
        return None
    headers = list(re.finditer(rf"^[ \t]*\[\[[ \t]*{table}[ \t]*\]\]", text, re.MULTILINE))
    if len(headers) != total:
        return None
    return text.count("\n", 0, headers[index].start()) + 1
