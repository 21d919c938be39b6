"""The polyline passes the suite of representations, in two and three dimensions, short and long."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from multirep.representations import Polyline
from multirep.testing import RepresentationSuite


class TestPolyline(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> Polyline:
        rng = np.random.default_rng(5)
        t = np.r_[0.0, np.sort(rng.uniform(0, 1, 60)), 1.0]
        return Polyline(t, np.column_stack([np.cos(5 * t), np.sin(3 * t)]))


class TestLongPolyline(RepresentationSuite):
    """Several blocks of vertices, rough, over another T, in space."""

    finest: ClassVar = 1e-6

    @pytest.fixture
    def representation(self) -> Polyline:
        rng = np.random.default_rng(6)
        t = np.linspace(-2.0, 3.0, 9_000)
        walk = np.cumsum(rng.normal(size=(9_000, 3)), axis=0)
        return Polyline(t, walk)


class TestPolylineOfOneCoordinate(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> Polyline:
        return Polyline([0.0, 0.25, 0.5, 0.625, 1.0], [[0.0], [1.0], [1.0], [-1.0], [0.0]])
