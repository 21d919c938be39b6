"""Certified deviations: never below what is seen, and hardly above."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.splines import evaluate
from multirep.splines.arrays import Array
from multirep.splines.curvature import second_derivative_bound
from multirep.splines.deviation import spline_chord_deviation
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

FRACTIONS = st.integers(0, 64).map(lambda k: k / 64)
ROOT = float(np.sqrt(0.5))
CIRCLE_KNOTS = np.array([0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1])
CIRCLE_WEIGHTS = np.array([1, ROOT, 1, ROOT, 1, ROOT, 1, ROOT, 1])
CIRCLE_POINTS = np.array(
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)], dtype=float
)
CUBIC_KNOTS = np.array([0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1])
CUBIC_POINTS = np.array([(0, 0), (1, 2), (3, 1), (4, -1), (6, 0), (7, 2), (9, 1)], dtype=float)


def curve(spline: DyadicSpline, t: Array) -> Array:
    values = evaluate(spline.knots, spline.coefficients, spline.degree, t)
    return values[:, :-1] / values[:, -1:] if spline.rational else values


def seen(spline: DyadicSpline, t: Array, points: Array, count: int = 40) -> Array:
    """Look at many parameters of every chord and keep the largest distance of each."""
    shares = np.linspace(0, 1, count)[:, None]
    at = t[:-1] + shares * np.diff(t)
    at[-1] = t[1:]
    line = points[:-1] + shares[..., None] * np.diff(points, axis=0)
    dense = curve(spline, at.ravel()).reshape(line.shape)
    return np.asarray(np.linalg.norm(dense - line, axis=2).max(axis=0))


@given(
    dyadic_splines(rational=None),
    st.lists(FRACTIONS, min_size=2, max_size=8, unique=True),
    st.integers(0, 3),
    st.sampled_from([0.0, 1 / 64, 2.0]),
    st.sampled_from([0.0, 1e6]),
)
def test_no_point_is_farther_than_the_bound(
    spline: DyadicSpline, t: list[float], splits: int, noise: float, offset: float
) -> None:
    """Any knots, any chords, on the curve or off it; with an allowance too."""
    coefficients = spline.coefficients.copy()
    if spline.rational:
        coefficients[:, :-1] += offset * coefficients[:, -1:]
    else:
        coefficients += offset
    spline = spline._replace(coefficients=coefficients)
    at = np.sort(np.array(t))
    points = curve(spline, at)
    points += noise * np.cos(np.arange(points.size)).reshape(points.shape)
    true = seen(spline, at, points)
    for allowance in (None, np.inf, float(true.max()), 0.0):
        bound = spline_chord_deviation(
            spline.knots,
            spline.coefficients,
            spline.degree,
            at,
            points,
            rational=spline.rational,
            splits=splits,
            allowance=allowance,
        )
        assert (bound >= true).all()


@given(
    dyadic_splines(rational=None, degrees=(2, 4)),
    st.lists(FRACTIONS, min_size=8, max_size=20, unique=True),
)
def test_two_splits_bring_the_bound_close_to_the_truth(
    spline: DyadicSpline, t: list[float]
) -> None:
    """Within a tenth, wherever a weight does not change manifold within one chord."""
    at = np.unique(np.concatenate((np.sort(t), spline.knots)))
    at = np.unique(np.concatenate((at, (at[1:] + at[:-1]) / 2)))
    points = curve(spline, at)
    true = seen(spline, at, points, count=200).max()
    bound = spline_chord_deviation(
        spline.knots, spline.coefficients, spline.degree, at, points,
        rational=spline.rational, splits=2,
    )  # fmt: skip
    rounding = 1e-11
    assert bound.max() <= 1.1 * true + rounding


def test_the_published_figures_of_the_circle() -> None:
    """32 chords of the nine-point circle, certified after 0, 1 and 2 splits."""
    fixtures = json.loads(Path(__file__).with_name("bounds.json").read_text())
    homogeneous = np.column_stack((CIRCLE_POINTS * CIRCLE_WEIGHTS[:, None], CIRCLE_WEIGHTS))
    spline = DyadicSpline(CIRCLE_KNOTS, homogeneous, 2, True)
    t = np.linspace(0, 1, 33)
    points = curve(spline, t)
    for splits in range(3):
        bound = spline_chord_deviation(
            CIRCLE_KNOTS, homogeneous, 2, t, points, rational=True, splits=splits
        )
        assert bound.max() == pytest.approx(fixtures["circle"][f"splits {splits}"], rel=1e-9)
    assert seen(spline, t, points).max() == pytest.approx(fixtures["circle"]["true"], rel=1e-3)


def test_the_published_figures_of_a_cubic() -> None:
    """32 chords of a clamped uniform cubic: certificates and second derivatives."""
    fixtures = json.loads(Path(__file__).with_name("bounds.json").read_text())
    t = np.linspace(0, 1, 33)
    points = evaluate(CUBIC_KNOTS, CUBIC_POINTS, 3, t)
    for splits in range(2):
        bound = spline_chord_deviation(CUBIC_KNOTS, CUBIC_POINTS, 3, t, points, splits=splits)
        assert bound.max() == pytest.approx(fixtures["cubic"][f"splits {splits}"], rel=1e-9)
    second = second_derivative_bound(CUBIC_KNOTS, CUBIC_POINTS, 3)
    assert second == pytest.approx(fixtures["cubic"]["second derivative"], rel=1e-12)
    assert second.max() / 32**2 / 8 == pytest.approx(fixtures["cubic"]["sagitta"], rel=1e-12)
    cheap = spline_chord_deviation(CUBIC_KNOTS, CUBIC_POINTS, 3, t, points, allowance=1.0)
    true = fixtures["cubic"]["true"]
    assert true <= cheap.max() <= 1.01 * true


@given(dyadic_splines(degrees=(2, 5)))
def test_no_second_derivative_is_larger_than_its_bound(spline: DyadicSpline) -> None:
    """On each span; exact up to degree 3."""
    knots, points, p, _ = spline
    bounds = second_derivative_bound(knots, points, p)
    for i, bound in enumerate(bounds):
        low, high = knots[p + i], knots[p + i + 1]
        if low == high:
            assert bound == 0
            continue
        t = low + (high - low) * np.linspace(0, 1, 33)[:-1]
        values = np.linalg.norm(evaluate(knots, points, p, t, order=2), axis=1)
        left = evaluate(knots, points, p, [high], order=2, side="left")
        true = max(values.max(), float(np.linalg.norm(left)))
        assert bound >= true * (1 - 1e-9) - 1e-9
        if p <= 3:
            assert bound <= true * (1 + 1e-9) + 1e-9


def test_a_straight_line_has_no_second_derivative() -> None:
    """Degree 1 as well."""
    knots = np.array([0.0, 0, 0.5, 1, 1])
    assert second_derivative_bound(knots, np.array([[0.0], [3.0], [1.0]]), 1).tolist() == [0, 0]


def test_pieces_one_ulp_wide_are_no_special_case() -> None:
    """A sample beside a knot; a division by the piece's length would explode."""
    beside = 200 / 1000
    t = np.array([0, np.nextafter(beside, 0), beside, np.nextafter(beside, 1), 0.6, 1.0])
    knots = np.array([0, 0, 0, 0, beside, beside, 1, 1, 1, 1])
    points = np.array([(0, 0), (1, 2), (3, 1), (4, -1), (6, 0), (7, 2)], dtype=float)
    weights = np.array([1, 8, 0.125, 4, 1, 2.0])
    for coefficients, rational in (
        (points, False),
        (np.column_stack((points * weights[:, None], weights)), True),
    ):
        spline = DyadicSpline(knots, coefficients, 3, rational)
        samples = curve(spline, t)
        for allowance in (None, 10.0):
            bound = spline_chord_deviation(
                knots, coefficients, 3, t, samples, rational=rational, allowance=allowance
            )
            assert (bound >= seen(spline, t, samples)).all()
            assert bound[1:3].max() <= 1e-11


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_bounds_scale_with_the_coordinates(size: float) -> None:
    """No absolute threshold anywhere."""
    t = np.linspace(0, 1, 12)
    points = evaluate(CUBIC_KNOTS, CUBIC_POINTS, 3, t)
    for allowance in (None, 0.1):
        at_one = spline_chord_deviation(
            CUBIC_KNOTS, CUBIC_POINTS, 3, t, points, allowance=allowance
        )
        scaled = spline_chord_deviation(
            CUBIC_KNOTS,
            CUBIC_POINTS * size,
            3,
            t,
            points * size,
            allowance=None if allowance is None else allowance * size,
        )
        assert scaled == pytest.approx(at_one * size, rel=1e-12)


def test_the_bound_shrinks_with_the_square_of_the_spacing() -> None:
    """Halving the chords quarters it."""
    bounds = []
    for count in (64, 128, 256):
        t = np.linspace(0, 1, count + 1)
        points = evaluate(CUBIC_KNOTS, CUBIC_POINTS, 3, t)
        bounds.append(spline_chord_deviation(CUBIC_KNOTS, CUBIC_POINTS, 3, t, points).max())
    ratios = np.array(bounds[:-1]) / bounds[1:]
    assert ratios == pytest.approx([4, 4], rel=0.05)


def test_a_stretch_is_bounded_like_the_whole() -> None:
    """Chords far away do not matter (but for the rounding term)."""
    rng = np.random.default_rng(8)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(30)), [1.0] * 4))
    points = rng.standard_normal((34, 2))
    t = np.sort(rng.random(50))
    samples = evaluate(knots, points, 3, t)
    whole = spline_chord_deviation(knots, points, 3, t, samples)
    part = spline_chord_deviation(knots, points, 3, t[10:21], samples[10:21])
    assert part == pytest.approx(whole[10:20], abs=1e-12)
