"""The tools that edit wavelet B-splines pass the suite of tools."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep import SampledSplice
from multirep.representations import WaveletBSpline
from multirep.testing import ToolSuite
from multirep.tool import Tool
from multirep.tools import Sweep

NAN, INF = float("nan"), float("inf")


class TestSweep(ToolSuite):
    malformed: ClassVar = [
        {"t": 0.5, "to": [0, NAN], "level": 2},
        {"t": INF, "to": [0, 0], "level": 2},
        {"t": 0.5, "to": [0, 0], "level": -1},
        {"t": 0.5, "to": [0, 0], "level": NAN},
        {"t": 0.5, "to": [0, 0]},
        {"t": 0.5, "level": 2},
        {"at": "ab", "to": [0, 0], "level": 2},
    ]

    @pytest.fixture
    def value(self) -> WaveletBSpline:
        t = np.linspace(0.0, 1.0, 600)
        wiggle = 0.05 * np.sin(200 * t) * np.exp(-((t - 0.6) ** 2) / 0.001)
        points = np.column_stack([np.cos(3 * t) + wiggle, np.cos(4 * t) + wiggle])
        return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-3)

    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(t=0.3, to=(0.5, 0.7), level=3)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        to = (0.0, 0.0)
        return [
            Sweep(t=2.0, to=to, level=2),
            Sweep(to=to, level=2),
            Sweep(t=0.5, at=to, to=to, level=2),
            Sweep(t=0.5, to=(1.0, 2.0, 3.0), level=2),
            Sweep(t=0.5, to=to, level=41),
        ]


class TestFractionalSweep(TestSweep):
    """By the nearest point, at the end of T, between two levels."""

    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(at=(2.0, 1.0), to=(1.5, 1.5), level=4.4)
