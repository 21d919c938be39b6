"""Going over from one curve to another inside an interval, on any knots of both."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import Interval
from multirep.errors import EditError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet.confining import confined, confined_to, mixed
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.splices import SpliceList
from multirep.testing import check_edit


def graded(seed: int, count: int) -> Graded:
    """Random control points on random knots of levels up to 9."""
    rng = np.random.default_rng(seed)
    u = np.unique(rng.integers(1, 512, count))[:, None] / 512
    knots = clamped(np.concatenate(([0.0], np.unique(u), [1.0])))
    return Graded.of(Interval(0, 1), knots, rng.normal(size=(len(knots) - 4, 2)))


ends = st.lists(st.integers(0, 64), min_size=2, max_size=2, unique=True).map(
    lambda pair: Interval(min(pair) / 64, max(pair) / 64)
)


@given(
    seed=st.integers(0, 10_000),
    counts=st.tuples(st.integers(1, 60), st.integers(1, 60)),
    interval=ends,
    apron=st.sampled_from([1.0, 0.25, 0.03]),
    fixed=st.tuples(st.booleans(), st.booleans()),
)
def test_nothing_changes_outside(seed, counts, interval, apron, fixed):
    """At guarded ends not a bit; at others the curve is the same up to rounding; it stays C2."""
    before, after = graded(seed, counts[0]), graded(seed + 1, counts[1])
    value = WaveletBSpline._of(before)
    if fixed[0] and interval.start > 0:
        value = value.held(Interval(0, interval.start))[0].value
    if fixed[1] and interval.stop < 1:
        value = value.held(Interval(interval.stop, 1))[0].value
    before = value._graded
    found = confined(before, after, interval, apron, fixed)
    edit = check_edit(value, value._edit(found))
    for splice in edit.splices:
        assert splice.start >= interval.start or not fixed[0]
        assert splice.stop <= interval.stop or not fixed[1]
    t = np.linspace(0, 1, 500)
    outside = (t < interval.start) | (t > interval.stop)
    moved = np.abs(edit.value(t[outside]) - value(t[outside]))
    assert moved.max(initial=0) <= 1e-13 * before.magnitude
    u = np.asarray(found.u)
    assert (np.diff(u[3:-3]) > 0).all()
    assert found.level <= max(before.level, after.level, 18)


@given(
    seed=st.integers(0, 10_000),
    counts=st.tuples(st.integers(1, 60), st.integers(1, 60)),
    interval=ends,
)
def test_the_middle_is_the_other_curve(seed, counts, interval):
    """Where all weights are 1 the curve is the other one, on its knots alone."""
    before, after = graded(seed, counts[0]), graded(seed + 1, counts[1])
    found = confined(before, after, interval, 1 / 64)
    width = min(1 / 64, interval.length / 3)
    low, high = interval.start + width, interval.stop - width
    u = np.asarray(found.u)
    # A control point that is not all of the other curve acts three spans into the middle.
    low = u[u.searchsorted(low) + 2] if interval.start > 0 else 0.0
    high = u[u.searchsorted(high, "right") - 3] if interval.stop < 1 else 1.0
    if low < high:
        t = np.linspace(low, high, 300)
        assert np.abs(found.evaluate(t) - after.evaluate(t)).max() <= 1e-12
        inner = u[(u > low) & (u < high)][7:-7]
        assert np.isin(inner, np.asarray(after.u)).all()


@given(seed=st.integers(0, 10_000), share=st.integers(0, 8))
def test_mixing_is_a_straight_line_in_the_curves(seed, share):
    """At every place, on any two sets of knots; bits that both have stay."""
    one, share = graded(seed, 30), share / 8
    changed = WaveletBSpline._of(one).sweep(0.25, [1.0, 1.0], 5).value._graded
    for two in (graded(seed + 1, 30), changed):
        t = np.linspace(0, 1, 300)
        found = mixed(one, two, share).evaluate(t)
        first, second = one.evaluate(t), two.evaluate(t)
        assert np.abs(found - (first + share * (second - first))).max() <= 1e-12
    assert (found == first)[t > 0.8].all()


def test_all_of_t_is_the_other_curve():
    """Nothing to go over to: no knots of the first are kept."""
    one, two = graded(1, 20), graded(2, 20)
    assert confined_to(one, two, SpliceList([(0, 1)]), 0.1) is two


def test_several_stretches():
    """Each goes over by itself."""
    one, two = graded(1, 60), graded(2, 60)
    where = SpliceList([(0, 0.25), (0.75, 1)])
    found = confined_to(one, two, where, 0.01)
    t = np.array([0.0, 0.1, 0.5, 0.9, 1.0])
    wanted = np.where((t == 0.5)[:, None], one.evaluate(t), two.evaluate(t))
    assert np.abs(found.evaluate(t) - wanted).max() <= 1e-12


def test_no_room_is_refused_and_no_difference_is_none():
    """An interval that no knots fit into; and two curves that agree there."""
    one, two = graded(1, 20), graded(2, 20)
    short = SpliceList([(0.5, np.nextafter(0.5, 1))])
    with pytest.raises(EditError, match="no room"):
        confined_to(one, two, short, 0.1)
    assert confined_to(one, one, SpliceList([(0.25, 0.75)]), 0.1) is one
