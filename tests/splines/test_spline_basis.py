"""Spans and basis functions against their definitions, on exactly representable grids."""

from fractions import Fraction
from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from multirep.splines import basis_functions, find_spans
from multirep.testing.reference import basis_function, exact
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

EPS = np.finfo(np.float64).eps
PARAMETERS = st.lists(st.integers(0, 64).map(lambda k: k / 64), min_size=1, max_size=6)


@given(dyadic_splines(), PARAMETERS, st.sampled_from(["left", "right"]))
def test_the_span_of_a_parameter_is_never_empty_and_holds_it(
    spline: DyadicSpline, t: list[float], side: Literal["left", "right"]
) -> None:
    """Closed on the side that is asked for, except at the ends of the domain."""
    spans = find_spans(spline.knots, spline.degree, t, side=side)
    for value, k in zip(t, spans, strict=True):
        low, high = spline.knots[k], spline.knots[k + 1]
        assert low < high
        assert low <= value <= high
        if side == "right" and value < 1:
            assert value < high
        if side == "left" and value > 0:
            assert low < value


def test_spans_of_parameters_outside_the_domain_are_the_outer_ones() -> None:
    """Also where a window's outer knots are not clamped."""
    knots = np.arange(8.0)
    assert find_spans(knots, 2, [-5.0, 1.0, 2.0, 5.0, 9.0]).tolist() == [2, 2, 2, 4, 4]


@given(dyadic_splines(degrees=(1, 4), max_inner=4), PARAMETERS)
def test_basis_functions_agree_with_the_recursion(spline: DyadicSpline, t: list[float]) -> None:
    """Cox-de Boor in exact fractions is the oracle."""
    knots, p = exact(spline.knots.tolist()), spline.degree
    spans = find_spans(spline.knots, p, t)
    values = basis_functions(spline.knots, p, t, spans)
    for row, value, k in zip(values, t, spans.tolist(), strict=True):
        true = [float(basis_function(knots, p, i, Fraction(value))) for i in range(k - p, k + 1)]
        assert row == pytest.approx(true, rel=32 * EPS, abs=0)


@given(dyadic_splines(), PARAMETERS)
def test_basis_functions_are_a_partition_of_unity(spline: DyadicSpline, t: list[float]) -> None:
    """Non-negative and summing to one; derivatives sum to nothing."""
    spans = find_spans(spline.knots, spline.degree, t)
    values = basis_functions(spline.knots, spline.degree, t, spans)
    assert (values >= 0).all()
    assert np.abs(values.sum(axis=1) - 1).max() <= 8 * EPS
    slopes = basis_functions(spline.knots, spline.degree, t, spans, order=1)
    assert (np.abs(slopes.sum(axis=1)) <= 16 * EPS * np.abs(slopes).max(axis=1)).all()


@given(dyadic_splines(), PARAMETERS, st.integers(0, 6))
def test_derivatives_of_basis_functions_agree_with_scipy(
    spline: DyadicSpline, t: list[float], order: int
) -> None:
    """Of any order, above the degree too."""
    knots, coefficients, p, _ = spline
    spans = find_spans(knots, p, t)
    values = basis_functions(knots, p, t, spans, order=order)
    mine = np.einsum("mi,mid->md", values, coefficients[spans[:, None] + np.arange(-p, 1)])
    scipys = BSpline(knots, coefficients, p)(t, order)
    scale = 1 + np.abs(values).sum(axis=1, keepdims=True)
    assert (np.abs(mine - scipys) <= 1e3 * EPS * 4 * scale).all()


def test_far_from_the_left_end_of_a_long_knot_vector_nothing_is_lost() -> None:
    """A window of a knot vector gives the basis of the whole."""
    knots = np.concatenate(([0.0] * 3, np.arange(0, 1001) / 1000, [1.0] * 3))
    t = np.array([0.7123, 0.7131])
    spans = find_spans(knots, 3, t)
    window = slice(int(spans[0]) - 3, int(spans[1]) + 5)
    inside = find_spans(knots[window], 3, t)
    assert np.array_equal(
        basis_functions(knots, 3, t, spans), basis_functions(knots[window], 3, t, inside)
    )
