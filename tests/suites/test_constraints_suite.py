"""The built-in constraints pass the suite of constraints."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from multirep.constraints import (
    CornerConstraint,
    DerivativeConstraint,
    Freeze,
    Mark,
    PointConstraint,
)
from multirep.representations import Nurbs, Polyline
from multirep.testing import ConstraintSuite

NAN, INF = float("nan"), float("inf")


class OnNurbs(ConstraintSuite):
    @pytest.fixture
    def value(self) -> Nurbs:
        n, p = 20, 3
        knots = np.r_[[0.0] * p, np.linspace(0, 1, n - p + 1), [1.0] * p]
        u = np.linspace(0, 1, n)
        return Nurbs(degree=p, knots=knots, points=np.column_stack([4 * u, np.sin(6 * u)]))


class TestPoint(OnNurbs):
    malformed: ClassVar = [
        {"t": NAN, "point": (0, 0)},
        {"t": 0.5, "point": (0, INF)},
        {"t": "x", "point": (0, 0)},
        {"t": 0.5, "point": 3},
        {"t": 0.5},
    ]

    @pytest.fixture
    def constraint(self) -> PointConstraint:
        return PointConstraint(t=0.4321, point=(1.9, 0.8))


class TestPointAtTheStart(TestPoint):
    @pytest.fixture
    def constraint(self) -> PointConstraint:
        return PointConstraint(t=0.0, point=(-0.5, 0.25))


class TestDerivative(OnNurbs):
    malformed: ClassVar = [{"t": 0.5}, {"t": 0.5, "left": (NAN, 0)}, {"t": NAN, "left": (1, 0)}]

    @pytest.fixture
    def constraint(self) -> DerivativeConstraint:
        return DerivativeConstraint(t=0.4321, left=(4.0, 1.0), right=(4.0, 1.0))


class TestDerivativeOfOneSide(TestDerivative):
    @pytest.fixture
    def constraint(self) -> DerivativeConstraint:
        return DerivativeConstraint(t=0.4321, right=(4.0, -4.0))


class TestCorner(OnNurbs):
    malformed: ClassVar = [{"t": 0.5}, {"t": 0.5, "point": (0, NAN)}]

    @pytest.fixture
    def constraint(self) -> CornerConstraint:
        return CornerConstraint(t=0.4321, point=(1.9, 0.8), left=(2.0, 4.0), right=(2.0, -4.0))


class OnPolyline(ConstraintSuite):
    @pytest.fixture
    def value(self) -> Polyline:
        t = np.linspace(0, 1, 80)
        return Polyline(t, np.column_stack([4 * t, np.sin(6 * t)]))


class TestFreeze(OnPolyline):
    malformed: ClassVar = [
        {},
        {"interval": (0.5, 0.25)},
        {"interval": (0.5, NAN)},
        {"interval": (0.1, 0.2), "stroke": [[0, 0]], "radius": 1.0},
        {"stroke": [[0, 0]]},
        {"stroke": [[0, 0]], "radius": -1.0},
    ]

    @pytest.fixture
    def constraint(self) -> Freeze:
        return Freeze(interval=(0.3, 0.512345))


class TestPaintedFreeze(TestFreeze):
    @pytest.fixture
    def constraint(self) -> Freeze:
        return Freeze(stroke=[[1.0, 1.0], [2.0, 0.5]], radius=0.3)


class TestMark(OnPolyline):
    malformed: ClassVar = [{"interval": (0.5, 0.25)}, {"interval": 3}, {}]

    @pytest.fixture
    def constraint(self) -> Mark:
        return Mark(interval=(0.3, 0.7))
