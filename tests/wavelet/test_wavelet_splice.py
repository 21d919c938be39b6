"""Splices follow what they are given, and leave the rest alone bit by bit."""

from __future__ import annotations

from functools import cache

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import Interval, MultiRepresentation, SampledSplice, SpliceList
from multirep.bounds import spline_chord_deviation
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.testing import check_splice

TOLERANCE = 1e-3


@cache
def curve(
    dimension: int = 2, domain: tuple[float, float] = (0.0, 1.0), offset: float = 0.0
) -> WaveletBSpline:
    s = np.linspace(0, 1, 1500)
    wiggle = 0.05 * np.sin(120 * s) * np.exp(-((s - 0.6) ** 2) / 0.002)
    rows = np.stack([np.cos((5 + k) * s) + wiggle for k in range(dimension)], axis=1) + offset
    t = domain[0] + s * (domain[1] - domain[0])
    return WaveletBSpline.fit(SampledSplice(t, rows), tolerance=TOLERANCE)


def pushed(
    value: WaveletBSpline, interval: Interval, height: float, *, sharp: bool = False
) -> SampledSplice:
    """Samples of the curve with a bump on top; at both ends it stays as it is."""
    sampled = value.sample(interval, tolerance=TOLERANCE / 8)
    s = (sampled.t - interval.start) / interval.length
    bump = np.minimum(s, 1 - s) * 2 if sharp else (4 * s * (1 - s)) ** 2
    offset = height * np.arange(1, value.dimension + 1)
    return attrs.evolve(sampled, points=sampled.points + bump[:, None] * offset)


intervals = st.tuples(st.integers(0, 640), st.integers(1, 64)).map(
    lambda pair: Interval(pair[0] / 704, (pair[0] + pair[1]) / 704)
)


@pytest.mark.parametrize("dimension", [1, 2, 3])
@given(interval=intervals, height=st.integers(-8, 8), sharp=st.booleans())
def test_splices_obey_the_law_anywhere(dimension, interval, height, sharp):
    """Ends nowhere in particular, bumps with and without corners: certified, and local."""
    value = curve(dimension)
    sampled = pushed(value, interval, height / 32, sharp=sharp)
    edit = check_splice(value, sampled, tolerance=TOLERANCE)
    proved = spline_chord_deviation(
        np.asarray(edit.value.knots),
        np.asarray(edit.value.points),
        3,
        sampled.t,
        sampled.points,
        splits=4,
    )
    assert (proved <= 1.002 * sampled.allowance(TOLERANCE)).all()


@pytest.mark.parametrize("domain", [(-2.0, 5.0), (1e5, 1e5 + 1.0), (0.0, 1e-5)])
@given(interval=intervals, sharp=st.booleans())
def test_splices_obey_the_law_on_any_domain(domain, interval, sharp):
    """The knots in T are rounded; nothing else is different."""
    value = curve(2, domain)
    length = domain[1] - domain[0]
    moved = Interval(domain[0] + interval.start * length, domain[0] + interval.stop * length)
    check_splice(value, pushed(value, moved, 0.1, sharp=sharp), tolerance=TOLERANCE)


def test_a_hundred_splices_stay_sound_and_do_not_pile_up():
    """Random places, one after the other; every one proved, the size bounded by what is there."""
    rng, value = np.random.default_rng(3), curve()
    sizes = []
    for _ in range(100):
        a = rng.uniform(0, 0.95)
        interval = value.reach(Interval(a, a + 0.05), Interval(0.0, 1.0))
        sampled = pushed(value, interval, rng.uniform(-0.1, 0.1))
        value = check_splice(value, sampled, tolerance=TOLERANCE).value
        sizes.append(value.size)
    assert sizes[-1] <= 1.6 * sizes[49]
    assert value.size <= 600


