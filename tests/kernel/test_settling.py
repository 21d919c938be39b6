"""The loop that re-establishes constraints: rounds, groups, priorities, cycles, and an end."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.aim import Aim
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import ConflictError, EditError, MultirepError, PluginError
from multirep.interval import Interval
from multirep.multirepresentation import MultiRepresentation
from multirep.scene import Scene
from multirep.settling import MAX_ROUNDS, Settlement, settle
from multirep.splices import SpliceList
from multirep.testing import CountingRepresentation, LoopbackRepresentation, RecordingTool

N = 16


def line() -> LoopbackRepresentation:
    """Vertices (k, 0) at k / 16."""
    k = np.arange(N + 1)
    return LoopbackRepresentation(k / N, np.column_stack([k, 0 * k]))


def curve() -> MultiRepresentation:
    return MultiRepresentation(
        line(), tolerance=1e-3, kinds=[LoopbackRepresentation, CountingRepresentation]
    )


def moved(value: LoopbackRepresentation, heights: Mapping[int, float]) -> Edit[Any]:
    """Put vertices at heights; one splice around them, as a loopback compares."""
    edit: Edit[Any] = Edit(value, SpliceList.EMPTY)
    for index, height in heights.items():
        step = edit.value.move(index, [value.points[index, 0], height])
        edit = Edit(step.value, SpliceList([(edit.splices | step.splices).hull]))
    return edit


@attrs.frozen
class Height(Constraint[LoopbackRepresentation]):
    """A vertex has a height, and re-establishing that moves other vertices as well."""

    name = "height"
    needs = LoopbackRepresentation

    index: int
    height: float = 0.0
    side_effects: tuple[tuple[int, float], ...] = ()
    reach: int = 1
    log: list[str] = attrs.field(factory=list, eq=False)

    def region(self, value: LoopbackRepresentation) -> Interval:
        return Interval(max(self.index - self.reach, 0) / N, min(self.index + self.reach, N) / N)

    def residual(self, value: LoopbackRepresentation) -> float:
        return float(abs(value.points[self.index, 1] - self.height))

    def enforce(
        self, value: LoopbackRepresentation, change: SpliceList, scene: Scene
    ) -> Edit[LoopbackRepresentation]:
        self.log.append(f"{self.index}")
        return moved(value, {self.index: self.height, **dict(self.side_effects)})


@attrs.frozen
class Important(Height):
    name = "important"
    priority = 5


@attrs.frozen
class Together(Height):
    name = "together"
    family = "together"

    calls: ClassVar[list[tuple[str, ...]]] = []

    @classmethod
    def enforce_together(
        cls, group: Mapping[str, Any], value: Any, change: SpliceList, scene: Scene
    ) -> Edit[Any]:
        cls.calls.append(tuple(group))
        return moved(value, {member.index: member.height for member in group.values()})


def disturbed(heights: Mapping[int, float]) -> tuple[MultiRepresentation, SpliceList]:
    target = curve()
    edit = moved(target.view(LoopbackRepresentation), heights)
    target.commit(LoopbackRepresentation, edit)
    return target, edit.splices


def heights(target: MultiRepresentation) -> list[float]:
    return target.view(LoopbackRepresentation).points[:, 1].tolist()


# -- rounds ----------------------------------------------------------------------------------------


def test_without_constraints_there_is_nothing_to_do() -> None:
    """No round, no look at any representation."""
    target, change = disturbed({3: 1.0})
    with target.listening() as events:
        assert settle(target, {}, change, Scene()) == Settlement(0, (), change)
    assert not events


def test_a_change_wakes_only_the_constraints_that_it_touches() -> None:
    """Those apart are neither asked nor reported, though they do not hold."""
    target, _ = disturbed({3: 1.0, 12: 1.0})
    near, far = Height(3), Height(12)
    settlement = settle(target, {"near": near, "far": far}, SpliceList([(2 / N, 4 / N)]), Scene())
    assert [item.name for item in settlement.constraints] == ["near"]
    assert (near.log, far.log, settlement.rounds) == (["3"], [], 1)


def test_what_holds_is_reported_with_its_residual_and_left_alone() -> None:
    """No round when nothing is broken."""
    target, change = disturbed({3: 1.0})
    constraint = Height(4)
    settlement = settle(target, {"c": constraint}, change, Scene())
    assert (settlement.rounds, settlement.constraints[0].residual) == (0, 0.0)
    assert not constraint.log


def test_a_constraint_may_break_another_that_then_mends_itself() -> None:
    """A chain of two takes two rounds, and everything that changed is reported."""
    target, change = disturbed({3: 1.0})
    chain = {"a": Height(3, side_effects=((5, 2.0),)), "b": Height(5)}
    settlement = settle(target, chain, change, Scene())
    assert settlement.rounds == 2
    assert heights(target) == [0.0] * (N + 1)
    assert settlement.changed == SpliceList([(2 / N, 6 / N)])


def test_a_constraint_may_ask_for_another_representation() -> None:
    """It is brought up to date, edited, and the tool's follows again."""

    class Elsewhere(Height):
        name = "elsewhere"
        needs = CountingRepresentation

    target = curve()
    target.view(CountingRepresentation)
    framework = mr.Framework()
    framework.add("c", target)
    framework.constrain("c", Elsewhere(3), name="e")
    outcome = framework.apply("c", RecordingTool(index=3, offset=(0, 1)))
    assert outcome.rounds == 1
    assert target.view(LoopbackRepresentation).points[3, 1] == 0.0
    assert dict(target.authors)[Interval(2 / N, 4 / N)] == "counting"


