"""Run a script: build the curves, do the steps in a session, bound every deviation."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from attrs import frozen

from multirep.deviation import Deviation
from multirep.errors import (
    ConflictError,
    EditRejectedError,
    MultirepError,
    PluginError,
    RegistrationError,
    ScriptError,
    StepFailedError,
    ToleranceError,
    UnreportedChangeError,
)
from multirep.events import Committed
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.script.model import (
    ConstrainStep,
    CurveSpec,
    HistoryStep,
    PointsSource,
    ReleaseStep,
    Script,
    Step,
    ToolStep,
)
from multirep.session import Session
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.registry import Registry

#: Told before each piece of work: how much is done, how much there is, what comes.
Progress = Callable[[int, int, str], None]
#: The work failed, though nothing is wrong with the script.
FAILURES = (ConflictError, PluginError, RegistrationError, ToleranceError, UnreportedChangeError)


@frozen(eq=False)
class StepResult:
    """What a step did, where it changed its curve (None: several), and the residuals."""

    index: int
    what: str
    curve: str | None
    changed: SpliceList
    seconds: float
    work: dict[str, int]
    constraints: tuple[tuple[str, float], ...] = ()


@frozen(eq=False)
class CurveResult:
    """A curve after the last step: every representation up to date, every pair bounded.

    ``before`` is the curve as it was read, ``changed`` where the steps that were not undone changed
    it, ``edits`` how many they are.
    """

    name: str
    tolerance: float
    representations: dict[str, Representation]
    deviations: dict[tuple[str, str], Deviation]
    before: Representation
    changed: SpliceList
    edits: int
    notes: tuple[str, ...]


@frozen(eq=False)
class Result:
    """What running a script gave."""

    script: Script
    curves: tuple[CurveResult, ...]
    steps: tuple[StepResult, ...]


def run(script: Script, registry: Registry, progress: Progress | None = None) -> Result:
    """Run a script in a session of its own.

    Parameters
    ----------
    script : Script
        As :func:`multirep.script.reading.read_script` gives it.
    registry : Registry
        The same as it was read with.
    progress : callable, optional
        Told what comes before each piece of work.

    Returns
    -------
    Result

    Raises
    ------
    ScriptError
        When a curve or a step asks for what does not exist on this curve (an index too large,
        nothing to undo).
    StepFailedError
        When the work fails: a conflict of constraints, a tolerance that cannot be proved, a broken
        plugin.
    """
    tell = progress or (lambda done, total, what: None)
    total = len(script.curves) + len(script.steps) + len(script.curves)
    session = Session()
    before: dict[str, Representation] = {}
    notes: dict[str, tuple[str, ...]] = {}
    for index, spec in enumerate(script.curves):
        tell(index, total, f"read {spec.name}")
        curve = _build(script.path, index, spec, registry)
        session.add(spec.name, curve)
        before[spec.name] = curve.view(curve.authors[0][1])
        merged = (f"{curve.merged} repeated points merged",) if curve.merged else ()
        notes[spec.name] = spec.notes + merged
    history = _History(session)
    results = []
    for step in script.steps:
        tell(len(script.curves) + step.index, total, _what(step))
        with _located(script.path, step):
            results.append(history.do(step))
    curves = []
    for index, spec in enumerate(script.curves):
        tell(total - len(script.curves) + index, total, f"bound the deviations of {spec.name}")
        try:
            curve = session.curve(spec.name)
            curves.append(_result(spec, curve, before[spec.name], history, notes[spec.name]))
        except MultirepError as error:
            raise StepFailedError(f"{spec.name}: {error}", file=str(script.path)) from error
    return Result(script, tuple(curves), tuple(results))


def _build(path: Path, index: int, spec: CurveSpec, registry: Registry) -> MultiRepresentation:
    kinds = [
        registry.representations[name] for name in spec.representations or registry.representations
    ]
    source = spec.source
    try:
        if isinstance(source, PointsSource):
            return MultiRepresentation.from_points(
                source.points, t=source.t, tolerance=spec.tolerance, kinds=kinds
            )
        nurbs: Any = registry.representations["nurbs"]
        weights = [1.0] * len(source.points) if source.weights is None else source.weights
        author = nurbs(
            degree=source.degree, knots=source.knots, points=source.points, weights=weights
        )
        return MultiRepresentation(author, tolerance=spec.tolerance, kinds=kinds)
    except ToleranceError as error:
        key = f"curve[{index}].tolerance"
        raise ScriptError(str(error), file=str(path), line=spec.line, key=key) from error
    except (MultirepError, ValueError) as error:
        key = f"curve[{index}]"
        raise ScriptError(str(error), file=str(path), line=spec.line, key=key) from error


class _History:
    """Does steps, and remembers which changes stand, so that undone ones can be told from them."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.done: list[tuple[str, SpliceList]] = []
        self.undone: list[tuple[str, SpliceList]] = []

    def do(self, step: Step) -> StepResult:
        """Do one step."""
        begin = perf_counter()
        if isinstance(step, HistoryStep):
            return self._travel(step, begin)
        changed = SpliceList.EMPTY
        work: dict[str, int] = {}
        residuals: tuple[tuple[str, float], ...] = ()
        if isinstance(step, ToolStep):
            outcome = self.session.apply(step.curve, step.tool)
            changed = outcome.changed
            done = outcome.work
            work = {"sampled": done.sampled, "samples": done.samples, "fitted": done.fitted}
            residuals = tuple((held.name, held.residual) for held in outcome.constraints)
        elif isinstance(step, ConstrainStep):
            with self.session.curve(step.curve).listening() as events:
                self.session.constrain(step.curve, step.constraint, name=step.name)
            for event in events:
                changed = changed | event.splices if isinstance(event, Committed) else changed
        else:
            self.session.release(step.curve, step.name)
        self.done.append((step.curve, changed))
        self.undone.clear()
        seconds = perf_counter() - begin
        return StepResult(step.index, _what(step), step.curve, changed, seconds, work, residuals)

    def _travel(self, step: HistoryStep, begin: float) -> StepResult:
        undo = step.what == "undo"
        (self.session.undo if undo else self.session.redo)(step.times)
        source, target = (self.done, self.undone) if undo else (self.undone, self.done)
        moved = [source.pop() for _ in range(step.times)]
        target += moved
        curves = {name for name, _ in moved}
        changed = SpliceList.EMPTY
        for _, splices in moved:
            changed = changed | splices
        curve = curves.pop() if len(curves) == 1 else None
        seconds = perf_counter() - begin
        return StepResult(step.index, step.what, curve, changed, seconds, {})


