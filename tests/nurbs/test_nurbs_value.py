"""The value: what is accepted, what it evaluates to, what it says about itself."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nurbs_cases import curves, random_curve, smooth_curve
from scipy.interpolate import BSpline

from multirep.errors import EditError, InvalidCurveError, ParameterError, ToleranceError
from multirep.interval import Interval
from multirep.representations import Nurbs
from multirep.testing.laws import check_same
from multirep.testing.reference import exact, rational_curve_point

CUBIC = {"degree": 3, "knots": [0, 0, 0, 0, 1, 1, 1, 1], "points": [[0, 0], [1, 2], [3, 2], [4, 0]]}


@given(curves(), st.lists(st.integers(0, 64), min_size=1, max_size=6))
def test_points_are_those_of_the_definition(curve: Nurbs, places: list[int]) -> None:
    """Against the recursion in exact fractions, at knots and between."""
    knots = exact(np.asarray(curve.knots).tolist())
    points = [exact(row) for row in np.asarray(curve.points).tolist()]
    weights = exact(np.asarray(curve.weights).tolist())
    p, n = curve.degree, curve.size
    for k in places:
        t = Fraction(k, 64)
        # The recursion closes the last span of the knot vector, not of the domain.
        window = slice(0, n + p + 1)
        if t == knots[n]:
            t = knots[n] - Fraction(1, 2**60)
        expected = rational_curve_point(knots[window], points, weights, p, t)
        found = curve(k / 64)
        error = max(abs(float(x) - y) for x, y in zip(expected, found, strict=True))
        assert error <= 1e-11


@given(curves(rational=False), st.integers(0, 4), st.sampled_from(["left", "right"]))
def test_derivatives_are_those_of_scipy(curve: Nurbs, order: int, side: str) -> None:
    """Of any order; at knots from the right, and from the left when asked."""
    spline = BSpline(np.asarray(curve.knots), np.asarray(curve.points), curve.degree)
    t = np.linspace(0, 1, 65)
    knots = np.unique(np.asarray(curve.knots))
    t = t[~np.isin(t, knots)]
    expected = spline(t, nu=order) if order <= curve.degree else np.zeros((len(t), curve.dimension))
    scale = 1 + np.abs(expected).max()
    assert np.abs(curve.derivative(t, order, side) - expected).max() <= 1e-9 * scale


def test_rational_derivatives_converge_as_differences_do() -> None:
    """Central differences of the points approach every order at second order."""
    rng = np.random.default_rng(2)
    knots = [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]
    curve = Nurbs(
        degree=4, knots=knots, points=rng.normal(size=(5, 3)), weights=[1, 0.3, 2, 0.7, 1.5]
    )
    t = np.linspace(0.1, 0.9, 9)
    for order in (1, 2, 3, 4, 6):
        errors = []
        for h in (1e-2, 5e-3):
            low, high = curve.derivative(t - h, order - 1), curve.derivative(t + h, order - 1)
            errors.append(np.abs((high - low) / (2 * h) - curve.derivative(t, order)).max())
        assert errors[0] > 3.5 * errors[1], order


def test_derivatives_at_a_corner_differ_by_side() -> None:
    """A knot of full multiplicity has a left and a right tangent; other knots have one."""
    corner = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 2, 2, 2], points=[[0], [1], [2], [1], [0]])
    assert corner.derivative(1.0, side="left") == 2.0
    assert corner.derivative(1.0, side="right") == -2.0
    assert corner.derivative([0.0, 2.0], side="left")[:, 0].tolist() == [2.0, -2.0]


@settings(max_examples=30)
@given(curves())
def test_one_parameter_or_many_give_the_same_bits(curve: Nurbs) -> None:
    """Scalar, sorted, unsorted and two-dimensional parameters agree bit by bit."""
    t = np.linspace(0, 1, 33)
    many = curve(t)
    assert (np.array([curve(s) for s in t]) == many).all()
    order = np.random.default_rng(0).permutation(33)
    assert (curve(t[order]) == many[order]).all()
    assert (curve(t.reshape(3, 11)) == many.reshape(3, 11, -1)).all()


def test_scattered_parameters_on_a_long_curve() -> None:
    """A few parameters far apart are not looked up by walking through everything between."""
    curve = smooth_curve(30_000)
    t = np.array([0.9, 0.1, 0.5, 0.1, 1.0, 0.0])
    spline = curve.to_scipy()
    assert np.abs(curve(t) - spline(t)).max() <= 1e-14
    assert curve(np.empty(0)).shape == (0, 2)
    assert curve.derivative(np.empty(0)).shape == (0, 2)


def test_outside_the_domain() -> None:
    """Parameters outside T are refused, also where an unclamped knot vector goes on."""
    curve = Nurbs(degree=1, knots=[0, 1, 2, 3], points=[[0.0], [1.0]])
    assert curve.domain == Interval(1, 2)
    for t in (0.5, 2.5, np.nan, [1.5, 3.0]):
        with pytest.raises(ParameterError, match="outside the domain"):
            curve(t)


def test_a_circle_is_a_circle() -> None:
    """Four rational quadratic arcs: every point has radius 1 to rounding, samples are certified."""
    corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    knots = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]) / 4
    circle = Nurbs(degree=2, knots=knots, points=corners, weights=[*[1, 0.5**0.5] * 4, 1])
    t = np.linspace(0, 1, 2001)
    assert np.abs(np.hypot(*circle(t).T) - 1).max() <= 4e-16
    for tolerance in (1e-1, 1e-3, 1e-6):
        sampled = circle.sample(circle.domain, tolerance=tolerance)
        inside = np.hypot(*sampled(t).T)
        assert inside.min() >= 1 - tolerance
        assert len(sampled.t) <= 1.3 * 2 * np.pi * 1.2 / np.sqrt(8 * tolerance) + 8


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"degree": 2.5}, "whole number"),
        ({"degree": 0}, "between 1 and 25"),
        ({"degree": 4}, "needs 5 control points"),
        ({"knots": [0, 0, 0, 0, 1, 1, 1]}, "need 8 knots, got 7"),
        ({"knots": [0, 0, 0, 0, 1, 1, 0.5, 1]}, "must not decrease; knot 6 is 0.5 after 1.0"),
        ({"knots": [0, 0, 0, 0, 0, 1, 1, 1]}, "at most 4 times"),
        ({"knots": [0, 0, 0, 0, 1, 1, 1, np.nan]}, r"knots must be finite; number \[7\]"),
        ({"points": [[0, 0], [1, np.inf], [3, 2], [4, 0]]}, r"control points must be finite"),
        ({"points": [0, 1, 2, 3]}, r"shape \(n, d\)"),
        ({"points": [[0, 0], [1], [3, 2], [4, 0]]}, "rows of equal length"),
        ({"weights": [1, 1, 0, 1]}, "weight 2 is 0.0"),
        ({"weights": [1, 1, -2, 1]}, "must be positive"),
        ({"weights": [1, 1]}, "need 4 weights"),
    ],
)
def test_bad_data_are_refused(change: dict[str, object], message: str) -> None:
    """Each with the numbers that are wrong and what is allowed."""
    with pytest.raises(InvalidCurveError, match=message):
        Nurbs(**{**CUBIC, **change})  # type: ignore[arg-type]


def test_interior_knots_stay_below_breaking_the_curve() -> None:
    """An interior knot may occur p times, not p + 1 times."""
    points = np.zeros((6, 1))
    Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 2, 2, 2, 2][:8], points=points[:5])
    with pytest.raises(InvalidCurveError, match=r"at most 2 times.*1.0 occurs 3 times"):
        Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1, 2, 2, 2], points=points)


def test_it_cannot_be_changed() -> None:
    """Neither the attributes nor the arrays; and what was passed in is not held on to."""
    points = np.array(CUBIC["points"], dtype=float)
    curve = Nurbs(degree=3, knots=CUBIC["knots"], points=points)  # type: ignore[arg-type]
    points[0] = 99
    assert curve.points[0].tolist() == [0, 0]
    with pytest.raises(AttributeError, match="immutable"):
        curve.degree = 2
    with pytest.raises(ValueError, match="read-only"):
        curve.points[0][0] = 1


@given(curves())
def test_data_survive(curve: Nurbs) -> None:
    """As plain data, and for polynomial curves through scipy, bit by bit."""
    check_same(curve, Nurbs.from_dict(curve.to_dict()))
    if not curve.is_rational:
        check_same(curve, Nurbs.from_scipy(curve.to_scipy()))


def test_data_are_checked() -> None:
    """Unknown and missing entries are named; rational curves do not fit into scipy."""
    with pytest.raises(InvalidCurveError, match="unknown \\['closed'\\]"):
        Nurbs.from_dict({**CUBIC, "closed": True})
    with pytest.raises(InvalidCurveError, match="missing \\['knots'\\]"):
        Nurbs.from_dict({"degree": 3, "points": CUBIC["points"]})
    rational = Nurbs(**CUBIC, weights=[1, 2, 1, 1])  # type: ignore[arg-type]
    with pytest.raises(EditError, match="scipy has no rational splines"):
        rational.to_scipy()
    flat = Nurbs.from_scipy(BSpline(np.array([0, 0, 1, 1.0]), np.array([1.0, 3.0]), 1))
    assert flat.dimension == 1
    assert flat(0.5) == 2.0


def test_what_it_says_about_itself() -> None:
    """Size, magnitude and whether it is rational; weights 1 are the same as none."""
    curve = Nurbs(**CUBIC, weights=[1, 1, 1, 1])  # type: ignore[arg-type]
    assert (curve.size, curve.magnitude, curve.is_rational) == (4, 4.0, False)
    assert np.asarray(curve.weights).tolist() == [1, 1, 1, 1]
    assert repr(curve) == (
        "<Nurbs 'nurbs': polynomial of degree 3, 4 control points in 2-D over [0, 1]>"
    )
    moved = curve.move_control_point(3, [-7, 0]).value
    assert moved.magnitude == 7.0
    assert moved.move_control_point(3, [0, 0]).value.magnitude == 3.0


@pytest.mark.parametrize("seed", range(10))
def test_samples_follow_the_curve(seed: int) -> None:
    """Certified on any stretch, with corners among the samples."""
    rng = np.random.default_rng(seed)
    curve, scale = random_curve(rng)
    start, stop = np.sort(rng.random(2)).tolist()
    for tolerance in (1e-1 * scale, 1e-4 * scale):
        sampled = curve.sample(Interval(start, stop), tolerance=tolerance)
        t = np.linspace(start, stop, 2001)
        off = np.linalg.norm(curve(t) - sampled(t), axis=1)
        assert off.max() <= sampled.bound <= tolerance
        knots, times = np.unique(np.asarray(curve.knots), return_counts=True)
        full = knots[(times >= curve.degree) & (knots > start) & (knots < stop)]
        assert sampled.breaks == tuple(full.tolist())
        assert np.isin(full, sampled.t).all()


def test_samples_below_rounding_are_refused() -> None:
    """The message says what rounding may cost."""
    curve = Nurbs(**CUBIC)  # type: ignore[arg-type]
    with pytest.raises(ToleranceError, match="out of reach"):
        curve.sample(curve.domain, tolerance=1e-17)
