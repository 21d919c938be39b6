"""The tools that edit NURBS pass the suite of tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.representations import Nurbs
from multirep.testing import ToolSuite
from multirep.tool import Tool
from multirep.tools import DirectManipulation, InsertKnot, MoveControlPoint, SetWeight

NAN, INF = float("nan"), float("inf")


class NurbsToolSuite(ToolSuite):
    @pytest.fixture
    def value(self) -> Nurbs:
        rng = np.random.default_rng(11)
        n, p = 24, 3
        knots = np.r_[[0.0] * (p + 1), np.sort(rng.uniform(0, 1, n - p - 1)), [1.0] * (p + 1)]
        u = np.linspace(0, 1, n)
        points = np.column_stack([4 * u, np.sin(6 * u)])
        return Nurbs(degree=p, knots=knots, points=points, weights=2.0 ** rng.uniform(-1, 1, n))


class TestMoveControlPoint(NurbsToolSuite):
    malformed: ClassVar = [
        {"index": -1, "to": [0, 0]},
        {"index": 1.5, "to": [0, 0]},
        {"index": 1, "to": [0, NAN]},
        {"index": 1},
    ]

    @pytest.fixture
    def tool(self) -> MoveControlPoint:
        return MoveControlPoint(index=9, to=(1.0, 2.0))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            MoveControlPoint(index=24, to=(1.0, 2.0)),
            MoveControlPoint(index=3, to=(1.0, 2.0, 3.0)),
        ]


class TestMoveLastControlPoint(TestMoveControlPoint):
    @pytest.fixture
    def tool(self) -> MoveControlPoint:
        return MoveControlPoint(index=23, to=(4.0, 2.0))


class TestSetWeight(NurbsToolSuite):
    malformed: ClassVar = [
        {"index": 1, "weight": 0.0},
        {"index": 1, "weight": -1.0},
        {"index": 1, "weight": NAN},
        {"index": 1, "weight": INF},
        {"index": -1, "weight": 1.0},
    ]

    @pytest.fixture
    def tool(self) -> SetWeight:
        return SetWeight(index=9, weight=5.0)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [SetWeight(index=24, weight=2.0)]


class TestInsertKnot(NurbsToolSuite):
    malformed: ClassVar = [
        {"t": NAN},
        {"t": 0.5, "times": 0},
        {"t": 0.5, "times": 1.5},
        {"t": "x"},
        {},
    ]

    @pytest.fixture
    def tool(self) -> InsertKnot:
        return InsertKnot(t=0.512345)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [InsertKnot(t=1.5), InsertKnot(t=0.5, times=4), InsertKnot(t=0.0)]


class TestInsertKnotTwice(TestInsertKnot):
    @pytest.fixture
    def tool(self) -> InsertKnot:
        return InsertKnot(t=0.512345, times=2)


class TestDirectManipulation(NurbsToolSuite):
    malformed: ClassVar = [
        {"t": NAN, "to": [0, 0]},
        {"t": 0.5, "to": [0, NAN]},
        {"t": 0.5},
        {"t": 0.5, "to": [0, 0], "control_points": 0},
        {"t": 0.5, "to": [0, 0], "hold_ends": 3},
    ]

    @pytest.fixture
    def tool(self) -> DirectManipulation:
        return DirectManipulation(t=0.512345, to=(2.0, 1.0))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            DirectManipulation(t=1.5, to=(2.0, 1.0)),
            DirectManipulation(t=0.5, to=(2.0, 1.0, 0.0)),
            DirectManipulation(t=0.5, at=(2.0, 1.0), to=(2.0, 1.0)),
            DirectManipulation(to=(2.0, 1.0)),
            DirectManipulation(t=0.0, to=(2.0, 1.0)),
            DirectManipulation(t=0.5, to=(2.0, 1.0), control_points=5),
        ]

    def test_the_curve_goes_where_it_is_pulled(self, value: Nurbs, tool: Any) -> None:
        """The point is hit up to rounding."""
        after = tool.edit(value, self.scene()).value
        t = tool.t if tool.t is not None else value.nearest(tool.at).t
        np.testing.assert_allclose(after(t), tool.to, atol=1e-12)


class TestDirectManipulationByPlace(TestDirectManipulation):
    @pytest.fixture
    def tool(self) -> DirectManipulation:
        return DirectManipulation(at=(1.0, 1.2), to=(1.0, 1.5), control_points=1)


class TestDirectManipulationOfAnEnd(TestDirectManipulation):
    @pytest.fixture
    def tool(self) -> DirectManipulation:
        return DirectManipulation(t=0.0, to=(-1.0, 1.5), hold_ends=False)
