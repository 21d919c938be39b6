"""The framework: constraints come and go, edits go through whole or not, and conflicts say why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import attrs
import numpy as np
import pytest

import multirep as mr
from multirep.aim import Aim
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import (
    ConflictError,
    EditError,
    EditRejectedError,
    FrozenError,
    MultirepError,
    PluginError,
    UnknownNameError,
)
from multirep.interval import Interval
from multirep.multirepresentation import MultiRepresentation
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.testing import CountingRepresentation, LoopbackRepresentation, RecordingTool
from multirep.tool import Tool

N = 16


def loopback() -> LoopbackRepresentation:
    k = np.arange(N + 1)
    return LoopbackRepresentation(k / N, np.column_stack([k, 0 * k]))


@pytest.fixture
def framework() -> mr.Framework:
    framework = mr.Framework()
    kinds = [LoopbackRepresentation, CountingRepresentation]
    framework.add("c", MultiRepresentation(loopback(), tolerance=1e-3, kinds=kinds))
    return framework


@attrs.frozen
class Level(Constraint[LoopbackRepresentation]):
    """Two neighbouring vertices have one given height."""

    name = "level"
    needs = LoopbackRepresentation

    index: int
    height: float = 0.0

    def region(self, value: LoopbackRepresentation) -> Interval:
        return Interval((self.index - 1) / N, (self.index + 2) / N)

    def residual(self, value: LoopbackRepresentation) -> float:
        return float(np.abs(value.points[self.index : self.index + 2, 1] - self.height).max())

    def enforce(self, value: LoopbackRepresentation, change: SpliceList, scene: Scene) -> Edit[Any]:
        edit = value.move(self.index, [self.index, self.height])
        second = edit.value.move(self.index + 1, [self.index + 1, self.height])
        return Edit(second.value, edit.splices | second.splices)


@attrs.frozen
class Ice(Constraint[LoopbackRepresentation]):
    """Keeps stretches frozen."""

    name = "ice"
    needs = LoopbackRepresentation

    splices: SpliceList

    def region(self, value: LoopbackRepresentation) -> Interval:
        return self.splices.hull

    def residual(self, value: LoopbackRepresentation) -> float:
        return 0.0

    def enforce(self, value: LoopbackRepresentation, change: SpliceList, scene: Scene) -> Edit[Any]:
        raise AssertionError("a constraint that freezes is asked for nothing")

    def frozen(self, value: LoopbackRepresentation) -> SpliceList:
        return self.splices


def ice(text: str) -> Ice:
    return Ice(SpliceList.parse(text))


@attrs.frozen
class Lift(Tool[LoopbackRepresentation]):
    """Lifts vertices; says where if it is told to."""

    name = "lift"
    edits = LoopbackRepresentation

    indices: tuple[int, ...]
    t: float | None = None
    to: tuple[float, ...] | None = None

    def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
        points = np.array(value.points)
        points[list(self.indices), 1] += 1.0
        ends = (min(self.indices) - 1) / N, (max(self.indices) + 1) / N
        return Edit(attrs.evolve(value, points=points), SpliceList([ends]))


def heights(framework: mr.Framework, kind: Any = LoopbackRepresentation) -> Any:
    return framework.curve("c").view(kind).points[:, 1]


# -- constraints come and go -----------------------------------------------------------------------


def test_a_constraint_is_established_when_it_is_added(framework: mr.Framework) -> None:
    """With a name of its own, and an outcome that says what it did."""
    name, outcome = framework.constrain("c", Level(4, 2.0))
    assert name == "level"
    assert outcome.rounds == 1
    assert outcome.changed == SpliceList([(3 / N, 6 / N)])
    assert [(item.name, item.residual) for item in outcome.constraints] == [("level", 0.0)]
    assert heights(framework)[4] == heights(framework, CountingRepresentation)[4] == 2.0
    assert framework.constrain("c", Level(8))[0] == "level 2"


def test_a_constraint_that_holds_changes_nothing(framework: mr.Framework) -> None:
    """Not even an author."""
    before = framework.curve("c").snapshot()
    assert not framework.constrain("c", Level(4))[1].changed
    assert framework.curve("c").snapshot() is before


def test_names_are_unique_and_known(framework: mr.Framework) -> None:
    """A second one of a name, and the release of an unknown one, are refused."""
    framework.constrain("c", Level(4), name="flat")
    with pytest.raises(MultirepError, match="has a constraint named 'flat' already"):
        framework.constrain("c", Level(8), name="flat")
    with pytest.raises(UnknownNameError, match="did you mean 'flat'"):
        framework.release("c", "flatt")


def test_a_released_constraint_is_not_asked_any_more(framework: mr.Framework) -> None:
    """Edits go through."""
    framework.constrain("c", Level(4), name="flat")
    framework.release("c", "flat")
    framework.apply("c", RecordingTool(index=4, offset=(0, 1)))
    assert heights(framework)[4] == 1.0
    assert not framework.constraints("c")


# -- everything or nothing -------------------------------------------------------------------------


def test_an_edit_goes_through_with_what_constraints_answer(framework: mr.Framework) -> None:
    """The tool's representation is brought up to date, the outcome reports rounds and residuals."""
    framework.constrain("c", Level(4), name="flat")
    outcome = framework.apply("c", Lift((6, 5)))
    assert heights(framework).tolist()[4:7] == [0.0, 0.0, 1.0]
    assert outcome.rounds == 1
    assert outcome.changed == SpliceList([(3 / N, 7 / N)])
    assert [item.name for item in outcome.constraints] == ["flat"]


