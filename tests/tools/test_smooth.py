"""Smoothing: to which curve, on which stretch, and what stays."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep import Interval, SampledSplice
from multirep.constraints import Freeze
from multirep.errors import EditError, FrozenError, ParameterError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.representations.wavelet.smoothing import APRON_SPANS
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing import check_certificate, check_edit
from multirep.tools import Smooth


@cache
def rough(finest: int = 8, dimension: int = 2) -> WaveletBSpline:
    steps = np.random.default_rng(finest).normal(size=(2**finest + 3, dimension))
    return WaveletBSpline(steps.cumsum(axis=0))


@cache
def cornered() -> WaveletBSpline:
    """A polygon with few control points between its corners, and clusters of knots there."""
    t = np.array([0.0, 0.2, 0.45, 0.5, 0.8, 1.0])
    points = np.array([[0, 0], [2, 1], [3, -1], [3, 1], [5, 0], [5, 3.0]])
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-5)


CURVES = {"rough": rough, "cornered": cornered, "space": lambda: rough(6, 3)}
each_curve = pytest.mark.parametrize("curve", CURVES)
#: Ends of stretches as 64ths, both orders of magnitude of length among them.
stretches = st.tuples(st.integers(0, 63), st.integers(1, 64)).map(
    lambda pair: (pair[0] / 64, min(pair[0] + pair[1], 64) / 64)
)


@each_curve
def test_everywhere_it_is_the_curve_of_the_level(curve):
    """Without an interval nothing is left of what the level does not hold."""
    value = CURVES[curve]()
    t = np.linspace(0, 1, 500)
    for level in (0, 1.5, 3, 4.75):
        smoothed = check_edit(value, lambda v, n=level: Smooth(level=n).edit(v, Scene())).value
        wanted = value.pyramid().control_points(level)
        assert np.abs(smoothed(t) - WaveletBSpline(wanted)(t)).max() <= 1e-11
        assert smoothed.size <= len(wanted)


@each_curve
@given(interval=stretches, level=st.integers(0, 40))
def test_on_a_stretch_it_is_the_same_in_the_middle_and_nothing_outside(curve, interval, level):
    """Beyond the aprons the curve is that of the level; what lies outside stays, bit by bit."""
    value, level = CURVES[curve](), level / 4
    edit = check_edit(value, lambda v: Smooth(level=level, interval=interval).edit(v, Scene()))
    if not edit.splices:
        return
    apron = min(APRON_SPANS * 2.0 ** -int(level), (interval[1] - interval[0]) / 3)
    low = interval[0] + apron * (interval[0] > 0)
    high = interval[1] - apron * (interval[1] < 1)
    # A control point that moves by less acts three spans into the middle.
    t = np.linspace(low, high, 400)
    u = np.asarray(edit.value.knots)
    full = (t >= u[np.minimum(u.searchsorted(low) + 3, len(u) - 1)]) | (low == 0)
    full &= (t <= u[np.maximum(u.searchsorted(high, "right") - 4, 0)]) | (high == 1)
    wanted = value.at_level(level)(t[full])
    assert np.abs(edit.value(t[full]) - wanted).max(initial=0) <= 1e-9 * value.magnitude


@given(interval=stretches, level=st.integers(0, 24))
def test_where_the_curve_is_fine_enough_only_controls_inside_move(interval, level):
    """Where the aprons have knots, not one control point of the outside is written anew."""
    value, level = rough(10), level / 4
    start = min(interval[0], 15 / 16)
    interval = (start, max(interval[1], start + 1 / 16))
    edit = Smooth(level=level, interval=interval).edit(value, Scene())
    assert SpliceList([interval]).contains(edit.splices)


@given(interval=stretches, level=st.integers(0, 28))
def test_the_ends_of_a_stretch_join_smoothly(interval, level):
    """Point, slope and curvature have no jump, there or anywhere."""
    value = cornered()
    edit = Smooth(level=level / 4, interval=interval).edit(value, Scene())
    u = np.unique(np.asarray(edit.value.knots))[1:-1]
    for order in range(3):
        left, right = (edit.value.derivative(u, order, side) for side in ("left", "right"))
        scale = max(1.0, np.abs(left).max(), np.abs(right).max())
        assert np.abs(left - right).max(initial=0) <= 1e-9 * scale


@each_curve
@given(level=st.integers(0, 20))
def test_a_fractional_level_goes_over_gradually(curve, level):
    """A little more level changes the curve a little, at whole levels too, also on a stretch."""
    value, level = CURVES[curve](), level / 4
    t = np.linspace(0, 1, 300)
    before = Smooth(level=level, interval=(0.2, 0.7)).edit(value, Scene()).value(t)
    for step, allowed in ((1e-6, 1e-4), (1e-9, 1e-7)):
        for near in (level + step, max(level - step, 0)):
            after = Smooth(level=near, interval=(0.2, 0.7)).edit(value, Scene()).value(t)
            assert np.abs(after - before).max() <= allowed * value.magnitude


def test_smoothing_needs_fewer_control_points():
    """Knots of details that are gone go too, in the middle of a stretch as well."""
    value = rough()
    for interval in (None, (0.1, 0.9)):
        smoothed = Smooth(level=2, interval=interval).edit(value, Scene()).value
        assert smoothed.size < value.size


def test_a_corner_among_long_spans_can_be_rounded():
    """Knots are added where the curve is too coarse to stay as it is beside a short stretch."""
    value = cornered()
    edit = check_edit(value, Smooth(level=4, interval=(0.44, 0.46)).edit(value, Scene()))
    assert edit.splices
    t = np.concatenate((np.linspace(0, 0.44, 200), np.linspace(0.46, 1, 200)))
    assert np.abs(edit.value(t) - value(t)).max() <= 1e-14
    assert np.linalg.norm(edit.value(0.45) - value(0.45)) > 1e-3


def test_what_is_smooth_already_stays():
    """From its finest level on a curve does not change, and no splice is reported."""
    for level in (8, 8.5, 40, 1000):
        edit = Smooth(level=level).edit(rough(), Scene())
        assert edit.value.points is rough().points
        assert not edit.splices


def test_smoothing_turns_with_the_curve():
    """It commutes with any turn, and does not see where the origin is."""
    value, t = rough(), np.linspace(0, 1, 300)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    moved = WaveletBSpline(np.asarray(value.points) @ turn.T + 1000)
    for interval in (None, (0.3, 0.6)):
        tool = Smooth(level=3.3, interval=interval)
        one, two = (tool.edit(v, Scene()).value(t) for v in (value, moved))
        assert np.abs(one @ turn.T + 1000 - two).max() <= 1e-11


def test_a_stretch_of_a_long_curve_shares_the_rest():
    """Blocks of control points that lie outside are those of the curve before."""
    value = rough(14)
    edit = Smooth(level=11, interval=(0.5, 0.502)).edit(value, Scene())
    old = {id(block) for block in value.points.blocks}
    new = [block for block in edit.value.points.blocks if id(block) not in old]
    assert edit.splices
    assert sum(map(len, new)) < value.size / 3


@pytest.mark.parametrize("interval", [(0.25, 0.5), (0.2137, 0.5011)])
def test_frozen_stretches_stay_and_the_rest_is_smooth(interval):
    """Around ice the curve is smoothed on both sides, with aprons; all representations agree."""
    session = mr.Session()
    session.add("curve", mr.MultiRepresentation(rough(7), tolerance=0.01))
    session.constrain("curve", Freeze(interval=interval))
    curve = session.curve("curve")
    kinds = (Polyline, Nurbs, WaveletBSpline)
    t = np.linspace(interval[0], interval[1], 200)
    before = [curve.view(kind)(t) for kind in kinds]
    session.apply("curve", Smooth(level=3))
    for kind, values in zip(kinds, before, strict=True):
        assert (curve.view(kind)(t) == values).all()
    away = np.concatenate((np.linspace(0, 0.12, 100), np.linspace(0.75, 1, 100)))
    assert np.abs(curve.view(WaveletBSpline)(away) - rough(7).at_level(3)(away)).max() < 1e-12
    check_certificate(curve)


@pytest.mark.parametrize("frozen", [(0, 1), (0.25, 0.75)])
def test_all_of_it_frozen_is_refused_by_name(frozen):
    """The error says what froze it, and what to release."""
    session = mr.Session()
    session.add("curve", mr.MultiRepresentation(rough(6), tolerance=0.01))
    session.constrain("curve", Freeze(interval=frozen), name="ice")
    with pytest.raises(FrozenError, match="'ice'") as caught:
        session.apply("curve", Smooth(level=3, interval=(0.4, 0.6)))
    assert caught.value.release == ("ice",)


@pytest.mark.parametrize(
    ("tool", "error", "message"),
    [
        (Smooth(level=2, interval=(0.5, 1.25)), ParameterError, "1.25"),
        (Smooth(level=2, interval=(-1, 0.5)), ParameterError, "-1"),
        (Smooth(level=2, interval=(0.5, 0.5 + 1e-15)), EditError, r"2\*\*-"),
    ],
)
def test_refusals_say_what_is_wrong(tool, error, message):
    """The message holds the numbers."""
    with pytest.raises(error, match=message):
        tool.edit(rough(), Scene())


def test_domains_other_than_the_unit_interval():
    """Intervals are parameters in T; the level counts spans of all of it."""
    rows = np.asarray(rough().points)
    one, two = WaveletBSpline(rows), WaveletBSpline(rows, domain=(10, 14))
    first = Smooth(level=3, interval=(0.25, 0.5)).edit(one, Scene())
    second = check_edit(two, Smooth(level=3, interval=(11, 12)).edit(two, Scene()))
    t = np.linspace(0, 1, 200)
    assert np.abs(first.value(t) - second.value(10 + 4 * t)).max() <= 1e-12
    assert SpliceList([Interval(11, 12)]).contains(second.splices)


@each_curve
def test_details_fade_out_over_an_apron(curve):
    """Close to an end inside T hardly anything has gone: the change grows with the square."""
    value, end = CURVES[curve](), 0.3125
    edit = Smooth(level=3, interval=(end, 1)).edit(value, Scene())
    gone = np.abs(value.at_level(3)(np.linspace(0, 1, 500)) - value(np.linspace(0, 1, 500))).max()
    for part in (0.05, 0.1, 0.2):
        t = np.linspace(end, end + part * min(APRON_SPANS / 8, (1 - end) / 3), 100)
        assert np.abs(edit.value(t) - value(t)).max() <= 3 * (part + 0.02) ** 2 * gone
