"""The built-in constraints pass the suite of constraints."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.constraint import Constraint
from multirep.constraints import (
    CornerConstraint,
    DerivativeConstraint,
    Freeze,
    Mark,
    PointConstraint,
)
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing import ConstraintSuite

NAN, INF = float("nan"), float("inf")


def wavy(degree: int = 3, *, rational: bool = False) -> Nurbs:
    rng = np.random.default_rng(degree)
    n = 18
    inner = np.sort(rng.uniform(0, 1, n - degree - 1))
    knots = np.r_[[0.0] * (degree + 1), inner, [1.0] * (degree + 1)]
    x = np.linspace(0, 4, n)
    weights = 2.0 ** rng.uniform(-1, 1, n) if rational else None
    points = np.column_stack([x, np.sin(2 * x)])
    return Nurbs(degree=degree, knots=knots, points=points, weights=weights)


class LinearSuite(ConstraintSuite):
    @pytest.fixture
    def value(self) -> Nurbs:
        return wavy()


class TestPoint(LinearSuite):
    malformed: ClassVar = [
        {"t": NAN, "point": [0, 0]},
        {"t": 0.5, "point": [0, INF]},
        {"t": 0.5, "point": 3},
        {"t": "x", "point": [0, 0]},
        {"t": 0.5},
    ]

    @pytest.fixture
    def constraint(self) -> PointConstraint:
        return PointConstraint(t=0.4, point=(1.5, 2.0))


class TestPointAtAnEnd(LinearSuite):
    """The end of the curve moves there."""

    @pytest.fixture
    def constraint(self) -> PointConstraint:
        return PointConstraint(t=1.0, point=(5.0, 2.0))


class TestPointOnARationalCurve(TestPoint):
    @pytest.fixture
    def value(self) -> Nurbs:
        return wavy(2, rational=True)


class TestPointOfAPolygon(TestPoint):
    """Degree 1: between two vertices."""

    @pytest.fixture
    def value(self) -> Nurbs:
        return wavy(1)


class TestDerivative(LinearSuite):
    malformed: ClassVar = [
        {"t": 0.5},
        {"t": 0.5, "left": [NAN, 0]},
        {"t": INF, "left": [1, 0]},
        {"t": 0.5, "right": "ab"},
    ]

    @pytest.fixture
    def constraint(self) -> DerivativeConstraint:
        return DerivativeConstraint(t=0.6, left=(1.0, 2.0), right=(1.0, 2.0))


class TestOneSidedDerivative(TestDerivative):
    @pytest.fixture
    def constraint(self) -> DerivativeConstraint:
        return DerivativeConstraint(t=0.6, left=(1.0, 2.0))


class TestTwoDerivativesOnARationalCurve(TestDerivative):
    @pytest.fixture
    def value(self) -> Nurbs:
        return wavy(4, rational=True)

    @pytest.fixture
    def constraint(self) -> DerivativeConstraint:
        return DerivativeConstraint(t=0.6, left=(1.0, 2.0), right=(-3.0, 4.0))


class TestCorner(LinearSuite):
    malformed: ClassVar = [
        {"t": 0.5, "left": [1, 0]},
        {"t": 0.5, "point": [0, NAN]},
        {"t": 0.5, "point": [0, 0], "left": [NAN, 0]},
    ]

    @pytest.fixture
    def constraint(self) -> CornerConstraint:
        return CornerConstraint(t=0.5, point=(2.0, 1.0), left=(1.0, 9.0), right=(1.0, -9.0))


class TestCornerOnARationalCurve(TestCorner):
    @pytest.fixture
    def value(self) -> Nurbs:
        return wavy(3, rational=True)


class FrozenSuite(ConstraintSuite):
    """A constraint that the kernel keeps: it holds from the first and never enforces anything."""

    @pytest.fixture
    def value(self) -> Polyline:
        t = np.linspace(0, 1, 41)
        return Polyline(t, np.column_stack([4 * t, np.sin(6 * t)]))

    def test_the_residual_is_a_distance(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """It is 0: what is frozen is as it was."""
        assert constraint.residual(value) == 0.0

    def test_enforcing_makes_it_hold(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """There is nothing to enforce; what it freezes lies in its region."""
        edit = constraint.enforce(value, SpliceList([value.domain]), Scene())
        assert edit.value is value
        assert not edit.splices
        frozen = constraint.frozen(value)
        assert frozen
        assert constraint.region(value).contains(frozen.hull)

    def test_enforcing_stays_in_its_region(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """Trivially."""

    def test_enforcing_what_holds_changes_next_to_nothing(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """Likewise."""


class TestFreeze(FrozenSuite):
    malformed: ClassVar = [
        {},
        {"interval": (0.5, 0.2)},
        {"interval": (0.5, 0.5)},
        {"interval": (0.5, NAN)},
        {"interval": (0.1, 0.2, 0.3)},
        {"stroke": [[0, 0]]},
        {"radius": 1.0},
        {"stroke": [[0, 0]], "radius": 0.0},
        {"stroke": [[0, NAN]], "radius": 1.0},
        {"stroke": [], "radius": 1.0},
        {"stroke": [[0, 0]], "radius": 1.0, "interval": (0.1, 0.2)},
    ]

    @pytest.fixture
    def constraint(self) -> Freeze:
        return Freeze(interval=(0.3, 0.52))


class TestPaintedFreeze(TestFreeze):
    @pytest.fixture
    def constraint(self) -> Freeze:
        return Freeze(stroke=[[0.5, 0.9], [1.5, 0.9]], radius=0.3)


class TestMark(FrozenSuite):
    malformed: ClassVar = [{"interval": (1, 0)}, {"interval": 3}, {}]

    @pytest.fixture
    def constraint(self) -> Mark:
        return Mark(interval=(0.3, 0.52))
