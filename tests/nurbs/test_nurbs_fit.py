"""Fits from nothing: proved against the polyline, frugal, at any scale."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nurbs_cases import SMOOTH, chord_length, course, largest_deviation
from scipy.interpolate import BSpline, splprep

from multirep.errors import InvalidCurveError, ToleranceError, UnknownNameError
from multirep.representations import Nurbs
from multirep.sampled import SampledSplice
from multirep.testing.laws import check_fit
from multirep.testing.strategies import PlantedNurbs, planted_nurbs, polylines


def corners_of(curve: Nurbs) -> list[float]:
    knots, times = np.unique(np.asarray(curve.knots), return_counts=True)
    return [t for t in knots[times >= curve.degree].tolist() if 0 < t < 1]


@given(polylines(), st.sampled_from([1, 2, 3, 5]), st.sampled_from([1.0, 1e-2, 1e-5]))
def test_any_polyline_can_be_followed(
    line: tuple[np.ndarray, np.ndarray], degree: int, tolerance: float
) -> None:
    """At any tolerance above rounding: in the end every vertex can be a corner."""
    sampled = SampledSplice(*line)
    curve = check_fit(Nurbs, sampled, tolerance=tolerance, degree=degree)
    assert curve.size <= degree * len(sampled.t) + 60


def test_a_misspelt_option_is_named_with_the_right_one() -> None:
    """The nearest name is offered."""
    with pytest.raises(UnknownNameError, match="nurbs fit named 'degre'; did you mean 'degree'"):
        Nurbs.fit(SampledSplice([0, 1], [[0], [1]]), tolerance=1.0, degre=2)


@pytest.mark.parametrize("name", SMOOTH)
@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8])
def test_tolerances_from_coarse_to_fine(name: str, tolerance: float) -> None:
    """Never exceeded, whether above or below the detail of the data."""
    sampled = course(name, 601)
    curve = Nurbs.fit(sampled, tolerance=tolerance)
    assert largest_deviation(curve, sampled) <= tolerance


def searched_splprep(sampled: SampledSplice, error: float, degree: int = 3) -> int:
    """Return the fewest control points of FITPACK with that maximum error, s searched."""
    t, points = sampled.t, sampled.points
    grid = np.union1d(np.linspace(0, 1, 8001), t)
    line = sampled(grid)
    low, high, fewest = -12.0, 2.0, 10**9
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        for _ in range(18):
            middle = (low + high) / 2
            (knots, columns, _), _ = splprep(points.T, u=t, s=10**middle, k=degree)
            there = np.stack([BSpline(knots, c, degree)(grid) for c in columns], axis=1)
            if np.linalg.norm(there - line, axis=1).max() <= error:
                low, fewest = middle, min(fewest, len(knots) - degree - 1)
            else:
                high = middle
    return fewest


@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        *((name, 1e-2) for name in SMOOTH),
        ("bump", 1e-3),
        ("spiral", 1e-3),
        ("zigzag", 1e-3),
        pytest.param("doodle", 1e-3, marks=pytest.mark.slow),
    ],
)
def test_smooth_fits_need_fewer_control_points_than_fitpack(name: str, tolerance: float) -> None:
    """At the same maximum error against the polyline at most 0.95 times as many."""
    sampled = course(name, 2001)
    curve = Nurbs.fit(sampled, tolerance=tolerance)
    error = largest_deviation(curve, sampled)
    assert curve.size <= 0.95 * searched_splprep(sampled, error)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_counts_grow_with_the_right_power(degree: int) -> None:
    """A fit of degree p needs about tolerance^(-1 / (p + 1)) control points."""
    sampled = course("spiral", 20_001)
    counts = [
        Nurbs.fit(sampled, tolerance=tolerance, degree=degree).size - degree
        for tolerance in (1e-2, 1e-4)
    ]
    power = np.log(counts[1] / counts[0]) / np.log(100)
    assert power == pytest.approx(1 / (degree + 1), rel=0.25)


def test_smooth_courses_have_smooth_fits() -> None:
    """No corner is made where there is none."""
    for name in SMOOTH:
        for degree in (2, 3, 5):
            curve = Nurbs.fit(course(name, 30_001), tolerance=1e-3, degree=degree)
            assert not corners_of(curve)


def test_a_square_given_by_five_points() -> None:
    """Its corners are knots of full multiplicity, met to rounding; its sides are straight."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 0.0]])
    sampled = SampledSplice(chord_length(square), square)
    for degree in (1, 2, 3, 5):
        curve = Nurbs.fit(sampled, tolerance=1e-6, degree=degree)
        assert corners_of(curve) == pytest.approx([0.25, 0.5, 0.75])
        assert curve.size == 4 * degree + 1
        assert largest_deviation(curve, sampled) <= 1e-12


