"""The polyline as a value: refusals, evaluation, derivatives, nearest places, data."""

from __future__ import annotations

import pickle
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polyline_reference import dense, values
from polyline_reference import tiny_blocks as tiny_blocks

from multirep.arrays import Array
from multirep.errors import InvalidCurveError, ParameterError
from multirep.representations.polyline import Polyline
from multirep.testing.strategies import polylines

LINE = ([0.0, 1.0], [[0.0, 0.0], [1.0, 2.0]])


@pytest.mark.parametrize(
    ("t", "points", "message"),
    [
        ([0, 1], [[0, 0], [np.nan, 1]], r"point 1 is \[nan, 1.0\]"),
        ([0, 1], [[0, 0], [1, np.inf]], "finite"),
        ([0, 1], [[0, 0], [1, 1e300]], "below"),
        ([0, 1], [0, 1], r"shape \(n, d\).*got shape \(2,\)"),
        ([0, 1], np.empty((2, 0)), r"shape \(n, d\)"),
        ([0, 1], [[0, 0], [1]], "numbers in an array"),
        ([0, 1], [["a", "b"], ["c", "d"]], "numbers in an array"),
        ([0], [[0, 0]], "two distinct points or more, got 1"),
        ([], np.empty((0, 2)), "two distinct points or more, got 0"),
        ([0, 1, 2], [[1, 2], [1, 2], [1, 2]], r"got 3 times \[1.0, 2.0\]"),
        ([0, 1, 1], [[0, 0], [1, 1], [2, 2]], r"t\[1\] = .*1.0.* followed by"),
        ([0, 2, 1], [[0, 0], [1, 1], [2, 2]], "increase strictly"),
        ([0, np.nan, 1], [[0, 0], [1, 1], [2, 2]], r"t\[1\] is not"),
        ([0, 1], [[0, 0], [1, 1], [2, 2]], "expected 3 parameters"),
        ([[0], [1]], [[0, 0], [1, 1]], "expected 2 parameters"),
        (["x", 1], [[0, 0], [1, 1]], "parameters must be numbers"),
    ],
)
def test_bad_data_are_refused_with_the_numbers(t: object, points: object, message: str) -> None:
    """Every refusal of DESIGN section 10 names what was found."""
    with pytest.raises(InvalidCurveError, match=message):
        Polyline(t, points)  # type: ignore[arg-type]


@pytest.mark.parametrize("dimension", [1, 2, 3, 5])
def test_any_dimension(dimension: int) -> None:
    """Points may have any number of coordinates."""
    rows = np.arange(3.0 * dimension).reshape(3, dimension)
    polyline = Polyline([0, 1, 2], rows)
    assert polyline.dimension == dimension
    assert polyline(1.5).tolist() == (rows[1:].mean(axis=0)).tolist()
    assert polyline([0.5, 1.5]).shape == (2, dimension)


