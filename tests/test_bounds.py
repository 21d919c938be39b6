"""What a plugin author needs to prove a bound."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.bounds import (
    bernstein_bound,
    chord_deviation,
    rational_bernstein_bound,
    sagitta,
    sample_curve,
    spline_chord_deviation,
)
from multirep.splines.certificates import halving_matrix
from multirep.testing.reference import bernstein_value, exact

NUMBERS = st.integers(-256, 256).map(lambda k: k / 64)


def polynomials(weights: bool = False) -> st.SearchStrategy[list[float]]:
    numbers = st.integers(1, 256).map(lambda k: k / 64) if weights else NUMBERS
    return st.lists(numbers, min_size=4, max_size=4)


@given(st.lists(polynomials(), min_size=2, max_size=2), st.integers(0, 3))
def test_no_polynomial_exceeds_its_bernstein_bound(columns: list[list[float]], splits: int) -> None:
    """Evaluated exactly; more splits never make the bound worse."""
    coefficients = np.array([columns]).transpose(0, 2, 1)
    bound = bernstein_bound(coefficients, splits=splits)[0]
    for k in range(33):
        values = [float(bernstein_value(exact(column), Fraction(k, 32))) for column in columns]
        assert np.linalg.norm(values) <= bound * (1 + 1e-15)
    assert bernstein_bound(coefficients, splits=splits + 1)[0] <= bound * (1 + 1e-15)


@given(polynomials(), polynomials(weights=True), st.integers(0, 3))
def test_no_rational_exceeds_its_bound(
    numerator: list[float], weights: list[float], splits: int
) -> None:
    """With positive weights."""
    bound = rational_bernstein_bound(
        np.array(numerator)[None, :, None], np.array(weights)[None], splits=splits
    )[0]
    for k in range(33):
        t = Fraction(k, 32)
        value = bernstein_value(exact(numerator), t) / bernstein_value(exact(weights), t)
        assert abs(float(value)) <= bound * (1 + 1e-14)


@given(polynomials(), st.integers(0, 3))
def test_halving_keeps_the_polynomial(column: list[float], splits: int) -> None:
    """Dyadic coefficients are halved without any rounding."""
    parts = (halving_matrix(3, splits) @ np.array(column)).reshape(-1, 4)
    for i, part in enumerate(parts.tolist()):
        for share in (Fraction(0), Fraction(1, 2), Fraction(1)):
            t = (i + share) / len(parts)
            assert bernstein_value(exact(part), share) == bernstein_value(exact(column), t)


def test_the_sagitta_of_a_parabola_is_exact() -> None:
    """Equality holds."""
    assert sagitta(0.5, 2.0) == 0.0625
    assert sagitta([1.0, 2.0], [2.0, 2.0]).tolist() == [0.25, 1.0]


def test_a_polyline_off_the_curve_is_charged_for_its_vertices() -> None:
    """The deviation at the vertices and the sagitta add up at most."""
    t = np.linspace(0, 1, 9)
    wave = np.stack([np.cos(t), np.sin(t)], axis=1)
    points = wave + 0.01
    bound = chord_deviation(t, points, wave, 1.0)
    dense = np.linspace(0, 1, 801)
    line = np.stack([np.interp(dense, t, column) for column in points.T], axis=1)
    true = np.linalg.norm(np.stack([np.cos(dense), np.sin(dense)], axis=1) - line, axis=1)
    assert true.max() <= bound.max() <= 0.01 * np.sqrt(2) + 1 / 64 / 8 + 1e-9


def test_either_end_of_a_chord_counts() -> None:
    """One vertex off the curve raises the bound of both its chords."""
    t = np.array([0.0, 1.0, 2.0, 3.0])
    line = np.stack([t, t], axis=1)
    points = line + np.array([[0, 0], [0, 0], [0, 1], [0, 0]])
    assert chord_deviation(t, points, line, 0.0) == pytest.approx([0, 1, 1], abs=1e-12)


@pytest.mark.parametrize("tolerance", [1e-1, 1e-3, 1e-5, 1e-7])
def test_any_curve_is_sampled_by_its_second_derivative(tolerance: float) -> None:
    """A corner at 1 is a sample; the count is near the optimum."""

    def curve(t: np.ndarray) -> np.ndarray:
        return np.stack([t, np.abs(t - 1) + np.exp(t)], axis=1)

    t, points, bounds = sample_curve(
        curve, lambda a, b: np.exp(b), 0.0, 2.0, tolerance=tolerance, corners=[1.0]
    )
    assert 1.0 in t
    assert (t[1:] > t[:-1]).all()
    assert np.array_equal(points, curve(t))
    assert bounds.max() <= tolerance
    best = 2 * (np.exp(1) - 1) / np.sqrt(8 * tolerance)
    assert len(t) - 1 <= 1.5 * best + 2
    shares = np.linspace(0, 1, 20)[:, None]
    dense = t[:-1] + shares * np.diff(t)
    line = points[:-1] + shares[..., None] * np.diff(points, axis=0)
    true = np.linalg.norm(curve(dense.ravel()).reshape(line.shape) - line, axis=2).max(axis=0)
    assert (true <= bounds).all()


def test_sampling_below_rounding_is_refused() -> None:
    """The message says what rounding costs."""
    for tolerance in (1e-11, 1e-300):
        with pytest.raises(ValueError, match=r"out of reach: rounding .* up to 1e\+06 alone"):
            sample_curve(
                lambda t: np.stack([t, t**2], axis=1) + 1e6,
                lambda a, b: 2.0,
                0.0,
                1.0,
                tolerance=tolerance,
            )


def test_a_plugin_proves_a_bezier_curve_in_one_call() -> None:
    """Bezier pieces are a spline with knots of multiplicity p."""
    knots = np.repeat([0.0, 0.5, 1.0], [4, 3, 4])
    points = np.array([(0, 0), (0, 1), (1, 1), (1, 0), (1, -1), (2, -1), (2, 0)], dtype=float)
    t = np.array([0.0, 0.5, 1.0])
    bound = spline_chord_deviation(knots, points, 3, t, points[::3], splits=3)
    assert bound == pytest.approx([0.75, 0.75], rel=0.01)
