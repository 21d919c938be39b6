"""Sampling, splicing and fitting: exact samples, certified simplification, end gaps, any scale."""

from __future__ import annotations

import attrs
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from polyline_reference import check_edit, distance_on_chords, values
from polyline_reference import tiny_blocks as tiny_blocks

from multirep.arrays import Array
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError, UnknownNameError
from multirep.interval import Interval
from multirep.representations.polyline import Polyline
from multirep.sampled import SampledSplice
from multirep.testing.strategies import dyadic_intervals, polylines, sampled_splices


def smooth(count: int, interval: tuple[float, float] = (0.0, 1.0)) -> SampledSplice:
    """Samples of a smooth curve."""
    t = np.linspace(*interval, count)
    return SampledSplice(t, np.stack([np.cos(6 * t), np.sin(4 * t)], axis=1))


# -- sampling --------------------------------------------------------------------------------------


@given(polylines(max_size=30), dyadic_intervals())
@pytest.mark.usefixtures("tiny_blocks")
def test_a_sample_is_the_stretch_itself(data: tuple[Array, Array], interval: Interval) -> None:
    """All vertices inside, bit by bit, and the ends on the curve; the bound is rounding at most."""
    t, points = data
    polyline = Polyline(t, points)
    sampled = polyline.sample(interval, tolerance=1e-3)
    inside = (t > interval.start) & (t < interval.stop)
    assert sampled.t.tolist() == [interval.start, *t[inside].tolist(), interval.stop]
    assert sampled.points[1:-1].tolist() == points[inside].tolist()
    assert sampled.points[[0, -1]].tobytes() == polyline(list(interval)).tobytes()
    assert sampled.bound <= 1e-14
    if np.isin(list(interval), t).all():
        assert sampled.bound == 0.0
    at = np.linspace(*interval, 300)
    off = np.linalg.norm(sampled(at) - values(t, points, at), axis=1)
    assert off.max() <= sampled.bound + 1e-14


def test_the_rounding_bound_of_a_cut_segment_holds() -> None:
    """The point where an end cuts a segment is within the bound, in rational arithmetic."""
    from fractions import Fraction

    rng = np.random.default_rng(5)
    worst = 0.0
    for _ in range(300):
        points = rng.normal(size=(2, 3)) * 10.0 ** rng.integers(-3, 3, size=(2, 1))
        polyline = Polyline([0.1, 0.7], points)
        a = rng.uniform(0.1, 0.69)
        sampled = polyline.sample(Interval(a, 0.7), tolerance=1e-3)
        t0, t1 = Fraction(0.1), Fraction(0.7)
        u = (Fraction(a) - t0) / (t1 - t0)
        exact = [
            Fraction(p) + u * (Fraction(q) - Fraction(p)) for p, q in zip(*points, strict=True)
        ]
        off = [float(Fraction(x) - y) for x, y in zip(sampled.points[0], exact, strict=True)]
        worst = max(worst, float(np.linalg.norm(off)) / sampled.bound)
    assert 0.01 < worst <= 1.0


def test_breaks_are_the_kinks_that_show() -> None:
    """A kink is a corner when rounding it off takes more than four sampling tolerances."""
    for angle in (0.01, 0.1, 1.0):
        polyline = Polyline([0, 1, 3], [[-1, 0], [0, 0], [2, 2 * angle]])
        rounding = angle * 1 / 8  # the jump of the slope is `angle`, the shorter segment 1 long
        assert polyline.sample(Interval(0, 3), tolerance=rounding / 4.1).breaks == (1.0,)
        assert polyline.sample(Interval(0, 3), tolerance=rounding / 3.9).breaks == ()


def test_breaks_at_an_end_of_the_stretch_are_reported() -> None:
    """The curve has its corner there, whoever asks for one side only; the ends of T are none."""
    polyline = Polyline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    assert polyline.sample(Interval(1, 2), tolerance=1e-3).breaks == (1.0,)
    assert polyline.sample(Interval(0, 1), tolerance=1e-3).breaks == (1.0,)
    assert polyline.sample(Interval(0.5, 0.75), tolerance=1e-3).breaks == ()


def test_a_stretch_outside_the_domain_is_refused() -> None:
    """So is one of no length."""
    polyline = Polyline([0, 1], [[0, 0], [1, 1]])
    for interval in (Interval(0.5, 1.5), Interval(0.5, 0.5)):
        with pytest.raises(ParameterError, match="not a stretch"):
            polyline.sample(interval, tolerance=1e-3)


# -- splicing --------------------------------------------------------------------------------------


