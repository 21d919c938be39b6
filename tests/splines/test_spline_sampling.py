"""Sampling: proved, frugal, and exact where it must be."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from multirep.splines import corner_parameters, evaluate, refine, sample_spline
from multirep.splines.arrays import Array
from multirep.splines.pieces import cut_stretch
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

FRACTIONS = st.integers(0, 64).map(lambda k: k / 64)


def curve(spline: DyadicSpline, t: Array) -> Array:
    values = evaluate(spline.knots, spline.coefficients, spline.degree, t)
    return values[:, :-1] / values[:, -1:] if spline.rational else values


def seen(spline: DyadicSpline, t: Array, points: Array) -> Array:
    shares = np.linspace(0, 1, 30)[:, None]
    at = t[:-1] + shares * np.diff(t)
    at[-1] = t[1:]
    line = points[:-1] + shares[..., None] * np.diff(points, axis=0)
    dense = curve(spline, at.ravel()).reshape(line.shape)
    return np.asarray(np.linalg.norm(dense - line, axis=2).max(axis=0))


def optimum(spline: DyadicSpline, tolerance: float) -> float:
    """Integrate ``sqrt(||R''|| / (8 tolerance))`` densely."""
    breaks = np.unique(spline.knots)
    fine = (np.arange(2000) + 0.5) / 2000
    t = (breaks[:-1, None] + np.diff(breaks)[:, None] * fine).ravel()
    widths = np.repeat(np.diff(breaks) / 2000, 2000)
    stretch = cut_stretch(
        spline.knots, spline.coefficients, spline.degree, 0.0, 1.0, spline.rational
    )
    return float((widths * np.sqrt(stretch.bending(t) / (8 * tolerance))).sum())


def clamped(inner: Array, degree: int) -> Array:
    return np.concatenate(([0.0] * (degree + 1), inner, [1.0] * (degree + 1)))


def uniform(count: int, degree: int) -> Array:
    return clamped(np.linspace(0, 1, count - degree + 1)[1:-1], degree)


def fractal(levels: int) -> DyadicSpline:
    """A cubic with detail at every level: many knots a chord."""
    rng = np.random.default_rng(1)
    knots, points = uniform(4, 3), np.array([(0, 0), (0.3, 1), (0.7, -1), (1, 0)])
    for level in range(levels):
        breaks = np.unique(knots)
        finer = np.sort(np.concatenate((knots, (breaks[1:] + breaks[:-1]) / 2)))
        points = refine(knots, points, 3, finer)
        points = points + rng.standard_normal(points.shape) * 0.1 * 0.5 ** (1.5 * level)
        knots = finer
    return DyadicSpline(knots, points, 3, False)


def smooth_curves() -> dict[str, DyadicSpline]:
    """Curves like those of the reference figures, without corners."""
    rng = np.random.default_rng(2)
    gentle = np.array([(0, 0), (1, 2), (3, 1), (4, -1), (6, 0), (7, 2), (9, 1)], dtype=float)
    angle = np.linspace(0, 8 * np.pi, 40)
    spiral = np.stack([np.cos(angle) * (1 + angle / 8), np.sin(angle) * (1 + angle / 8)], axis=1)
    cusp = [(0, 0), (1, 1), (2, 2), (3, 3), (3.05, 3), (3.1, 2.9), (4, 2), (5, 1), (6, 0)]
    walk = np.cumsum(rng.standard_normal((200, 2)), axis=0)
    weights = 10 ** rng.uniform(-0.5, 0.5, 20)[:, None]
    blob = np.concatenate((rng.standard_normal((20, 2)) * weights, weights), axis=1)
    return {
        "gentle": DyadicSpline(uniform(7, 3), gentle, 3, False),
        "spiral": DyadicSpline(uniform(40, 3), spiral, 3, False),
        "cusp": DyadicSpline(uniform(9, 3), np.array(cusp), 3, False),
        "fractal": fractal(10),
        "quintic": DyadicSpline(
            clamped(np.sort(rng.random(10)), 5), rng.standard_normal((16, 3)), 5, False
        ),
        "walk": DyadicSpline(clamped(np.sort(rng.random(196)), 3), walk, 3, False),
        "rational": DyadicSpline(uniform(20, 3), blob, 3, True),
    }


@given(
    dyadic_splines(rational=None),
    st.lists(FRACTIONS, min_size=2, max_size=2, unique=True),
    st.sampled_from([1.0, 1e-2, 1e-4]),
)
def test_samples_are_exact_and_chords_proved(
    spline: DyadicSpline, interval: list[float], tolerance: float
) -> None:
    """Ends and full knots are samples, points are the curve's, no chord leaves it farther."""
    start, stop = sorted(interval)
    t, points, bounds = sample_spline(
        spline.knots,
        spline.coefficients,
        spline.degree,
        start,
        stop,
        tolerance=tolerance,
        rational=spline.rational,
    )
    assert t[0] == start
    assert t[-1] == stop
    assert (t[1:] > t[:-1]).all()
    assert np.array_equal(points, curve(spline, t))
    assert (seen(spline, t, points) <= bounds).all()
    assert bounds.max() <= tolerance
    values, counts = np.unique(spline.knots, return_counts=True)
    full = values[(counts >= spline.degree) & (values > start) & (values < stop)]
    assert np.isin(full, t).all()


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("name", list(smooth_curves()))
def test_there_are_hardly_more_samples_than_the_optimum(name: str, tolerance: float) -> None:
    """At most 1.10 times the asymptotic optimum and one more, also with many knots a chord."""
    spline = smooth_curves()[name]
    best = optimum(spline, tolerance)
    t, _, bounds = sample_spline(
        spline.knots,
        spline.coefficients,
        spline.degree,
        0.0,
        1.0,
        tolerance=tolerance,
        rational=spline.rational,
    )
    assert len(t) - 1 <= 1.10 * best + 1
    assert bounds.max() <= tolerance


