"""A session under random use: any tools, views, tolerances, undo and redo, on four representations.

After each step the certificate holds, and what was not reported as changed has not changed by one
bit, in any representation. Undo to the start gives the values of the start.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, ClassVar

import attrs
import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

import multirep as mr
from multirep.edit import Edit
from multirep.errors import EditRejectedError, ToleranceError
from multirep.events import Committed, Event, Fitted
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.state import State
from multirep.testing import check_certificate, check_edit
from multirep.testing.laws import ROUNDING, dense_parameters
from multirep.testing.strategies import dyadic_intervals, splice_lists


class Quintic(Nurbs):
    """A second NURBS, of degree 5: the fourth representation."""

    name = "quintic"
    summary = "NURBS of degree 5"
    default_degree = 5


KINDS: tuple[type[Representation], ...] = (Polyline, Nurbs, WaveletBSpline, Quintic)
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4)


@attrs.frozen
class Primitive(mr.Tool[Any]):
    """An operation of a representation as a tool, for those that no tool offers."""

    name = "primitive"
    edits: ClassVar[type[Representation]] = Polyline

    operation: Callable[[Any], Edit[Any]]

    def edit(self, value: Any, scene: Scene) -> Edit[Any]:
        return self.operation(value)


class NurbsPrimitive(Primitive):
    edits = Nurbs


class WaveletPrimitive(Primitive):
    edits = WaveletBSpline


class QuinticPrimitive(Primitive):
    edits = Quintic


# -- where sessions start --------------------------------------------------------------------------


def smooth() -> mr.MultiRepresentation:
    t = np.linspace(0, 1, 120)
    points = np.column_stack([4 * t, np.sin(7 * t)])
    return mr.MultiRepresentation.from_points(points, tolerance=1e-2, kinds=KINDS)


def rough() -> mr.MultiRepresentation:
    rng = np.random.default_rng(12)
    points = np.cumsum(rng.normal(size=(90, 2)), axis=0) / 8
    return mr.MultiRepresentation.from_points(points, tolerance=1e-2, kinds=KINDS)


def square() -> mr.MultiRepresentation:
    points = [[0, 0], [2, 0], [2, 2], [0, 2], [0, 0.25]]
    return mr.MultiRepresentation.from_points(points, tolerance=1e-2, kinds=KINDS)


def circle() -> mr.MultiRepresentation:
    corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4
    nurbs = Nurbs(degree=2, knots=knots, points=corners, weights=[*[1, 0.5**0.5] * 4, 1])
    return mr.MultiRepresentation(nurbs, tolerance=1e-2, kinds=KINDS)


def wavelet() -> mr.MultiRepresentation:
    t = np.linspace(0, 1, 300)
    points = np.column_stack([3 * t, np.cos(5 * t) + 0.1 * np.sin(60 * t) * (t > 0.7)])
    value = WaveletBSpline.fit(SampledSplice(t, points), tolerance=5e-3)
    return mr.MultiRepresentation(value, tolerance=1e-2, kinds=KINDS)


def spiral() -> mr.MultiRepresentation:
    t = np.linspace(0, 1, 80)
    points = np.column_stack([np.cos(9 * t), np.sin(9 * t), 2 * t])
    return mr.MultiRepresentation.from_points(points, tolerance=1e-2, kinds=KINDS)


STARTS = (smooth, rough, square, circle, wavelet, spiral)


# -- edits -----------------------------------------------------------------------------------------


def nearby(value: Representation, index: int, row: Any, offset: tuple[float, ...]) -> Any:
    return np.asarray(row) + np.resize(offset, value.dimension)


def moved_vertex(u: float, offset: tuple[float, ...]) -> Primitive:
    def operation(polyline: Polyline) -> Edit[Polyline]:
        index = round(u * (polyline.size - 1))
        return polyline.move_vertex(index, nearby(polyline, index, polyline.points[index], offset))

    return Primitive(operation)


def inserted_vertex(u: float, offset: tuple[float, ...]) -> Primitive:
    def operation(polyline: Polyline) -> Edit[Polyline]:
        t = polyline.domain.start + u * polyline.domain.length
        return polyline.insert_vertex(t, nearby(polyline, 0, polyline(t), offset))

    return Primitive(operation)


def deleted_vertex(u: float, offset: tuple[float, ...]) -> Primitive:
    return Primitive(lambda polyline: polyline.delete_vertex(round(u * (polyline.size - 1))))


def moved_control_point(
    tool: type[Primitive],
) -> Callable[[float, tuple[float, ...]], Primitive]:
    def made(u: float, offset: tuple[float, ...]) -> Primitive:
        def operation(spline: Any) -> Edit[Any]:
            index = round(u * (len(spline.points) - 1))
            to = nearby(spline, index, spline.points[index], offset)
            return spline.move_control_point(index, to)

        return tool(operation)

    return made


def set_weight(u: float, offset: tuple[float, ...]) -> Primitive:
    weight = 2.0 ** (4 * offset[0])
    return NurbsPrimitive(lambda nurbs: nurbs.set_weight(round(u * (nurbs.size - 1)), weight))


def inserted_knot(u: float, offset: tuple[float, ...]) -> Primitive:
    return NurbsPrimitive(lambda nurbs: nurbs.insert_knot(0.001 + 0.998 * u))


def swept(u: float, offset: tuple[float, ...]) -> Primitive:
    def operation(wavelet: WaveletBSpline) -> Edit[WaveletBSpline]:
        level = min(abs(offset[0]) * 20, wavelet.level)
        return wavelet.sweep(u, nearby(wavelet, 0, wavelet(u), offset), level)

    return WaveletPrimitive(operation)


EDITS: tuple[Callable[[float, tuple[float, ...]], Primitive], ...] = (
    moved_vertex,
    inserted_vertex,
    deleted_vertex,
    moved_control_point(NurbsPrimitive),
    moved_control_point(QuinticPrimitive),
    moved_control_point(WaveletPrimitive),
    set_weight,
    inserted_knot,
    swept,
)

places = st.integers(0, 64).map(lambda k: k / 64)
offsets = st.tuples(*[st.integers(-24, 24).map(lambda k: k / 64)] * 2)
edits = st.builds(lambda make, u, offset: make(u, offset), st.sampled_from(EDITS), places, offsets)
kinds = st.sampled_from(KINDS)


# -- what is checked -------------------------------------------------------------------------------


def values_of(state: State) -> dict[str, Representation]:
    return {name: held.value for name, held in state.held.items() if held.value is not None}


def check_step(before: State, after: State, events: list[Event]) -> None:
    """Whatever was not reported by events is bit-identical, in every representation."""
    for name, value in values_of(before).items():
        reported = SpliceList.EMPTY
        for event in events:
            if isinstance(event, Committed | Fitted) and event.kind == name:
                reported = reported | event.splices
        now = after.held[name].value
        assert now is not None
        if now is not value:
            check_edit(value, Edit(now, reported), several=True)


def check_up_to_date_pairs(state: State) -> None:
    """Where neither is stale, any two values are within the tolerance; nothing is brought up to
    date.
    """
    values = values_of(state)
    names = list(values)
    for i, one in enumerate(names):
        for two in names[i + 1 :]:
            stale = state.held[one].stale | state.held[two].stale
            t = dense_parameters(values[one], stale, values[two])
            for splice in stale:
                t = t[(t < splice.start) | (splice.stop < t)]
            if t.size:
                apart = np.linalg.norm(values[one](t) - values[two](t), axis=1)
                slack = ROUNDING * max(values[one].magnitude, values[two].magnitude)
                assert apart.max() <= state.tolerance + slack, (one, two, t[apart.argmax()])


class SessionMachine(RuleBasedStateMachine):
    """One curve in a session; each rule is a user's action."""

    session: mr.Session
    curve: mr.MultiRepresentation

    @initialize(start=st.sampled_from(STARTS), tolerance=st.sampled_from(TOLERANCES[:3]))
    def begin(self, start: Callable[[], mr.MultiRepresentation], tolerance: float) -> None:
        self.curve = start()
        self.curve.tolerance = tolerance
        self.session = mr.Session()
        self.session.add("curve", self.curve)
        self.start = self.curve.snapshot()
        self.past: list[State] = []
        self.future: list[State] = []

    def step(self, action: Callable[[], object]) -> None:
        """Do something as one undo step; refusals must leave everything as it was."""
        before = self.curve.snapshot()
        with self.curve.listening() as events:
            try:
                action()
            except (EditRejectedError, ToleranceError):
                assert self.curve.snapshot() is before
                return
        check_step(before, self.curve.snapshot(), events)
        self.past.append(before)
        self.future.clear()

    @rule(kind=kinds)
    def view(self, kind: type[Representation]) -> None:
        before = self.curve.snapshot()
        with self.curve.listening() as events:
            value = self.curve.view(kind)
        assert self.curve.stale(kind) == SpliceList.EMPTY
        check_step(before, self.curve.snapshot(), events)
        with self.curve.listening() as again:
            assert self.curve.view(kind) is value
        assert not [e for e in again if not type(e).__name__ == "Skipped"]

    @rule(kind=kinds, where=st.one_of(dyadic_intervals(), splice_lists(max_splices=3)))
    def view_a_part(self, kind: type[Representation], where: Interval | SpliceList) -> None:
        before = self.curve.snapshot()
        with self.curve.listening() as events:
            self.curve.view(kind, where)
        region = SpliceList([where]) if isinstance(where, Interval) else where
        assert not self.curve.stale(kind).intersects(region)
        check_step(before, self.curve.snapshot(), events)

    @rule(tool=edits)
    def edit(self, tool: Primitive) -> None:
        self.step(lambda: self.session.apply("curve", tool))

    @rule(tools=st.lists(edits, min_size=2, max_size=4))
    def drag(self, tools: list[Primitive]) -> None:
        def action() -> None:
            with self.session.gesture("curve") as gesture:
                for tool in tools:
                    gesture.apply(tool)

        self.step(action)

    @rule(tolerance=st.sampled_from(TOLERANCES))
    def change_tolerance(self, tolerance: float) -> None:
        self.step(lambda: self.session.set_tolerance("curve", tolerance))

    @precondition(lambda self: self.past)
    @rule(data=st.data())
    def undo(self, data: st.DataObject) -> None:
        for _ in range(data.draw(st.integers(1, len(self.past)))):
            self.future.append(self.curve.snapshot())
            self.session.undo()
            self.check_is(self.past.pop())

    @precondition(lambda self: self.future)
    @rule()
    def redo(self) -> None:
        self.past.append(self.curve.snapshot())
        self.session.redo()
        self.check_is(self.future.pop())

    def check_is(self, state: State) -> None:
        """The very same values: nothing is computed again."""
        now = self.curve.snapshot()
        assert now.tolerance == state.tolerance
        assert now.authors == state.authors
        for name, held in state.held.items():
            assert now.held[name].value is held.value
            assert now.held[name].stale == held.stale

    @invariant()
    def certificate(self) -> None:
        """What is up to date agrees as it is; brought up to date, everything is proved to agree."""
        before = self.curve.snapshot()
        check_up_to_date_pairs(before)
        check_certificate(self.curve)
        self.curve.restore(before)

    def teardown(self) -> None:
        if hasattr(self, "session") and len(self.past) == self.session.undoable > 0:
            self.session.undo(self.session.undoable)
            self.check_is(self.past[0])


def test_a_session_keeps_its_promises() -> None:
    """A few sessions of a dozen steps each; the slow test below runs many long ones."""
    run_state_machine_as_test(
        SessionMachine, settings=settings(max_examples=15, stateful_step_count=10)
    )


@pytest.mark.slow
def test_long_sessions_keep_their_promises() -> None:
    """The same with more and longer sessions."""
    run_state_machine_as_test(
        SessionMachine, settings=settings(max_examples=200, stateful_step_count=30)
    )
