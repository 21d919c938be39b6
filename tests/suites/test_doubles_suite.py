"""The doubles pass the suites themselves, and the suites say what is missing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

import attrs
import numpy as np
import pytest

from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.fields import as_point, finite_point
from multirep.interval import Interval
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing import (
    ConstraintSuite,
    CountingRepresentation,
    LoopbackRepresentation,
    NoTouchRepresentation,
    RecordingTool,
    RepresentationSuite,
    ToolSuite,
    VetoConstraint,
)


def loopback() -> LoopbackRepresentation:
    t = np.linspace(0.0, 1.0, 33)
    return LoopbackRepresentation(t, np.column_stack([np.cos(5 * t), np.sin(3 * t), t**2]))


class TestLoopback(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> LoopbackRepresentation:
        return loopback()


class TestCounting(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> CountingRepresentation:
        return CountingRepresentation(loopback().t, loopback().points)


class TestNoTouch(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> NoTouchRepresentation:
        return NoTouchRepresentation(loopback().t, loopback().points)


class TestRecordingTool(ToolSuite):
    malformed: ClassVar = [
        {"index": -1, "offset": (0, 1)},
        {"index": 1.5, "offset": (0, 1)},
        {"index": 1, "offset": (0, float("nan"))},
        {"index": 1, "offset": 3},
    ]

    @pytest.fixture
    def value(self) -> LoopbackRepresentation:
        return loopback()

    @pytest.fixture
    def tool(self) -> RecordingTool:
        return RecordingTool(index=7, offset=(0.0, 0.5, -0.25))

    @pytest.fixture
    def refused(self) -> Sequence[RecordingTool]:
        return [RecordingTool(index=33, offset=(0.0, 0.5, 0.0))]

    def test_every_call_is_written_down(self, tool: RecordingTool) -> None:
        """The value and the scene of each call are kept, in order."""
        value, scene = loopback(), Scene()
        tool.edit(value, scene)
        tool.edit(value, scene)
        assert [(v is value, s is scene) for v, s in tool.calls] == [(True, True)] * 2


@attrs.frozen
class Pin(Constraint[LoopbackRepresentation]):
    """A vertex of a loopback stays where it is told.

    Parameters
    ----------
    index : int
        Which vertex.
    point : tuple of float
        Where it must be.
    """

    name = "pin"
    needs = LoopbackRepresentation

    index: int = attrs.field(validator=[attrs.validators.instance_of(int), attrs.validators.ge(1)])
    point: tuple[float, ...] = attrs.field(converter=as_point, validator=finite_point)

    def region(self, value: LoopbackRepresentation) -> Interval:
        return Interval(float(value.t[self.index - 1]), float(value.t[self.index + 1]))

    def residual(self, value: LoopbackRepresentation) -> float:
        return float(np.linalg.norm(value.points[self.index] - self.point))

    def enforce(
        self, value: LoopbackRepresentation, change: SpliceList, scene: Scene
    ) -> Edit[LoopbackRepresentation]:
        return value.move(self.index, self.point)


class TestPin(ConstraintSuite):
    malformed: ClassVar = [{"index": 0, "point": (0, 0)}, {"index": 1, "point": (np.nan, 0)}]

    @pytest.fixture
    def value(self) -> LoopbackRepresentation:
        return loopback()

    @pytest.fixture
    def constraint(self) -> Pin:
        return Pin(index=5, point=(1.0, 1.0, 1.0))


def test_a_veto_holds_until_the_curve_moves() -> None:
    """Its residual is how far the curve moved on the interval."""
    value = loopback()
    veto = VetoConstraint.on(value, Interval(0.25, 0.5))
    assert veto.residual(value) == 0.0
    assert veto.residual(value.move(32, [9.0, 9.0, 9.0]).value) == 0.0
    assert veto.residual(value.move(12, value.points[12] + 1.0).value) > 1.0
    assert veto.region(value) == Interval(0.25, 0.5)


def test_no_touch_raises_where_it_must_not_be_sampled() -> None:
    """Inside the splices it samples, outside and across it raises."""
    value = NoTouchRepresentation(loopback().t, loopback().points)
    guarded = value.touchable_on(SpliceList([(0.25, 0.5)]))
    guarded.sample(Interval(0.3, 0.5), tolerance=1e-3)
    for interval in (Interval(0.2, 0.3), Interval(0.6, 0.7), Interval(0.0, 1.0)):
        with pytest.raises(AssertionError, match="NO TOUCH"):
            guarded.sample(interval, tolerance=1e-3)
        value.sample(interval, tolerance=1e-3)


MISSING = """
import pytest
from multirep.testing import ConstraintSuite, RepresentationSuite, ToolSuite

class TestRepresentation(RepresentationSuite):
    pass

class TestTool(ToolSuite):
    pass

class TestConstraint(ConstraintSuite):
    pass

class TestHalf(ToolSuite):
    @pytest.fixture
    def tool(self):
        return None
"""


def test_a_missing_fixture_fails_with_what_to_supply(pytester: pytest.Pytester) -> None:
    """An empty subclass does not pass and does not skip: each test says which fixture is
    missing.
    """
    pytester.makepyfile(test_missing=MISSING)
    result = pytester.runpytest_inprocess("-p", "no:cacheprovider", "-q", "--tb=line")
    outcomes = result.parseoutcomes()
    assert outcomes["errors"] >= 100
    assert (
        outcomes.get("passed", 0) + outcomes.get("failed", 0) == 2
    )  # the half class needs no value
    text = result.stdout.str()
    for name in ("representation", "tool", "value", "constraint"):
        assert f"must supply a fixture `{name}`" in text