@given(polylines(max_size=30), dyadic_intervals(), st.data())
@pytest.mark.usefixtures("tiny_blocks")
def test_a_splice_stays_within_the_allowance_of_each_chord(
    data: tuple[Array, Array], interval: Interval, draw: st.DataObject
) -> None:
    """Inside within the allowance; outside bit-identical; corners and ends are kept."""
    polyline = Polyline(*data)
    sampled = draw.draw(sampled_splices(interval=interval))
    tolerance = draw.draw(st.integers(1, 512)) / 64
    gaps = [np.linalg.norm(polyline(s) - sampled(s)) for s in interval]
    free = [s in tuple(polyline.domain) for s in interval]
    allowed = sampled.allowance(tolerance)
    if any(gap > a and not f for gap, a, f in zip(gaps, allowed[[0, -1]], free, strict=True)):
        with pytest.raises(ToleranceError, match="where only"):
            polyline.splice(sampled, tolerance=tolerance)
        return
    assume((np.concatenate([sampled.points, polyline.points]) != sampled.points[0]).any())
    edit = polyline.splice(sampled, tolerance=tolerance)
    after = check_edit(polyline, edit)
    seen = distance_on_chords(after, sampled)
    assert (seen <= allowed * (1 + 1e-12)).all()
    assert seen.max() <= edit.bound * (1 + 1e-12) + 1e-300
    assert np.isin(sampled.breaks, np.asarray(after.t)).all()
    assert edit.splices.contains(interval)
    for s, f in zip(interval, free, strict=True):
        if not f:
            assert after(s).tobytes() == polyline(s).tobytes()
    grown = [x for x in edit.splices.hull if x not in tuple(interval)]
    assert np.isin(grown, data[0]).all()  # the splice grows to neighbouring vertices only


@given(sampled_splices(interval=Interval(0, 1), max_size=30), st.integers(1, 640))
def test_a_fit_stays_within_the_allowance_of_each_chord(sampled: SampledSplice, share: int) -> None:
    """Within the allowance, seen densely, with the ends and corners of the samples."""
    assume((sampled.points != sampled.points[0]).any())
    tolerance = share / 64
    polyline = Polyline.fit(sampled, tolerance=tolerance)
    assert (
        distance_on_chords(polyline, sampled) <= sampled.allowance(tolerance) * (1 + 1e-12)
    ).all()
    assert np.isin(sampled.breaks, np.asarray(polyline.t)).all()
    assert polyline([0, 1]).tolist() == sampled.points[[0, -1]].tolist()
    assert np.isin(np.asarray(polyline.t), sampled.t).all()


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0 - 1e-9, 1.0])
@pytest.mark.parametrize("end", [0, -1])
def test_end_gaps_up_to_exactly_the_allowance_are_closed(share: float, end: int) -> None:
    """A gap of exactly the allowance of its chord is closed; a larger one is refused."""
    base = smooth(9, (0.25, 0.75))
    sampled = attrs.evolve(base, bound=0.25, chord_bounds=np.linspace(0, 0.25, 8))
    tolerance = 0.5
    allowed = sampled.allowance(tolerance)
    gap = share * float(allowed[end])
    outside = base.points[[0, -1]].copy()
    outside[end, 0] += gap
    t = [0, 0.25, 0.75, 1]
    polyline = Polyline(t, [outside[0] - 1, *outside, outside[1] + 1])
    edit = polyline.splice(sampled, tolerance=tolerance)
    after = check_edit(polyline, edit)
    assert after.points[1].tolist() == outside[0].tolist()
    assert after([0.25, 0.75]).tolist() == outside.tolist()
    assert (distance_on_chords(after, sampled) <= allowed * (1 + 1e-12)).all()
    assert edit.bound >= gap * (1 - 1e-12)
    beyond = outside.copy()
    beyond[end, 0] = base.points[end, 0] + 1.001 * float(allowed[end])
    polyline = Polyline(t, [beyond[0] - 1, *beyond, beyond[1] + 1])
    with pytest.raises(ToleranceError, match=rf"t = {[0.25, 0.75][end]}") as error:
        polyline.splice(sampled, tolerance=tolerance)
    assert error.value.where == [0.25, 0.75][end]
    assert error.value.reachable is not None
    assert error.value.reachable > tolerance


def test_a_gap_is_closed_along_the_first_chord() -> None:
    """The deviation runs straight from the gap to nothing: certified where no sample looks."""
    sampled = smooth(33, (0.25, 1.0))
    polyline = Polyline([0, 0.25, 1], [[9, 9], sampled.points[0] + [0.01, 0], [9, 9]])
    after = check_edit(polyline, polyline.splice(sampled, tolerance=0.01))
    t = np.linspace(0.25, float(after.t[2]), 50)
    off = np.linalg.norm(after(t) - sampled(t), axis=1)
    assert off.max() <= 0.01 * (1 + 1e-12)


@pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_any_scale_and_dimension_alike(scale: float, dimension: int) -> None:
    """The same vertices are kept at any scale: no absolute thresholds."""
    rng = np.random.default_rng(3)
    t = np.linspace(0, 1, 400)
    rows = np.stack([np.sin((k + 2) * t + k) for k in range(dimension)], axis=1)
    rows += 1e-5 * rng.normal(size=rows.shape)
    kept = np.asarray(Polyline.fit(SampledSplice(t, rows), tolerance=1e-3).t)
    scaled = Polyline.fit(SampledSplice(t, rows * scale), tolerance=1e-3 * scale)
    assert np.asarray(scaled.t).tolist() == kept.tolist()
    assert 10 < len(kept) < 80