def test_a_conflict_changes_nothing_and_names_the_smallest_way_out(framework: mr.Framework) -> None:
    """One of the two must go; both cannot hold on the vertex that they share."""
    framework.constrain("c", Level(4, 0.0), name="low")
    framework.constrain("c", Level(10, 0.0), name="far")
    before, held = framework.curve("c").snapshot(), framework.constraints("c")
    with pytest.raises(ConflictError, match="releasing 'low' lets it through") as caught:
        framework.constrain("c", Level(5, 1.0), name="high")
    error = caught.value
    assert error.release == ("low",)
    assert set(error.constraints) == {"low", "high"}
    assert set(error.cycle) == {"low", "high"}
    assert error.where["high"] == SpliceList([(4 / N, 7 / N)])
    assert framework.curve("c").snapshot() is before
    assert framework.constraints("c") == held


def test_the_way_out_may_take_two(framework: mr.Framework) -> None:
    """Two constraints in the way of one: no single release helps."""
    framework.constrain("c", Level(3, 0.0), name="one")
    framework.constrain("c", Level(5, 0.0), name="two")
    with pytest.raises(ConflictError) as caught:
        framework.constrain("c", Level(4, 1.0), name="both")
    assert set(caught.value.release) == {"one", "two"}


def test_a_constraint_that_fails_when_added_is_not_kept(framework: mr.Framework) -> None:
    """Its error names it."""

    @attrs.frozen
    class Broken(Level):
        name = "broken"

        def residual(self, value: LoopbackRepresentation) -> float:
            raise ZeroDivisionError("oops")

    before = framework.curve("c").snapshot()
    with pytest.raises(PluginError, match="'broken' failed with ZeroDivisionError: oops"):
        framework.constrain("c", Broken(4))
    assert framework.curve("c").snapshot() is before
    assert not framework.constraints("c")


# -- frozen stretches ------------------------------------------------------------------------------


def bits(framework: mr.Framework, a: float, b: float) -> list[bytes]:
    curve, t = framework.curve("c"), np.linspace(a, b, 33)
    return [curve.view(kind)(t).tobytes() for kind in curve.kinds]


def test_what_is_frozen_stays_in_every_representation(framework: mr.Framework) -> None:
    """Edits beside it go through untouched; edits of it are refused with its name."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    before = bits(framework, 0.25, 0.5)
    framework.apply("c", RecordingTool(index=9, offset=(0, 1)))
    with pytest.raises(FrozenError, match=r"'ears' keeps frozen.*releasing 'ears'") as caught:
        framework.apply("c", RecordingTool(index=6, offset=(0, 1)))
    assert caught.value.constraints == caught.value.release == ("ears",)
    assert caught.value.where == {"ears": SpliceList.parse("[1/4,1/2]")}
    curve = framework.curve("c")
    with pytest.raises(FrozenError):
        curve.commit("loopback", curve.view(LoopbackRepresentation).move(6, [0, 0]))
    assert bits(framework, 0.25, 0.5) == before


def test_an_edit_that_reaches_in_is_faded_out_before_the_border(framework: mr.Framework) -> None:
    """Nothing frozen changes, no jump at the border, full effect beyond the apron."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    before = bits(framework, 0.25, 0.5)
    plain = Lift((5, 6, 7, 8, 9, 10, 11, 12)).edit(loopback(), Scene()).value
    outcome = framework.apply("c", Lift((5, 6, 7, 8, 9, 10, 11, 12)))
    assert outcome.faded == SpliceList.parse("[1/4,1/2]")
    assert outcome.changed == SpliceList.parse("[1/2,13/16]")
    assert bits(framework, 0.25, 0.5) == before
    value = framework.curve("c").view(LoopbackRepresentation)
    t = np.linspace(0.5, 13 / 16, 400)
    apron = 0.5 + (13 / 16 - 0.5) / 3
    s = np.clip((t - 0.5) / (apron - 0.5), 0, 1)
    weight = s * s * (3 - 2 * s)
    assert np.abs(value(t)[:, 1] - weight * plain(t)[:, 1]).max() <= 1e-3
    assert value(0.5)[1] == 0.0
    assert value.points[value.t.searchsorted(0.75), 1] == 1.0


