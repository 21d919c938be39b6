"""The corner and the mark tool pass the suite of tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.edit import Edit
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline
from multirep.scene import Scene
from multirep.testing import ToolSuite
from multirep.testing.laws import check_same
from multirep.tool import Tool
from multirep.tools import Corner, Mark

NAN, INF = float("nan"), float("inf")


class TestCorner(ToolSuite):
    malformed: ClassVar = [
        {"t": NAN},
        {"t": 0.5, "left": [NAN, 0]},
        {"t": 0.5, "to": "ab"},
        {"t": 0.5, "remove": True, "left": [1, 0]},
        {"t": 0.5, "remove": 1},
        {"at": [INF, 0]},
    ]

    @pytest.fixture
    def value(self) -> Nurbs:
        rng = np.random.default_rng(3)
        knots = np.r_[[0.0] * 4, np.sort(rng.uniform(0, 1, 14)), [1.0] * 4]
        x = np.linspace(0, 4, 18)
        return Nurbs(degree=3, knots=knots, points=np.column_stack([x, np.sin(2 * x)]))

    @pytest.fixture
    def tool(self) -> Corner:
        return Corner(t=0.5, left=(1.0, 9.0), right=(1.0, -9.0))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            Corner(t=0.5, remove=True),
            Corner(t=0.0),
            Corner(t=1.0, left=(1.0, 0.0)),
            Corner(t=2.0),
            Corner(),
            Corner(t=0.5, at=(0.0, 0.0)),
            Corner(t=0.5, left=(1.0, 0.0, 0.0)),
            Corner(at=(0.0, 0.0, 0.0)),
        ]


class TestMovedCorner(TestCorner):
    @pytest.fixture
    def tool(self) -> Corner:
        return Corner(at=(2.0, -0.5), to=(2.0, 0.0))


class TestRationalCorner(TestCorner):
    @pytest.fixture
    def value(self) -> Nurbs:
        rng = np.random.default_rng(4)
        x = np.linspace(0, 4, 12)
        knots = np.r_[[0.0] * 3, np.sort(rng.uniform(0, 1, 9)), [1.0] * 3]
        return Nurbs(
            degree=2,
            knots=knots,
            points=np.column_stack([x, np.sin(2 * x)]),
            weights=2.0 ** rng.uniform(-1, 1, 12),
        )


class TestMark(ToolSuite):
    """It leaves the curve alone; what it does to the constraints is tested elsewhere."""

    malformed: ClassVar = [
        {},
        {"left": NAN},
        {"left": 0.2, "remove": True},
        {"remove": 1},
        {"left": 0.2, "label": ""},
    ]

    @pytest.fixture
    def value(self) -> Polyline:
        t = np.linspace(0, 1, 41)
        return Polyline(t, np.column_stack([4 * t, np.sin(6 * t)]))

    @pytest.fixture
    def tool(self) -> Mark:
        return Mark(left=0.3, right=0.52)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [Mark(left=-0.5), Mark(left=0.8, right=0.2), Mark(remove=True), Mark(left=1.0)]

    def check(self, value: Representation, tool: Tool[Any]) -> Edit[Any]:
        edit = tool.edit(value, Scene())
        assert edit.value is value
        return edit

    def test_the_edit_is_exact(self, tool: Tool[Any], value: Representation) -> None:
        """It changes nothing."""
        assert not self.check(value, tool).splices

    def test_others_follow_and_undo_restores(self, tool: Tool[Any], value: Representation) -> None:
        """Undo takes the marks away again, and redo brings them back."""
        session = self.session(value)
        session.apply("curve", tool)
        assert list(session.framework.constraints("curve")) == ["mark"]
        assert session.curve("curve").frozen
        session.undo()
        assert not session.framework.constraints("curve")
        assert not session.curve("curve").frozen
        check_same(session.curve("curve").view(type(value)), value, elements=self.elements)
        session.redo()
        assert session.curve("curve").frozen