# -- groups and priorities -------------------------------------------------------------------------


def test_groups_go_from_high_to_low_priority_and_then_by_name() -> None:
    """In each round."""
    log: list[str] = []
    target, change = disturbed({2: 1.0, 6: 1.0, 10: 1.0})
    constraints = {
        "b": Height(2, log=log),
        "a": Height(6, log=log),
        "z": Important(10, log=log),
    }
    settle(target, constraints, change, Scene())
    assert log == ["10", "6", "2"]


@pytest.mark.parametrize("reach", [0, 1])
def test_what_an_enforcement_leaves_alone_is_not_asked_again(reach: int) -> None:
    """Each broken constraint says twice how far it is off: before and after it is enforced."""
    asked: list[int] = []

    @attrs.frozen
    class Asked(Height):
        def residual(self, value: LoopbackRepresentation) -> float:
            asked.append(self.index)
            return super().residual(value)

    target, change = disturbed({2: 1.0, 7: 1.0, 12: 1.0})
    constraints = {f"h{k}": Asked(k, reach=reach) for k in (2, 7, 12)}
    settlement = settle(target, constraints, change, Scene())
    assert settlement.rounds == 1
    assert [done.residual for done in settlement.constraints] == [0.0, 0.0, 0.0]
    assert sorted(asked) == [2, 2, 7, 7, 12, 12]


def test_a_family_is_enforced_by_one_call_where_claims_overlap() -> None:
    """Chains of overlapping claims are one group, holding members included; those apart are not."""
    Together.calls.clear()
    target, change = disturbed({3: 1.0, 4: 1.0, 12: 1.0})
    members = {f"t{k}": Together(k) for k in (2, 3, 4, 5, 8, 12)}
    settlement = settle(target, members, change, Scene())
    assert Together.calls == [("t12",), ("t2", "t3", "t4", "t5")]
    assert settlement.rounds == 1


# -- conflicts -------------------------------------------------------------------------------------