def test_a_thousand_splices_elsewhere_do_not_move_one_bit():
    """No drift: a stretch that no splice touched is the same after a thousand."""
    rng, value = np.random.default_rng(4), curve()
    start, touched = value, SpliceList.EMPTY
    for k in range(1000):
        a = rng.uniform(0.7, 0.95) if k % 2 else rng.uniform(0.0, 0.15)
        interval = Interval(a, a + 0.05)
        height = 0.02 * (-1) ** (k // 2)
        edit = value.splice(pushed(value, interval, height), tolerance=TOLERANCE)
        value, touched = edit.value, touched | edit.splices
    t = np.linspace(0, 1, 4001)
    t = t[[not touched.contains(float(s)) for s in t]]
    assert t.max() - t.min() > 0.2
    assert (value(t) == start(t)).all()


@given(intervals, st.integers(1, 8))
def test_from_knot_to_knot_nothing_outside_is_touched(interval, height):
    """Where `reach` finds room, the reported splice ends where the samples do."""
    value = curve()
    reached = value.reach(interval, value.domain)
    assert reached.contains(interval)
    knots = np.asarray(value.knots)
    assert reached.start in knots
    assert reached.stop in knots
    edit = value.splice(pushed(value, interval, height / 64), tolerance=TOLERANCE)
    assert edit.splices
    edit = value.splice(pushed(value, reached, height / 64), tolerance=TOLERANCE)
    inside = SpliceList([reached.clipped(value.domain)])
    close = [s for s in edit.splices if not inside.contains(s)]
    # Unless the old knots beside the ends are too far apart for the turn that is needed there.
    for splice in close:
        assert splice.start >= knots[max(np.searchsorted(knots, reached.start) - 2, 0)]
        assert splice.stop <= knots[min(np.searchsorted(knots, reached.stop) + 2, len(knots) - 1)]


def test_joins_are_twice_differentiable():
    """At both ends of the splice the first two derivatives go on as before."""
    value = curve()
    for interval in (Interval(0.31, 0.47), Interval(0.25, 0.5), Interval(0.6001, 0.6503)):
        edit = value.splice(pushed(value, interval, 0.1), tolerance=TOLERANCE)
        for t in interval:
            for order in (0, 1, 2):
                left = edit.value.derivative(t, order, "left")
                right = edit.value.derivative(t, order, "right")
                scale = np.abs(value.derivative(t, order)).max() + 1.0
                assert np.abs(left - right).max() <= 1e-6 * scale
                outside = edit.value.derivative(
                    t, order, "left" if t == interval.start else "right"
                )
                assert np.abs(outside - value.derivative(t, order)).max() <= 1e-7 * scale


def test_knots_that_a_finer_shape_left_behind_go():
    """A wiggle comes and goes; the knots go with it, those of the lead-in excepted."""
    value = curve()
    interval = Interval(0.2, 0.4)
    plain = value.sample(interval, tolerance=TOLERANCE / 8)
    t = np.linspace(0.2, 0.4, 600)
    wiggle = 0.05 * np.sin(np.pi * (t - 0.2) / 0.2)[:, None] * np.sin(400 * t)[:, None]
    rough = SampledSplice(t, plain(t) + wiggle)
    fine = value.splice(rough, tolerance=TOLERANCE).value
    assert fine.size > value.size + 50
    back = fine.splice(plain, tolerance=TOLERANCE).value
    assert back.size <= value.size + 12


def test_edits_all_over_leave_about_as_many_points_as_a_fresh_fit():
    """Splices are thinned too: without it, 100 of them leave half as many again as are needed."""
    t = np.arange(401) / 400
    points = np.stack((np.cos(5 * t), np.sin(7 * t)), axis=1)
    kinds = [Polyline, WaveletBSpline]
    edited = MultiRepresentation.from_points(points, tolerance=1e-3, kinds=kinds)
    rng = np.random.default_rng(0)
    for vertex in (rng.permutation(399)[:100] + 1).tolist():
        line = edited.view(Polyline)
        to = line.points[vertex] + 0.01 * rng.normal(size=2)
        edited.commit(Polyline, line.move_vertex(vertex, to))
        edited.view(WaveletBSpline)
    fresh = MultiRepresentation(edited.view(Polyline), tolerance=1e-3, kinds=kinds)
    assert edited.view(WaveletBSpline).size <= 1.25 * fresh.view(WaveletBSpline).size


@given(intervals, st.sampled_from([-0.1, 0.02]))
def test_the_report_ends_where_the_changes_end(interval, height):
    """A splice reports what it replaced, which is where control points and knots differ."""
    value = curve()
    edit = value.splice(pushed(value, interval, height), tolerance=TOLERANCE)
    assert edit.splices.hull == value.changes(edit.value).hull


def test_samples_alone_decide_the_knots():
    """Between the lead-ins, the result does not depend on the knots that were there before."""
    value = curve()
    finer = value.refine(Interval(0.3, 0.6)).value.refine(Interval(0.3, 0.5)).value
    sampled = pushed(value, Interval(0.25, 0.75), 0.1)
    one = np.asarray(value.splice(sampled, tolerance=TOLERANCE).value.knots)
    two = np.asarray(finer.splice(sampled, tolerance=TOLERANCE).value.knots)
    assert one[(one > 0.35) & (one < 0.65)].tolist() == two[(two > 0.35) & (two < 0.65)].tolist()


def test_where_a_seam_takes_the_allowance_both_sides_give_way():
    """A chord with a hundredth of what its neighbours may use: the loose side bends, too."""
    value = curve()
    sampled = pushed(value, Interval(0.2, 0.6), 0.05, sharp=True)
    bounds = np.zeros(len(sampled.t) - 1)
    bounds[len(bounds) // 2] = 0.099
    sampled = attrs.evolve(sampled, bound=0.099, chord_bounds=bounds)
    check_splice(value, sampled, tolerance=TOLERANCE)


@pytest.mark.parametrize("part", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("interval", [Interval(0.3, 0.4), Interval(0.25, 0.5)])
def test_gaps_near_the_allowance_are_closed(part, interval):
    """The curve stands off the samples by nearly all that is allowed; it is led in all the same."""
    value = curve()
    sampled = value.sample(interval, tolerance=1e-6)
    away = attrs.evolve(sampled, points=sampled.points + part * TOLERANCE * np.array([0.6, 0.8]))
    check_splice(value, away, tolerance=TOLERANCE)


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-2.0, 5.0)])
@given(
    which=st.tuples(st.integers(5, 10), st.integers(14, 20)),
    near=st.tuples(
        *[st.sampled_from([0, 2**-53, -(2**-53), 2**-51, -(2**-45), 2**-40, -(2**-30)])] * 2
    ),
)
def test_ends_a_hair_beside_a_knot_are_joined(domain, which, near):
    """No knot fits between; symmetric drawings have ends like 1/2 less one rounding."""
    value = curve(2, domain)
    start, stop = (
        float(value.knots[k]) + off * (domain[1] - domain[0])
        for k, off in zip(which, near, strict=True)
    )
    sampled = value.sample(Interval(start, stop), tolerance=1e-6)
    away = attrs.evolve(sampled, points=sampled.points + TOLERANCE * np.array([0.36, 0.48]))
    check_splice(value, away, tolerance=TOLERANCE)


