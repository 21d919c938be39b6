"""Plugins made of random faults: whatever they do, a curve is never half changed.

Representations, tools and constraints are built from a sound one by spoiling any of its methods.
Errors are ours, name the plugin, and leave state, history and constraints as they were.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, example, given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep.constraint import Constraint
from multirep.constraints import Freeze
from multirep.edit import Edit
from multirep.errors import MultirepError, PluginError, RegistrationError, ToleranceError
from multirep.interval import Interval
from multirep.registry import Registry
from multirep.representation import Representation
from multirep.representations import Polyline
from multirep.sampled import SampledSplice
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing import LoopbackRepresentation, RecordingTool, check_certificate
from multirep.tool import Tool

quiet = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)

#: What a careless method may return in place of what it should.
NONSENSE: tuple[Any, ...] = (
    None,
    0,
    -1.0,
    float("nan"),
    float("inf"),
    "text",
    (),
    [],
    {},
    np.zeros(3),
    np.full((2, 2), np.nan),
    SpliceList.EMPTY,
    Interval(0.0, 2.0),
    Edit(None, SpliceList.EMPTY),
    Edit("text", SpliceList([(0.0, 1.0)])),
    Edit(None, None),  # type: ignore[arg-type]
    object(),
)
#: What it may raise.
ERRORS: tuple[BaseException, ...] = (
    ValueError("a bug"),
    KeyError("a bug"),
    ZeroDivisionError("a bug"),
    AssertionError("a bug"),
    RecursionError("a bug"),
    MemoryError("a bug"),
    AttributeError("a bug"),
    StopIteration("a bug"),
    np.linalg.LinAlgError("a bug"),
    ToleranceError("a refusal"),
)

faults = st.one_of(
    st.sampled_from(NONSENSE).map(lambda value: ("returns", value)),
    st.sampled_from(ERRORS).map(lambda error: ("raises", error)),
)


def spoilt(fault: tuple[str, Any]) -> Callable[..., Any]:
    how, what = fault

    def method(*arguments: Any, **options: Any) -> Any:
        if how == "raises":
            raise what
        return what

    return method


def line() -> LoopbackRepresentation:
    t = np.linspace(0.0, 1.0, 41)
    return LoopbackRepresentation(t, np.column_stack([4 * t, np.sin(6 * t)]))


def session_with(*kinds: type[Representation]) -> mr.Session:
    session = mr.Session()
    curve = mr.MultiRepresentation(line(), tolerance=1e-2, kinds=[LoopbackRepresentation, *kinds])
    session.add("curve", curve)
    return session


def check_unharmed(session: mr.Session, before: Any, steps: int = 0) -> None:
    """The state is the very one from before, and the curve can still be worked with."""
    curve = session.curve("curve")
    assert curve.snapshot() is before
    assert session.undoable == steps
    session.apply("curve", RecordingTool(index=30, offset=(0.0, 0.125)))
    session.undo()


# -- tools -----------------------------------------------------------------------------------------


@quiet
@given(fault=faults)
def test_a_tool_whose_edit_goes_wrong_changes_nothing(fault: tuple[str, Any]) -> None:
    """Whatever `edit` returns or raises, the message names the tool and nothing happened."""

    @attrs.frozen
    class Broken(Tool[LoopbackRepresentation]):
        name = "broken-tool"
        edits = LoopbackRepresentation
        edit = spoilt(fault)

    session = session_with(Polyline)
    before = session.curve("curve").snapshot()
    with pytest.raises(MultirepError, match="broken-tool"):
        session.apply("curve", Broken())
    check_unharmed(session, before)


@quiet
@given(fault=faults, method=st.sampled_from(["aims", "constrains"]))
def test_a_tool_that_answers_nonsense_changes_nothing(fault: tuple[str, Any], method: str) -> None:
    """Also what it says beside its edit is checked before anything is done with it."""

    @attrs.frozen
    class Broken(RecordingTool):
        name = "broken-tool"

    setattr(Broken, method, spoilt(fault))
    assume(not (fault[0] == "returns" and _says_nothing(method, fault[1])))
    session = session_with(Polyline)
    session.constrain("curve", Freeze(interval=(0.0, 0.125)), name="ice")
    before = session.curve("curve").snapshot()
    with pytest.raises(MultirepError, match="broken-tool"):
        session.apply("curve", Broken(index=30, offset=(0.0, 0.25)))
    check_unharmed(session, before, steps=1)


def _says_nothing(method: str, answer: Any) -> bool:
    """No aims, or no constraints: as sound as it gets."""
    kinds = (tuple, list) if method == "aims" else (dict,)
    return isinstance(answer, kinds) and not answer


starts = st.integers(0, 63).map(lambda k: k / 64)


@quiet
@given(index=st.integers(0, 40), reported=st.lists(st.tuples(starts, starts), max_size=3))
def test_reports_are_believed_only_when_they_cover_the_change(
    index: int, reported: list[tuple[float, float]]
) -> None:
    """A tool with random splices: accepted when they cover what it changed, else nothing
    happened.
    """
    splices = SpliceList(tuple(sorted(pair)) for pair in reported)

    @attrs.frozen
    class Careless(Tool[LoopbackRepresentation]):
        name = "careless"
        edits = LoopbackRepresentation

        def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
            return Edit(value.move(index, value.points[index] + 1.0).value, splices)

    session = session_with(Polyline)
    curve = session.curve("curve")
    curve.view(Polyline)
    before, sound = curve.snapshot(), line().move(index, [9.0, 9.0]).splices
    if splices.contains(sound):
        session.apply("curve", Careless())
        check_certificate(curve)
        session.undo()
    else:
        with pytest.raises(MultirepError, match="careless"):
            session.apply("curve", Careless())
        check_unharmed(session, before)


@quiet
@given(data=st.data())
def test_a_tool_cannot_reach_into_the_values_that_it_is_given(data: st.DataObject) -> None:
    """Writing to arrays or attributes of the value raises, which becomes a refusal."""
    attribute = data.draw(st.sampled_from(["t", "points", "domain", "dimension", "name"]))

    @attrs.frozen
    class Vandal(Tool[LoopbackRepresentation]):
        name = "vandal"
        edits = LoopbackRepresentation

        def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
            if attribute in ("t", "points"):
                getattr(value, attribute)[:] = 0.0
            setattr(value, attribute, None)
            return Edit(value, SpliceList([value.domain]))

    session = session_with()
    before = session.curve("curve").snapshot()
    with pytest.raises(PluginError, match="vandal"):
        session.apply("curve", Vandal())
    check_unharmed(session, before)


# -- representations -------------------------------------------------------------------------------


@quiet
@given(fault=faults, method=st.sampled_from(["fit", "splice", "reach", "changes"]))
@example(fault=("returns", np.zeros(3)), method="changes")
def test_a_representation_that_goes_wrong_changes_nothing(
    fault: tuple[str, Any], method: str
) -> None:
    """It cannot be viewed; all others can, and the state is as before."""

    class Broken(LoopbackRepresentation):
        name = "broken-kind"

    if method == "fit":
        Broken.fit = classmethod(spoilt(fault))  # type: ignore[assignment]
    session = session_with(Polyline, Broken)
    curve = session.curve("curve")
    curve.view(Polyline)
    if method != "fit":
        curve.view(Broken)
        setattr(Broken, method, spoilt(fault))
    session.apply("curve", RecordingTool(index=10, offset=(0.0, 0.25)))
    before = curve.snapshot()
    if method == "changes" and isinstance(fault[1], SpliceList) and not fault[1]:
        return  # a lie that nobody can find out
    with pytest.raises(MultirepError) as caught:
        curve.view(Broken)
    assert "broken-kind" in str(caught.value) or fault == ("raises", ERRORS[-1])
    check_unharmed(session, before, steps=1)
    check_certificate(curve, kinds=["loopback", "polyline"])


@quiet
@given(fault=faults)
def test_an_author_that_cannot_be_sampled_changes_nothing(fault: tuple[str, Any]) -> None:
    """Nobody can follow it, which is said with its name; undo leads back to where they could."""

    class Broken(LoopbackRepresentation):
        name = "broken-author"

    session = session_with(Polyline, Broken)
    curve = session.curve("curve")
    curve.view(Polyline)
    curve.commit(Broken, curve.view(Broken).move(20, [1.0, 1.0]))
    Broken.sample = spoilt(fault)  # type: ignore[method-assign]
    before = curve.snapshot()
    with pytest.raises(MultirepError) as caught:
        curve.view(Polyline)
    assert "broken-author" in str(caught.value) or fault == ("raises", ERRORS[-1])
    assert curve.snapshot() is before


@quiet
@given(bound=st.sampled_from([1e-1, float("nan"), float("inf"), 1e300]))
def test_a_sample_that_certifies_too_little_is_refused(bound: float) -> None:
    """An author whose samples claim a bound above the tolerance is found out."""

    class Vague(LoopbackRepresentation):
        name = "vague"

        def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
            return attrs.evolve(super().sample(interval, tolerance=tolerance), bound=bound)

    t = np.linspace(0.0, 1.0, 41)
    author = Vague(t, np.column_stack([4 * t, np.sin(6 * t)]))
    curve = mr.MultiRepresentation(author, tolerance=1e-2, kinds=[Vague, Polyline])
    with pytest.raises(PluginError, match="vague"):
        curve.view(Polyline)
    assert curve.stale(Polyline)


@quiet
@given(scale=st.sampled_from([0.0, 0.5, 2.0, -1.0, 1e9]), where=st.sampled_from(["left", "all"]))
def test_a_representation_that_changes_more_than_it_reports_is_found_out(
    scale: float, where: str
) -> None:
    """A splice that touches vertices elsewhere is refused, and the message names the kind."""

    class Sloppy(LoopbackRepresentation):
        name = "sloppy"

        def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Any]:
            edit = super().splice(sampled, tolerance=tolerance)
            points = np.array(edit.value.points)
            points[: 3 if where == "left" else None] *= scale
            return Edit(attrs.evolve(edit.value, points=points), edit.splices)

    session = session_with(Sloppy)
    curve = session.curve("curve")
    curve.view(Sloppy)
    session.apply("curve", RecordingTool(index=30, offset=(0.0, 0.25)))
    before = curve.snapshot()
    with pytest.raises(MultirepError, match="sloppy"):
        curve.view(Sloppy)
    check_unharmed(session, before, steps=1)


# -- constraints -----------------------------------------------------------------------------------


@quiet
@given(fault=faults, method=st.sampled_from(["region", "residual", "enforce", "frozen"]))
def test_a_constraint_that_goes_wrong_is_not_added(fault: tuple[str, Any], method: str) -> None:
    """It is refused with its name, nothing is constrained afterwards, nothing changed."""

    @attrs.frozen
    class Broken(Constraint[LoopbackRepresentation]):
        name = "broken-constraint"
        needs = LoopbackRepresentation

        def region(self, value: LoopbackRepresentation) -> Interval:
            return Interval(0.25, 0.5)

        def residual(self, value: LoopbackRepresentation) -> float:
            return float(np.linalg.norm(value.points[15]))

        def enforce(
            self, value: LoopbackRepresentation, change: SpliceList, scene: Scene
        ) -> Edit[Any]:
            return value.move(15, [0.0, 0.0])

    setattr(Broken, method, spoilt(fault))
    session = session_with(Polyline)
    curve = session.curve("curve")
    before = curve.snapshot()
    how, what = fault
    if how == "returns":
        # what may be meant so: 0, or an interval that is cut to T
        assume(not (method == "residual" and isinstance(what, int)))
        assume(not (method == "region" and isinstance(what, Interval)))
        assume(not (method == "frozen" and what is SpliceList.EMPTY))
    with pytest.raises(MultirepError) as caught:
        session.constrain("curve", Broken(), name="mine")
    assert re.search(r"mine|broken-constraint", str(caught.value)) or what is ERRORS[-1]
    assert not session.framework.constraints("curve")
    check_unharmed(session, before)


# -- the registry ----------------------------------------------------------------------------------


@quiet
@given(
    name=st.one_of(st.sampled_from(NONSENSE), st.text(max_size=8)),
    edits=st.sampled_from([*NONSENSE, LoopbackRepresentation, int, Tool]),
)
def test_a_registry_takes_whole_plugins_only(name: Any, edits: Any) -> None:
    """A tool with any name and any kind: registered with both right, else refused without a
    trace.
    """
    body = {"name": name, "edits": edits, "edit": lambda self, value, scene: None}
    kind = attrs.frozen(type("Odd", (Tool,), body))
    registry = Registry.of(LoopbackRepresentation)
    sound = edits is LoopbackRepresentation and isinstance(name, str)
    if sound and name and name == name.strip().lower():
        registry.register(kind)
        assert registry.tools[name] is kind
        with pytest.raises(RegistrationError, match="two tools"):
            registry.register(kind)
    else:
        with pytest.raises(RegistrationError):
            registry.register(kind)
    assert len(registry.tools) == (1 if registry.tools else 0)


@pytest.mark.parametrize("thing", [*NONSENSE, int, Tool, Representation, Constraint])
def test_a_registry_takes_nothing_else(thing: Any) -> None:
    """What is no complete plugin class is refused with an error of ours."""
    registry = Registry.of(LoopbackRepresentation)
    with pytest.raises(RegistrationError):
        registry.register(thing)
    assert list(registry.representations) == ["loopback"]
    assert not registry.tools
    assert not registry.constraints


def test_two_plugins_of_one_name_name_both_sources() -> None:
    """The second is refused, the first stays."""

    @attrs.frozen
    class Other(Tool[LoopbackRepresentation]):
        name = "recording"
        edits = LoopbackRepresentation

        def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[Any]:
            raise NotImplementedError

    with pytest.raises(RegistrationError, match=r"RecordingTool.*Other"):
        Registry.of(LoopbackRepresentation, RecordingTool, Other)


def test_a_tool_without_its_representation_says_which() -> None:
    """The name of the missing representation is in the message."""
    with pytest.raises(RegistrationError, match=r"'recording' edits 'loopback'.*not registered"):
        Registry.of(Polyline, RecordingTool)
