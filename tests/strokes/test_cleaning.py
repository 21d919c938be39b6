"""Cleaning removes the noise, keeps what was drawn, and takes whatever people draw."""

from __future__ import annotations

import time

import numpy as np
import pytest
from drawn_strokes import SQUARE, along, circle, distances, scatter, uneven
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.strokes import clean_stroke
from multirep.strokes.merging import gather
from multirep.strokes.smoothing import smooth
from multirep.testing.strategies import strokes

DENSE = circle(np.linspace(0, 1, 5001))


def bulge(*drawn: Array) -> float:
    """How far a rounded stroke may leave the segments between its samples."""
    return max(0.4 * np.linalg.norm(np.diff(rows, axis=0), axis=1).max() for rows in drawn)


@given(strokes(), st.sampled_from([None, 0.0, 0.5]))
def test_whatever_is_drawn_becomes_a_curve(stroke: Array, noise: float | None) -> None:
    """Finite, neighbours distinct, two points or more, near the samples; or all of it is noise."""
    try:
        cleaned = clean_stroke(stroke, noise=noise)
    except EditError as error:
        if noise and "all of it is noise" in str(error):
            return
        raise
    points = cleaned.points
    assert len(points) >= 2
    assert np.isfinite(points).all()
    assert (points[1:] != points[:-1]).any(axis=1).all()
    assert not points.flags.writeable
    low, high = stroke.min(axis=0), stroke.max(axis=0)
    margin = 8 * cleaned.noise + bulge(stroke)
    assert (points >= low - margin).all()
    assert (points <= high + margin).all()


@given(strokes())
def test_without_noise_nothing_moves(stroke: Array) -> None:
    """With noise = 0 the samples are the points, and backwards is backwards."""
    cleaned = clean_stroke(stroke, noise=0.0, straight=True)
    distinct = stroke[np.concatenate([[True], (stroke[1:] != stroke[:-1]).any(axis=1)])]
    assert (cleaned.points == distinct).all()
    back = clean_stroke(stroke[::-1], noise=0.0, straight=True)
    assert (back.points == cleaned.reversed().points).all()


@pytest.mark.parametrize("noise", [1e-3, 1e-2, 3e-2])
@pytest.mark.parametrize(("count", "left"), [(300, 0.6), (3000, 0.35), (30000, 0.2)])
def test_noise_is_removed(noise: float, count: int, left: float) -> None:
    """The remaining error is a part of the noise that falls with the number of samples."""
    for k, at in enumerate((np.linspace(0, 1, count), uneven(count))):
        points = clean_stroke(scatter(circle(at), noise, seed=k)).points
        assert np.sqrt((distances(points, DENSE) ** 2).mean()) <= left * noise
        # not at the cost of the shape: all of it is still there
        covered = distances(circle(np.linspace(0, 1, 200)), points)
        assert covered.max() <= 5 * noise


@pytest.mark.parametrize("noise", [1e-3, 1e-2])
def test_ends_and_corners_stay(noise: float) -> None:
    """Smoothing moves them by about the noise of one sample, never by its own width."""
    at = np.linspace(0, 1, 4000)
    for seed in range(5):
        stroke = clean_stroke(scatter(along(SQUARE, at), noise, seed))
        assert len(stroke.corners) == 3
        places = [stroke.points[0], *stroke.points[stroke.corners], stroke.points[-1]]
        for place, corner in zip(places, SQUARE, strict=True):
            assert np.linalg.norm(place - corner) <= 4 * noise


def test_more_noise_allowed_is_smoother() -> None:
    """The parameter says what may go: detail below it, not what is above."""
    at = np.linspace(0, 1, 2000)
    drawn = scatter(circle(at), 0.01)
    lengths = [
        np.linalg.norm(np.diff(clean_stroke(drawn, noise=noise).points, axis=0), axis=1).sum()
        for noise in (0.0, 0.003, 0.01, 0.03)
    ]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[-2] == pytest.approx(5.0, rel=0.01)


def test_a_stroke_that_is_all_noise_is_refused() -> None:
    """When nothing is left, the message says how large it was against the noise."""
    with pytest.raises(EditError, match=r"spans 1: all of it is noise of 50"):
        clean_stroke([[0, 0], [1, 0], [0, 1], [1, 1], [0, 0]], noise=50.0)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("shift", [0.0, 1e3])
