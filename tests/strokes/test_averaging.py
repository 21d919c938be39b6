"""Several strokes over each other: their mean, whatever their direction, speed and extent."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_strokes import SQUARE, along, circle, distances, scatter, uneven, wave
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.strokes import Stroke, average_strokes, clean_stroke, curve_from_strokes, sketched
from multirep.strokes.arc_length import arc_lengths
from multirep.strokes.places import runs_backwards
from multirep.testing.strategies import strokes

EVEN = np.linspace(0, 1, 400)


def raw(points: Array) -> Stroke:
    return clean_stroke(points, noise=0.0)


@given(strokes())
def test_one_stroke_is_its_own_mean(stroke: Array) -> None:
    """Nothing to average, nothing changes."""
    cleaned = raw(stroke)
    assert (average_strokes([cleaned]).points == cleaned.points).all()


@given(strokes(), st.integers(2, 5))
def test_the_mean_of_equal_strokes_is_that_stroke(stroke: Array, times: int) -> None:
    """Drawing the same again, as often as you like, changes nothing beyond rounding."""
    cleaned = raw(stroke)
    mean = average_strokes([cleaned] * times)
    size = np.abs(cleaned.points).max()
    assert distances(mean.points, cleaned.points).max() <= 1e-9 * size
    assert distances(cleaned.points, mean.points).max() <= 1e-9 * size


@pytest.mark.parametrize("curve", [circle, wave, lambda at: along(SQUARE, at)])
def test_noise_falls_with_the_root_of_the_number_of_strokes(curve) -> None:  # type: ignore[no-untyped-def]
    """Sixteen raw strokes leave about a quarter of the error of one."""
    dense = curve(np.linspace(0, 1, 4001))
    errors = {}
    for number in (1, 4, 16):
        drawn = [raw(scatter(curve(EVEN), 0.002, seed)) for seed in range(number)]
        mean = average_strokes(drawn).points
        errors[number] = np.sqrt((distances(mean, dense) ** 2).mean())
    assert errors[4] <= 0.6 * errors[1]
    assert errors[16] <= 0.35 * errors[1]
    assert errors[16] >= 0.1 * errors[1]


@pytest.mark.parametrize("curve", [circle, wave, lambda at: along(SQUARE, at)])
def test_the_direction_of_drawing_does_not_matter(curve) -> None:  # type: ignore[no-untyped-def]
    """A later stroke drawn the other way round gives the same mean; the first gives direction."""
    one, two = scatter(curve(EVEN), 0.003, 1), scatter(curve(uneven(300)), 0.003, 2)
    mean = sketched([one, two], noise=0.0).points
    same = sketched([one, two[::-1]], noise=0.0).points
    assert same == pytest.approx(mean, abs=1e-9)
    back = sketched([one[::-1], two], noise=0.0).points
    assert distances(back, mean).max() <= 3e-3
    assert np.linalg.norm(mean[0] - curve(0.0)) < 0.05
    assert np.linalg.norm(back[0] - curve(1.0)) < 0.05


def test_the_speed_of_drawing_does_not_matter() -> None:
    """Places correspond by arc length, not by sample: strokes at other speeds lie on each other."""
    one, two = circle(EVEN), circle(uneven(1500, 50.0))
    mean = sketched([one, two], noise=0.0).points
    assert np.abs(np.linalg.norm(mean, axis=1) - 1).max() <= 2e-4


def test_a_trembling_half_does_not_shift_the_other() -> None:
    """Where one hand draws a longer line through the same places, places still correspond."""
    at = np.linspace(0, 1, 2000)
    calm = wave(at)
    trembling = calm + 0.01 * np.sin(np.minimum(at, 0.5) * 900)[:, None]
    longer = arc_lengths(trembling)[-1] / arc_lengths(calm)[-1]
    assert longer > 1.3
    mean = average_strokes([raw(calm), raw(trembling)]).points
    assert distances(mean, calm).max() <= 0.01


def test_each_stroke_counts_once() -> None:
    """Three lines at heights 0, 0 and 3/8 have their mean at 1/8, in any order."""
    low, high = [[0, 0], [4, 0]], [[0, 0.375], [1, 0.375], [4, 0.375]]
    for order in ([low, low, high], [low, high, low], [high, low, low]):
        assert sketched(order).points[:, 1] == pytest.approx(0.125)


def test_a_short_stroke_refines_a_part() -> None:
    """Outside what it covers nothing moves; in its middle the mean lies half way; no step."""
    base = np.stack([np.linspace(0, 10, 201), np.zeros(201)], axis=1)
    part = np.stack([np.linspace(6, 4, 41), np.full(41, 0.2)], axis=1)
    mean = sketched([base, part], noise=0.0).points
    outside = (mean[:, 0] < 4 - 1e-9) | (mean[:, 0] > 6 + 1e-9)
    assert (mean[outside, 1] == 0).all()
    assert mean[np.abs(mean[:, 0] - 5).argmin(), 1] == pytest.approx(0.1)
    assert mean[:, 1].max() <= 0.1 + 1e-12
    slopes = np.diff(mean[:, 1]) / np.diff(mean[:, 0])
    assert np.abs(slopes).max() <= 0.3


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("at_end", [False, True])
def test_a_stroke_that_goes_beyond_extends(at_end: bool, backwards: bool) -> None:
    """The shared part is averaged, what only one of them has is kept, and all joins smoothly."""
    base = np.stack([np.linspace(0, 10, 201), np.zeros(201)], axis=1)
    more = np.stack([np.linspace(7, 14, 141), np.full(141, 0.1)], axis=1)
    if not at_end:
        more[:, 0] = 10 - more[:, 0]
    mean = sketched([base, more[::-1] if backwards else more], noise=0.0).points
    expected = (0.0, 14.0) if at_end else (-4.0, 10.0)
    assert (mean[0, 0], mean[-1, 0]) == pytest.approx(expected)
    assert (np.diff(mean[:, 0]) > 0).all()
    slopes = np.diff(mean[:, 1]) / np.diff(mean[:, 0])
    assert np.abs(slopes).max() <= 0.2
    free = mean[:, 0] > 10 if at_end else mean[:, 0] < 0
    assert (mean[free, 1] == 0.1).all()


def test_corners_meet_corners() -> None:
    """Of two squares, one drawn with longer sides, the mean has the same sharp corners."""
    small = along(SQUARE, EVEN)
    large = along(1.1 * np.array(SQUARE) - [0.0, 0.1], uneven(777, 5.0))
    mean = sketched([small, large], noise=0.0)
    assert 3 <= len(mean.corners) <= 6
    for corner in ([1.05, -0.05], [1.05, 1.0], [0, 1.0]):
        assert np.linalg.norm(mean.points - corner, axis=1).min() <= 0.03


def test_crossings_and_closed_shapes_know_their_direction() -> None:
    """Where ends or places are no guide the vote of all stations is."""
    eight = np.stack([np.sin(6.28 * EVEN), 0.6 * np.sin(12.56 * EVEN)], axis=1)
    ring = np.stack([np.cos(6.28 * EVEN), np.sin(6.28 * EVEN)], axis=1)
    for shape in (eight, ring):
        other = scatter(shape, 0.01)
        u, s = arc_lengths(shape), arc_lengths(other)
        assert not runs_backwards(shape, u, other, s)
        assert runs_backwards(shape, u, other[::-1], s)


@pytest.mark.parametrize(
    ("second", "message"),
    [
        ([[0, 9], [4, 9]], r"stroke 2 is not drawn over.*keeps 9 from them, allowed is 0\.8"),
        ([[5, 0], [9, 0]], "stroke 2 is not drawn over"),
        ([[0, 0, 0], [4, 0, 0]], "stroke 2 has 3 coordinates, the first has 2"),
    ],
)
def test_a_stroke_elsewhere_is_refused(second: list[list[float]], message: str) -> None:
    """Far away, beyond the end without a shared part, or in another dimension."""
    with pytest.raises(EditError, match=message):
        sketched([[[0, 0], [4, 0]], second])


def bow(start: float, stop: float, radius: float) -> Array:
    """An arc between two angles, in turns, a vertex each hundredth of a turn."""
    u = 2 * np.pi * np.linspace(start, stop, int(100 * abs(stop - start)) + 2)
    return radius * np.stack([np.cos(u), np.sin(u)], axis=1)


@given(st.integers(0, 63), st.sampled_from([0.97, 1.0, 1.05]), st.booleans())
def test_a_closed_outline_may_be_drawn_again_from_anywhere(
    start: int, turns: float, backwards: bool
) -> None:
    """Wherever the hand begins and whichever way it goes, the mean lies half way between."""
    again = bow(start / 64, start / 64 + turns, 1.2)
    strokes = [raw(bow(0, 1, 1.0)), raw(again[::-1] if backwards else again)]
    mean = average_strokes(strokes).points
    radii = np.linalg.norm(mean, axis=1)
    assert radii.min() >= 1.0 - 1e-2  # where the strokes do not overlap, one of them fades
    assert radii.max() <= 1.2 + 1e-2
    assert np.median(radii) == pytest.approx(1.1, abs=1e-2)
    turned = np.diff(np.unwrap(np.arctan2(mean[:, 1], mean[:, 0])))
    assert turned.sum() == pytest.approx(2 * np.pi, abs=0.3)
    assert np.linalg.norm(mean[0] - mean[-1]) <= 0.25
    assert mean[0] == pytest.approx([1.1, 0.0], abs=0.25)  # an open end is as far from the other


@pytest.mark.parametrize("backwards", [False, True])
def test_a_stroke_over_the_ends_of_a_closed_outline_refines_both(backwards: bool) -> None:
    """It is cut where they meet; what it does not reach stays."""
    again = bow(-0.1, 0.15, 1.05)
    mean = average_strokes([raw(bow(0, 1, 1.0)), raw(again[:: -1 if backwards else 1])]).points
    angle = np.arctan2(mean[:, 1], mean[:, 0]) / (2 * np.pi)
    radii = np.linalg.norm(mean, axis=1)
    reached = (angle >= -0.1) & (angle <= 0.15)
    assert radii[~reached] == pytest.approx(1.0, abs=1e-3)
    assert radii[np.abs(angle) < 0.01] == pytest.approx(1.025, abs=1e-3)
    assert mean[0] == pytest.approx(mean[-1], abs=1e-9)


@pytest.mark.parametrize("stop", [0.8, 0.95])
def test_a_bow_is_extended_round_to_its_beginning(stop: float) -> None:
    """What comes closer to the other end than to the one it left still goes on from that one."""
    mean = average_strokes([raw(bow(0, 0.7, 1.0)), raw(bow(0.2, stop, 1.05))]).points
    turned = np.diff(np.unwrap(np.arctan2(mean[:, 1], mean[:, 0]))).sum()
    assert turned == pytest.approx(2 * np.pi * stop, abs=1e-2)
    assert np.linalg.norm(mean, axis=1).min() >= 0.99


def test_a_stroke_to_and_fro_is_refused() -> None:
    """Its ends mean a short stretch, and it runs over much more: no mean of both makes sense."""
    line = np.stack([np.linspace(0, 10, 50), np.zeros(50)], axis=1)
    scribble = np.concatenate([line[10:], line[20:-1][::-1]])
    scribble[:, 1] += 0.1
    with pytest.raises(EditError, match=r"stroke 2 is not drawn over the ones before"):
        average_strokes([raw(line), raw(scribble)])


def test_a_curve_from_strokes_keeps_its_promises() -> None:
    """It is a multi-representation of the mean, in any dimension, and counts merged samples."""
    drawn = [scatter(wave(EVEN), 0.01, seed) for seed in range(3)]
    drawn[0] = np.concatenate([drawn[0][:5], drawn[0][4:]])
    curve = curve_from_strokes(drawn, tolerance=0.01)
    assert curve.merged == 1
    assert curve.view("polyline").size == len(sketched(drawn).points)
    helix = np.concatenate([wave(EVEN), EVEN[:, None]], axis=1)
    assert curve_from_strokes([helix], tolerance=0.01).dimension == 3


@st.composite
def overdrawn(draw: st.DrawFn) -> list[Array]:
    """Draw a stroke, then whole or partial, shifted, reversed repetitions of it, or anything."""
    base = draw(strokes(max_size=40))
    drawn = [base]
    for _ in range(draw(st.integers(1, 3))):
        if draw(st.integers(0, 4)) == 0:
            drawn.append(draw(strokes(max_size=20)))
            continue
        start = draw(st.integers(0, len(base) - 2))
        stop = draw(st.integers(start + 2, len(base)))
        part = base[start:stop] + draw(st.tuples(st.integers(-3, 3), st.integers(-3, 3)))
        if (part != part[0]).any():
            drawn.append(part[:: draw(st.sampled_from([1, -1]))])
    return drawn


@given(overdrawn(), st.sampled_from([None, 0.0]))
def test_any_strokes_have_a_mean_or_a_reason(drawn: list[Array], noise: float | None) -> None:
    """Whatever is drawn over whatever: a sound curve within the hull, or a refusal with why."""
    try:
        mean = sketched(drawn, noise=noise)
    except EditError as error:
        if "not drawn over" in str(error) or "cancels" in str(error):
            return
        raise
    points = mean.points
    assert len(points) >= 2
    assert (points[1:] != points[:-1]).any(axis=1).all()
    every = np.concatenate(drawn)
    steps = [np.linalg.norm(np.diff(rows, axis=0), axis=1).max() for rows in drawn]
    margin = 8 * mean.noise + 0.4 * max(steps)
    assert (points >= every.min(axis=0) - margin).all()
    assert (points <= every.max(axis=0) + margin).all()
    assert ((mean.corners >= 0) & (mean.corners < len(points))).all()
