"""Run a script: build the curves, do the steps in a session, bound every deviation."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from attrs import evolve, field, frozen

from multirep.arrays import Array
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
from multirep.events import Event, Fitting
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.script.history import History, StepResult, key_of, what_of
from multirep.script.model import (
    CurveSpec,
    Output,
    PointsSource,
    Script,
    Step,
    StrokesSource,
    WaveletSource,
)
from multirep.session import Session
from multirep.splices import SpliceList
from multirep.strokes.from_strokes import curve_from_strokes

if TYPE_CHECKING:
    from multirep.registry import Registry

#: Told before each piece of work, and as a long fit in it goes on: how much is done, how much there
#: is, what comes.
Progress = Callable[[int, int, str], None]
#: The work failed, though nothing is wrong with the script.
FAILURES = (ConflictError, PluginError, RegistrationError, ToleranceError, UnreportedChangeError)


@frozen(eq=False)
class CurveResult:
    """A curve when some steps are done: every representation up to date, every pair bounded.

    ``before`` is the curve as it was read, or as it was when fewer steps were done; ``changed``
    where the steps since then that were not undone changed it, ``edits`` how many they are,
    ``strokes`` where the pen went in them. ``frozen`` is what nothing may change, ``marks`` are the
    stretches between marks, ``pins`` the points and parameters that constraints hold.
    """

    name: str
    tolerance: float
    representations: dict[str, Representation]
    deviations: dict[tuple[str, str], Deviation]
    before: Representation | None
    changed: SpliceList
    edits: int
    notes: tuple[str, ...]
    strokes: tuple[Array, ...] = ()
    frozen: SpliceList = SpliceList.EMPTY
    marks: tuple[tuple[float, float], ...] = ()
    pins: tuple[float, ...] = ()


@frozen(eq=False)
class Result:
    """What running a script gave.

    ``moments`` are the curves at other times than the end, as outputs ask for them, by how many
    steps were done and since when changes are shown.
    """

    script: Script
    curves: tuple[CurveResult, ...]
    steps: tuple[StepResult, ...]
    moments: Mapping[tuple[int, int], tuple[CurveResult, ...]] = field(factory=dict)

    def seen(self, output: Output) -> tuple[CurveResult, ...]:
        """Return the curves as an output shows them."""
        last = len(self.script.steps)
        after = last if output.after is None else output.after
        return self.moments.get((after, output.since), self.curves)


def run(script: Script, registry: Registry, progress: Progress | None = None) -> Result:
    """Run a script in a session of its own.

    Parameters
    ----------
    script : Script
        As :func:`multirep.script.reading.read_script` gives it.
    registry : Registry
        The same as it was read with.
    progress : callable, optional
        Told what comes before each piece of work; within one, how far a long fit is.

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
    return _Run(script, registry, tell, total).done()


