"""Points and derivatives of splines against scipy and the definition."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from multirep.splines import evaluate
from multirep.testing.reference import curve_point, exact, rational_curve_point
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

EPS = np.finfo(np.float64).eps
PARAMETERS = st.lists(st.integers(0, 64).map(lambda k: k / 64), min_size=1, max_size=8)


@given(dyadic_splines(), PARAMETERS, st.integers(0, 6))
def test_any_order_of_parameters_gives_what_scipy_gives(
    spline: DyadicSpline, t: list[float], order: int
) -> None:
    """Bit by bit, although only a window goes to scipy and sorted."""
    knots, coefficients, p, _ = spline
    expected = BSpline(knots, coefficients, p)(t, order)
    assert np.array_equal(evaluate(knots, coefficients, p, t, order=order), expected)


@given(dyadic_splines(degrees=(1, 4), rational=None, max_inner=4), PARAMETERS)
def test_points_agree_with_the_definition(spline: DyadicSpline, t: list[float]) -> None:
    """Exact fractions are the oracle, for rational splines too."""
    knots, p = exact(spline.knots.tolist()), spline.degree
    points = [exact(row) for row in spline.points.tolist()]
    values = evaluate(spline.knots, spline.coefficients, p, t)
    if spline.rational:
        values = values[:, :-1] / values[:, -1:]
    for value, row in zip(t, values, strict=True):
        if spline.rational:
            weights = exact(spline.weights.tolist())
            true = rational_curve_point(knots, points, weights, p, Fraction(value))
        else:
            true = curve_point(knots, points, p, Fraction(value))
        assert row == pytest.approx([float(x) for x in true], abs=64 * 4 * 64 * EPS)


@given(dyadic_splines(max_multiplicity=3), PARAMETERS, st.integers(0, 3))
def test_the_left_side_is_the_limit_from_the_left(
    spline: DyadicSpline, t: list[float], order: int
) -> None:
    """The reversed spline's right side is the left side, up to the sign of odd orders."""
    knots, coefficients, p, _ = spline
    left = evaluate(knots, coefficients, p, t, order=order, side="left")
    inner = [value for value in t if value > 0]
    mirrored = evaluate(1 - knots[::-1], coefficients[::-1], p, [1 - v for v in inner], order=order)
    chosen = left[[value > 0 for value in t]] * (-1) ** order
    scale = 1 + np.abs(mirrored).max(initial=0)
    assert np.abs(chosen - mirrored).max(initial=0) <= 1e-10 * scale


def test_both_sides_of_a_corner_have_their_own_derivative() -> None:
    """At a knot of full multiplicity the derivative jumps, the point does not."""
    knots = np.array([0, 0, 0.5, 1, 1])
    points = np.array([[0.0], [1.0], [0.0]])
    assert evaluate(knots, points, 1, [0.5], side="left") == evaluate(knots, points, 1, [0.5])
    assert evaluate(knots, points, 1, [0.5], order=1).tolist() == [[-2.0]]
    assert evaluate(knots, points, 1, [0.5], order=1, side="left").tolist() == [[2.0]]


def test_no_parameters_give_no_points() -> None:
    """The shape is kept."""
    knots = np.array([0.0, 0, 1, 1])
    assert evaluate(knots, np.zeros((2, 3)), 1, []).shape == (0, 3)


@pytest.mark.parametrize("size", [1e-12, 1.0, 1e12])
def test_read_only_arrays_of_any_size_are_evaluated(size: float) -> None:
    """Values are frozen in a representation."""
    knots = np.array([0.0, 0, 0, 1, 1, 1])
    points = np.array([[0.0, 1.0], [1.0, 3.0], [2.0, 5.0]]) * size
    knots.setflags(write=False)
    points.setflags(write=False)
    assert evaluate(knots, points, 2, [0.5]) == pytest.approx(np.array([[1.0, 3.0]]) * size)


def test_a_value_depends_on_its_local_knots_alone() -> None:
    """Whatever else is asked for, and however long the spline, it is bit-identical."""
    rng = np.random.default_rng(3)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(500)), [1.0] * 4))
    points = rng.standard_normal((504, 2))
    t = rng.random(40)
    together = evaluate(knots, points, 3, t)
    alone = np.concatenate([evaluate(knots, points, 3, [value]) for value in t])
    assert np.array_equal(together, alone)
    other = points.copy()
    other[:200] += 1
    far = t > knots[210]
    assert np.array_equal(evaluate(knots, other, 3, t[far]), together[far])