def test_three_constraints_on_a_cycle_are_named_with_their_residuals() -> None:
    """Exactly those on the cycle; a bystander that is touched and broken once is not."""
    target, change = disturbed({3: 1.0, 4: 1.0})
    before = target.snapshot()
    constraints = {
        "bystander": Height(4, reach=8),
        "a": Height(3, 0.0, ((6, 1.0),), reach=2),
        "b": Height(6, 0.0, ((9, 2.0),), reach=2),
        "c": Height(9, 0.0, ((3, 3.0),), reach=2),
    }
    with pytest.raises(ConflictError, match="in a cycle") as caught, target.transaction():
        settle(target, constraints, change, Scene())
    error = caught.value
    assert set(error.cycle) == set(error.constraints) == {"a", "b", "c"}
    start = error.cycle.index("a")
    assert [error.cycle[(start + k) % 3] for k in range(3)] == ["a", "b", "c"]
    assert all(residual > 0 for residual in error.residuals.values())
    assert error.where["b"] == SpliceList([(4 / N, 8 / N)])
    assert target.snapshot() is before


def test_a_cycle_that_shrinks_is_let_go_on() -> None:
    """Two constraints that disturb each other less and less settle."""

    class Half(Height):
        name = "half"

        def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
            other = self.side_effects[0][0]
            return moved(value, {self.index: 0.0, other: value.points[self.index, 1] / 8})

    target, change = disturbed({3: 1.0})
    pair = {"a": Half(3, side_effects=((5, 0),)), "b": Half(5, side_effects=((3, 0),))}
    settlement = settle(target, pair, change, Scene())
    assert 2 < settlement.rounds < MAX_ROUNDS
    assert max(item.residual for item in settlement.constraints) < 1e-7