def test_far_from_the_origin_the_certificate_includes_rounding() -> None:
    """A circle of radius 1 at 1e12: what is certified holds in rational arithmetic."""
    from fractions import Fraction

    t = np.linspace(0, 1, 200)
    rows = np.stack([np.cos(6 * t), np.sin(6 * t)], axis=1) + 1e12
    sampled = SampledSplice(t, rows)
    after = Polyline.fit(sampled, tolerance=0.02)
    assert after.size < 100
    kept = np.asarray(after.t)
    for s, target in zip(t, rows, strict=True):
        k = min(max(int(kept.searchsorted(s, "right")) - 1, 0), len(kept) - 2)
        u = (Fraction(s) - Fraction(kept[k])) / (Fraction(kept[k + 1]) - Fraction(kept[k]))
        ends = zip(after.points[k], after.points[k + 1], target, strict=True)
        off = [
            float(Fraction(p) + u * (Fraction(q) - Fraction(p)) - Fraction(r)) for p, q, r in ends
        ]
        assert np.hypot(*off) <= 0.02


def test_simplification_is_frugal_and_linear() -> None:
    """Straight stretches need their ends; a curve at most 1.6 times the longest chords."""
    t = np.linspace(0, 1, 10_001)
    zigzag = np.stack([t, np.abs((4 * t) % 2 - 1)], axis=1)
    assert Polyline.fit(SampledSplice(t, zigzag), tolerance=1e-9).size == 5
    sampled = smooth(2001)
    for tolerance in (1e-2, 1e-3, 1e-4, 1e-5):
        got = Polyline.fit(sampled, tolerance=tolerance).size
        assert got <= 1.6 * fewest(sampled, tolerance) + 2


def fewest(sampled: SampledSplice, tolerance: float) -> int:
    """Count what the longest possible chords from left to right need (the slow way)."""
    t, points, count, start = sampled.t, sampled.points, 1, 0
    while start < len(t) - 1:
        stop, step = start + 1, 1
        while stop + 1 < len(t):
            u = ((t[start : stop + 2] - t[start]) / (t[stop + 1] - t[start]))[:, None]
            chord = points[start] + u * (points[stop + 1] - points[start])
            if np.linalg.norm(chord - points[start : stop + 2], axis=1).max() > tolerance:
                break
            stop += step
        start, count = stop, count + 1
    return count


def test_a_closed_curve_below_the_tolerance_keeps_three_vertices() -> None:
    """Two equal vertices are no curve: the farthest sample stays."""
    t = np.linspace(0, 1, 50)
    circle = np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1)
    circle[-1] = circle[0]
    polyline = Polyline.fit(SampledSplice(t, circle), tolerance=10.0)
    assert polyline.size == 3
    assert polyline.points[1][0] < -0.99


def test_samples_of_another_curve_are_refused() -> None:
    """The dimension and the interval must fit."""
    polyline = Polyline([0, 1], [[0, 0, 0], [1, 1, 1]])
    with pytest.raises(InvalidCurveError, match="2 coordinates for a curve with 3"):
        polyline.splice(smooth(5), tolerance=1)
    with pytest.raises(ParameterError, match="outside the domain"):
        polyline.splice(smooth(5, (0.5, 1.5)), tolerance=1)
    with pytest.raises(UnknownNameError, match="option of a polyline fit named 'degree'"):
        Polyline.fit(smooth(5), tolerance=1, degree=3)


# -- reaching --------------------------------------------------------------------------------------


@given(polylines(max_size=20), dyadic_intervals(), dyadic_intervals())
def test_reach_grows_to_vertices_inside_the_limits(
    data: tuple[Array, Array], inner: Interval, outer: Interval
) -> None:
    """Each end moves outward to the next vertex if that lies within, else stays."""
    within = inner.hull(outer)
    polyline = Polyline(*data)
    found = polyline.reach(inner, within)
    t = data[0]
    low, high = t[t <= inner.start].max(), t[t >= inner.stop].min()
    assert found.start == (low if low >= within.start else inner.start)
    assert found.stop == (high if high <= within.stop else inner.stop)


def test_a_thousand_splices_elsewhere_do_not_move_a_bit() -> None:
    """Following other curves on one stretch, again and again, neither moves nor grows the rest."""
    base = smooth(200)
    polyline = Polyline(base.t, base.points)
    start = polyline
    sizes = []
    for k in range(1000):
        a, b = 0.3 + 0.01 * np.sin(k), 0.5 + 0.01 * np.cos(3 * k)
        inner = np.linspace(a, b, 40)
        wave = polyline(inner) + 1e-3 * np.sin(k + np.pi * (inner - a) / (b - a))[:, None]
        wave[[0, -1]] = polyline([a, b])
        polyline = polyline.splice(SampledSplice(inner, wave), tolerance=1e-4).value
        sizes.append(polyline.size)
    t = np.asarray(polyline.t)
    left, right = t < 0.28, t > 0.53
    rows, original, old = np.asarray(polyline), np.asarray(start), np.asarray(start.t)
    assert rows[left].tobytes() == original[old < 0.28].tobytes()
    assert rows[right].tobytes() == original[old > 0.53].tobytes()
    assert max(sizes[500:]) <= max(sizes[:500]) + 5