def test_the_apron_ends_before_what_the_tool_asks_for(framework: mr.Framework) -> None:
    """The aim comes out in full however close to the border."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    tool = Lift((5, 6, 7, 8, 9, 10, 11, 12), t=9 / N, to=(9.0, 1.0))
    framework.apply("c", tool)
    value = framework.curve("c").view(LoopbackRepresentation)
    np.testing.assert_allclose(value(9 / N), [9, 1], atol=1e-3)


def test_an_aim_in_the_ice_is_a_conflict(framework: mr.Framework) -> None:
    """Though something could be done beside it."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    with pytest.raises(FrozenError, match=r"at t = 0.4375 would change.*'ears'"):
        framework.apply("c", Lift((7, 8, 9), t=7 / N, to=(7.0, 1.0)))


def test_a_tool_sees_what_is_frozen(framework: mr.Framework) -> None:
    """And the tolerance, in the scene."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    tool = RecordingTool(index=12, offset=(0, 1))
    framework.apply("c", tool)
    scene = tool.calls[0][1]
    assert scene.frozen == SpliceList.parse("[1/4,1/2]")
    assert scene.tolerance == 1e-3


def test_a_freeze_on_top_of_another_outlives_it(framework: mr.Framework) -> None:
    """Each is released by itself; what both hold stays until the second goes."""
    framework.constrain("c", ice("[1/4,1/2]"), name="a")
    framework.constrain("c", ice("[3/8,5/8]"), name="b")
    framework.release("c", "a")
    framework.apply("c", RecordingTool(index=5, offset=(0, 1)))
    with pytest.raises(FrozenError) as caught:
        framework.apply("c", RecordingTool(index=7, offset=(0, 1)))
    assert caught.value.constraints == ("b",)
    framework.release("c", "b")
    framework.apply("c", RecordingTool(index=7, offset=(0, 1)))


def test_a_constraint_cannot_move_what_is_frozen(framework: mr.Framework) -> None:
    """It is faded out, and then does not hold: a conflict."""
    framework.constrain("c", ice("[1/4,1/2]"), name="ears")
    with pytest.raises(ConflictError) as caught:
        framework.constrain("c", Level(5, 1.0), name="high")
    assert "high" in caught.value.constraints or "ears" in caught.value.constraints
    assert caught.value.release == ("ears",)


@pytest.mark.parametrize("text", ["[-1,1/2]", "[1/2,2]", "[3,4]"])
def test_only_what_is_there_can_be_frozen(framework: mr.Framework, text: str) -> None:
    """Stretches outside T are refused; nothing changes."""
    before = framework.curve("c").snapshot()
    with pytest.raises(MultirepError):
        framework.constrain("c", ice(text))
    assert framework.curve("c").claims == before.claims == {}


def test_tightening_that_would_change_the_ice_is_a_conflict() -> None:
    """A frozen stretch that does not meet a new tolerance is named; the old one stays."""
    from multirep.constraints import Freeze
    from multirep.representations import Nurbs, Polyline

    x = np.linspace(0, 6, 60)
    framework = mr.Framework()
    framework.add(
        "c",
        mr.MultiRepresentation.from_points(
            np.c_[x, np.sin(x)], tolerance=1e-2, kinds=[Polyline, Nurbs]
        ),
    )
    framework.constrain("c", Freeze(interval=(0.25, 0.5)), name="ears")
    with pytest.raises(ConflictError, match=r"tolerance 1e-08 .* 'ears' keeps frozen"):
        framework.set_tolerance("c", 1e-8)
    assert framework.curve("c").tolerance == 1e-2
    framework.release("c", "ears")
    framework.set_tolerance("c", 1e-6)
    assert framework.curve("c").deviation(Polyline, Nurbs).upper <= 1e-6


# -- tools that arrange constraints ----------------------------------------------------------------


@attrs.frozen
class Arrange(Tool[LoopbackRepresentation]):
    name = "arrange"
    edits = LoopbackRepresentation

    wishes: Mapping[str, Constraint[Any] | None]

    def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
        return Edit(value, SpliceList.EMPTY)

    def constrains(
        self, value: LoopbackRepresentation, held: Mapping[str, Constraint[Any]]
    ) -> Mapping[str, Constraint[Any] | None]:
        return self.wishes


def test_a_tool_may_add_replace_and_release_constraints(framework: mr.Framework) -> None:
    """In one step with its edit."""
    framework.apply("c", Arrange({"a": Level(4, 1.0), "b": Level(10, 2.0)}))
    assert heights(framework)[4], heights(framework)[10] == (1.0, 2.0)
    framework.apply("c", Arrange({"a": Level(4, 3.0), "b": None}))
    assert list(framework.constraints("c")) == ["a"]
    assert heights(framework)[4] == 3.0


def test_a_tool_whose_constraints_conflict_changes_nothing(framework: mr.Framework) -> None:
    """Neither the curve nor the constraints."""
    framework.constrain("c", Level(4, 0.0), name="low")
    before, held = framework.curve("c").snapshot(), framework.constraints("c")
    with pytest.raises(ConflictError):
        framework.apply("c", Arrange({"x": Level(10, 1.0), "y": Level(5, 1.0)}))
    assert framework.curve("c").snapshot() is before
    assert framework.constraints("c") == held


# -- what a tool asks for --------------------------------------------------------------------------


def test_aims_are_read_from_the_usual_fields() -> None:
    """``t`` or ``at``, and ``to``; anything else is none of the kernel's business."""
    value = loopback()
    assert Lift((3,), t=0.25, to=(4, 1)).aims(value) == (Aim(0.25, (4.0, 1.0)),)
    assert Lift((3,), t=0.25).aims(value) == (Aim(0.25),)
    assert Lift((3,), t=7.0).aims(value) == ()
    assert Lift((3,), t=0.25, to=(1, 2, 3)).aims(value) == (Aim(0.25),)
    assert RecordingTool(index=3, offset=(0, 1)).aims(value) == ()


