"""Fits are proved, frugal, and meet what a dense solver finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from multirep import Interval, SampledSplice
from multirep.bounds import spline_chord_deviation
from multirep.errors import ToleranceError, UnknownNameError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet.attempt import Frame, Problem
from multirep.representations.wavelet.target import Target


def free_problem(sampled: SampledSplice, tolerance: float) -> Problem:
    target = Target.of(sampled, tolerance)
    frame = Frame(np.zeros(3), np.ones(3), None, None)
    return Problem(target, Interval(0.0, 1.0), frame, 0.0, target.allowances)


@st.composite
def polylines(draw: st.DrawFn, most: int = 12) -> SampledSplice:
    """Vertices on the grid k/64 in both directions."""
    inner = draw(st.lists(st.integers(1, 63), max_size=most, unique=True))
    t = np.array([0, *sorted(inner), 64]) / 64
    rows = draw(
        st.lists(
            st.tuples(st.integers(-64, 64), st.integers(-64, 64)),
            min_size=len(t),
            max_size=len(t),
        )
    )
    return SampledSplice(t, np.array(rows) / 64)


knots = st.lists(st.integers(1, 255), max_size=20, unique=True).map(
    lambda inner: np.array([0, *sorted(inner), 256]) / 256
)


@given(polylines(), knots)
def test_an_attempt_is_the_dense_least_squares_solution(sampled, u):
    """Control points agree with numpy's least squares on the same weighted marks."""
    found = free_problem(sampled, 1.0).attempt(u)
    vector = np.r_[[u[0]] * 3, u, [u[-1]] * 3]
    quarters = (u[:-1, None] + np.diff(u)[:, None] * np.arange(4) / 4).ravel()
    marks = np.unique(np.r_[quarters, u[-1], sampled.t])
    gaps = np.diff(marks)
    root = np.sqrt(np.r_[gaps, 0.0] + np.r_[0.0, gaps])[:, None]
    basis = BSpline(vector, np.eye(len(u) + 2), 3)(marks)
    dense = np.linalg.lstsq(root * basis, root * sampled(marks), rcond=None)[0]
    scale = max(1.0, np.abs(dense).max())
    assert np.abs(found.points.T + sampled.points[0] - dense).max() <= 1e-9 * scale


