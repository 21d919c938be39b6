"""A session under random use: any tools, views, tolerances, undo and redo, on four representations.

After each step the certificate holds, and what was not reported as changed has not changed by one
bit, in any representation. Undo to the start gives the values of the start.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import attrs
import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from kinds import KINDS, Quintic
from machines import check_machine

import multirep as mr
from multirep.arrays import Array
from multirep.constraints import Freeze
from multirep.edit import Edit
from multirep.errors import ConflictError, EditRejectedError, MultirepError, ToleranceError
from multirep.events import Committed, Event, Fitted, Prepared
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.state import State
from multirep.testing import check_certificate, check_edit
from multirep.testing.laws import ROUNDING
from multirep.testing.looking import dense_parameters
from multirep.testing.strategies import dyadic_intervals, splice_lists
from multirep.tools import (
    Corner,
    DeleteVertex,
    DirectManipulation,
    InsertKnot,
    InsertVertex,
    MoveControlPoint,
    MoveVertex,
    Oversketch,
    SetWeight,
    Smooth,
    Spatula,
    Sweep,
)

TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4)


@attrs.frozen
class MoveQuintic(mr.Tool[Quintic]):
    """Move a control point of the second NURBS."""

    name = "move-quintic"
    edits = Quintic

    index: int
    to: tuple[float, ...]

    def edit(self, value: Quintic, scene: Scene) -> Edit[Quintic]:
        return value.move_control_point(self.index, self.to)


@attrs.frozen
class MoveWavelet(mr.Tool[WaveletBSpline]):
    """Move a control point of the wavelet B-spline."""

    name = "move-wavelet"
    edits = WaveletBSpline

    index: int
    to: tuple[float, ...]

    def edit(self, value: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        return value.move_control_point(self.index, self.to)


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

#: Makes a tool for the curve as it is, of a place (0 to 1) and an offset.
Maker: TypeAlias = Callable[[mr.MultiRepresentation, float, tuple[float, ...]], mr.Tool[Any]]


def place(curve: mr.MultiRepresentation, u: float) -> float:
    return curve.domain.start + u * curve.domain.length


def beside(row: Any, offset: tuple[float, ...]) -> tuple[float, ...]:
    point = np.asarray(row)
    return tuple((point + np.resize(offset, len(point))).tolist())


def row_at(value: Any, u: float) -> tuple[int, Any]:
    index = round(u * (len(value.points) - 1))
    return index, value.points[index]


def move_vertex(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    index, row = row_at(curve.view(Polyline), u)
    return MoveVertex(index=index, to=beside(row, offset))


def insert_vertex(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    t = place(curve, u)
    return InsertVertex(t=t, to=beside(curve.view(Polyline)(t), offset))


def delete_vertex(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    return DeleteVertex(index=row_at(curve.view(Polyline), u)[0])


def spatula(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    point = curve.view(Polyline)(place(curve, u))
    start = point + 0.2
    return Spatula(radius=0.15, path=[start.tolist(), beside(start, offset)])


def oversketch(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    t = np.linspace(place(curve, 0.8 * u), place(curve, 0.8 * u + 0.2), 20)
    stroke = curve.view(Polyline)(t)
    bump = np.sin(np.pi * np.linspace(0, 1, 20))[:, None] * np.resize(offset, stroke.shape[1])
    return Oversketch(stroke=(stroke + bump).tolist(), join=("C0", "G1", "C2")[round(2 * u)])


def move_control_point(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    index, row = row_at(curve.view(Nurbs), u)
    return MoveControlPoint(index=index, to=beside(row, offset))


def set_weight(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    return SetWeight(index=row_at(curve.view(Nurbs), u)[0], weight=2.0 ** (4 * offset[0]))


def insert_knot(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    return InsertKnot(t=place(curve, u), times=1 + round(abs(offset[0]) * 4))


def direct_manipulation(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    t = place(curve, u)
    to = beside(curve.view(Nurbs)(t), offset)
    return DirectManipulation(t=t, to=to, hold_ends=offset[0] > 0)


def make_corner(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    side = np.resize(offset, curve.dimension) * 8
    return Corner(t=place(curve, u), left=tuple(side.tolist()))


def sweep(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    t = place(curve, u)
    to = beside(curve.view(WaveletBSpline)(t), offset)
    return Sweep(t=t, to=to, level=abs(offset[0]) * 20)


def smooth_a_stretch(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    start, stop = place(curve, 0.8 * u), place(curve, 0.8 * u + 0.2)
    return Smooth(level=abs(offset[0]) * 20, interval=(start, stop))


def move_quintic(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    index, row = row_at(curve.view(Quintic), u)
    return MoveQuintic(index=index, to=beside(row, offset))


def move_wavelet(curve: mr.MultiRepresentation, u: float, offset: tuple[float, ...]) -> Any:
    index, row = row_at(curve.view(WaveletBSpline), u)
    return MoveWavelet(index=index, to=beside(row, offset))


MAKERS: tuple[Maker, ...] = (
    move_vertex,
    insert_vertex,
    delete_vertex,
    spatula,
    oversketch,
    move_control_point,
    set_weight,
    insert_knot,
    direct_manipulation,
    make_corner,
    sweep,
    smooth_a_stretch,
    move_quintic,
    move_wavelet,
)

places = st.integers(0, 64).map(lambda k: k / 64)
offsets = st.tuples(*[st.integers(-24, 24).map(lambda k: k / 64)] * 2)
edits = st.tuples(st.sampled_from(MAKERS), places, offsets)
kinds = st.sampled_from(KINDS)


# -- what is checked -------------------------------------------------------------------------------


def values_of(state: State) -> dict[str, Representation]:
    return {name: held.value for name, held in state.held.items() if held.value is not None}


def check_step(before: State, after: State, events: list[Event]) -> None:
    """Whatever was not reported by events is bit-identical, in every representation."""
    for name, value in values_of(before).items():
        reported = SpliceList.EMPTY
        for event in events:
            if isinstance(event, Committed | Fitted | Prepared) and event.kind == name:
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
            except (EditRejectedError, ToleranceError, ConflictError):
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

    @rule(edit=edits)
    def edit(self, edit: tuple[Maker, float, tuple[float, ...]]) -> None:
        make, u, offset = edit
        tool = make(self.curve, u, offset)
        self.step(lambda: self.session.apply("curve", tool))

    @rule(edits=st.lists(edits, min_size=2, max_size=4))
    def drag(self, edits: list[tuple[Maker, float, tuple[float, ...]]]) -> None:
        def action() -> None:
            with self.session.gesture("curve") as gesture:
                for make, u, offset in edits:
                    gesture.apply(make(self.curve, u, offset))

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


class FreezingMachine(SessionMachine):
    """The same with stretches that are frozen and released in between."""

    @initialize()
    def nothing_frozen(self) -> None:
        self.ice: dict[str, tuple[SpliceList, dict[str, Array]]] = {}

    def values_on(self, ice: SpliceList) -> dict[str, Array]:
        t = np.concatenate([np.linspace(s.start, s.stop, 65) for s in ice])
        return {name: value(t) for name, value in values_of(self.curve.snapshot()).items()}

    @rule(where=dyadic_intervals(16))
    def freeze(self, where: Interval) -> None:
        name = f"ice {self.session.undoable}"
        before = self.curve.snapshot()
        try:
            self.session.constrain("curve", Freeze(interval=tuple(where)), name=name)
        except MultirepError:
            assert self.curve.snapshot() is before
            return
        self.past.append(before)
        self.future.clear()
        ice = SpliceList([where])
        assert self.curve.frozen.contains(ice)

    @precondition(lambda self: self.session.framework.constraints("curve"))
    @rule(data=st.data())
    def release(self, data: st.DataObject) -> None:
        before = self.curve.snapshot()
        names = sorted(self.session.framework.constraints("curve"))
        self.session.release("curve", data.draw(st.sampled_from(names)))
        self.past.append(before)
        self.future.clear()

    @invariant()
    def frozen_stretches_keep_every_bit(self) -> None:
        """From when it was frozen until it is released, in every representation."""
        claims = self.curve.claims
        for name, ice in claims.items():
            if name not in self.ice or self.ice[name][0] != ice:
                self.ice[name] = ice, self.values_on(ice)
            for kind, values in self.values_on(ice).items():
                np.testing.assert_array_equal(values, self.ice[name][1][kind], err_msg=kind)
        for name in set(self.ice) - set(claims):
            del self.ice[name]


@pytest.mark.parametrize(
    ("sessions", "steps"), [(15, 10), pytest.param(40, 30, marks=pytest.mark.slow)]
)
def test_a_session_keeps_its_promises(sessions: int, steps: int) -> None:
    """Whatever is done: what is up to date agrees, what was not reported has not moved."""
    check_machine(SessionMachine, sessions=sessions, steps=steps)


@pytest.mark.parametrize(
    ("sessions", "steps"), [(8, 8), pytest.param(15, 30, marks=pytest.mark.slow)]
)
def test_a_session_with_frozen_stretches_keeps_its_promises(sessions: int, steps: int) -> None:
    """What is frozen is bit-identical in every representation, through undo too."""
    check_machine(FreezingMachine, sessions=sessions, steps=steps)


# -- sessions that once broke a promise ------------------------------------------------------------

Step: TypeAlias = tuple[Maker, float, tuple[float, ...]]


@pytest.mark.parametrize(
    ("start", "tolerance", "steps"),
    [
        # a knot one ulp beside a corner: the curve could not be sampled any more
        (circle, 1e-1, [(move_vertex, 0.09375, (0.0, -0.203125))]),
        (circle, 1e-1, [(move_vertex, 0.609375, (-0.265625, 0.15625))]),
    ],
)
def test_sessions_that_once_broke_a_promise(
    start: Callable[[], mr.MultiRepresentation], tolerance: float, steps: list[Step]
) -> None:
    """Each was found by the machine; all views are brought up to date after every step."""
    curve = start()
    curve.tolerance = tolerance
    session = mr.Session()
    session.add("curve", curve)
    check_certificate(curve)
    for make, u, offset in steps:
        before = curve.snapshot()
        with curve.listening() as events:
            session.apply("curve", make(curve, u, offset))
            check_certificate(curve)
        check_step(before, curve.snapshot(), events)