def test_a_constraint_that_undoes_a_tool_rejects_it(framework: mr.Framework) -> None:
    """A tool does not report done what was undone."""
    framework.constrain("c", Level(4), name="flat")
    with pytest.raises(ConflictError, match="tool 'lift' asks for") as caught:
        framework.apply("c", Lift((4,), t=4 / N, to=(4.0, 1.0)))
    assert caught.value.release == ("flat",)


def test_errors_of_a_tool_are_its_own(framework: mr.Framework) -> None:
    """A refusal, a bug in its aims, a bug in its wishes: each names it, nothing changes."""

    @attrs.frozen
    class Faulty(Lift):
        name = "faulty"
        where: str = "edit"

        def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
            if self.where == "edit":
                raise EditError("no")
            return Lift.edit(self, value, scene)

        def aims(self, value: LoopbackRepresentation) -> tuple[Aim, ...]:
            return () if self.where != "aims" else 1 / 0  # type: ignore[return-value]

        def constrains(self, value: Any, held: Any) -> Mapping[str, Constraint[Any] | None]:
            return {} if self.where != "wishes" else {}[1]  # type: ignore[index]

    framework.constrain("c", Level(10), name="far")
    before = framework.curve("c").snapshot()
    for where, error, message in (
        ("edit", EditRejectedError, "tool 'faulty': no"),
        ("aims", PluginError, "'faulty' failed with ZeroDivisionError"),
        ("wishes", PluginError, "'faulty' failed with KeyError"),
    ):
        with pytest.raises(error, match=message):
            framework.apply("c", Faulty((4,), where=where))
        assert framework.curve("c").snapshot() is before


def test_another_value_of_a_kind_is_all_that_a_state_changes() -> None:
    """Written out for speed; no field may be forgotten."""
    curve = mr.MultiRepresentation.from_points([[0, 0], [1, 2], [2, 0]], tolerance=0.01)
    curve.freeze("ice", mr.Interval(0.25, 0.5))
    state, held = curve.snapshot(), Held(None, mr.SpliceList.EMPTY)
    after = state.with_held("nurbs", held)
    assert after.held == {**state.held, "nurbs": held}
    for field in attrs.fields(State):
        if field.name != "held":
            assert getattr(after, field.name) is getattr(state, field.name)
            assert getattr(state, field.name)
