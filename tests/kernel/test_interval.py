"""Intervals: construction, refusals and the relations between two."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.errors import IntervalError
from multirep.interval import Interval
from multirep.testing.strategies import dyadic_intervals, dyadic_numbers, touching_intervals


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ((0.7, 0.2), r"\[0.7, 0.2\] is reversed"),
        ((math.nan, 1.0), "not a number"),
        ((0.0, math.nan), "not a number"),
        ((0.0, math.inf), "not finite"),
        ((-math.inf, 0.0), "not finite"),
        ((1.0,), "pair of numbers"),
        ((1.0, 2.0, 3.0), "pair of numbers"),
        ("ab", "pair of numbers"),
        (None, "pair of numbers"),
        (0.5, "pair of numbers"),
        (("a", "b"), "pair of numbers"),
    ],
)
def test_malformed_intervals_are_refused(value: object, message: str) -> None:
    """What is no finite ordered pair raises IntervalError with the value in the message."""
    with pytest.raises(IntervalError, match=message):
        Interval.of(value)  # type: ignore[arg-type]


def test_of_returns_an_interval_as_it_is() -> None:
    """Interval.of makes pairs intervals and leaves intervals alone."""
    interval = Interval(0.0, 1.0)
    assert Interval.of(interval) is interval
    assert Interval.of([0, 1]) == interval
    assert tuple(interval) == (0.0, 1.0)
    assert hash(Interval.of((0, 1))) == hash(interval)


@given(dyadic_intervals(), dyadic_intervals())
def test_overlap_means_an_intersection_of_positive_length(a: Interval, b: Interval) -> None:
    """Interiors meet exactly when the intersection has a length; both are symmetric."""
    common = a.intersection(b)
    assert common == b.intersection(a)
    assert a.overlaps(b) == b.overlaps(a) == (common is not None and common.length > 0)


@given(touching_intervals())
def test_touching_intervals_are_told_apart(pair: tuple[Interval, Interval]) -> None:
    """A common end point is an intersection and no overlap; one ulp decides."""
    a, b = pair
    common = a.intersection(b)
    assert (common is None) == (a.stop < b.start or b.stop < a.start)
    assert a.overlaps(b) == (a.start < b.stop and b.start < a.stop)
    hull = a.hull(b)
    assert hull.contains(a)
    assert hull.contains(b)
    assert set(hull) <= {*a, *b}


@given(dyadic_intervals(), dyadic_numbers())
def test_containment_includes_the_ends(a: Interval, t: float) -> None:
    """Both ends are inside, whole intervals are inside when both their ends are."""
    assert a.contains(a.start)
    assert a.contains(a.stop)
    assert a.contains(a)
    assert a.contains(t) == (a.start <= t <= a.stop)
    assert not a.contains(math.nextafter(a.stop, math.inf))
    assert a.start <= a.middle <= a.stop
    assert a.length == a.stop - a.start


@given(dyadic_intervals(), st.integers(0, 64))
def test_widened_then_clipped_returns(a: Interval, k: int) -> None:
    """Growing an interval and cutting it to its old bounds gives it back."""
    assert a.widened(k / 64).clipped(a) == a
    assert a.widened(k / 64).length == a.length + k / 32


def test_clipping_to_somewhere_else_is_refused() -> None:
    """There is no part of an interval outside itself."""
    with pytest.raises(IntervalError, match="outside"):
        Interval(0.0, 0.25).clipped(Interval(0.5, 1.0))