class _Run:
    """One run of a script."""

    def __init__(self, script: Script, registry: Registry, tell: Progress, total: int) -> None:
        self.script, self.registry, self.tell, self.total = script, registry, tell, total
        self.specs = {spec.name: (index, spec) for index, spec in enumerate(script.curves)}
        self.session = Session()
        self.notes: dict[str, tuple[str, ...]] = {}
        self.history = History(self.session, self.build)
        self.earlier: dict[int, dict[str, Representation]] = {}
        self.moments: dict[tuple[int, int], tuple[CurveResult, ...]] = {}
        last = len(script.steps)
        self.wanted = {(last if o.after is None else o.after, o.since) for o in script.outputs}

    def build(self, name: str) -> MultiRepresentation:
        """Make a curve of the script."""
        index, spec = self.specs[name]
        curve = _build(self.script.path, index, spec, self.registry)
        merged = (f"{curve.merged} repeated points merged",) if curve.merged else ()
        self.notes[name] = spec.notes + merged
        return curve

    def done(self) -> Result:
        """Do everything."""
        script = self.script
        for index, spec in enumerate(script.curves):
            self.tell(index, self.total, f"read {spec.name}")
            if not spec.added:
                self.session.add(spec.name, self.build(spec.name))
        # pictures at a time before the end must not influence what comes after
        self.look(0)
        results = []
        for step in script.steps:
            done = len(script.curves) + step.index
            with self.telling(done, what_of(step)), _located(script.path, step):
                results.append(self.history.do(step))
            if step.index + 1 < len(script.steps):
                self.look(step.index + 1)
        curves = []
        for index, spec in enumerate(script.curves):
            done = self.total - len(script.curves) + index
            with self.telling(done, f"bound the deviations of {spec.name}"):
                if spec.name in self.session.curves:
                    curves.append(self.result(spec))
        last = len(script.steps)
        for _, since in [pair for pair in self.wanted if pair[0] == last and pair[1] > 0]:
            self.moments[last, since] = tuple(self.since(curve, since) for curve in curves)
        return Result(script, tuple(curves), tuple(results), self.moments)

    @contextmanager
    def telling(self, done: int, what: str) -> Iterator[None]:
        """Tell what comes; and how far they are, of fits that take long."""
        self.tell(done, self.total, what)

        def heard(event: Event) -> None:
            if isinstance(event, Fitting):
                part = f"{event.kind} {event.done}/{event.total}"
                self.tell(done, self.total, f"{what}: {part}")

        with ExitStack() as listening:
            for curve in self.session.curves.values():
                listening.enter_context(curve.listening(heard))
            yield

    def look(self, steps: int) -> None:
        """Keep what outputs show of this time; the session stays as it is."""
        if steps and not any(steps in pair for pair in self.wanted):
            return
        framework = self.session.framework
        before = framework.snapshot()
        present = self.session.curves
        self.earlier[steps] = {
            name: curve.view(curve.authors[0][1]) for name, curve in present.items()
        }
        wanted = [since for after, since in self.wanted if after == steps]
        if wanted:
            done = len(self.script.curves) + steps
            with self.telling(done, f"show the curves after {steps} steps"):
                specs = [spec for spec in self.script.curves if spec.name in present]
                curves = [self.result(spec) for spec in specs]
            for since in wanted:
                self.moments[steps, since] = tuple(self.since(curve, since) for curve in curves)
        framework.restore(before)

    def since(self, curve: CurveResult, steps: int) -> CurveResult:
        """Return a result that tells only of what happened after so many steps."""
        standing = [d for d in self.history.done if d.curve == curve.name and d.index >= steps]
        return evolve(
            curve,
            before=self.earlier.get(steps, {}).get(curve.name),
            changed=SpliceList(splice for done in standing for splice in done.changed),
            edits=len(standing),
            strokes=tuple(stroke for done in standing for stroke in done.strokes)
            + (() if standing else self.drawn(curve.name)),
        )

    def drawn(self, name: str) -> tuple[Array, ...]:
        """Return the strokes that a curve began as."""
        source = self.specs[name][1].source
        if not isinstance(source, StrokesSource):
            return ()
        return tuple(np.asarray(stroke, dtype=np.float64) for stroke in source.strokes)

    def result(self, spec: CurveSpec) -> CurveResult:
        """Bring a curve up to date in every representation and bound every deviation."""
        curve = self.session.curve(spec.name)
        order = {"polyline": 0, "nurbs": 1, "wavelet": 2}
        kinds = sorted(curve.kinds, key=lambda kind: (order.get(kind, 3), kind))
        try:
            representations = {kind: curve.view(kind) for kind in kinds}
            deviations = {pair: curve.deviation(*pair) for pair in combinations(sorted(kinds), 2)}
        except MultirepError as error:
            raise StepFailedError(f"{spec.name}: {error}", file=str(self.script.path)) from error
        held = self.session.framework.constraints(spec.name).values()
        found = CurveResult(
            name=spec.name,
            tolerance=curve.tolerance,
            representations=representations,
            deviations=deviations,
            before=None,
            changed=SpliceList.EMPTY,
            edits=0,
            notes=self.notes[spec.name],
            frozen=curve.frozen,
            marks=tuple(held.interval for held in held if held.name == "mark"),  # type: ignore[attr-defined]
            pins=tuple(held.t for held in held if isinstance(getattr(held, "t", None), float)),  # type: ignore[attr-defined]
        )
        return self.since(found, 0)


def _build(path: Path, index: int, spec: CurveSpec, registry: Registry) -> MultiRepresentation:
    kinds = [
        registry.representations[name] for name in spec.representations or registry.representations
    ]
    source = spec.source
    try:
        if isinstance(source, StrokesSource):
            options = {
                key: value
                for key in ("noise", "corner_angle", "corner_window")
                if (value := getattr(source, key)) is not None
            }
            return curve_from_strokes(
                source.strokes, tolerance=spec.tolerance, kinds=kinds, **options
            )
        if isinstance(source, WaveletSource):
            data = {"level": source.level, "knots": source.knots, "points": source.points}
            wavelet = registry.representations["wavelet"].from_dict(data)
            return MultiRepresentation(wavelet, tolerance=spec.tolerance, kinds=kinds)
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
        raise ScriptError(str(error), key=key_of(self.step), **place) from error  # type: ignore[arg-type]