def test_corners_between_smooth_arcs() -> None:
    """Like a glyph: arcs stay smooth, corners are met all but exactly, at any sampling."""
    for count in (60, 400, 5000):
        u = np.linspace(0, 1, count + 1)
        arcs = [
            np.stack([np.cos(np.pi * u) + 2 * k, np.sin(np.pi * u)], axis=1)[::-1] for k in range(4)
        ]
        points = np.concatenate([arcs[0], *(arc[1:] for arc in arcs[1:])])
        sampled = SampledSplice(chord_length(points), points)
        tolerance = max(1e-3, 4 * (np.pi / count) ** 2 / 8)
        curve = Nurbs.fit(sampled, tolerance=tolerance)
        corners = corners_of(curve)
        assert corners == pytest.approx([0.25, 0.5, 0.75])
        assert np.abs(curve(corners) - [[1, 0], [3, 0], [5, 0]]).max() <= 1e-2 * tolerance
        assert curve.size <= 60


@settings(max_examples=25)
@given(planted_nurbs(degrees=(1, 2, 3, 5), rational=False, max_points=10))
def test_planted_curves_are_found_again(planted: PlantedNurbs) -> None:
    """Samples of a curve of few control points cost few more, or hardly more than FITPACK needs."""
    given_curve = Nurbs(degree=planted.degree, knots=planted.knots, points=planted.points)
    size = np.ptp(planted.points, axis=0).max()
    sampled = given_curve.sample(given_curve.domain, tolerance=1e-3 / 16 * size)
    curve = Nurbs.fit(sampled, tolerance=1e-3 * size, degree=planted.degree)
    assert largest_deviation(curve, sampled) <= 1e-3 * size + sampled.bound
    if curve.size > 3 * len(planted.points) + 8:  # sharp bends cost any free-knot spline dearly
        error = largest_deviation(curve, sampled)
        assert curve.size <= 1.25 * searched_splprep(sampled, error, planted.degree)


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_scale_does_not_matter(scale: float) -> None:
    """The same curve in other units has the same number of control points."""
    sampled = course("doodle", 801)
    expected = Nurbs.fit(sampled, tolerance=2e-3).size
    scaled = SampledSplice(sampled.t, sampled.points * scale)
    curve = Nurbs.fit(scaled, tolerance=2e-3 * scale)
    assert curve.size == pytest.approx(expected, rel=0.1)
    assert largest_deviation(curve, scaled) <= 2e-3 * scale


def test_far_from_the_origin_and_other_domains() -> None:
    """An offset of 1e6 and a domain far from 0 cost no more than rounding."""
    sampled = course("spiral", 801)
    expected = Nurbs.fit(sampled, tolerance=1e-3).size
    far = SampledSplice(1e3 + 1e-2 * sampled.t, sampled.points + 1e6)
    curve = Nurbs.fit(far, tolerance=1e-3)
    assert curve.size <= 1.2 * expected
    assert largest_deviation(curve, far) <= 1e-3