def test_a_cycle_that_shrinks_too_slowly_ends_after_the_last_round(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Bounded, and named."""

    class Slow(Height):
        name = "slow"

        def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
            return moved(value, {self.index: 0.499 * value.points[self.index, 1] + 1e-3})

    target, change = disturbed({3: 2.0**10})
    monkeypatch.setattr("multirep.settling.MAX_ROUNDS", 4)
    with pytest.raises(ConflictError, match="in 4 rounds") as caught:
        settle(target, {"s": Slow(3)}, change, Scene())
    assert caught.value.constraints == ("s",)


def test_constraints_that_would_go_on_for_a_thousand_rounds_are_stopped_after_a_few() -> None:
    """Each must stand above the other, and says that it gets nearer: one enforcement a round."""
    log: list[str] = []

    @attrs.frozen
    class Above(Height):
        name = "above"

        def residual(self, value: LoopbackRepresentation) -> float:
            mine, other = value.points[[self.index, self.side_effects[0][0]], 1].tolist()
            return 0.0 if mine > other else 2.0 ** (1000 - other)

        def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
            self.log.append(f"{self.index}")
            return moved(value, {self.index: value.points[self.side_effects[0][0], 1] + 1})

    target, change = disturbed({3: 1.0})
    pair = {"a": Above(3, 0, ((5, 0),), 3, log), "b": Above(5, 0, ((3, 0),), 3, log)}
    with pytest.raises(ConflictError, match=f"do not settle in {MAX_ROUNDS} rounds") as caught:
        settle(target, pair, change, Scene())
    assert log == ["5", "3"] * (MAX_ROUNDS // 2)
    assert len(log) <= 64
    assert caught.value.constraints == ("b",)


@pytest.mark.parametrize(
    ("enforced", "message"),
    [(1.0, "does not hold after it has re-established itself"), (None, "change nothing")],
)
def test_a_constraint_that_does_not_mend_itself_is_named(
    enforced: float | None, message: str
) -> None:
    """Whether it changes the curve in vain or not at all."""

    class Vain(Height):
        name = "vain"

        def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
            if enforced is None:
                return Edit(value, SpliceList.EMPTY)
            return moved(value, {self.index: value.points[self.index, 1] + enforced})

    target, change = disturbed({3: 1.0})
    with pytest.raises(ConflictError, match=message) as caught:
        settle(target, {"v": Vain(3), "other": Height(9)}, change, Scene())
    assert caught.value.constraints == ("v",)


def test_a_constraint_that_refuses_is_a_conflict_with_its_reason() -> None:
    """What it raises becomes the cause."""

    class Refusing(Height):
        name = "refusing"

        def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
            raise EditError("not today")

    target, change = disturbed({3: 1.0})
    with pytest.raises(ConflictError, match=r"'r'.*not today") as caught:
        settle(target, {"r": Refusing(3)}, change, Scene())
    assert caught.value.residuals == {"r": 1.0}
    assert isinstance(caught.value.__cause__, EditError)


def test_what_a_constraint_undoes_of_a_tool_is_a_conflict() -> None:
    """The aim was reached by the edit and is not any more."""
    target, change = disturbed({3: 1.0})
    scene = Scene(aims=(Aim(3 / N, (3.0, 1.0)),))
    with pytest.raises(ConflictError, match=r"tool 'x' asks for \(3.0, 1.0\)") as caught:
        settle(target, {"c": Height(3)}, change, scene, kind=LoopbackRepresentation, by="tool 'x'")
    assert caught.value.constraints == ("c",)
    assert caught.value.residuals == {"c": 1.0}


def test_an_aim_that_survives_is_no_conflict() -> None:
    """Constraints beside it may answer."""
    target, change = disturbed({3: 1.0, 4: 1.0})
    scene = Scene(aims=(Aim(3 / N, (3.0, 1.0)),))
    settlement = settle(target, {"c": Height(4)}, change, scene, kind=LoopbackRepresentation)
    assert settlement.rounds == 1


# -- any plugin ------------------------------------------------------------------------------------

FLOATS = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, float("nan"), float("inf"), 1e300, 1e-300]),
    st.floats(0, 2),
)
ERRORS = st.sampled_from([ValueError, KeyError, ZeroDivisionError, EditError, RuntimeError])
REGIONS = st.one_of(
    st.sampled_from([None, (0.5, 0.2), (2.0, 3.0), "all", (0.0, float("nan")), Interval(0.5, 0.5)]),
    st.tuples(st.integers(0, N - 1), st.integers(1, N)).map(
        lambda pair: Interval(pair[0] / N, min(pair[0] + pair[1], N) / N)
    ),
)
RESIDUALS = st.one_of(FLOATS, st.sampled_from([None, "far", [1.0]]), st.just("what it is"))
ENFORCEMENTS = st.one_of(
    st.sampled_from(
        ["nothing", "None", "value", "NaN", "unreported", "outside", "wrong kind", "mend"]
    ),
    st.dictionaries(st.integers(0, N), st.floats(-2, 2), min_size=1, max_size=3),
)


def _or_error(values: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.one_of(values, values, values, ERRORS)


@attrs.frozen(eq=False)
class Wild(Constraint[LoopbackRepresentation]):
    """Does whatever the test says, again and again: raises, oscillates, lies, returns NaN."""

    name = "wild"
    needs = LoopbackRepresentation

    index: int
    regions: list[Any]
    residuals: list[Any]
    enforcements: list[Any]
    counts: list[int] = attrs.field(factory=lambda: [0, 0, 0])

    def next(self, which: int, choices: list[Any]) -> Any:
        self.counts[which] += 1
        found = choices[self.counts[which] % len(choices)]
        if isinstance(found, type) and issubclass(found, Exception):
            raise found("wild")
        return found

    def region(self, value: LoopbackRepresentation) -> Any:
        return self.next(0, self.regions)

    def residual(self, value: LoopbackRepresentation) -> Any:
        found = self.next(1, self.residuals)
        if isinstance(found, str) and found == "what it is":
            return float(abs(value.points[self.index, 1]))
        return found

    def enforce(self, value: LoopbackRepresentation, change: SpliceList, scene: Scene) -> Any:
        found = self.next(2, self.enforcements)
        if isinstance(found, dict):
            return moved(value, found)
        sound = moved(value, {self.index: 0.0})
        spoilt: dict[str, Callable[[], Any]] = {
            "nothing": lambda: Edit(value, SpliceList.EMPTY),
            "None": lambda: None,
            "value": lambda: value,
            "NaN": lambda: Edit(
                attrs.evolve(value, points=[[0, 0], *value.points[1:] * np.inf]), sound.splices
            ),
            "unreported": lambda: Edit(moved(value, {8: 7.0}).value, SpliceList([(0, 1 / N)])),
            "outside": lambda: Edit(sound.value, SpliceList([(0.0, 2.0)])),
            "wrong kind": lambda: Edit(
                CountingRepresentation(value.t, value.points), SpliceList([(0.0, 1.0)])
            ),
            "mend": lambda: sound,
        }
        return spoilt[found]()


@st.composite
def wild_constraints(draw: st.DrawFn) -> Wild:
    def choices(values: st.SearchStrategy[Any]) -> list[Any]:
        return draw(st.lists(_or_error(values), min_size=1, max_size=4))

    return Wild(
        draw(st.integers(0, N)), choices(REGIONS), choices(RESIDUALS), choices(ENFORCEMENTS)
    )


@given(st.lists(wild_constraints(), min_size=1, max_size=4), st.integers(0, N))
def test_any_plugins_come_to_an_end_and_what_fails_leaves_everything_as_it_was(
    wild: list[Wild], index: int
) -> None:
    """The number of calls is bounded; after an error every value is the same object as before."""
    framework = mr.Framework()
    target = curve()
    framework.add("c", target)
    for k, constraint in enumerate(wild):
        before, held = target.snapshot(), framework.constraints("c")
        try:
            framework.constrain("c", constraint, name=f"w{k}")
        except MultirepError:
            assert target.snapshot().held is before.held
            assert framework.constraints("c") == held
    before, held = target.snapshot(), framework.constraints("c")
    failed: MultirepError | None = None
    try:
        framework.apply("c", RecordingTool(index=index, offset=(0, 1)))
    except MultirepError as error:
        failed = error
    if failed is not None:
        assert target.snapshot().held is before.held
        assert framework.constraints("c") == held
    if isinstance(failed, ConflictError):
        assert failed.constraints
        assert set(failed.constraints) <= set(held)
    trials = 2 * 64
    for constraint in wild:
        assert max(constraint.counts) < trials * len(wild) * 8 * MAX_ROUNDS


def test_an_error_of_a_plugin_names_it() -> None:
    """Also a residual that is no distance and a claim that is no interval."""
    target, change = disturbed({3: 1.0})
    for wild, message in (
        (Wild(3, [Interval(0, 1)], [float("nan")], ["mend"]), "residual nan"),
        (Wild(3, [Interval(0, 1)], [-1.0], ["mend"]), "residual -1.0"),
        (Wild(3, [Interval(0, 1)], [float("inf")], ["mend"]), "residual inf"),
        (Wild(3, [Interval(0, 1)], ["far"], ["mend"]), "residual 'far'"),
        (Wild(3, [Interval(0, 1)], ["0"], ["mend"]), "residual '0'"),
        (Wild(3, [Interval(0, 1)], [None], ["mend"]), "residual None"),
        (Wild(3, [Interval(0, 1)], [np.zeros(1)], ["mend"]), r"residual array\(\[0\.\]\)"),
        (Wild(3, [None], [1.0], ["mend"]), "claims None: an interval is a pair of numbers"),
        (Wild(3, [np.zeros(3)], [1.0], ["mend"]), "claims array"),
        (Wild(3, [(0.5, float("nan"))], [1.0], ["mend"]), "claims .*not a number"),
        (Wild(3, [(2.0, 3.0)], [1.0], ["mend"]), "claims"),
        (Wild(3, [ValueError], [1.0], ["mend"]), "ValueError: wild"),
        (Wild(3, [Interval(0, 1)], [1.0], ["None"]), "must return an Edit"),
    ):
        with pytest.raises(PluginError, match=message) as caught:
            settle(target, {"w": wild}, change, Scene())
        assert "w" in caught.value.plugin
