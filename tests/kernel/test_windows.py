"""Views of a part of T cost that part, and leave everything else alone, bit by bit."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule
from machines import check_machine

import multirep as mr
from multirep.arrays import Array
from multirep.deviation import CLOSE, deviation
from multirep.errors import StaleEditError
from multirep.events import Begun, Event, Fitted, Sampled
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.splices import SpliceList
from multirep.testing import (
    CountingRepresentation,
    LoopbackRepresentation,
    check_certificate,
    check_same,
)
from multirep.testing.strategies import dyadic_intervals, splice_lists
from multirep.windows import APRON

KINDS: list[type[Representation]] = [Polyline, Nurbs, WaveletBSpline]
FOLLOWERS = [Nurbs, WaveletBSpline]
T = Interval(0.0, 1.0)
TOLERANCE = 1e-3
#: Under this one every window of the coast is rich enough not to be widened.
FINE = 5e-5
#: A splice may sample this many times its window and aprons: authors once, and their ends again.
OVERHEAD = 1.3


@cache
def coast(n: int) -> Array:
    """A rough open curve: every window of it has features of its own."""
    rng = np.random.default_rng(5)
    t = np.linspace(0, 1, n)
    k = 1 + np.arange(400)
    phase = rng.uniform(0, 2 * np.pi, (2, len(k)))
    grid = np.linspace(0, 1, 8001)
    waves = [np.cos(2 * np.pi * np.outer(grid, k) + p) @ (0.3 * k**-1.1) for p in phase]
    rows = [np.interp(t, grid, wave) for wave in waves]
    points = np.column_stack([t + rows[0], rows[1]])
    points.setflags(write=False)
    return points


def worked_on(events: list[Event]) -> tuple[SpliceList, SpliceList]:
    """Where authors were sampled, and where representations changed."""
    sampled = SpliceList(e.interval for e in events if isinstance(e, Sampled))
    changed = SpliceList(s for e in events if isinstance(e, Fitted) for s in e.splices)
    return sampled, changed


def rows_in(events: list[Event]) -> int:
    return sum(e.samples for e in events if isinstance(e, Sampled))


def check_window(
    curve: mr.MultiRepresentation, kind: type[Representation], region: SpliceList
) -> int:
    """On a region a value is within the tolerance of all others that are up to date there.

    For all t: proved from both values alone, with what a proof leaves open. Returns how many others
    there were.
    """
    held = curve.snapshot().held
    value = held[kind.name].value
    assert value is not None
    assert not held[kind.name].stale.intersects(region)
    others = [
        other.value
        for name, other in held.items()
        if name != kind.name and other.value is not None and not other.stale.intersects(region)
    ]
    for other in others:
        apart = deviation(value, other, region, scale=curve.tolerance)
        assert apart.upper <= curve.tolerance * (1 + CLOSE), other.name
    return len(others)


# -- what a window costs ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_a_first_view_of_a_window_touches_the_window(kind: type[Representation]) -> None:
    """Of 10^5 vertices, all of them stale, those of the window and its aprons are looked at."""
    curve = mr.MultiRepresentation.from_points(coast(100_001), tolerance=FINE, kinds=KINDS)
    where = Interval(0.4, 0.43)
    with curve.listening() as events:
        curve.view(kind, where)
    apron = where.widened(2 * APRON * where.length)
    sampled, _ = worked_on(events)
    assert SpliceList([apron]).contains(sampled)
    assert rows_in(events) <= OVERHEAD * (1 + 4 * APRON) * 0.03 * 100_000
    assert [type(event) for event in events].count(Begun) == 1
    assert not curve.stale(kind).intersects(SpliceList([where]))
    assert curve.stale(kind).length >= 1 - 1.1 * where.length
    assert check_window(curve, kind, SpliceList([where])) == 1


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_a_window_of_a_stale_curve_touches_the_window(kind: type[Representation]) -> None:
    """When all of T was changed after a view, too: nothing beside the aprons moves by a bit."""
    curve = mr.MultiRepresentation.from_points(coast(100_001), tolerance=FINE, kinds=KINDS)
    before = curve.view(kind)
    polyline = curve.view(Polyline)
    moved = Polyline(np.asarray(polyline.t), polyline.points + np.array([0.3, 0.2]))
    curve.commit(Polyline, mr.Edit(moved, SpliceList([T])))
    where = Interval(0.4, 0.43)
    with curve.listening() as events:
        after = curve.view(kind, where)
    around = SpliceList([where.widened(2 * APRON * where.length)])
    sampled, changed = worked_on(events)
    assert around.contains(sampled)
    beside = SpliceList([where.widened(4 * APRON * where.length)])
    assert beside.contains(changed)
    t = np.linspace(0, 1, 20_001)
    t = t[[not beside.contains(float(at)) for at in t]]
    np.testing.assert_array_equal(before(t), after(t))
    assert check_window(curve, kind, SpliceList([where])) == 1
    shared = {id(block) for block in before.points.blocks}
    assert len(shared) > 8
    assert sum(id(block) not in shared for block in after.points.blocks) <= 2
    with curve.listening() as events:
        curve.deviation(Polyline, kind, where)
    assert worked_on(events) == (SpliceList.EMPTY, SpliceList.EMPTY)


def test_deviation_of_a_window_samples_the_window() -> None:
    """Neither curve is sampled anywhere else, nor brought up to date there."""
    t = np.linspace(0, 1, 2001)
    author = CountingRepresentation(t, coast(2001))
    kinds: list[Any] = [CountingRepresentation, LoopbackRepresentation]
    curve = mr.MultiRepresentation(author, tolerance=TOLERANCE, kinds=kinds)
    where = Interval(0.5, 0.55)
    curve.deviation(CountingRepresentation, LoopbackRepresentation, where)
    around = where.widened(2 * APRON * where.length)
    assert author.log
    assert all(around.contains(interval) for _, interval in author.log)
    assert curve.stale(LoopbackRepresentation).length > 0.9


# -- many windows ----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", FOLLOWERS)
@pytest.mark.parametrize("parts", [7, 64, 1000])
@pytest.mark.parametrize("order", ["forwards", "backwards", "at random"])
def test_scrolling_leaves_few_control_points(
    kind: type[Representation], parts: int, order: str
) -> None:
    """However small the windows, in any order: less than twice as many as a fit of all."""
    t = np.linspace(0, 2 * np.pi, 3000)
    wavy = np.column_stack([np.cos(t) + 0.05 * np.cos(20 * t), np.sin(t) + 0.05 * np.sin(17 * t)])
    whole = mr.MultiRepresentation.from_points(wavy, tolerance=TOLERANCE, kinds=KINDS)
    curve = mr.MultiRepresentation.from_points(wavy, tolerance=TOLERANCE, kinds=KINDS)
    numbers = np.arange(parts)
    if order == "backwards":
        numbers = numbers[::-1]
    elif order == "at random":
        numbers = np.random.default_rng(3).permutation(parts)
    for k in numbers[: parts if order != "at random" else parts // 2].tolist():
        curve.view(kind, Interval(k / parts, (k + 1) / parts))
    value = curve.view(kind)
    assert curve.stale(kind) == SpliceList.EMPTY
    assert value.size <= 2 * whole.view(kind).size
    check_certificate(curve)


def test_most_of_a_curve_is_fitted_as_a_whole() -> None:
    """A first view of most of it is that of all of it."""
    points = coast(500)
    one, two = (
        mr.MultiRepresentation.from_points(points, tolerance=TOLERANCE, kinds=KINDS)
        for _ in range(2)
    )
    check_same(one.view(Nurbs), two.view(Nurbs, Interval(0.1, 0.8)))
    assert two.stale(Nurbs) == SpliceList.EMPTY


def test_a_window_in_which_nothing_happens_is_widened() -> None:
    """A straight line is fitted as a whole, whichever bit of it is looked at."""
    points = np.linspace([0.0, 0.0], [1.0, 2.0], 1000)
    curve = mr.MultiRepresentation.from_points(points, tolerance=TOLERANCE, kinds=KINDS)
    assert curve.view(Nurbs, Interval(0.5, 0.51)).size == 4
    assert curve.stale(Nurbs) == SpliceList.EMPTY


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_corners_on_the_border_of_a_window_stay(kind: type[Representation]) -> None:
    """A window that ends at a corner, then its neighbour: as closely as anywhere."""
    t = np.linspace(0, 1, 129)
    points = np.column_stack([t, 0.02 * (np.arange(129) % 2) + np.where(t == 0.5, 1.0, 0.0)])
    curve = mr.MultiRepresentation.from_points(points, tolerance=TOLERANCE, t=t, kinds=KINDS)
    for where in (Interval(0.25, 0.5), Interval(0.5, 0.625), Interval(0.0, 0.25)):
        curve.view(kind, where)
        assert check_window(curve, kind, SpliceList([where])) == 1
    check_certificate(curve)


def test_editing_beside_a_window_is_refused() -> None:
    """What was not looked at cannot be edited; inside the window it can."""
    curve = mr.MultiRepresentation.from_points(coast(2001), tolerance=TOLERANCE, kinds=KINDS)
    nurbs = curve.view(Nurbs, Interval(0.4, 0.5))
    inside = int(nurbs.knots.searchsorted(0.45)) - 2
    with pytest.raises(StaleEditError, match="view it"):
        curve.commit(Nurbs, nurbs.move_control_point(0, [1.0, 1.0]))
    curve.commit(Nurbs, nurbs.move_control_point(inside, nurbs.points[inside] + 0.05))
    assert [name for _, name in curve.authors] == ["polyline", "nurbs", "polyline"]
    check_certificate(curve)


def test_freezing_and_tightening_after_windows() -> None:
    """Both bring up to date what they need; a frozen stretch keeps its bits beside windows."""
    curve = mr.MultiRepresentation.from_points(coast(801), tolerance=4e-3, kinds=KINDS)
    curve.view(Nurbs, Interval(0.4, 0.45))
    curve.view(WaveletBSpline, Interval(0.1, 0.2))
    curve.tolerance = 2e-3
    curve.view(Nurbs, Interval(0.4, 0.45))
    assert check_window(curve, Nurbs, SpliceList([(0.4, 0.45)])) == 1
    curve.freeze("ice", Interval(0.5, 0.6))
    t = np.linspace(0.5, 0.6, 200)
    ice = {kind.name: curve.view(kind)(t) for kind in KINDS}
    for k, sign in ((20, 1.0), (220, -1.0), (700, 1.0)):
        polyline = curve.view(Polyline)
        assert not curve.frozen.contains(float(polyline.t[k]))
        edit = polyline.move_vertex(k, polyline.points[k] + [0.0, 0.1 * sign])
        curve.commit(Polyline, edit)
    for kind in FOLLOWERS:
        for k in range(16):
            curve.view(kind, Interval(k / 16, (k + 1) / 16))
        np.testing.assert_array_equal(curve.view(kind)(t), ice[kind.name])
    check_certificate(curve)


# -- any order of edits and windows ----------------------------------------------------------------


class WindowMachine(RuleBasedStateMachine):
    """Edits of any representation, and looks at any part of any other."""

    @initialize(tolerance=st.sampled_from([1e-2, 1e-3]), n=st.sampled_from([30, 400]))
    def begin(self, tolerance: float, n: int) -> None:
        self.curve = mr.MultiRepresentation.from_points(coast(n), tolerance=tolerance, kinds=KINDS)

    @rule(kind=st.sampled_from(KINDS), where=st.one_of(dyadic_intervals(), splice_lists()))
    def look(self, kind: type[Representation], where: Interval | SpliceList) -> None:
        region = SpliceList([where]) if isinstance(where, Interval) else where
        before = self.curve.snapshot().held[kind.name]
        with self.curve.listening() as events:
            after = self.curve.view(kind, where)
        assert not self.curve.stale(kind).intersects(region)
        assert before.stale.contains(self.curve.stale(kind))
        if region:
            check_window(self.curve, kind, region)
        if before.value is not None:
            _, changed = worked_on(events)
            assert changed.contains(before.value.changes(after))

    @rule(
        kind=st.sampled_from(KINDS),
        place=st.integers(1, 63),
        offset=st.tuples(*[st.integers(-8, 8).map(lambda k: k / 32)] * 2),
    )
    def edit(self, kind: type[Any], place: int, offset: tuple[float, float]) -> None:
        value = self.curve.view(kind, Interval((place - 1) / 64, (place + 1) / 64))
        stale = self.curve.stale(kind)
        if kind is Polyline:
            index = int(np.clip(value.t.searchsorted(place / 64), 1, value.size - 2))
            edit = value.move_vertex(index, value.points[index] + offset)
        elif kind is Nurbs:
            index = int(np.clip(value.knots.searchsorted(place / 64) - 2, 0, value.size - 1))
            edit = value.move_control_point(index, value.points[index] + offset)
        else:
            edit = value.sweep(place / 64, value(place / 64) + offset, 8)
        before = self.curve.snapshot()
        if edit.splices.intersects(stale):
            with pytest.raises(StaleEditError):
                self.curve.commit(kind, edit)
            assert self.curve.snapshot() is before
        else:
            self.curve.commit(kind, edit)

    @invariant()
    def everything_can_be_brought_up_to_date(self) -> None:
        before = self.curve.snapshot()
        check_certificate(self.curve)
        self.curve.restore(before)


@pytest.mark.parametrize(
    ("sessions", "steps"), [(10, 8), pytest.param(60, 20, marks=pytest.mark.slow)]
)
def test_any_windows_after_any_edits(sessions: int, steps: int) -> None:
    """The law holds on what was looked at, and on all of T after a view of everything."""
    check_machine(WindowMachine, sessions=sessions, steps=steps)