@pytest.mark.parametrize("dimension", [1, 2, 3, 5])
def test_any_dimension(dimension: int) -> None:
    """Heights over t, planes, space and beyond."""
    t = np.linspace(0, 1, 301)
    points = np.stack([np.sin((k + 1) * 4 * t) for k in range(dimension)], axis=1)
    sampled = SampledSplice(t, points)
    curve = Nurbs.fit(sampled, tolerance=1e-3)
    assert curve.dimension == dimension
    assert largest_deviation(curve, sampled) <= 1e-3


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_very_uneven_parameters(degree: int) -> None:
    """Steps in t that differ by a factor of a million."""
    rng = np.random.default_rng(4)
    steps = 10 ** rng.uniform(-6, 0, 300)
    t = np.concatenate(([0.0], steps.cumsum()))
    t /= t[-1]
    walk = rng.normal(size=(301, 2)).cumsum(0)
    sampled = SampledSplice(t, walk)
    for tolerance in (3.0, 0.1, 1e-4):
        curve = Nurbs.fit(sampled, tolerance=tolerance, degree=degree)
        assert largest_deviation(curve, sampled) <= tolerance


def test_rough_courses() -> None:
    """A random walk, far above, at and below its detail."""
    rng = np.random.default_rng(1)
    walk = rng.normal(size=(3000, 2)).cumsum(0)
    sampled = SampledSplice(chord_length(walk), walk)
    counts = []
    for tolerance in (10.0, 1.0, 0.1, 1e-3):
        curve = Nurbs.fit(sampled, tolerance=tolerance)
        assert largest_deviation(curve, sampled) <= tolerance
        counts.append(curve.size)
    assert counts == sorted(counts)
    assert counts[-1] <= 3 * 3000


def test_what_the_sampler_left_may_be_used() -> None:
    """A fit may use the sum where single chords are certified better than the bound."""
    sampled = course("spiral", 2001)
    generous = SampledSplice(
        sampled.t, sampled.points, bound=9e-3, chord_bounds=np.zeros(len(sampled.t) - 1)
    )
    more = Nurbs.fit(generous, tolerance=1e-3)
    assert 1e-3 < largest_deviation(more, sampled) <= 1e-2
    assert more.size == Nurbs.fit(sampled, tolerance=1e-2).size


def test_the_smallest_courses() -> None:
    """Two points are a line of any degree; three may be one."""
    for degree in (1, 2, 3, 7):
        line = SampledSplice([0, 1], [[0.0, 0.0], [3.0, 4.0]])
        curve = Nurbs.fit(line, tolerance=1e-9, degree=degree)
        assert curve.size == degree + 1
        assert largest_deviation(curve, line) <= 1e-14
        three = SampledSplice([0, 0.5, 1], [[0.0], [1e-3], [0.0]])
        assert Nurbs.fit(three, tolerance=1e-2, degree=degree).size == degree + 1


def test_nonsense_is_refused() -> None:
    """Degrees that are none, and tolerances below rounding, with what can be reached."""
    sampled = course("bump", 101)
    for degree in (0, 26):
        with pytest.raises(InvalidCurveError, match="between 1 and 25"):
            Nurbs.fit(sampled, tolerance=1e-3, degree=degree)
    with pytest.raises(InvalidCurveError, match="whole number"):
        Nurbs.fit(sampled, tolerance=1e-3, degree=2.5)  # type: ignore[arg-type]
    with pytest.raises(ToleranceError, match="rounding") as info:
        Nurbs.fit(sampled, tolerance=1e-16)
    reachable = info.value.reachable
    assert reachable is not None
    Nurbs.fit(sampled, tolerance=2 * reachable)


@pytest.mark.slow
def test_time_is_linear_in_the_samples() -> None:
    """Ten times as many samples of one curve cost at most 15 times as much."""
    from time import process_time

    times = []
    for count in (10_001, 100_001):
        sampled = course("doodle", count)
        best = np.inf
        for _ in range(3):
            begin = process_time()
            Nurbs.fit(sampled, tolerance=1e-3)
            best = min(best, process_time() - begin)
        times.append(best)
    assert times[1] <= 15 * times[0]