def test_a_sample_at_a_knot_is_the_curve_bit_for_bit() -> None:
    """From the right, as the curve is evaluated, although the stretch lies on the left."""
    spline = smooth_curves()["rational"]
    for knot in np.unique(spline.knots)[1:-1]:
        t, points, _ = sample_spline(
            spline.knots, spline.coefficients, 3, 0.0, float(knot), tolerance=0.1, rational=True
        )
        assert np.array_equal(points, curve(spline, t))


def test_corners_cost_no_more_than_a_sample_each() -> None:
    """Every smooth stretch is counted up to a whole chord."""
    rng = np.random.default_rng(4)
    knots = clamped(np.repeat(np.linspace(0, 1, 12)[1:-1], 3), 3)
    spline = DyadicSpline(knots, np.cumsum(rng.standard_normal((34, 2)), axis=0), 3, False)
    for tolerance in (1e-1, 1e-2, 1e-3):
        t, _, _ = sample_spline(knots, spline.coefficients, 3, 0.0, 1.0, tolerance=tolerance)
        assert len(t) - 1 <= 1.05 * optimum(spline, tolerance) + 11


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_a_straight_line_is_one_chord(degree: int) -> None:
    """However many knots it has."""
    knots = uniform(200, degree)
    greville = np.convolve(knots, np.full(degree, 1 / degree), "valid")[1:-1]
    points = np.outer(greville, [3.0, -4.0]) + np.array([1.0, 2.0])
    t, _, bounds = sample_spline(knots, points, degree, 0.125, 0.875, tolerance=1e-9)
    assert t.tolist() == [0.125, 0.875]
    assert bounds[0] <= 1e-12


def test_a_polygon_is_sampled_at_its_vertices() -> None:
    """Degree 1 is exact; the bound is what rounding may do."""
    knots = np.array([0, 0, 0.25, 0.5, 1, 1])
    points = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, -1.0], [3.0, 0.0]])
    t, there, bounds = sample_spline(knots, points, 1, 0.125, 1.0, tolerance=1e-9)
    assert t.tolist() == [0.125, 0.25, 0.5, 1.0]
    assert there.tolist() == [[0.5, 0.5], [1.0, 1.0], [2.0, -1.0], [3.0, 0.0]]
    assert bounds.max() <= 1e-13


def test_the_count_grows_with_the_root_of_the_accuracy() -> None:
    """A hundred times finer needs ten times as many."""
    spline = smooth_curves()["spiral"]
    counts = [
        len(sample_spline(spline.knots, spline.coefficients, 3, 0.0, 1.0, tolerance=tolerance)[0])
        for tolerance in (1e-2, 1e-4, 1e-6)
    ]
    assert np.array(counts[1:]) / counts[:-1] == pytest.approx([10, 10], rel=0.05)


