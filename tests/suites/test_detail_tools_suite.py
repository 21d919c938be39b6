"""The tools that work on details of wavelet B-splines pass the suite of tools."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep import SampledSplice
from multirep.representation import Representation
from multirep.representations import WaveletBSpline
from multirep.testing import ToolSuite
from multirep.tool import Tool
from multirep.tools import CopyDetail, ShowLevel, Smooth, Sweep

NAN, INF = float("nan"), float("inf")


def graded() -> WaveletBSpline:
    """Fine in one place, coarse in others."""
    t = np.linspace(0.0, 1.0, 600)
    wiggle = 0.05 * np.sin(200 * t) * np.exp(-((t - 0.6) ** 2) / 0.001)
    points = np.column_stack([np.cos(3 * t) + wiggle, np.cos(4 * t) + wiggle])
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-3)


def rough(dimension: int = 2) -> WaveletBSpline:
    """Uniform of level 6, on another domain."""
    steps = np.random.default_rng(7).normal(size=(67, dimension))
    return WaveletBSpline(steps.cumsum(axis=0), domain=(-1, 2))


class TestSmooth(ToolSuite):
    malformed: ClassVar = [
        {"level": -1},
        {"level": NAN},
        {"level": INF},
        {"level": "x"},
        {"level": 2, "interval": [0.5, 0.5]},
        {"level": 2, "interval": [0.5, 0.25]},
        {"level": 2, "interval": [0.5, NAN]},
        {"level": 2, "interval": 0.5},
        {},
    ]

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()

    @pytest.fixture
    def tool(self) -> Smooth:
        return Smooth(level=4)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            Smooth(level=2, interval=(0.5, 1.5)),
            Smooth(level=2, interval=(0.6, 0.6 + 1e-14)),
        ]


class TestSmoothAStretch(ToolSuite):
    """Between two levels, with ends that are no knots."""

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()

    @pytest.fixture
    def tool(self) -> Smooth:
        return Smooth(level=4.3, interval=(0.4321, 0.7654))


class TestSmoothUpToAnEnd(ToolSuite):
    """On another domain, where all spans are alike."""

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return rough(3)

    @pytest.fixture
    def tool(self) -> Smooth:
        return Smooth(level=2.5, interval=(-1, 0.625))


class TestShowLevel(ToolSuite):
    malformed: ClassVar = [
        {"source": "other", "level": -1},
        {"source": "other", "level": NAN},
        {"source": "", "level": 2},
        {"source": 3, "level": 2},
        {"source": "other"},
        {"level": 2},
    ]

    def others(self) -> Mapping[str, Representation]:
        return {"other": rough(), "flat": rough(1), "fine": graded()}

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()

    @pytest.fixture
    def tool(self) -> ShowLevel:
        return ShowLevel(source="other", level=3.25)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [ShowLevel(source="nobody", level=2), ShowLevel(source="flat", level=2)]


class TestCopyDetail(ToolSuite):
    malformed: ClassVar = [
        {"source": "other", "levels": []},
        {"source": "other", "levels": [-1]},
        {"source": "other", "levels": [1.5]},
        {"source": "other", "levels": 3},
        {"source": "other", "levels": ["3"]},
        {"source": "other", "levels": [3], "frame": "sideways"},
        {"source": "", "levels": [3]},
        {"source": "other"},
        {"levels": [3]},
    ]

    def others(self) -> Mapping[str, Representation]:
        return {"other": rough(), "flat": rough(1), "fine": graded()}

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()

    @pytest.fixture
    def tool(self) -> CopyDetail:
        return CopyDetail(source="other", levels=(3, 4, 5))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            CopyDetail(source="nobody", levels=(2,)),
            CopyDetail(source="flat", levels=(2,)),
            CopyDetail(source="other", levels=(2, 16)),
        ]


class TestCopyDetailAlongAxes(TestCopyDetail, ToolSuite):
    """From a graded curve to a uniform one, a level that is finer than this curve."""

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return rough()

    @pytest.fixture
    def tool(self) -> CopyDetail:
        return CopyDetail(source="fine", levels=(6,), frame="axes")


class TestCopyDetailInSpace(ToolSuite):
    def others(self) -> Mapping[str, Representation]:
        return {"other": rough(3)}

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        t = np.linspace(0.0, 1.0, 131)
        return WaveletBSpline(np.column_stack([np.cos(9 * t), np.sin(9 * t), t]))

    @pytest.fixture
    def tool(self) -> CopyDetail:
        return CopyDetail(source="other", levels=(2, 4))


class TestSweepOfSeveral(ToolSuite):
    malformed: ClassVar = [
        {"t": 0.5, "to": [0, 0], "level": 2, "hold": [NAN]},
        {"t": 0.5, "to": [0, 0], "level": 2, "hold": []},
        {"t": 0.5, "to": [0, 0], "level": 2, "targets": []},
        {"t": 0.5, "to": [0, 0], "level": 2, "targets": [[0.5, INF, 0]]},
        {"t": 0.5, "to": [0, 0], "level": 2, "targets": [[0.5, 1, 0], [0.6, 1]]},
    ]

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()

    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(t=0.3, to=(0.5, 0.7), level=3.5, hold=(0.1, 0.5), targets=((0.7, -0.5, 0.5),))

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        to = (0.0, 0.0)
        return [
            Sweep(t=0.3, to=to, level=3, hold=(2.0,)),
            Sweep(t=0.3, to=to, level=3, hold=(0.3,)),
            Sweep(t=0.3, to=to, level=3, targets=((0.5, 1.0),)),
            Sweep(t=0.3, to=to, level=0, hold=(0.1, 0.2, 0.5, 0.9)),
            Sweep(t=0.3, to=to, level=47, hold=(0.1,)),
        ]
