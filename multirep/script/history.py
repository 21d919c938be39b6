"""Doing the steps of a script in a session, and remembering which changes stand."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

from attrs import frozen

from multirep.arrays import Array
from multirep.errors import ConflictError
from multirep.multirepresentation import MultiRepresentation
from multirep.outcome import Outcome, Work
from multirep.script.drawn import strokes_of
from multirep.script.model import (
    AddStep,
    ConstrainStep,
    GestureStep,
    HistoryStep,
    ReleaseStep,
    ReparameterizeStep,
    Step,
    ToleranceStep,
    ToolStep,
    ViewStep,
)
from multirep.session import Session
from multirep.splices import SpliceList


@frozen(eq=False)
class StepResult:
    """What a step did, where it changed its curve (None: several), and the residuals.

    ``rounds`` of re-establishing constraints that took; ``faded`` are the frozen stretches before
    which it was faded out; ``conflict`` is what came of it if it changed nothing for that.
    """

    index: int
    what: str
    curve: str | None
    changed: SpliceList
    seconds: float
    work: dict[str, int]
    constraints: tuple[tuple[str, float], ...] = ()
    rounds: int = 0
    faded: SpliceList = SpliceList.EMPTY
    conflict: ConflictError | None = None


@frozen(eq=False)
class Done:
    """A step that stands: of which curve, when (counted in steps), where, with which strokes."""

    curve: str
    index: int
    changed: SpliceList
    strokes: tuple[Array, ...] = ()


class History:
    """Does steps, and remembers which changes stand, so that undone ones can be told from them.

    Parameters
    ----------
    session : Session
    build : callable
        Makes the curve of a name that an ``add`` step brings in.
    """

    def __init__(self, session: Session, build: Callable[[str], MultiRepresentation]) -> None:
        self.session = session
        self.build = build
        self.done: list[Done] = []
        self.undone: list[Done] = []

    def do(self, step: Step) -> StepResult:
        """Do one step."""
        begin = perf_counter()
        if isinstance(step, HistoryStep):
            return self._travel(step, begin)
        if isinstance(step, ViewStep):
            self._view(step)
            seconds = perf_counter() - begin
            return StepResult(step.index, "view", step.curve, SpliceList.EMPTY, seconds, {})
        before = self.session.undoable
        conflict: ConflictError | None = None
        try:
            outcome = self._outcome(step)
        except ConflictError as error:
            if not getattr(step, "may_conflict", False):
                raise
            outcome, conflict = Outcome(SpliceList.EMPTY, NO_WORK), error
        if self.session.undoable > before:  # adding a first curve is no step of the session
            strokes = strokes_of(step)
            self.done.append(Done(step.curve, step.index, outcome.changed, strokes))
            self.undone.clear()
        work: dict[str, int] = {}
        if outcome.work is not NO_WORK:
            done = outcome.work
            work = {"sampled": done.sampled, "samples": done.samples, "fitted": done.fitted}
        residuals = tuple((held.name, held.residual) for held in outcome.constraints)
        seconds = perf_counter() - begin
        what = what_of(step)
        return StepResult(
            step.index,
            what,
            step.curve,
            outcome.changed,
            seconds,
            work,
            residuals,
            outcome.rounds,
            outcome.faded,
            conflict,
        )

    def _outcome(self, step: Step) -> Outcome:
        session = self.session
        if isinstance(step, ToolStep):
            return session.apply(step.curve, step.tool)
        if isinstance(step, GestureStep):
            return self._gesture(step)
        if isinstance(step, ConstrainStep):
            return session.constrain(step.curve, step.constraint, name=step.name).outcome
        if isinstance(step, ToleranceStep):
            return session.set_tolerance(step.curve, step.tolerance)
        if isinstance(step, ReparameterizeStep):
            return session.reparameterize(step.curve, step.mapping)
        if isinstance(step, AddStep):
            session.add(step.curve, self.build(step.curve))
        elif isinstance(step, ReleaseStep):
            session.release(step.curve, step.name)
        return Outcome(SpliceList.EMPTY, NO_WORK)

    def _gesture(self, step: GestureStep) -> Outcome:
        """Do all parts as one undo step, and report them as one."""
        outcomes: list[Outcome] = []
        with self.session.gesture(step.curve) as gesture:
            for part in step.parts:
                if isinstance(part, ToolStep):
                    outcomes.append(gesture.apply(part.tool))
                else:
                    self._view(part)
        changed = SpliceList(splice for outcome in outcomes for splice in outcome.changed)
        works = [outcome.work for outcome in outcomes]
        work = Work(
            sum(work.sampled for work in works),
            sum(work.samples for work in works),
            sum(work.fitted for work in works),
            sum(work.seconds for work in works),
        )
        last = {held.name: held for outcome in outcomes for held in outcome.constraints}
        rounds = sum(outcome.rounds for outcome in outcomes)
        faded = SpliceList(splice for outcome in outcomes for splice in outcome.faded)
        return Outcome(changed, work, tuple(last.values()), rounds, faded)

    def _view(self, step: ViewStep) -> None:
        for kind in step.kinds:
            self.session.curve(step.curve).view(kind, step.where)

    def _travel(self, step: HistoryStep, begin: float) -> StepResult:
        undo = step.what == "undo"
        (self.session.undo if undo else self.session.redo)(step.times)
        source, target = (self.done, self.undone) if undo else (self.undone, self.done)
        moved = [source.pop() for _ in range(step.times)]
        target += moved
        curves = {done.curve for done in moved}
        changed = SpliceList(splice for done in moved for splice in done.changed)
        curve = curves.pop() if len(curves) == 1 else None
        seconds = perf_counter() - begin
        return StepResult(step.index, step.what, curve, changed, seconds, {})


#: Of steps that do not ask representations for anything.
NO_WORK = Work(0, 0, 0, 0.0)


def key_of(step: Step) -> str:
    """Return the key of the script that makes a step what it is."""
    if isinstance(step, HistoryStep):
        return step.what
    return {
        ToolStep: "tool",
        GestureStep: "gesture",
        ConstrainStep: "constrain",
        ReleaseStep: "release",
        ToleranceStep: "tolerance",
        ReparameterizeStep: "reparameterize",
        AddStep: "add",
        ViewStep: "view",
    }[type(step)]


def what_of(step: Step) -> str:
    """Return what the report calls a step."""
    if isinstance(step, ToolStep):
        return step.name
    if isinstance(step, ConstrainStep):
        return f"constrain {step.kind}"
    if isinstance(step, GestureStep):
        tools = dict.fromkeys(part.name for part in step.parts if isinstance(part, ToolStep))
        return " ".join(["gesture", *tools])
    return key_of(step)