@given(polylines(), knots)
def test_the_certificate_bounds_what_is_seen_and_little_more(sampled, u):
    """Span by span the proved deviation is above a dense look, and not far above it.

    Bernstein coefficients of a cubic exceed it five times at most (those of the Chebyshev
    polynomial do).
    """
    found = free_problem(sampled, 1.0).attempt(u)
    curve = BSpline(np.r_[[u[0]] * 3, u, [u[-1]] * 3], found.points.T, 3)
    for k, ratio in enumerate(found.ratios):
        t = np.union1d(np.linspace(u[k], u[k + 1], 400), sampled.t)
        t = t[(t >= u[k]) & (t <= u[k + 1])]
        seen = np.linalg.norm(curve(t) + sampled.points[0] - sampled(t), axis=1).max()
        assert seen <= ratio + 1e-12
        assert ratio <= 5.01 * seen + 1e-9
    assert found.bound == pytest.approx(found.ratios.max(), rel=1e-12)


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("relative", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
def test_fits_are_within_tolerance_by_an_independent_proof(dimension, relative):
    """A wave with a corner and a jump of curvature, at every tolerance; knots are sound."""
    t = np.r_[np.linspace(0, 0.4, 300), np.linspace(0.41, 1, 50)]
    rows = np.stack([np.sin((3 + k) * t) + np.abs(t - 1 / 3) for k in range(dimension)], axis=1)
    fitted = WaveletBSpline.fit(SampledSplice(t, rows), tolerance=relative)
    u = np.asarray(fitted.knots)
    assert (u[:4] == 0).all()
    assert (u[-4:] == 1).all()
    assert (np.diff(u[3:-3]) > 0).all()
    assert (u * 2.0**fitted.level == np.rint(u * 2.0**fitted.level)).all()
    proved = spline_chord_deviation(u, np.asarray(fitted.points), 3, t, rows, splits=4)
    assert proved.max() <= 1.002 * relative


def test_allowances_differ_chord_by_chord():
    """What the sampler left unused on a chord, the fit may use there, and only there."""
    t = np.linspace(0, 1, 201)
    rows = np.stack([np.sin(9 * t), np.abs(np.sin(14 * t))], axis=1)
    bounds = np.where(t[:-1] < 0.5, 0.1, 0.0)
    sampled = SampledSplice(t, rows, bound=0.1, chord_bounds=bounds)
    fitted = WaveletBSpline.fit(sampled, tolerance=1e-3)
    proved = spline_chord_deviation(fitted.knots[:], fitted.points[:], 3, t, rows, splits=4)
    assert (proved <= 1.002 * sampled.allowance(1e-3)).all()
    inner = fitted.knots[4:-4]
    assert np.count_nonzero(inner > 0.6) <= 12 < np.count_nonzero(inner < 0.5)


def test_straight_lines_need_four_control_points():
    """However many vertices lie on them."""
    t = np.linspace(0, 1, 1000) ** 2
    fitted = WaveletBSpline.fit(SampledSplice(t, np.c_[t, 3 * t]), tolerance=1e-9)
    assert (fitted.size, fitted.level) == (4, 0)


@pytest.mark.parametrize(("sharpness", "most"), [(1.0, 7), (1e3, 7), (1e6, 7)])
def test_a_corner_needs_three_knots(sharpness, most):
    """However sharp it is compared with the tolerance."""
    sampled = SampledSplice([0, 0.3, 1], [[0, 0], [0.3, 0.3 * sharpness], [1, 0]])
    fitted = WaveletBSpline.fit(sampled, tolerance=1e-3)
    assert fitted.size <= most


def test_a_spike_of_two_chords_is_followed():
    """Two chords up and down within 2e-9 of T take few knots, above level 30."""
    t = np.array([0, 0.3, 0.3 + 1e-9, 0.3 + 2e-9, 1])
    fitted = WaveletBSpline.fit(
        SampledSplice(t, np.array([0, 0, 1, 0, 0.0])[:, None]), tolerance=1e-2
    )
    assert fitted.level > 30
    assert fitted.size < 30
    assert fitted(t[2]) == pytest.approx(1.0, abs=1e-2)


def test_wild_data_are_followed():
    """A corner at every vertex: two to three control points a vertex."""
    rng = np.random.default_rng(5)
    t = np.r_[0, np.sort(rng.uniform(0, 1, 998)), 1]
    walk = np.cumsum(rng.normal(size=(1000, 2)), axis=0)
    fitted = WaveletBSpline.fit(SampledSplice(t, walk), tolerance=1e-2)
    assert fitted.size <= 3200


@pytest.mark.parametrize(
    ("tolerance", "most"), [(1e-2, 28), (1e-3, 38), (1e-4, 70), (1e-5, 135), (1e-6, 255)]
)
def test_smooth_fits_are_frugal(tolerance, most):
    """A smooth curve needs few control points, and their number grows as the fourth root."""
    t = np.linspace(0, 1, 30001)
    rows = np.stack([np.cos(20 * t), np.sin(27 * t)], axis=1)
    fitted = WaveletBSpline.fit(SampledSplice(t, rows), tolerance=tolerance)
    assert fitted.size <= most


def test_thinning_spares_what_halving_alone_leaves():
    """A fit from nothing has no knot to spare: hardly any can be taken out alone."""
    t = np.linspace(0, 1, 2001)
    sampled = SampledSplice(t, np.stack([np.cos(7 * t) + 0.02 * np.sin(60 * t), np.sin(9 * t)], 1))
    fitted = WaveletBSpline.fit(sampled, tolerance=1e-3)
    problem = free_problem(sampled, 1e-3)
    u = fitted.knots[3:-3]
    spare = [
        k for k in range(1, len(u) - 1) if problem.attempt(np.delete(u, k)).ratios.max() <= 1.0
    ]
    assert len(spare) <= 0.1 * len(u) + 1


def test_unreachable_tolerances_say_what_is_reachable():
    """Below rounding, or a jump within one unit in the last place: refused with numbers."""
    rough = SampledSplice([0, 0.5, 1], [[1e6], [1e6 + 1], [1e6]])
    with pytest.raises(ToleranceError, match="rounding") as caught:
        WaveletBSpline.fit(rough, tolerance=1e-12)
    assert caught.value.reachable > 1e-12
    WaveletBSpline.fit(rough, tolerance=4 * caught.value.reachable)
    t = np.linspace(0, 1, 500)
    with pytest.raises(ToleranceError, match="rounding"):
        WaveletBSpline.fit(SampledSplice(t, np.sin(9 * t)[:, None]), tolerance=1e-30)
    jump = SampledSplice([0, 0.3, np.nextafter(0.3, 1), 1], [[0], [0], [1], [1]])
    with pytest.raises(ToleranceError, match="reachable") as caught:
        WaveletBSpline.fit(jump, tolerance=1e-3)
    assert caught.value.where == pytest.approx(0.3)
    assert 1e-3 < caught.value.reachable < 1.0


def test_fits_take_no_options():
    """An unknown option is named."""
    with pytest.raises(UnknownNameError, match="wavelet fit named 'degree'"):
        WaveletBSpline.fit(SampledSplice([0, 1], [[0], [1]]), tolerance=1.0, degree=3)


def test_fits_over_any_domain_map_the_knots():
    """T = [-7, 5]: the same shape, the knots moved, the ends exact."""
    t = np.linspace(0, 1, 301)
    rows = np.stack([np.cos(6 * t), t], axis=1)
    one = WaveletBSpline.fit(SampledSplice(t, rows), tolerance=1e-4)
    two = WaveletBSpline.fit(SampledSplice(-7 + 12 * t, rows), tolerance=1e-4)
    assert two.domain == Interval(-7.0, 5.0)
    assert np.abs(np.asarray(two.knots) - (-7 + 12 * np.asarray(one.knots))).max() <= 1e-14
    assert np.abs(two(-7 + 12 * t) - one(t)).max() <= 1e-12
