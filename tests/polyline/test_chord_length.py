"""Chord-length parameters: proportional, strictly increasing whatever the points are."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.representations.polyline import Polyline, chord_length
from multirep.testing.strategies import strokes


@given(strokes())
def test_parameters_are_in_proportion_to_length(points: Array) -> None:
    """Merging repeats and summing lengths the slow way gives the same parameters."""
    rows = [points[0]]
    rows += [b for a, b in pairwise(points) if (a != b).any()]
    lengths = [0.0]
    for a, b in pairwise(rows):
        lengths.append(lengths[-1] + float(np.hypot(*(b - a))))
    t, kept, merged = chord_length(points)
    assert kept.tolist() == np.array(rows).tolist()
    assert merged == len(points) - len(rows)
    np.testing.assert_allclose(t, np.array(lengths) / lengths[-1], atol=1e-14)


@given(
    st.lists(st.integers(-320, 320), min_size=1, max_size=60),
    st.sampled_from([(0.0, 1.0), (-3.0, 5.0), (1e6, 1e6 + 1), (-1e-9, 1e-9)]),
)
def test_parameters_increase_strictly_for_segments_of_any_length(
    exponents: list[int], domain: tuple[float, float]
) -> None:
    """Segments from 1e-96 to 1e96 side by side: the parameters stay apart, with room between."""
    steps = [10.0 ** (0.3 * e) for e in exponents]
    steps = [s * (-1) ** k for k, s in enumerate(steps)]
    points = np.stack([np.cumsum([0.0, *steps]), np.zeros(len(steps) + 1)], axis=1)
    t = chord_length(points, domain=Interval(*domain)).t
    assert (t[0], t[-1]) == domain
    middles = 0.5 * (t[1:] + t[:-1])
    assert (t[:-1] < middles).all()
    assert (middles < t[1:]).all()


@pytest.mark.parametrize("scale", [1e-150, 1e-12, 1.0, 1e12, 1e140])
def test_parameters_do_not_depend_on_the_scale(scale: float) -> None:
    """Tiny and huge coordinates neither underflow nor overflow."""
    points = np.array([[0, 0], [3, 4], [3, 5], [0, 5]])
    np.testing.assert_allclose(
        chord_length(points * scale).t, chord_length(points).t, rtol=1e-15, atol=0
    )


def test_many_tiny_segments_beside_a_long_one() -> None:
    """A run of 1e5 segments below the resolution of T keeps all its points."""
    tiny = np.arange(100_000.0) * 1e-30
    points = np.concatenate([tiny, [1.0]])[:, None]
    t, rows, merged = chord_length(points)
    assert (len(rows), merged) == (100_001, 0)
    assert (np.diff(t) > 0).all()
    assert t[-2] < 1e-6


def test_repeated_points_are_merged_and_counted() -> None:
    """Real strokes have them; a point that comes back later stays."""
    points = [[0, 0], [0, 0], [1, 0], [0, 0], [0, 0], [0, 0], [2, 0]]
    found = chord_length(points)
    assert found.merged == 3
    assert found.points.tolist() == [[0, 0], [1, 0], [0, 0], [2, 0]]
    polyline = Polyline.from_points(points, domain=(2, 4))
    assert polyline.domain == Interval(2, 4)
    assert polyline.size == 4


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ([[1, 2], [1, 2]], "two distinct points or more, got 2 times"),
        ([[1, 2]], "two distinct points"),
        ([[np.nan, 0], [1, 1]], "finite"),
        ([1, 2, 3], "shape"),
    ],
)
def test_bad_points_are_refused(points: list[object], message: str) -> None:
    """A curve needs two distinct finite points."""
    with pytest.raises(InvalidCurveError, match=message):
        chord_length(points)  # type: ignore[arg-type]


def test_a_domain_without_room_is_refused() -> None:
    """T must hold enough numbers for the parameters."""
    with pytest.raises(InvalidCurveError, match="too few numbers"):
        chord_length(np.arange(100.0)[:, None], domain=Interval(1.0, 1.0 + 1e-12))


def test_given_parameters_keep_repeated_points() -> None:
    """With parameters of its own a repeated point is a rest, not a repetition."""
    assert Polyline.from_points([[0, 0], [0, 0], [1, 1]], t=[0, 1, 2]).size == 3
