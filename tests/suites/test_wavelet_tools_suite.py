"""The sweep passes the suite of tools, at any level."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.representations import WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.testing import ToolSuite
from multirep.tool import Tool
from multirep.tools import Sweep

NAN = float("nan")


def graded() -> WaveletBSpline:
    """A smooth curve with fine detail in one place, so that its knots are graded."""
    t = np.linspace(0.0, 1.0, 600)
    detail = 0.05 * np.sin(150 * t) * np.exp(-((t - 0.3) ** 2) / 0.002)
    points = np.column_stack([4 * t, np.sin(6 * t) + detail])
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-3)


class WaveletToolSuite(ToolSuite):
    @pytest.fixture
    def value(self) -> WaveletBSpline:
        return graded()


class TestSweep(WaveletToolSuite):
    malformed: ClassVar = [
        {"t": 0.5, "to": [0, 0], "level": -1},
        {"t": 0.5, "to": [0, 0], "level": NAN},
        {"t": 0.5, "to": [0, NAN], "level": 1},
        {"t": NAN, "to": [0, 0], "level": 1},
        {"t": 0.5, "level": 1},
    ]

    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(t=0.412345, to=(2.0, 1.0), level=3)

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        return [
            Sweep(t=1.5, to=(2.0, 1.0), level=3),
            Sweep(t=0.5, to=(2.0, 1.0, 0.0), level=3),
            Sweep(t=0.5, at=(2.0, 1.0), to=(2.0, 1.0), level=3),
            Sweep(to=(2.0, 1.0), level=3),
            Sweep(t=0.5, to=(2.0, 1.0), level=60),
        ]

    def test_the_curve_goes_where_it_is_swept(self, value: WaveletBSpline, tool: Any) -> None:
        """The point is hit up to rounding, at any level."""
        t = tool.t if tool.t is not None else value.nearest(tool.at).t
        np.testing.assert_allclose(tool.edit(value, self.scene()).value(t), tool.to, atol=1e-9)


class TestBroadSweep(TestSweep):
    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(t=0.412345, to=(2.0, 1.0), level=0)


class TestFractionalSweep(TestSweep):
    @pytest.fixture
    def tool(self) -> Sweep:
        return Sweep(at=(1.3, 0.9), to=(2.0, 1.0), level=2.75)