class _located:
    """Say which step of which file an error belongs to."""

    def __init__(self, path: Path, step: Step) -> None:
        self.path, self.step = path, step

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if not isinstance(error, MultirepError):
            return
        reason = error.__cause__ if isinstance(error, EditRejectedError) else error
        place = {"file": str(self.path), "line": self.step.line, "step": self.step.index}
        if isinstance(reason, FAILURES):
            raise StepFailedError(str(error), **place) from error  # type: ignore[arg-type]
        raise ScriptError(str(error), key=_key(self.step), **place) from error  # type: ignore[arg-type]


def _key(step: Step) -> str:
    """Return the key of the script that makes a step what it is."""
    if isinstance(step, HistoryStep):
        return step.what
    keys = {ToolStep: "tool", ConstrainStep: "constrain", ReleaseStep: "release"}
    return keys[type(step)]


def _what(step: Step) -> str:
    """Return what the report calls a step."""
    if isinstance(step, ToolStep):
        return step.name
    if isinstance(step, ConstrainStep):
        return f"constrain {step.kind}"
    return "release" if isinstance(step, ReleaseStep) else step.what


def _result(
    spec: CurveSpec,
    curve: MultiRepresentation,
    before: Representation,
    history: _History,
    notes: tuple[str, ...],
) -> CurveResult:
    order = {"polyline": 0, "nurbs": 1, "wavelet": 2}
    kinds = sorted(curve.kinds, key=lambda kind: (order.get(kind, 3), kind))
    representations = {kind: curve.view(kind) for kind in kinds}
    deviations = {pair: curve.deviation(*pair) for pair in combinations(sorted(kinds), 2)}
    standing = [splices for name, splices in history.done if name == spec.name]
    changed = SpliceList(splice for splices in standing for splice in splices)
    return CurveResult(
        name=spec.name,
        tolerance=curve.tolerance,
        representations=representations,
        deviations=deviations,
        before=before,
        changed=changed,
        edits=len(standing),
        notes=notes,
    )
