"""NURBS of several degrees, polynomial and rational, pass the suite of representations."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from multirep.representations import Nurbs
from multirep.testing import RepresentationSuite


def wavy(degree: int, n: int, dimension: int) -> Nurbs:
    rng = np.random.default_rng(degree)
    inner = np.sort(rng.uniform(0, 1, n - degree - 1))
    knots = np.r_[[0.0] * (degree + 1), inner, [1.0] * (degree + 1)]
    greville = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(n)])
    rates = 3.0 + np.arange(dimension)
    points = np.sin(rates * greville[:, None]) + 0.02 * rng.normal(size=(n, 1))
    return Nurbs(degree=degree, knots=knots, points=points)


class TestCubicNurbs(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> Nurbs:
        return wavy(3, 24, 2)


class TestLinearNurbs(RepresentationSuite):
    fit_options: ClassVar = {"degree": 1}

    @pytest.fixture
    def representation(self) -> Nurbs:
        return wavy(1, 30, 2)


class TestQuadraticNurbs(RepresentationSuite):
    fit_options: ClassVar = {"degree": 2}

    @pytest.fixture
    def representation(self) -> Nurbs:
        return wavy(2, 20, 3)


class TestQuinticNurbs(RepresentationSuite):
    fit_options: ClassVar = {"degree": 5}

    @pytest.fixture
    def representation(self) -> Nurbs:
        return wavy(5, 20, 2)


class TestRationalNurbs(RepresentationSuite):
    """A full circle of four quadratic arcs: double interior knots, weights 1 and 1/sqrt 2."""

    @pytest.fixture
    def representation(self) -> Nurbs:
        corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
        knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4
        return Nurbs(degree=2, knots=knots, points=corners, weights=[*[1, 0.5**0.5] * 4, 1])


class TestRationalCubicNurbs(RepresentationSuite):
    """Weights from 1/4 to 4, unclamped knots, a repeated knot inside, in space."""

    @pytest.fixture
    def representation(self) -> Nurbs:
        rng = np.random.default_rng(8)
        knots = [-0.3, -0.2, -0.05, 0, 0.1, 0.25, 0.25, 0.25, 0.5, 0.6, 0.8, 1, 1.1, 1.2, 1.5]
        points = np.cumsum(rng.uniform(-1, 1.5, (11, 3)), axis=0)
        return Nurbs(degree=3, knots=knots, points=points, weights=2.0 ** rng.uniform(-2, 2, 11))