@pytest.mark.parametrize("size", [1e-12, 1e-6, 1e6, 1e12])
def test_sampling_does_not_depend_on_the_units(size: float) -> None:
    """The same parameters for the same curve, a power of ten larger, up to rounding."""
    spline = smooth_curves()["cusp"]
    t, _, _ = sample_spline(spline.knots, spline.coefficients, 3, 0.0, 1.0, tolerance=1e-3)
    scaled, _, bounds = sample_spline(
        spline.knots, spline.coefficients * size, 3, 0.0, 1.0, tolerance=1e-3 * size
    )
    assert scaled == pytest.approx(t, abs=1e-9)
    assert bounds.max() <= 1e-3 * size


def test_far_from_the_origin_the_count_stays() -> None:
    """An offset of a million sizes."""
    spline = smooth_curves()["spiral"]
    near = sample_spline(spline.knots, spline.coefficients, 3, 0.0, 1.0, tolerance=1e-4)
    far = sample_spline(spline.knots, spline.coefficients + 1e7, 3, 0.0, 1.0, tolerance=1e-4)
    assert abs(len(far[0]) - len(near[0])) <= 2
    assert far[2].max() <= 1e-4


def test_a_tolerance_below_rounding_is_refused_with_the_numbers() -> None:
    """Never a result out of tolerance, never an endless loop."""
    spline = smooth_curves()["gentle"]
    for tolerance in (1e-15, 1e-30):
        with pytest.raises(ValueError, match=r"out of reach: rounding of coordinates up to 9 "):
            sample_spline(spline.knots, spline.coefficients, 3, 0.0, 1.0, tolerance=tolerance)
    with pytest.raises(ValueError, match="out of reach"):
        sample_spline(np.array([0.0, 0, 1, 1]), np.eye(2), 1, 0.0, 1.0, tolerance=1e-17)


def test_just_above_rounding_still_works() -> None:
    """The smallest tolerances that are accepted are met."""
    knots, points = uniform(4, 3), np.array([[0.0, 0.0], [1e-9, 1e-9], [2e-9, 0.0], [1.0, 1.0]])
    _, _, bounds = sample_spline(knots, points, 3, 0.25, 0.2500001, tolerance=2e-14)
    assert bounds.max() <= 2e-14


def test_corners_are_where_the_derivative_jumps() -> None:
    """And not where a smooth curve merely has a knot of full multiplicity."""
    rng = np.random.default_rng(7)
    knots = clamped(np.sort(rng.random(5)), 3)
    points = rng.standard_normal((9, 2)) * 100 + 1e4
    smooth = np.sort(np.concatenate((knots, [0.3] * 3, [0.6] * 3)))
    refined = refine(knots, points, 3, smooth)
    assert corner_parameters(smooth, refined, 3, 0.0, 1.0).tolist() == []
    bent = refined.copy()
    bent[np.searchsorted(smooth, 0.6) - 1] += 0.1
    assert corner_parameters(smooth, bent, 3, 0.0, 1.0).tolist() == [0.6]
    assert corner_parameters(smooth, bent, 3, 0.6, 1.0).tolist() == []
    weights = 10 ** rng.uniform(-1, 1, 9)[:, None]
    rational = refine(knots, np.concatenate((points * weights, weights), axis=1), 3, smooth)
    assert corner_parameters(smooth, rational, 3, 0.0, 1.0, rational=True).tolist() == []


@given(dyadic_splines(degrees=(1, 3), rational=None))
def test_corners_are_knots_with_two_different_derivatives(spline: DyadicSpline) -> None:
    """Evaluated from both sides."""
    assume(len(spline.knots) > 2 * spline.degree + 2)
    knots, coefficients, p, rational = spline
    corners = corner_parameters(knots, coefficients, p, 0.0, 1.0, rational=rational)
    for knot in np.unique(knots[p + 1 : -p - 1]):
        sides = []
        for side in ("left", "right"):
            point = evaluate(knots, coefficients, p, [knot], side=side)[0]
            slope = evaluate(knots, coefficients, p, [knot], order=1, side=side)[0]
            if rational:
                slope = (slope[:-1] - slope[-1] * point[:-1] / point[-1]) / point[-1]
            sides.append(slope)
        assert (knot in corners) == (np.abs(sides[1] - sides[0]).max() > 1e-8)