def test_gaps_beyond_the_allowance_are_refused_at_once():
    """The message says where, how far, and what is allowed."""
    value = curve()
    for interval in (Interval(0.3, 0.4), Interval(0.25, 0.5)):
        sampled = value.sample(interval, tolerance=1e-6)
        away = attrs.evolve(sampled, points=sampled.points + 2 * TOLERANCE)
        with pytest.raises(ToleranceError, match="join the curve outside") as caught:
            value.splice(away, tolerance=TOLERANCE)
        assert caught.value.where in interval


def test_splices_that_do_not_belong_are_refused():
    """Outside T, or in another space."""
    value = curve()
    with pytest.raises(ParameterError):
        value.splice(SampledSplice([0.5, 1.5], np.zeros((2, 2))), tolerance=1.0)
    with pytest.raises(InvalidCurveError, match="3 coordinates"):
        value.splice(SampledSplice([0.5, 0.6], np.zeros((2, 3))), tolerance=1.0)


def test_a_splice_shares_all_blocks_that_it_does_not_touch():
    """On a curve of 40 000 control points nearly all blocks are the same objects after a splice."""
    rows = np.cumsum(np.random.default_rng(0).normal(size=(2**15 + 3, 2)), axis=0) / 100
    value = WaveletBSpline(rows)
    sampled = pushed(value, Interval(0.5, 0.501), 0.01)
    after = value.splice(sampled, tolerance=TOLERANCE).value
    old = {id(block) for block in value.points.blocks}
    assert sum(id(block) not in old for block in after.points.blocks) <= 2


