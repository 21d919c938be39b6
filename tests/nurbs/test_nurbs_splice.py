"""Splices: certified inside, bit-identical outside, few knots, whatever the curve and course."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nurbs_cases import course, curves, largest_deviation, random_curve, smooth_curve

from multirep.blocks import BLOCK_ROWS
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.interval import Interval
from multirep.representations import Nurbs
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.testing.laws import check_edit, check_splice
from multirep.testing.strategies import dyadic_intervals


def random_stretch(rng: np.random.Generator, curve: Nurbs) -> tuple[float, float]:
    """Anywhere, from an end of T, between two knots, or all of T."""
    a, b = np.sort(rng.random(2)).tolist()
    mode = rng.random()
    if mode < 0.15:
        a = 0.0
    elif mode < 0.3:
        b = 1.0
    elif mode < 0.35:
        a, b = 0.0, 1.0
    elif mode < 0.6:
        knots = np.unique(np.asarray(curve.knots))
        knots = knots[(knots >= 0) & (knots <= 1)]
        a, b = np.sort(rng.choice(knots, 2, replace=False)).tolist()
    if b - a < 1e-3:
        b = min(1.0, a + 1e-3)
        a = b - 1e-3
    return a, b


def random_course(
    rng: np.random.Generator, curve: Nurbs, scale: float
) -> tuple[SampledSplice, float]:
    """Samples of the curve with a bump, with noise, shifted by almost all that is allowed, or a
    polyline of a few far vertices; and a tolerance.
    """
    a, b = random_stretch(rng, curve)
    tolerance = scale * 10 ** rng.uniform(-4, -1)
    sampled = curve.sample(Interval(a, b), tolerance=tolerance / 8)
    t, points, kind = sampled.t, sampled.points.copy(), rng.integers(0, 4)
    direction = rng.normal(size=curve.dimension)
    direction /= np.linalg.norm(direction)
    if kind == 0:
        height = scale * float(rng.choice([0.01, 0.1, 1.0]))
        points += (np.sin(np.pi * (t - a) / (b - a)) ** 2)[:, None] * direction * height
    elif kind == 1:
        points += rng.normal(size=points.shape) * tolerance * 0.2
        points[[0, -1]] = sampled.points[[0, -1]]
    elif kind == 2:
        inner = np.unique(a + (b - a) * rng.random(int(rng.integers(1, 12))))
        t = np.concatenate([[a], inner[(inner > a) & (inner < b)], [b]])
        points = curve(t)
        points[1:-1] += rng.normal(size=(len(t) - 2, curve.dimension)) * scale * 0.3
        return SampledSplice(t, points), tolerance
    else:
        points += direction * tolerance * float(rng.choice([0.5, 0.9, 0.99]))
    return SampledSplice(t, points, sampled.bound, (), sampled.chord_bounds), tolerance


@pytest.mark.parametrize("seed", range(150))
def test_any_splice_keeps_the_contract(seed: int) -> None:
    """Degrees 1 to 7, rational or not, any knots, coordinates 1e-9 to 1e12, gaps up to 0.99."""
    rng = np.random.default_rng(seed)
    curve, scale = random_curve(rng)
    sampled, tolerance = random_course(rng, curve, scale)
    if len(sampled.t) > 600:
        return
    edit = check_splice(curve, sampled, tolerance=tolerance)
    Nurbs.from_dict(edit.value.to_dict())


@settings(max_examples=60)
@given(curves(), dyadic_intervals(), st.data())
def test_splices_on_a_grid(curve: Nurbs, stretch: Interval, data: st.DataObject) -> None:
    """With coincidences: ends at knots, knots at vertices, equal control points."""
    a, b = stretch
    places = st.lists(st.integers(1, 63), max_size=5, unique=True)
    inner = [a + (b - a) * k / 64 for k in sorted(data.draw(places))]
    t = np.array([a, *inner, b])
    points = curve(t)
    if a == 0.0:
        points[0] += data.draw(st.integers(-64, 64)) / 64
    for k in range(1, len(t) - 1):
        points[k] += data.draw(st.integers(-64, 64)) / 64
    tolerance = data.draw(st.sampled_from([0.5, 0.05, 0.002]))
    check_splice(curve, SampledSplice(t, points), tolerance=tolerance)


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_ends_at_knots_leave_the_outside_untouched(degree: int) -> None:
    """From the ends that `reach` proposes, a splice changes nothing outside: it reports [a, b]."""
    curve = smooth_curve(40, degree)
    wish = Interval(0.41, 0.57)
    ends = curve.reach(wish, Interval(0.2, 0.8))
    knots = np.asarray(curve.knots).tolist()
    assert ends.contains(wish)
    assert ends.start in knots
    assert ends.stop in knots
    sampled = curve.sample(ends, tolerance=1e-5)
    u = (sampled.t - ends.start) / ends.length
    bent = SampledSplice(
        sampled.t, sampled.points + 0.01 * np.sin(np.pi * u)[:, None] ** 4, sampled.bound
    )
    edit = check_splice(curve, bent, tolerance=1e-3)
    assert edit.splices == SpliceList([ends])


def test_reach_stays_within() -> None:
    """It covers the wish, never leaves what is allowed; without a knot it is the wish."""
    curve = smooth_curve(12)
    wish = Interval(0.501, 0.502)
    assert curve.reach(wish, wish) == wish
    assert curve.reach(Interval(0.0, 1.0), Interval(0.0, 1.0)) == Interval(0.0, 1.0)
    for a, b in ((0.4, 0.6), (0.1, 0.9), (0.0, 1.0)):
        ends = curve.reach(wish, Interval(a, b))
        assert Interval(a, b).contains(ends)
        assert ends.contains(wish)


def test_joins_are_smooth() -> None:
    """At both ends of a splice p - 1 derivatives are continuous, where the course allows it."""
    for degree in (2, 3, 5):
        curve = smooth_curve(30, degree)
        sampled = curve.sample(Interval(0.313, 0.617), tolerance=1e-6)
        u = (sampled.t - 0.313) / 0.304
        shift = 0.02 * np.sin(np.pi * u)[:, None] ** 6
        edit = curve.splice(SampledSplice(sampled.t, sampled.points + shift, 1e-4), tolerance=1e-3)
        for end in (0.313, 0.617):
            for order in range(degree):
                left = edit.value.derivative(end, order, "left")
                right = edit.value.derivative(end, order, "right")
                scale = np.abs(curve.derivative(np.linspace(0, 1, 99), order)).max()
                assert np.abs(left - right).max() <= 1e-6 * scale, (degree, end, order)


def test_a_turn_at_the_end_gives_up_smoothness_only_there() -> None:
    """A course that leaves at an angle is followed, with a corner at the end."""
    curve = smooth_curve(30)
    start = curve(0.4)
    t = np.array([0.4, 0.5, 0.6])
    course_points = np.stack([start, start + np.array([1.0, 2.0]), curve(0.6)])
    edit = check_splice(curve, SampledSplice(t, course_points), tolerance=1e-4)
    knots = np.asarray(edit.value.knots)
    assert [(knots == s).sum() for s in t] == [3, 3, 3]
    assert edit.value.size < curve.size + 12


@pytest.mark.parametrize("share", [0.5, 0.9, 0.99, 0.999])
def test_a_gap_at_the_end_is_closed_inside(share: float) -> None:
    """The course may start almost an allowance away from the curve; knots gather at the end."""
    curve = smooth_curve(200)
    tolerance = 1e-3
    sampled = curve.sample(Interval(0.4, 0.6), tolerance=tolerance / 64)
    shifted = SampledSplice(
        sampled.t,
        sampled.points + np.array([0.0, share * (tolerance - sampled.bound)]),
        sampled.bound,
    )
    edit = check_splice(curve, shifted, tolerance=tolerance)
    assert edit.value.size <= curve.size + 40


def test_a_gap_beyond_the_allowance_is_refused_at_once() -> None:
    """The error says how large the gap is, and where."""
    curve = smooth_curve(30)
    sampled = curve.sample(Interval(0.4, 0.6), tolerance=1e-5)
    with pytest.raises(ToleranceError, match=r"0.002 away.*t = 0.4, more than the allowed") as info:
        curve.splice(
            SampledSplice(sampled.t, sampled.points + np.array([0, 0.002])), tolerance=1e-3
        )
    assert info.value.where == 0.4
    assert info.value.reachable == pytest.approx(0.002)


def test_nonsense_is_refused() -> None:
    """Samples outside T, of another dimension, and tolerances below rounding."""
    curve = smooth_curve(12)
    with pytest.raises(ParameterError, match="leaves the domain"):
        curve.splice(SampledSplice([0.5, 1.5], np.zeros((2, 2))), tolerance=1.0)
    with pytest.raises(InvalidCurveError, match="2 coordinates cannot follow samples in 3"):
        curve.splice(SampledSplice([0.5, 1.0], np.zeros((2, 3))), tolerance=1.0)
    sampled = curve.sample(Interval(0.4, 0.6), tolerance=1e-6)
    with pytest.raises(ToleranceError, match="rounding") as info:
        curve.splice(sampled, tolerance=1e-17)
    assert info.value.reachable is not None
    assert info.value.reachable > 1e-17


def test_ends_of_the_domain_are_met() -> None:
    """Where the stretch reaches an end of T, the curve ends where the course does."""
    for ends in ((0.0, 0.3), (0.6, 1.0), (0.0, 1.0)):
        curve = smooth_curve(30)
        t = np.linspace(*ends, 50)
        points = curve(t)
        points[(t < 0.2) | (t > 0.8)] += [0.0, 0.5]
        edit = check_splice(curve, SampledSplice(t, points), tolerance=1e-3)
        for end in set(ends) & {0.0, 1.0}:
            assert np.abs(edit.value(end) - points[0 if end == 0 else -1]).max() <= 1e-15


def test_rational_curves_keep_their_weights_outside() -> None:
    """Bit by bit; inside the weights stay between the smallest and the largest around."""
    rng = np.random.default_rng(5)
    curve = smooth_curve(40)
    weights = np.exp(rng.normal(size=40))
    curve = Nurbs(degree=3, knots=curve.knots, points=curve.points, weights=weights)
    ends = curve.reach(Interval(0.4, 0.6), Interval(0.0, 1.0))
    t = np.linspace(ends.start, ends.stop, 60)
    shift = 0.2 * np.sin(np.pi * (t - ends.start) / ends.length)[:, None] ** 2
    edit = check_splice(curve, SampledSplice(t, curve(t) + shift), tolerance=3e-3)
    after = np.asarray(edit.value.weights)
    assert (after[:12] == weights[:12]).all()
    assert (after[-12:] == weights[-12:]).all()
    assert after.min() >= 0.5 * weights.min()
    assert after.max() <= 2 * weights.max()


def test_breaks_become_corners_and_go_again() -> None:
    """A kink becomes a knot of full multiplicity; when the course is smooth again, it goes."""
    curve = smooth_curve(40)
    t = np.linspace(0.3, 0.7, 81)
    tent = np.maximum(0.0, 1 - np.abs(t - 0.5) / 0.2)[:, None] * [0.0, 1.0]
    kinked = check_splice(
        curve, SampledSplice(t, curve(t) + tent, breaks=(0.5,)), tolerance=1e-3
    ).value
    assert (np.asarray(kinked.knots) == t[40]).sum() == 3
    tangents = [kinked.derivative(t[40], side=side) for side in ("left", "right")]
    assert tangents[0][1] - tangents[1][1] > 8
    ends = Interval(0.29, 0.71)
    back = curve.sample(ends, tolerance=1e-4)
    flat = kinked.splice(back, tolerance=1e-3).value
    assert np.unique(np.asarray(flat.knots), return_counts=True)[1][1:-1].max() == 1
    assert flat.size <= curve.size + 2


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_dragging_about_one_place_piles_nothing_up(degree: int) -> None:
    """200 splices of moving bumps on one stretch: a few control points more than a fresh fit."""
    sampled = course("spiral", 2001)
    t, points = sampled.t, sampled.points
    value = Nurbs.fit(sampled, tolerance=1e-3, degree=degree)
    begin, changed, current, low = value, SpliceList.EMPTY, points, 1.0
    for step in range(200):
        middle = 0.5 + 0.05 * np.sin(step / 3)
        inside = np.abs(t - middle) < 0.05
        current = points.copy()
        bell = np.cos((t[inside] - middle) / 0.05 * np.pi / 2) ** 2
        current[inside, 1] += 0.02 * np.sin(step / 5) * bell
        ends = value.reach(Interval(0.39, 0.61), Interval(0.32, 0.68))
        at = np.concatenate(([ends.start], t[(t > ends.start) & (t < ends.stop)], [ends.stop]))
        moved = np.stack([np.interp(at, t, column) for column in current.T], axis=1)
        edit = value.splice(SampledSplice(at, moved), tolerance=1e-3)
        value, changed, low = edit.value, changed | edit.splices, min(low, ends.start)
    fresh = Nurbs.fit(SampledSplice(t, current), tolerance=1e-3, degree=degree)
    assert value.size <= fresh.size + 16
    outside = np.linspace(0, changed.hull.start, 50)[:-1]
    assert (value(outside) == begin(outside)).all()
    beside = np.linspace(0, low, 200)
    assert np.abs(value(beside) - begin(beside)).max() <= 1e-13


def test_control_points_are_removed_where_detail_goes() -> None:
    """Where a curve of many knots is told to be a line, few knots remain."""
    curve = smooth_curve(400)
    t = np.array([0.2, 0.8])
    line = np.stack([curve(0.2), curve(0.8)])
    edit = check_splice(curve, SampledSplice(t, line), tolerance=1e-3)
    assert edit.value.size < 400 - 225


def test_a_splice_does_not_look_at_the_rest_of_the_curve() -> None:
    """All blocks but those of the window are shared, and NaN in a block far away does no harm."""
    curve = smooth_curve(12 * BLOCK_ROWS)
    knots, points = curve.knots, curve.points
    middle = knots[6 * BLOCK_ROWS]
    ends = Interval(float(middle), float(knots[6 * BLOCK_ROWS + 20]))
    nothing = np.full((BLOCK_ROWS // 2, 2), np.nan)
    poisoned = curve._with(points=points.replaced(0, BLOCK_ROWS // 2, nothing))
    sampled = poisoned.sample(ends, tolerance=1e-9)
    edit = poisoned.splice(sampled, tolerance=1e-6)
    shared = {id(block) for block in poisoned.points.blocks}
    assert sum(id(block) in shared for block in edit.value.points.blocks) >= 10
    assert poisoned.changes(edit.value).hull.length < 2 * ends.length


def test_the_subclass_survives() -> None:
    """A second NURBS kind with its own name and degree is spliced and edited as itself."""

    class Quintic(Nurbs):
        name = "quintic"
        default_degree = 5

    curve = Quintic.fit(course("bump", 501), tolerance=1e-2)
    assert (type(curve), curve.degree) == (Quintic, 5)
    sampled = curve.sample(Interval(0.2, 0.4), tolerance=1e-4)
    edit = check_edit(curve, lambda c: c.splice(sampled, tolerance=1e-2))
    assert type(edit.value) is Quintic
    assert type(curve.insert_knot(0.3).value) is Quintic
    assert largest_deviation(edit.value, sampled) <= 1e-2
