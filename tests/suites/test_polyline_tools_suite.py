"""The tools that edit polylines pass the suite of tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.representations import Polyline
from multirep.testing import ToolSuite
from multirep.tool import Tool
from multirep.tools import (
    DeleteVertex,
    InsertVertex,
    MoveVertex,
    Oversketch,
    Sketch,
    Spatula,
)

NAN, INF = float("nan"), float("inf")


class PolylineToolSuite(ToolSuite):
    @pytest.fixture
    def value(self) -> Polyline:
        rng = np.random.default_rng(11)
        t = np.r_[0.0, np.sort(rng.uniform(0, 1, 60)), 1.0]
        return Polyline(t, np.column_stack([4 * t, np.sin(6 * t)]))


class TestMoveVertex(PolylineToolSuite):
    malformed: ClassVar = [
        {"index": -1, "to": [0, 0]},
        {"index": 1.5, "to": [0, 0]},
        {"index": "1", "to": [0, 0]},
        {"index": 1, "to": [0, NAN]},
        {"index": 1, "to": [INF, 0]},
        {"index": 1, "to": 3},
        {"index": 1, "to": "ab"},
        {"index": 1},
    ]

    @pytest.fixture
    def tool(self) -> MoveVertex:
        return MoveVertex(index=17, to=(1.0, 2.0))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [MoveVertex(index=62, to=(1.0, 2.0)), MoveVertex(index=3, to=(1.0, 2.0, 3.0))]


class TestMoveFirstVertex(TestMoveVertex):
    """The ends of the curve are vertices like others."""

    @pytest.fixture
    def tool(self) -> MoveVertex:
        return MoveVertex(index=0, to=(-1.0, 2.0))


class TestInsertVertex(PolylineToolSuite):
    malformed: ClassVar = [
        {"t": NAN},
        {"t": 0.1, "to": [NAN, 0]},
        {"t": "x"},
        {"t": [0.1]},
        {},
    ]

    @pytest.fixture
    def tool(self) -> InsertVertex:
        return InsertVertex(t=0.512345, to=(1.0, 2.0))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            InsertVertex(t=1.5),
            InsertVertex(t=0.0),
            InsertVertex(t=0.5, to=(1.0, 2.0, 3.0)),
        ]


class TestInsertVertexOnTheCurve(TestInsertVertex):
    """Without a place the curve keeps its shape, but its vertices change."""

    @pytest.fixture
    def tool(self) -> InsertVertex:
        return InsertVertex(t=0.512345)


class TestDeleteVertex(PolylineToolSuite):
    malformed: ClassVar = [{"index": -1}, {"index": 0.5}, {"index": None}]

    @pytest.fixture
    def tool(self) -> DeleteVertex:
        return DeleteVertex(index=30)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [DeleteVertex(index=0), DeleteVertex(index=61), DeleteVertex(index=62)]


class TestSpatula(PolylineToolSuite):
    malformed: ClassVar = [
        {"radius": 0.0, "path": [[0, 0]]},
        {"radius": -1.0, "path": [[0, 0]]},
        {"radius": NAN, "path": [[0, 0]]},
        {"radius": INF, "path": [[0, 0]]},
        {"radius": 1.0, "path": []},
        {"radius": 1.0, "path": [[0, NAN]]},
        {"radius": 1.0, "path": [[0, 0], [1]]},
    ]

    @pytest.fixture
    def tool(self) -> Spatula:
        return Spatula(radius=0.25, path=[[1.5, 1.6], [1.5, 0.7], [2.0, 0.5]])

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [Spatula(radius=0.25, path=[[0.0, 0.0, 0.0]])]


class TestSketch(PolylineToolSuite):
    malformed: ClassVar = [
        {},
        {"stroke": [[0, 0], [1, NAN]]},
        {"stroke": [[0, 0], [1, 0]], "strokes": [[[0, 0], [1, 0]]]},
        {"stroke": [[0, 0], [1, 0]], "noise": -1.0},
        {"stroke": [[0, 0], [1, 0]], "corner_angle": 0.0},
    ]

    @pytest.fixture
    def tool(self) -> Sketch:
        t = np.linspace(0, 1, 40)
        return Sketch(stroke=np.column_stack([4 * t, 1 + np.cos(5 * t)]).tolist())

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [Sketch(stroke=[[0, 0, 0], [1, 0, 0]]), Sketch(stroke=[[1, 1], [1, 1]])]


class TestOversketch(PolylineToolSuite):
    malformed: ClassVar = [
        {},
        {"stroke": [[0, 0], [1, NAN]]},
        {"stroke": [[0, 0], [1, 0]], "join": "G7"},
        {"stroke": [[0, 0], [1, 0]], "apron": -1.0},
    ]

    @pytest.fixture
    def tool(self) -> Oversketch:
        t = np.linspace(1.0, 2.5, 40)
        bump = 0.3 * np.sin(np.pi * (t - 1) / 1.5)
        return Oversketch(stroke=np.column_stack([t, np.sin(1.5 * t) + bump]).tolist())

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            Oversketch(stroke=[[0, 0, 0], [1, 0, 0]]),
            Oversketch(stroke=[[100.0, 100.0], [101.0, 100.0]]),
        ]
