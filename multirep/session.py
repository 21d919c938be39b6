"""A session: a framework with a history of undoable gestures and a journal to do it all again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from multirep.constraint import Constraint
from multirep.errors import HistoryError
from multirep.framework import CurveState, Framework
from multirep.history import History
from multirep.journal import (
    Added,
    Applied,
    Constrained,
    Entry,
    Gestured,
    Journal,
    Looked,
    Meddled,
    Released,
    Reparameterized,
    ToleranceSet,
    Travelled,
)
from multirep.moments import Moment
from multirep.multirepresentation import MultiRepresentation
from multirep.outcome import Outcome
from multirep.reparameterization import ParameterMap
from multirep.tool import Tool


class Established(str):
    """The name of a constraint that was added, with what adding it did as ``outcome``."""

    __slots__ = ("outcome",)

    outcome: Outcome

    def __new__(cls, name: str, outcome: Outcome) -> Established:
        """Make a name with an outcome."""
        self = super().__new__(cls, name)
        self.outcome = outcome
        return self


class Gesture:
    """Several applications that are one undo step (a drag); see :meth:`Session.gesture`."""

    def __init__(self, framework: Framework, curve: str, journal: Journal) -> None:
        self._framework = framework
        self._curve = curve
        self._journal = journal
        self._entries: list[Applied | Looked | Meddled] = []

    def apply(self, tool: Tool[Any]) -> Outcome:
        """Apply a tool to the curve of the gesture."""
        self._entries += self._journal.unnoticed(self._framework.curves)
        outcome = self._framework.apply(self._curve, tool)
        self._entries.append(Applied(self._curve, tool))
        self._journal.remember(self._framework.curves)
        return outcome


class Session:
    """Curves that are edited by tools, with undo and redo by gesture.

    Everything that it offers is an undo step: edits, constraints, tolerance, parameters, and curves
    that come in later; those that were added before anything was done are what it starts from. A
    new step after an undo drops what could have been redone, as in editors. :meth:`script` writes
    down what was done.

    Examples
    --------
    >>> import multirep as mr
    >>> from multirep.tools import MoveVertex
    >>> session = mr.Session()
    >>> zigzag = mr.MultiRepresentation.from_points([[0, 0], [1, 1], [2, 0]], tolerance=0.01)
    >>> session.add("zigzag", zigzag)
    >>> before = session.curve("zigzag").view("polyline")
    >>> with session.gesture("zigzag") as gesture:
    ...     for height in (1.5, 2.0):
    ...         outcome = gesture.apply(MoveVertex(index=1, to=(1, height)))
    >>> session.undo()
    >>> session.curve("zigzag").view("polyline") is before
    True
    """

    def __init__(self) -> None:
        self.framework = Framework()
        self.journal = Journal()
        self._history = History()
        self._open = False

    def add(self, name: str, curve: MultiRepresentation) -> None:
        """Add a curve under a new name: one undo step, but for those from before the first step."""
        state = curve.snapshot()
        if self.undoable or self.redoable or self._open:
            with self._step() as entries:
                self.framework.add(name, curve)
                entries.append(Added(name, state, curve.kinds, True))
        else:
            self.framework.add(name, curve)
            self.journal.write(*self.journal.unnoticed(self.curves))
            self.journal.write(Added(name, None, curve.kinds, False))
            start = self._history.start().states
            self._history.begin(Moment(self.curves, {**start, name: CurveState(state, {})}))
            self.journal.remember(self.curves)

    def curve(self, name: str) -> MultiRepresentation:
        """Return a curve by name."""
        return self.framework.curve(name)

    @property
    def curves(self) -> Mapping[str, MultiRepresentation]:
        """The curves by name."""
        return self.framework.curves

    def apply(self, curve: str, tool: Tool[Any]) -> Outcome:
        """Apply a tool as one undo step; see :meth:`multirep.Framework.apply`."""
        with self._step() as entries:
            entries.append(Applied(curve, tool))
            return self.framework.apply(curve, tool)

    def constrain(
        self, curve: str, constraint: Constraint[Any], *, name: str | None = None
    ) -> Established:
        """Add a constraint as one undo step.

        Returns
        -------
        Established
            Its name, as a string; ``outcome`` has what changed and the residuals.

        Raises
        ------
        ConflictError
            When it cannot hold together with the others; see :meth:`multirep.Framework.constrain`.
        """
        with self._step() as entries:
            given, outcome = self.framework.constrain(curve, constraint, name=name)
            entries.append(Constrained(curve, constraint, given))
            return Established(given, outcome)

    def release(self, curve: str, name: str) -> None:
        """Remove a constraint as one undo step."""
        with self._step() as entries:
            entries.append(Released(curve, str(name)))
            self.framework.release(curve, name)

    def set_tolerance(self, curve: str, tolerance: float) -> Outcome:
        """Change the tolerance of a curve as one undo step."""
        with self._step() as entries:
            entries.append(ToleranceSet(curve, float(tolerance)))
            return self.framework.set_tolerance(curve, tolerance)

    def reparameterize(self, curve: str, mapping: ParameterMap = "even") -> Outcome:
        """Map the parameters of a curve as one undo step; by default to even speed.

        See :meth:`multirep.MultiRepresentation.reparameterize` for other maps, and
        :meth:`multirep.Framework.reparameterize` for when it is refused.
        """
        with self._step() as entries:
            entries.append(Reparameterized(curve, mapping))
            return self.framework.reparameterize(curve, mapping)

    @contextmanager
    def gesture(self, curve: str) -> Iterator[Gesture]:
        """Apply several tools as one undo step; an exception undoes all of them.

        Systems that its moves solve are factored once as long as they are the same. Until the block
        ends, everything else that this session offers is refused.
        """
        self.framework.curve(curve)
        with self._step() as entries, self.framework.remembering():
            gesture = Gesture(self.framework, curve, self.journal)
            yield gesture
            entries.append(Gestured(curve, tuple(gesture._entries)))
            entries += self.journal.unnoticed(self.curves)

    @contextmanager
    def _step(self) -> Iterator[list[Entry]]:
        """One undo step; the block adds to the list what the journal shall say of it."""
        before = self._settled("change anything")
        entries: list[Entry] = []
        self._open = True
        try:
            yield entries
        except BaseException:
            self._go(before)
            raise
        finally:
            self._open = False
        self._history.step(before)
        self.journal.write(*entries)
        self.journal.remember(self.curves)

    def _settled(self, verb: str) -> Moment:
        """Write down what was looked at since the last step; return how everything is now."""
        self._check_closed(verb)
        curves = self.curves
        self.journal.write(*self.journal.unnoticed(curves))
        return Moment(curves, self.framework.snapshot())

    def _check_closed(self, verb: str) -> None:
        if self._open:
            raise HistoryError(f"cannot {verb} beside an open gesture, but by its own apply()")

    # -- history -----------------------------------------------------------------------------------

    @property
    def undoable(self) -> int:
        """How many steps can be undone."""
        return self._history.undoable

    @property
    def redoable(self) -> int:
        """How many steps can be redone."""
        return self._history.redoable

    def undo(self, steps: int = 1) -> None:
        """Go back; values are bit-identical to what they were.

        Those that somebody still holds are the same objects.

        Raises
        ------
        HistoryError
            When there are not so many steps; nothing is changed then.
        """
        self._travel(steps, "undo")

    def redo(self, steps: int = 1) -> None:
        """Go forth again after an undo."""
        self._travel(steps, "redo")

    def _travel(self, steps: int, verb: Literal["undo", "redo"]) -> None:
        self._check_closed(verb)
        if steps < 1:
            raise HistoryError(f"steps to {verb} must be 1 or more, got {steps}")
        back = verb == "undo"
        there = self.undoable if back else self.redoable
        if steps > there:
            raise HistoryError(f"cannot {verb} {steps} steps: there are {there}")
        present = self._settled(verb)
        self._go(self._history.travel(present, -steps if back else steps))
        self.journal.write(Travelled(back, steps))

    def _go(self, moment: Moment) -> None:
        there = self.framework.curves
        for name in there.keys() - moment.curves.keys():
            self.framework.remove(name)
        for name in moment.curves:
            if name not in there:
                self.framework.add(name, moment.curves[name])
        self.framework.restore(moment.states)
        self.journal.remember(self.curves)

    # -- writing it down ---------------------------------------------------------------------------

    def script(self) -> str:
        """Return a script (TOML, DESIGN section 8) that does again all that was done here.

        It gives the same values, bit for bit, in every representation, on the same machine. Undo
        and redo are steps of it, failed attempts are not; looks at a curve between two steps are
        written as ``view`` steps where they brought something up to date.

        Raises
        ------
        ScriptError
            When something cannot be written down: a curve that had been edited before it was added
            or was changed past the session, a tool whose parameters TOML cannot say.

        Examples
        --------
        >>> import multirep as mr
        >>> session = mr.Session()
        >>> session.add("line", mr.MultiRepresentation.from_points([[0, 0], [1, 0]], tolerance=0.1))
        >>> outcome = session.set_tolerance("line", 0.2)
        >>> print(session.script()[-41:])
        <BLANKLINE>
        [[step]]
        curve = "line"
        tolerance = 0.2
        <BLANKLINE>
        """
        from multirep.script.writing import written

        self.journal.write(*self.journal.unnoticed(self.curves))
        start = self._history.start().states
        return written(self.journal.entries, {name: one.state for name, one in start.items()})

    def save_script(self, path: Path | str) -> None:
        """Write :meth:`script` to a file, whole or not at all.

        Raises
        ------
        ScriptError
            Also when the file cannot be written.
        """
        from multirep.script.files import write_all

        path = Path(path)
        write_all(path.parent, {path.name: self.script()})
