from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import Interval
from multirep.representations.wavelet.dyadic import (
    FINEST_LEVEL,
    clusters,
    coarsest_between,
    finest_level,
    halves,
    level_counts,
    levels,
    parameters,
    starting,
)

dyadic = st.integers(0, 40).flatmap(
    lambda level: st.integers(0, 1 << level).map(lambda k: k / (1 << level))
)
pairs = st.tuples(dyadic, dyadic).filter(lambda pair: pair[0] < pair[1])


def level_of(u: float) -> int:
    """By definition, in exact fractions; 0 for both ends."""
    return Fraction(u).denominator.bit_length() - 1


@given(st.lists(dyadic, min_size=1))
def test_levels_are_exponents_of_reduced_fractions(numbers):
    """The level is that of the fraction in lowest terms."""
    expected = [level_of(u) for u in numbers]
    assert levels(np.array(numbers)).tolist() == expected
    assert level_counts(np.array(numbers)).tolist() == [expected.count(k) for k in range(53)]


@given(pairs)
def test_halves_lie_in_the_middle_half_and_are_coarse(pair):
    """A halving knot leaves a quarter on either side; few levels finer than the span's length."""
    start, stop = pair
    (middle,) = halves(np.array([start]), np.array([stop]))
    assert abs(middle - 0.5 * (start + stop)) <= 0.25 * (stop - start)
    assert level_of(middle) <= math.floor(-math.log2(stop - start)) + 2


@given(st.integers(0, 39), st.data())
def test_halves_of_dyadic_spans_are_their_middles(level, data):
    """A span [k, k + 1] / 2**l is halved exactly."""
    k = data.draw(st.integers(0, (1 << level) - 1))
    start, stop = k / (1 << level), (k + 1) / (1 << level)
    assert halves(np.array([start]), np.array([stop])) == 0.5 * (start + stop)


@given(st.floats(0, 1), st.floats(0, 1))
def test_coarsest_between_is_the_only_one_of_its_level(a, b):
    """It lies in the interval, and no coarser dyadic number does."""
    low, high = sorted((a, b))
    if high - low < 2.0**-40:
        return
    found = coarsest_between(low, high)
    assert low <= found <= high
    coarser = 2.0 ** (1 - level_of(found))
    if coarser <= 1.0:
        assert math.ceil(low / coarser) * coarser > high


@given(st.lists(st.floats(0.01, 0.99), min_size=1, max_size=8), st.floats(2.0**-36, 2.0**-5))
def test_clusters_stand_near_their_centres(centres, width):
    """Three knots to a centre, exact, each within half a width of its place."""
    found = clusters(np.array(centres), np.full(len(centres), width)).reshape(3, -1)
    for row, shift in zip(found, (-width, 0.0, width), strict=True):
        assert (np.abs(row - np.array(centres) - shift) <= 0.51 * width).all()
    assert (np.diff(found, axis=0) >= 0.5 * width).all()
    assert max(level_of(u) for u in found.ravel()) <= 3 - math.log2(width)


@given(pairs, st.floats(2.0**-36, 1.0), st.floats(2.0**-36, 1.0))
def test_starting_knots_ascend_between_the_ends(pair, first, last):
    """Both ends are there, all are distinct, and short first spans come three at a time."""
    start, stop = pair
    if stop - start < 2.0**-30:
        return
    knots = starting(start, stop, first, last)
    assert knots[0] == start
    assert knots[-1] == stop
    assert (np.diff(knots) > 0).all()
    if 6 * first < stop - start:
        assert np.diff(knots[:4]).max() <= 1.6 * first


@pytest.mark.parametrize("domain", [(0, 1), (-2, 3), (1e6, 1e6 + 1), (-1e-6, 1e-7), (5, 1e9)])
def test_parameters_keep_ends_and_order(domain):
    """Both ends are met exactly; the finest spans that are allowed stay apart."""
    interval = Interval(*map(float, domain))
    level = finest_level(interval)
    assert 0 <= level <= FINEST_LEVEL
    ends = parameters(np.array([0.0, 1.0]), interval)
    assert tuple(ends) == tuple(interval)
    for place in (0.0, 0.3, 0.7, 1.0 - 8 * 2.0**-level):
        near = round(place * 2**level) * 2.0**-level + np.arange(33) * 2.0 ** -(level + 2)
        assert (np.diff(parameters(near[near <= 1.0], interval)) > 0).all()