@given(polylines(max_size=40), st.randoms(use_true_random=False))
def test_evaluation_agrees_with_interp(data: tuple[Array, Array], random: Random) -> None:
    """Evaluation equals ``np.interp`` up to rounding, in any order of the parameters."""
    t, points = data
    polyline = Polyline(t, points)
    at = dense(t)
    shuffled = at.copy()
    random.shuffle(shuffled)
    np.testing.assert_allclose(polyline(at), values(t, points, at), rtol=0, atol=1e-14)
    assert polyline(shuffled)[shuffled.argsort(kind="stable")].tobytes() == polyline(at).tobytes()
    for s in at[:: max(1, len(at) // 9)]:
        assert polyline(s).tobytes() == polyline([s])[0].tobytes()


@given(polylines(max_size=12))
def test_a_vertex_evaluates_to_itself_bit_by_bit(data: tuple[Array, Array]) -> None:
    """At its parameters a polyline gives its vertices, for every split of the parameters."""
    t, points = data
    scaled = points * np.pi
    polyline = Polyline(t, scaled)
    assert polyline(t).tobytes() == np.asarray(polyline).tobytes()
    assert all(
        polyline(s).tobytes() == row.tobytes() for s, row in zip(t, polyline.points, strict=True)
    )


@pytest.mark.usefixtures("tiny_blocks")
def test_grouping_does_not_change_a_bit() -> None:
    """Many blocks, few parameters or many: the same values."""
    rng = np.random.default_rng(1)
    t = np.cumsum(rng.uniform(0.1, 1, 300))
    points = rng.normal(size=(300, 3))
    polyline = Polyline(t, points)
    at = rng.uniform(t[0], t[-1], 2000)
    one_by_one = np.array([polyline(s) for s in at])
    assert polyline(at).tobytes() == one_by_one.tobytes()
    assert polyline(at[:7]).tobytes() == one_by_one[:7].tobytes()
    np.testing.assert_allclose(one_by_one, values(t, points, at), atol=1e-13)
    assert polyline(np.empty(0)).shape == (0, 3)


def test_outside_the_domain_is_refused() -> None:
    """No extrapolation, and NaN is outside."""
    polyline = Polyline(*LINE)
    for t in (-0.1, 1.1, np.nan, [0.5, 2.0]):
        with pytest.raises(ParameterError, match="outside the domain"):
            polyline(t)


def test_negative_zeros_do_not_survive() -> None:
    """0.0 and -0.0 are one value, so that equal curves are equal bit by bit."""
    polyline = Polyline([-0.0, 1], [[-0.0, 1], [1, -0.0]])
    assert not np.signbit(np.asarray(polyline)).any()
    assert not np.signbit(polyline.move_vertex(0, [-0.0, 2]).value.points[0]).any()


@given(polylines(max_size=8))
def test_derivatives_are_the_slopes_on_either_side(data: tuple[Array, Array]) -> None:
    """Right and left derivatives differ at vertices only; higher ones vanish."""
    t, points = data
    polyline = Polyline(t, points)
    slopes = np.diff(points, axis=0) / np.diff(t)[:, None]
    assert polyline.derivative(t[:-1]).tolist() == slopes.tolist()
    assert polyline.derivative(t[1:], side="left").tolist() == slopes.tolist()
    middles = 0.5 * (t[1:] + t[:-1])
    assert polyline.derivative(middles, side="left").tolist() == slopes.tolist()
    assert polyline.derivative(t[0], side="left").tolist() == slopes[0].tolist()
    assert polyline.derivative(t[-1]).tolist() == slopes[-1].tolist()
    assert not polyline.derivative(t, order=2).any()
    assert polyline.derivative(t, order=0).tolist() == points.tolist()


def test_derivative_refuses_what_makes_no_sense() -> None:
    """A side is left or right; an order is not negative."""
    polyline = Polyline(*LINE)
    with pytest.raises(ValueError, match="'middle'"):
        polyline.derivative(0.5, side="middle")
    with pytest.raises(ValueError, match="-1"):
        polyline.derivative(0.5, order=-1)


@pytest.mark.usefixtures("tiny_blocks")
@given(polylines(max_size=60), st.tuples(st.integers(-300, 300), st.integers(-300, 300)))
def test_nearest_is_the_nearest_of_all_segments(
    data: tuple[Array, Array], at: tuple[int, int]
) -> None:
    """No segment is nearer than the answer, though whole blocks are never looked at."""
    t, points = data
    polyline = Polyline(t, points)
    point = np.array(at) / 64
    found = polyline.nearest(point)
    step, start = np.diff(points, axis=0), points[:-1]
    length = (step**2).sum(axis=1)
    u = ((point - start) * step).sum(axis=1) / np.where(length > 0, length, 1)
    feet = start + np.clip(u, 0, 1)[:, None] * step
    best = np.linalg.norm(feet - point, axis=1).min()
    assert found.distance == pytest.approx(best, rel=1e-12, abs=1e-14)
    assert found.point.tobytes() == polyline(found.t).tobytes()
    assert found.distance == pytest.approx(float(np.linalg.norm(found.point - point)))


def test_nearest_refuses_a_wrong_point() -> None:
    """The point must be finite and of the curve's dimension."""
    polyline = Polyline(*LINE)
    for point in ([0.0], [0, 0, 0], [np.nan, 0]):
        with pytest.raises(InvalidCurveError, match="2 coordinates"):
            polyline.nearest(point)


@given(polylines())
def test_data_come_back_bit_by_bit(data: tuple[Array, Array]) -> None:
    """Writing and reading, and pickling, give an equal value."""
    polyline = Polyline(data[0], data[1] * np.pi)
    copies = Polyline.from_dict(polyline.to_dict()), pickle.loads(pickle.dumps(polyline))
    for copy in copies:
        assert np.asarray(copy.t).tobytes() == np.asarray(polyline.t).tobytes()
        assert np.asarray(copy).tobytes() == np.asarray(polyline).tobytes()
        assert copy.domain == polyline.domain


def test_data_with_other_keys_are_refused() -> None:
    """Reading names what it found."""
    with pytest.raises(InvalidCurveError, match=r"\['knots', 't'\]"):
        Polyline.from_dict({"t": [0, 1], "knots": []})


def test_a_polyline_cannot_be_changed() -> None:
    """Neither fields nor arrays can be set, and the caller's array is a copy."""
    points = np.array([[0.0, 0.0], [1.0, 1.0]])
    polyline = Polyline([0, 1], points)
    points[0] = 7
    assert polyline.points[0].tolist() == [0, 0]
    with pytest.raises(AttributeError):
        polyline.t = polyline.t  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        polyline.points[0][0] = 1


def test_it_reads_like_an_array() -> None:
    """``np.asarray`` gives the vertices; the representation says what it is."""
    polyline = Polyline(*LINE)
    assert np.asarray(polyline).tolist() == LINE[1]
    assert np.asarray(polyline, dtype=np.float32).dtype == np.float32
    assert repr(polyline) == "Polyline(2 vertices in 2 coordinates over [0, 1])"
    assert (polyline.size, polyline.magnitude) == (2, 2.0)