def test_size_and_place_do_not_matter(scale: float, shift: float) -> None:
    """Tiny, huge and far from the origin: the same stroke."""
    drawn = scatter(along(SQUARE, uneven(1000)), 0.01)
    reference = clean_stroke(drawn)
    moved = clean_stroke(scale * (drawn + shift))
    assert len(moved.points) == len(reference.points)
    assert moved.corners.tolist() == reference.corners.tolist()
    assert moved.points / scale - shift == pytest.approx(reference.points, abs=1e-6)


def test_a_resting_pen_leaves_one_place() -> None:
    """Where the pen trembles in one place for a while, the curve passes once."""
    still = scatter(np.zeros((500, 2)), 0.01)
    before = scatter(np.stack([np.linspace(-1, 0, 200), np.zeros(200)], axis=1), 0.01, 1)
    after = scatter(np.stack([np.zeros(200), np.linspace(0, 1, 200)], axis=1), 0.01, 2)
    stroke = clean_stroke(np.concatenate([before, still, after]))
    length = np.linalg.norm(np.diff(stroke.points, axis=0), axis=1).sum()
    assert length == pytest.approx(2.0, rel=0.03)


@given(strokes(max_size=40), st.sampled_from([0.3, 1.0, 3.0]))
def test_gathering_keeps_the_mean(stroke: Array, noise: float) -> None:
    """Places weighted by their samples have the mean of the samples, and count them all."""
    rows = stroke[np.concatenate([[True], (stroke[1:] != stroke[:-1]).any(axis=1)])]
    gathered = gather(rows, noise)
    assert gathered.counts.sum() == len(rows)
    mean = (gathered.counts[:, None] * gathered.points).sum(axis=0) / len(rows)
    assert mean == pytest.approx(rows.mean(axis=0), abs=1e-9 * np.abs(rows).max())


def test_the_smoother_is_a_penalised_least_squares_fit() -> None:
    """Against the same minimum by a dense solve, for the bandwidth that it chose."""
    at = np.linspace(0, 1, 120)
    points = scatter(along([[0, 0], [1, 0], [1, 1]], at), 0.02)
    counts = np.random.default_rng(1).integers(1, 5, size=len(points)).astype(float)
    corners = np.array([60])
    result = smooth(points, counts, corners, 0.02)
    h = np.linalg.norm(np.diff(points, axis=0), axis=1)
    h = np.maximum(h / np.median(h), 1 / 8)
    rows = []
    for j in range(1, len(points) - 1):
        if j in corners:
            continue
        row = np.zeros(len(points))
        row[j - 1], row[j + 1] = 1 / h[j - 1], 1 / h[j]
        row[j] = -row[j - 1] - row[j + 1]
        rows.append(row * np.sqrt(2 / (h[j - 1] + h[j])))
    rough = np.array(rows).T @ np.array(rows)
    # the normal equations hold for some weight: W (g - p) = -lambda R g
    left, right = (counts[:, None] * (points - result)).ravel(), (rough @ result).ravel()
    weight = left @ right / (right @ right)
    assert weight > 0
    assert left == pytest.approx(weight * right, abs=1e-6 * np.abs(left).max())


def test_lines_are_not_bent_by_smoothing() -> None:
    """A straight stroke at any speed stays straight: its smoothed points lie on the line."""
    at = uneven(500, 100.0)
    points = np.stack([at, 2 * at], axis=1)
    result = smooth(points, np.ones(500), np.empty(0, dtype=np.intp), 0.1)
    assert result @ [2, -1] == pytest.approx(np.zeros(500), abs=1e-9)


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_a_hundred_thousand_samples_take_a_moment(noise: float) -> None:
    """Linear: ten times the samples cost at most about ten times the time."""
    seconds = []
    for count in (10_000, 100_000):
        drawn = scatter(circle(uneven(count)), noise)
        best = np.inf
        for _ in range(3):
            begin = time.process_time()
            clean_stroke(drawn)
            best = min(best, time.process_time() - begin)
        seconds.append(best)
    assert seconds[1] <= 20 * seconds[0] + 0.05
