"""The promises of DESIGN section 1 that a random session cannot show: no drift, no touch, no
trace.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from kinds import KINDS

import multirep as mr
from multirep import errors
from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import (
    EditRejectedError,
    PluginError,
    StaleEditError,
    UnreportedChangeError,
)
from multirep.events import Committed, Fitted, Sampled, Skipped
from multirep.interval import Interval
from multirep.registry import Registry
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline
from multirep.splices import SpliceList
from multirep.testing import (
    CountingRepresentation,
    LoopbackRepresentation,
    NoTouchRepresentation,
    RecordingTool,
    VetoConstraint,
    check_certificate,
    default_elements,
    faulty_tools,
)


def wavy(
    tolerance: float = 1e-2, n: int = 200, kinds: Any = KINDS, waves: float = 20
) -> mr.MultiRepresentation:
    t = np.linspace(0, 1, n)
    points = np.column_stack([8 * t, np.sin(waves * t)])
    return mr.MultiRepresentation.from_points(points, t=t, tolerance=tolerance, kinds=kinds)


def push(value: Any, t: float, offset: Array) -> Edit[Any]:
    """Move what a representation offers near ``t``: a vertex or a control point."""
    if isinstance(value, Polyline):
        index = int(np.clip(value.t.searchsorted(t), 1, value.size - 2))
        return value.move_vertex(index, value.points[index] + offset)
    degree = (len(value.knots) - len(value.points)) - 1
    index = int(np.clip(value.knots.searchsorted(t) - degree // 2 - 1, 0, len(value.points) - 1))
    return value.move_control_point(index, value.points[index] + offset)


# -- no drift --------------------------------------------------------------------------------------


@pytest.mark.parametrize("everyone_looks", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_thousand_edits_elsewhere_leave_an_untouched_stretch_untouched(
    everyone_looks: bool,
) -> None:
    """Through four representations in turn, each brought up to date to be edited, or all always."""
    curve = wavy(tolerance=1e-2, n=600, waves=80)
    values = {kind: curve.view(kind) for kind in KINDS}
    rng = np.random.default_rng(7)
    untouched, changed = SpliceList([curve.domain]), SpliceList.EMPTY
    for k in range(1000):
        kind = KINDS[k % 4]
        side = rng.choice([0.15, 0.85])
        with curve.listening() as events:
            value = curve.view(kind)
            # back and forth, so that the curve stays about where it is
            offset = rng.uniform(-0.1, 0.1, 2) * (1 if k % 8 < 4 else -1)
            curve.commit(kind, push(value, side + rng.uniform(-0.08, 0.08), offset))
            for other in KINDS if everyone_looks or k == 999 else ():
                curve.view(other)
        for event in events:
            if isinstance(event, Committed | Fitted):
                changed = changed | event.splices
    untouched = untouched - changed
    assert untouched.contains(Interval(0.4, 0.6)), f"edits came near: {changed}"
    t = np.linspace(0, 1, 4001)
    t = t[[untouched.contains(float(s)) for s in t]]
    for kind, before in values.items():
        after = curve.view(kind)
        np.testing.assert_array_equal(before(t), after(t))
        for mine, theirs in zip(default_elements(before), default_elements(after), strict=True):
            np.testing.assert_array_equal(mine.outside(changed), theirs.outside(changed))
    check_certificate(curve)


@pytest.mark.parametrize("kind", KINDS[1:])
def test_what_a_representation_authored_is_not_fitted_anew(kind: type[Representation]) -> None:
    """Between two stale stretches that are close its own stretch stays, but for rounding.

    Knots inserted at the ends of the splices may write it in other control points.
    """
    curve = wavy()
    value = curve.view(kind)
    edit = push(value, 0.5, np.array([0.0, 0.3]))
    curve.commit(kind, edit)
    polyline = curve.view(Polyline)
    (mine,) = edit.splices
    step = 1 / 199
    for t in (mine.start - 3 * step, mine.stop + 3 * step):
        curve.commit(Polyline, push(polyline, t, np.array([0.0, -0.2])))
        polyline = curve.view(Polyline)
    assert curve.stale(kind)
    own = SpliceList(stretch for stretch, name in curve.authors if name == kind.name)
    t = np.linspace(0, 1, 4001)
    t = t[[own.contains(float(s)) for s in t]]
    assert len(t) > 50
    np.testing.assert_allclose(edit.value(t), curve.view(kind)(t), rtol=0, atol=1e-13)
    check_certificate(curve)


def test_a_short_stretch_of_ones_own_is_not_fitted_anew_with_its_neighbours() -> None:
    """Two long stale stretches beside a short own one are brought up to date one by one."""
    u = np.linspace(0, 1, 60)
    knots = np.r_[[0.0] * 3, np.linspace(0, 1, 58), [1.0] * 3]
    start = Nurbs(degree=3, knots=knots, points=np.column_stack([8 * u, np.sin(20 * u)]))
    curve = mr.MultiRepresentation(start, tolerance=1e-2, kinds=[Nurbs, Polyline])
    edit = push(curve.view(Polyline), 0.5, np.array([0.0, 0.3]))
    curve.commit(Polyline, edit)
    (mine,) = edit.splices
    nurbs = curve.view(Nurbs)
    left = int(nurbs.knots.searchsorted(mine.start, side="right")) - 5
    right = int(nurbs.knots.searchsorted(mine.stop, side="left"))
    for index in (left, right):
        moved = nurbs.move_control_point(index, nurbs.points[index] + [0.0, 0.3])
        assert not moved.splices.intersects(edit.splices)
        curve.commit(Nurbs, moved)
        nurbs = curve.view(Nurbs)
    stale = curve.stale(Polyline)
    assert len(stale) == 2
    assert mine.length < min(splice.length for splice in stale)
    with curve.listening() as events:
        after = curve.view(Polyline)
    for event in events:
        assert not (isinstance(event, Sampled) and event.author == "polyline"), event
    inside = np.linspace(mine.start, mine.stop, 101)[1:-1]
    np.testing.assert_array_equal(edit.value(inside), after(inside))
    check_certificate(curve)


# -- lazily, and only where it changed -------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_an_up_to_date_view_does_nothing(kind: type[Representation]) -> None:
    """No sampler and no fitter runs: the only event is that it was skipped."""
    curve = wavy()
    value = curve.view(kind)
    with curve.listening() as events:
        assert curve.view(kind) is value
        assert curve.view(kind.name, Interval(0.2, 0.3)) is value
    assert events == [Skipped(kind.name, "up to date")] * 2


def test_a_change_elsewhere_wakes_nobody_who_looks_here() -> None:
    """A view of a part that is not stale runs nothing, however stale the rest is."""
    curve = wavy()
    for kind in KINDS:
        curve.view(kind)
    curve.commit(Polyline, push(curve.view(Polyline), 0.2, np.array([0.0, 0.5])))
    for kind in KINDS[1:]:
        with curve.listening() as events:
            curve.view(kind, Interval(0.5, 1.0))
        assert [type(event) for event in events] == [Skipped]
        assert curve.stale(kind)


def test_only_the_neighbourhood_of_a_change_is_sampled_and_fitted() -> None:
    """All sampling and fitting after an edit stays near it, in every representation."""
    curve = wavy(tolerance=1e-4, n=600, waves=80)
    for kind in KINDS:
        curve.view(kind)
    edit = push(curve.view(Polyline), 0.5, np.array([0.0, 0.1]))
    curve.commit(Polyline, edit)
    near = edit.splices.hull.widened(0.1)
    for kind in KINDS[1:]:
        with curve.listening() as events:
            curve.view(kind)
        assert [type(event) for event in events].count(Fitted) >= 1
        for event in events:
            if isinstance(event, Sampled | Fitted):
                assert near.contains(event.interval), event
            if isinstance(event, Fitted):
                assert near.contains(event.splices.hull), event


def test_an_author_is_not_sampled_outside_the_stale_splices() -> None:
    """A representation that raises when it is touched elsewhere serves all others after an edit."""
    t = np.linspace(0, 1, 200)
    line = NoTouchRepresentation(t, np.column_stack([8 * t, np.sin(20 * t)]))
    kinds = [NoTouchRepresentation, *KINDS]
    curve = mr.MultiRepresentation(line, tolerance=1e-2, kinds=kinds)
    for kind in kinds:
        curve.view(kind)
    edit = line.move(100, line.points[100] + [0.0, 0.3])
    allowed = SpliceList([edit.splices.hull.widened(4 * edit.splices.length)])
    curve.commit(NoTouchRepresentation, Edit(edit.value.touchable_on(allowed), edit.splices))
    with curve.listening() as events:
        for kind in KINDS:
            curve.view(kind)
    touched = [event for event in events if isinstance(event, Sampled)]
    assert {event.author for event in touched} == {"no-touch"}
    assert all(allowed.contains(event.interval) for event in touched)
    untouchable = curve.view(NoTouchRepresentation).touchable_on(SpliceList.EMPTY)
    curve.commit(NoTouchRepresentation, Edit(untouchable, SpliceList.EMPTY))
    with curve.listening() as events:
        for kind in kinds:
            curve.view(kind)
    assert {type(event) for event in events} == {Skipped}


def test_every_stretch_is_taken_from_its_author() -> None:
    """With a chain of editors each stretch is sampled from who edited it, never from a copy."""
    kinds = [CountingRepresentation, LoopbackRepresentation, Polyline]
    t = np.linspace(0, 1, 101)
    start = CountingRepresentation(t, np.column_stack([t, np.sin(9 * t)]))
    curve = mr.MultiRepresentation(start, tolerance=1e-2, kinds=kinds)
    curve.commit(Polyline, push(curve.view(Polyline), 0.3, np.array([0.0, 0.4])))
    loopback = curve.view(LoopbackRepresentation)
    curve.commit(LoopbackRepresentation, loopback.move(60, loopback.points[60] + [0.0, 0.4]))
    with curve.listening() as events:
        for kind in kinds:
            curve.view(kind)
    sampled = [event for event in events if isinstance(event, Sampled)]
    assert {event.author for event in sampled} == {"loopback", "polyline"}
    for event in sampled:
        (author,) = {name for part, name in curve.authors if part.overlaps(event.interval)}
        assert event.author == author
    check_certificate(curve)


# -- all or nothing --------------------------------------------------------------------------------


def session_of(kind: type[Representation]) -> mr.Session:
    session = mr.Session()
    session.add("wave", wavy(kinds=[*KINDS, LoopbackRepresentation]))
    for every in (*KINDS, LoopbackRepresentation):
        session.curve("wave").view(every)
    return session


FAULTS = list(faulty_tools(Polyline, lambda value: push(value, 0.5, np.array([0.0, 0.3]))))


def operation(value: Any) -> Edit[Any]:
    if isinstance(value, LoopbackRepresentation):
        return value.move(100, value.points[100] + 0.3)
    return push(value, 0.5, np.array([0.0, 0.3]))


@pytest.mark.parametrize("kind", [*KINDS, LoopbackRepresentation], ids=lambda kind: kind.name)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_faulty_tool_leaves_everything_as_it_was(kind: type[Representation], fault: str) -> None:
    """Whatever it does wrong: the same state, no undo step, and an error that names the tool."""
    session = session_of(kind)
    curve = session.curve("wave")
    before = curve.snapshot()
    values = {name: held.value for name, held in before.held.items()}
    tool = faulty_tools(kind, operation)[fault]
    with pytest.raises((PluginError, EditRejectedError)) as caught:
        session.apply("wave", tool)
    assert tool.name in str(caught.value)
    assert curve.snapshot() is before
    assert session.undoable == 0
    for name, value in values.items():
        assert value is not None
        assert curve.view(name) is value
    check_certificate(curve)


def test_a_failing_gesture_undoes_all_of_it() -> None:
    """Two moves go through, the third tool fails: the curve is as before the first."""
    session = session_of(LoopbackRepresentation)
    curve = session.curve("wave")
    before = curve.snapshot()
    nudge = RecordingTool(index=50, offset=(0.0, 0.1))
    raises = faulty_tools(LoopbackRepresentation, operation)["raises"]

    def drag() -> None:
        with session.gesture("wave") as gesture:
            for tool in (nudge, nudge, raises):
                gesture.apply(tool)

    with pytest.raises(PluginError, match="raises"):
        drag()
    assert curve.snapshot() is before
    assert session.undoable == 0
    assert len(nudge.calls) == 2


def test_a_veto_takes_the_edit_back() -> None:
    """A constraint that refuses leaves the curve as it was; elsewhere edits go through."""
    session = session_of(LoopbackRepresentation)
    curve = session.curve("wave")
    value = curve.view(LoopbackRepresentation)
    session.constrain("wave", VetoConstraint.on(value, Interval(0.4, 0.6)), name="hands off")
    before = curve.snapshot()
    with pytest.raises(errors.MultirepError, match=r"hands off|vetoed"):
        session.apply("wave", RecordingTool(index=100, offset=(0.0, 0.3)))
    assert curve.snapshot() is before
    outcome = session.apply("wave", RecordingTool(index=20, offset=(0.0, 0.3)))
    assert outcome.changed


def test_without_a_session_a_veto_takes_the_edit_back_too() -> None:
    """The framework alone is all or nothing: the edit was committed before the constraint spoke."""
    curve = wavy(kinds=[*KINDS, LoopbackRepresentation])
    framework = mr.Framework()
    framework.add("wave", curve)
    value = curve.view(LoopbackRepresentation)
    framework.constrain("wave", VetoConstraint.on(value, Interval(0.4, 0.6)), name="hands off")
    before = curve.snapshot()
    with pytest.raises(errors.MultirepError, match=r"hands off|vetoed"):
        framework.apply("wave", RecordingTool(index=100, offset=(0.0, 0.3)))
    assert curve.snapshot() is before
    assert list(framework.constraints("wave")) == ["hands off"]
    elsewhere = LoopbackRepresentation(value.t, value.points + 1.0)
    veto = VetoConstraint.on(elsewhere, Interval(0.1, 0.2))
    with pytest.raises(errors.MultirepError, match=r"second|vetoed"):
        framework.constrain("wave", veto, name="second")
    assert curve.snapshot() is before
    assert list(framework.constraints("wave")) == ["hands off"]


def test_an_edit_of_a_stale_stretch_is_refused() -> None:
    """Committing an edit made on an old value raises and says where it is not up to date."""
    curve = wavy()
    nurbs, polyline = curve.view(Nurbs), curve.view(Polyline)
    curve.commit(Polyline, push(polyline, 0.5, np.array([0.0, 0.3])))
    before = curve.snapshot()
    with pytest.raises(StaleEditError, match="view it before editing it"):
        curve.commit(Nurbs, push(nurbs, 0.5, np.array([0.0, 0.3])))
    assert curve.snapshot() is before
    curve.commit(Nurbs, push(nurbs, 0.1, np.array([0.0, 0.3])))  # elsewhere it is up to date
    check_certificate(curve)


def test_an_edit_of_an_older_value_is_refused() -> None:
    """Two edits of one value: the second would silently take the first back."""
    curve = wavy()
    polyline = curve.view(Polyline)
    curve.commit(Polyline, push(polyline, 0.2, np.array([0.0, 0.3])))
    before = curve.snapshot()
    with pytest.raises((StaleEditError, UnreportedChangeError)):
        curve.commit(Polyline, push(polyline, 0.7, np.array([0.0, 0.3])))
    assert curve.snapshot() is before


# -- tolerance -------------------------------------------------------------------------------------


def test_tightening_makes_stale_only_what_no_longer_meets_it() -> None:
    """Loosening wakes nobody; tightening back to what was met wakes nobody either."""
    curve = wavy(tolerance=1e-3)
    for kind in KINDS:
        curve.view(kind)
    values = {kind: curve.view(kind) for kind in KINDS}
    curve.tolerance = 1e-1
    assert not any(curve.stale(kind) for kind in KINDS)
    curve.tolerance = 1e-3
    for kind, value in values.items():
        assert curve.view(kind) is value, kind.name
    curve.tolerance = 1e-4
    assert not curve.stale(Polyline)
    assert all(curve.stale(kind) for kind in KINDS[1:])
    check_certificate(curve)


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan"), float("inf"), 1e-18])
def test_tolerances_that_make_no_sense_are_refused(tolerance: float) -> None:
    """Zero, negative, NaN, infinite and below rounding raise; the old one stays."""
    curve = wavy(tolerance=1e-2)
    before = curve.snapshot()
    with pytest.raises(errors.ToleranceError, match="tolerance"):
        curve.tolerance = tolerance
    assert curve.snapshot() is before


# -- any number of representations -----------------------------------------------------------------


def test_with_many_representations_every_pair_is_within_tolerance() -> None:
    """Six kinds, each the author somewhere: errors do not chain, however they took over."""
    kinds = [*KINDS, LoopbackRepresentation, CountingRepresentation]
    curve = wavy(tolerance=5e-3, kinds=kinds)
    for k, kind in enumerate(kinds):
        value, t = curve.view(kind), 0.08 + 0.15 * k
        if isinstance(value, LoopbackRepresentation):
            index = int(value.t.searchsorted(t))
            curve.commit(kind, value.move(index, value.points[index] + [0.0, 0.2]))
        else:
            curve.commit(kind, push(value, t, np.array([0.0, 0.2])))
    assert len({name for _, name in curve.authors}) == len(kinds)
    seen = check_certificate(curve)
    assert seen > 0


def test_two_kinds_of_one_name_are_refused() -> None:
    """A second class under a taken name raises and names both."""

    class Impostor(Nurbs):
        name = "polyline"

    with pytest.raises(errors.RegistrationError, match=r"Polyline.*Impostor|Impostor.*Polyline"):
        wavy(kinds=[Polyline, Impostor])
    with pytest.raises(errors.RegistrationError, match="two representations"):
        Registry.of(Polyline, Impostor)
