"""Sampled splices: interpolation, the allowance, refusals."""

from __future__ import annotations

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.sampled import SampledSplice
from multirep.testing.strategies import dyadic_numbers, sampled_splices


@given(sampled_splices(dimension=3))
def test_a_vertex_comes_out_bit_by_bit(sampled: SampledSplice) -> None:
    """L at a sample parameter is the sample, whether asked alone or with others."""
    assert sampled(sampled.t).tobytes() == sampled.points.tobytes()
    for t, point in zip(sampled.t, sampled.points, strict=True):
        assert sampled(t).tobytes() == point.tobytes()


@pytest.mark.parametrize("seed", range(20))
def test_a_vertex_comes_out_bit_by_bit_off_the_grid(seed: int) -> None:
    """Also where the arithmetic of the chord would round, at the last vertex above all."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1e3, 1e3, 9))
    sampled = SampledSplice(t, rng.normal(size=(9, 3)) * 10.0 ** rng.integers(-9, 9, (9, 1)))
    assert sampled(t).tobytes() == sampled.points.tobytes()
    assert sampled(t[-1]).tobytes() == sampled.points[-1].tobytes()


@given(sampled_splices(), st.lists(dyadic_numbers(1024), min_size=1, max_size=20))
def test_interpolation_agrees_with_numpy(sampled: SampledSplice, u: list[float]) -> None:
    """In between, L is what numpy.interp says, up to rounding."""
    a, b = sampled.interval
    at = a + np.array(u) * (b - a)
    expected = np.stack([np.interp(at, sampled.t, column) for column in sampled.points.T], axis=1)
    np.testing.assert_allclose(sampled(at), expected, rtol=0, atol=1e-14)
    assert sampled(at[0]).shape == (2,)
    np.testing.assert_array_equal(sampled(at)[0], sampled(at[0]))


@given(sampled_splices(), dyadic_numbers())
def test_what_the_sampler_left_unused_the_fit_may_use(
    sampled: SampledSplice, tolerance: float
) -> None:
    """On every chord: the chord's own bound and the allowance make bound + tolerance together."""
    allowance = sampled.allowance(tolerance)
    assert allowance.shape == (len(sampled.t) - 1,)
    used = np.full_like(allowance, sampled.bound)
    if sampled.chord_bounds is not None:
        used = sampled.chord_bounds
    np.testing.assert_array_equal(
        used + allowance, np.full_like(allowance, sampled.bound + tolerance)
    )
    assert (allowance >= tolerance).all()


def test_a_sampled_splice_keeps_nobody_elses_array() -> None:
    """The arrays are read-only and do not follow the arrays that they were made of."""
    t, points = np.array([0.0, 1.0]), np.zeros((2, 2))
    sampled = SampledSplice(t, points)
    points[:] = 1.0
    t[0] = -5.0
    assert sampled.t.tolist() == [0.0, 1.0]
    assert sampled.points.tolist() == [[0.0, 0.0], [0.0, 0.0]]
    with pytest.raises(ValueError, match="read-only"):
        sampled.points[0] = 1.0
    with pytest.raises(attrs.exceptions.FrozenInstanceError):
        sampled.bound = 2.0  # type: ignore[misc]
    assert sampled.interval == Interval(0.0, 1.0)
    assert sampled.dimension == 2


@pytest.mark.parametrize(
    ("t", "points", "message"),
    [
        ([0, 1], [0, 1], "shape|need"),
        ([0, 1], [[0.0], [1.0], [2.0]], r"\(2,\) and \(3, 1\)"),
        ([0], [[0.0]], "2 samples or more, got 1"),
        ([[0, 1]], [[0.0], [1.0]], "need"),
        ([0, 0], [[0.0], [1.0]], "increase strictly"),
        ([1, 0], [[0.0], [1.0]], "increase strictly"),
        ([0, np.nan], [[0.0], [1.0]], "increase strictly"),
        ([0, 1], [[0.0], [np.nan]], "finite"),
        ([0, 1], [[0.0], [np.inf]], "finite"),
    ],
)
def test_malformed_samples_are_refused(t: object, points: object, message: str) -> None:
    """Wrong shapes, disorder and numbers that are not finite raise InvalidCurveError."""
    with pytest.raises(InvalidCurveError, match=message):
        SampledSplice(t, points)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("bound", "chords", "message"),
    [
        (-1.0, None, "0 or more, got -1.0"),
        (1.0, [0.5], r"3 samples has 2 chords, .* shape \(1,\)"),
        (1.0, [[0.5, 0.5]], r"shape \(1, 2\)"),
        (1.0, [0.5, 2.0], "the bound, which is 1.0; got 0.5 to 2.0"),
        (1.0, [-0.5, 1.0], "got -0.5 to 1.0"),
    ],
)
def test_malformed_certificates_are_refused(bound: float, chords: object, message: str) -> None:
    """A bound for each chord, none negative or above that of the whole."""
    with pytest.raises(InvalidCurveError, match=message):
        SampledSplice([0, 1, 2], np.zeros((3, 2)), bound, (), chords)  # type: ignore[arg-type]