@given(
    st.lists(st.tuples(st.integers(1, 62), st.integers(1, 20)), min_size=1, max_size=4),
    st.integers(0, 2**30),
)
def test_held_stretches_stay_bit_by_bit(places, seed):
    """Whatever splices end beside a held stretch, it does not move one bit."""
    # Far from the origin every operation rounds: what is not left alone shows.
    rng, value = np.random.default_rng(seed), curve(2, (0.0, 1.0), 1e3 / 7)
    a, b = 0.35 + rng.uniform(0, 0.1), 0.55 + rng.uniform(0, 0.1)
    edit, guard = value.held(Interval(a, b))
    value = edit.value
    assert guard.contains(Interval(a, b))
    assert guard.length <= 1.01 * (b - a)
    again, same = value.held(guard)
    original = curve(2, (0.0, 1.0), 1e3 / 7)
    assert same == guard
    assert not again.splices
    t = np.linspace(a, b, 200)
    before = value(t)
    assert np.abs(before - original(t)).max() <= 1e-12
    for place, width in places:
        start = place / 64
        job = Interval(start, min(1.0, start + width / 64))
        for side in (Interval(0.0, guard.start), Interval(guard.stop, 1.0)):
            part = job.intersection(side)
            if part is None or part.length < 1e-3:
                continue
            sampled = pushed(value, value.reach(part, side), 0.05)
            edit = value.splice(sampled, tolerance=TOLERANCE)
            assert not edit.splices.intersects(SpliceList([(a, b)]))
            value = edit.value
            assert (value(t) == before).all()


def test_held_ends_prefer_the_places_that_are_asked_for():
    """A dyadic end stays where it is, the ends of T need nothing, what is kept already decides."""
    value = curve()
    edit, guard = value.held(Interval(0.0, 0.40625))
    assert guard == Interval(0.0, 0.40625)
    _, wider = edit.value.held(Interval(0.2, 0.9), SpliceList([(0.0, 0.40625)]))
    assert wider.start == 0.0
    assert 0.9 <= wider.stop <= 0.901


def test_a_vertex_can_be_dragged_to_and_fro():
    """Slivers left at the ends of former splices cost a further attempt, not the session."""
    s = 2 * np.pi * np.linspace(0, 1, 100)
    wave = 0.05 * np.stack([np.cos(20 * s), np.sin(17 * s)], axis=1)
    rows = np.stack([np.cos(s), np.sin(s)], axis=1) + wave
    curve = MultiRepresentation.from_points(
        rows, tolerance=TOLERANCE, kinds=[Polyline, Nurbs, WaveletBSpline]
    )
    for k in range(70):
        value = curve.view(Polyline)
        vertex = value.t.searchsorted(0.2)
        offset = np.zeros(2)
        offset[k // 2 % 2] = 10 * TOLERANCE * (-1) ** k
        curve.commit(Polyline, value.move_vertex(vertex, value.points[vertex] + offset))
        curve.view(Nurbs)
        curve.view(WaveletBSpline)
    assert curve.deviation(Polyline, WaveletBSpline).upper <= TOLERANCE
