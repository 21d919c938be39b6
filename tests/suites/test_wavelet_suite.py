"""The wavelet B-spline passes the suite of representations."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from multirep.representations import WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.testing import RepresentationSuite


class TestWaveletBSpline(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> WaveletBSpline:
        t = np.linspace(0.0, 1.0, 400)
        # fine detail in one place only, so that the knots are graded
        detail = 0.05 * np.sin(150 * t) * np.exp(-((t - 0.3) ** 2) / 0.002)
        points = np.column_stack([np.cos(5 * t), np.sin(3 * t) + detail])
        return WaveletBSpline.fit(SampledSplice(t, points), tolerance=2e-3)


class TestLongWaveletBSpline(RepresentationSuite):
    """Rough, over another T, in space."""

    finest: ClassVar = 1e-5  # that many samples take their time; the smooth one goes further

    @pytest.fixture
    def representation(self) -> WaveletBSpline:
        rng = np.random.default_rng(4)
        t = np.linspace(-2.0, 3.0, 1500)
        walk = np.cumsum(rng.normal(size=(1500, 3)), axis=0)
        return WaveletBSpline.fit(SampledSplice(t, walk), tolerance=0.5)
