"""Which windows are chosen, and how the curve fades beside them: laws on exact grids."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from multirep.interval import Interval
from multirep.representations import Polyline
from multirep.splices import SpliceList
from multirep.testing.strategies import dyadic_intervals, splice_lists
from multirep.windows import APRON, LOOSER, MOST, SHORTEST, SMALL_REST, Window, faded, windows

T = Interval(0.0, 1.0)
TOLERANCE = 1e-3


# -- the choice of windows -------------------------------------------------------------------------


@given(stale=splice_lists(), where=splice_lists())
@example(SpliceList([T]), SpliceList.parse("[0,43/64] [11/16,45/64]"))  # taken with the first
def test_windows_cover_what_is_asked_for(stale: SpliceList, where: SpliceList) -> None:
    """All stale stretches on where, nothing but stale ones, disjoint, from left to right."""
    found = list(windows(stale, where, T))
    fresh = SpliceList(window.fresh for window in found)
    asked = stale & where
    assert fresh.contains(asked)
    assert stale.contains(fresh)
    for window in found:
        assert asked.intersects(SpliceList([window.fresh]))
        assert window.stale.contains(window.fresh)
        assert stale.contains(window.stale)
        assert window.stale.contains(window.target())
    assert all(a.fresh.stop <= b.fresh.start for a, b in pairwise(found))
    assert all(a.fresh.stop <= b.stale.start for a, b in pairwise(found))


@given(where=dyadic_intervals())
def test_a_window_is_little_more_than_what_is_asked_for(where: Interval) -> None:
    """A stretch is taken as a whole when half of it is asked for, an end when little is left."""
    (window,) = windows(SpliceList([T]), SpliceList([where]), T)
    if window.fresh == T:
        rests = 2 * SMALL_REST * APRON * where.length
        assert where.length + rests >= MOST
        return
    apron = max(APRON * where.length, SHORTEST)
    assert window.fresh.start in (0.0, where.start)
    assert window.fresh.stop in (1.0, where.stop)
    assert where.start - window.fresh.start <= SMALL_REST * apron
    assert window.fresh.stop - where.stop <= SMALL_REST * apron


@given(
    stale=st.just(SpliceList([T])) | splice_lists(),
    where=splice_lists(),
    t=st.integers(0, 64).map(lambda k: k / 64),
)
@example(SpliceList([T]), SpliceList.parse("[0,9/64] [5/32,11/64]"), 0.0)  # no room between them
@example(SpliceList([T]), SpliceList.parse("[1/64,2/64] [5/64,12/64] [13/64,24/64]"), 0.0)
def test_what_a_splice_does_not_refresh_are_the_aprons(
    stale: SpliceList, where: SpliceList, t: float
) -> None:
    """On a side where stale curve goes on; up to ``t`` it may be up to date already."""
    for window in windows(stale, where, T):
        target, (a, b) = window.target(), window.fresh
        assert window.within(1.0, T).contains(target)
        assert window.refreshed(target) == window.fresh
        assert window.cut == (target != window.fresh)
        for inner, outer, border in (
            (a, target.start, window.stale.start),
            (b, target.stop, window.stale.stop),
        ):
            assert abs(inner - outer) == (window.apron if inner != border else 0.0)
        if t < b:
            later = window.after(t)
            assert later.fresh == Interval(max(a, t), b)
            assert later.stale == Interval(max(window.stale.start, t), window.stale.stop)


@pytest.mark.parametrize(
    ("stale", "first", "second", "near"),
    [
        ("[0,1/4] [3/8,1]", "[0,1/4]", "[3/8,1]", True),
        ("[0,1/4] [3/4,1]", "[0,1/4]", "[3/4,1]", False),  # the gap is longer than either
        (
            "[0,1]",
            "[1/4,5/16]",
            "[21/64,25/64]",
            False,
        ),  # stale curve stays between
        ("[0,1/2] [5/8,1]", "[1/4,1/2]", "[5/8,7/8]", True),  # cut on the far sides
        ("[0,1/2] [5/8,1]", "[0,7/16]", "[5/8,1]", False),  # cut towards the other
    ],
)
def test_windows_with_nothing_stale_and_little_between_them_are_near(
    stale: str, first: str, second: str, near: bool
) -> None:
    """Such windows become one, which covers both and what is between them."""
    one, two = (
        Window(
            SpliceList.parse(fresh).hull,
            next(part for part in SpliceList.parse(stale) if part.overlaps(at)),
            1 / 32,
        )
        for fresh in (first, second)
        for at in SpliceList.parse(fresh)
    )
    assert one.is_near(two) is near
    both = one.hull(two)
    assert both.fresh == one.fresh.hull(two.fresh)
    assert both.stale == one.stale.hull(two.stale)


# -- the aprons ------------------------------------------------------------------------------------


@given(where=dyadic_intervals(), offset=st.tuples(*[st.integers(-64, 64)] * 2))
def test_an_apron_leads_from_the_authors_to_what_a_kind_holds(
    where: Interval, offset: tuple[int, int]
) -> None:
    """On the window the polyline and its certificates stay; the ends are the kind's."""
    (window,) = windows(SpliceList([T]), SpliceList([where]), T)
    t = np.linspace(0, 1, 129)
    author = Polyline(t, np.column_stack([t, np.sin(20 * t) * np.cos(71 * t)]))
    target = window.target()
    sampled = author.sample(target, tolerance=TOLERANCE)
    held = Polyline(author.t, author.points + np.array(offset) / 64)
    result = faded(sampled, held, window, delta=TOLERANCE)
    a, b = window.fresh
    inside = (result.t >= a) & (result.t <= b)
    np.testing.assert_array_equal(result.points[inside], author(result.t[inside]))
    assert set(sampled.t[(sampled.t >= a) & (sampled.t <= b)]) <= set(result.t)
    for end, border in ((0, window.stale.start), (-1, window.stale.stop)):
        goes_on = window.fresh.start != border if end == 0 else window.fresh.stop != border
        expected = held(target.start if end == 0 else target.stop)
        if goes_on:
            np.testing.assert_array_equal(result.points[end], expected)
    # on the way it stays between the two, ever closer to what is held
    way = np.linalg.norm(result.points - author(result.t), axis=1)
    rounding = 1e-14
    assert (way <= np.linalg.norm(offset) / 64 + rounding).all()
    assert (np.diff(way[result.t <= a]) <= rounding).all()
    assert (np.diff(way[result.t >= b]) >= -rounding).all()
    # the fit may be off by a hop in the window, by the looser limit on the aprons
    allowed = result.allowance(TOLERANCE)
    middles = 0.5 * (result.t[1:] + result.t[:-1])
    on_window = (middles > a) & (middles < b)
    before = sampled.allowance(TOLERANCE)[sampled.t.searchsorted(middles[on_window]) - 1]
    np.testing.assert_allclose(allowed[on_window], before, rtol=1e-12)
    np.testing.assert_allclose(
        allowed[~on_window], (1 + LOOSER) * TOLERANCE + sampled.bound, rtol=1e-12
    )
