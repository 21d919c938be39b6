"""A session: a framework with a history of undoable gestures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from multirep.constraint import Constraint
from multirep.errors import HistoryError
from multirep.framework import CurveState, Framework
from multirep.multirepresentation import MultiRepresentation
from multirep.outcome import Outcome
from multirep.reparameterization import ParameterMap
from multirep.tool import Tool


class Gesture:
    """Several applications that are one undo step (a drag); see :meth:`Session.gesture`."""

    def __init__(self, framework: Framework, curve: str) -> None:
        self._framework = framework
        self._curve = curve

    def apply(self, tool: Tool[Any]) -> Outcome:
        """Apply a tool to the curve of the gesture."""
        return self._framework.apply(self._curve, tool)


class Session:
    """Curves that are edited by tools, with undo and redo by gesture.

    A new edit after an undo drops what could have been redone, as in editors.

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
        self._past: list[Mapping[str, CurveState]] = []
        self._future: list[Mapping[str, CurveState]] = []

    def add(self, name: str, curve: MultiRepresentation) -> None:
        """Add a curve under a new name."""
        self.framework.add(name, curve)

    def curve(self, name: str) -> MultiRepresentation:
        """Return a curve by name."""
        return self.framework.curve(name)

    @property
    def curves(self) -> Mapping[str, MultiRepresentation]:
        """The curves by name."""
        return self.framework.curves

    def apply(self, curve: str, tool: Tool[Any]) -> Outcome:
        """Apply a tool as one undo step; see :meth:`multirep.Framework.apply`."""
        with self._step():
            return self.framework.apply(curve, tool)

    def constrain(self, curve: str, constraint: Constraint[Any], *, name: str | None = None) -> str:
        """Add a constraint as one undo step; returns its name."""
        with self._step():
            return self.framework.constrain(curve, constraint, name=name)[0]

    def release(self, curve: str, name: str) -> None:
        """Remove a constraint as one undo step."""
        with self._step():
            self.framework.release(curve, name)

    def set_tolerance(self, curve: str, tolerance: float) -> None:
        """Change the tolerance of a curve as one undo step."""
        with self._step():
            self.framework.set_tolerance(curve, tolerance)

    def reparameterize(self, curve: str, mapping: ParameterMap = "even") -> Outcome:
        """Map the parameters of a curve as one undo step; by default to even speed.

        See :meth:`multirep.MultiRepresentation.reparameterize` for other maps, and
        :meth:`multirep.Framework.reparameterize` for when it is refused.
        """
        with self._step():
            return self.framework.reparameterize(curve, mapping)

    @contextmanager
    def gesture(self, curve: str) -> Iterator[Gesture]:
        """Apply several tools as one undo step; an exception undoes all of them."""
        self.framework.curve(curve)
        with self._step():
            yield Gesture(self.framework, curve)

    @contextmanager
    def _step(self) -> Iterator[None]:
        before = self.framework.snapshot()
        try:
            yield
        except BaseException:
            self.framework.restore(before)
            raise
        self._past.append(before)
        self._future.clear()

    # -- history -----------------------------------------------------------------------------------

    @property
    def undoable(self) -> int:
        """How many steps can be undone."""
        return len(self._past)

    @property
    def redoable(self) -> int:
        """How many steps can be redone."""
        return len(self._future)

    def undo(self, steps: int = 1) -> None:
        """Go back; values are bit-identical to what they were, for they are the same objects.

        Raises
        ------
        HistoryError
            When there are not so many steps; nothing is changed then.
        """
        self._travel(steps, self._past, self._future, "undo")

    def redo(self, steps: int = 1) -> None:
        """Go forth again after an undo."""
        self._travel(steps, self._future, self._past, "redo")

    def _travel(
        self,
        steps: int,
        source: list[Mapping[str, CurveState]],
        target: list[Mapping[str, CurveState]],
        verb: str,
    ) -> None:
        if steps < 1:
            raise HistoryError(f"steps to {verb} must be 1 or more, got {steps}")
        if steps > len(source):
            raise HistoryError(f"cannot {verb} {steps} steps: there are {len(source)}")
        for _ in range(steps):
            target.append(self.framework.snapshot())
            self.framework.restore(source.pop())
