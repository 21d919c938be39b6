"""Planted scatter and planted corners are found; smooth strokes have neither."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from drawn_strokes import SQUARE, along, circle, scatter, uneven, wave
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.strokes import clean_stroke, estimate_noise, find_corners
from multirep.strokes.arc_length import angles_between
from multirep.testing.strategies import strokes

SMOOTH = [circle, wave]
FIFTY = np.radians(50.0)


@pytest.mark.parametrize("curve", [circle, wave, lambda at: along(SQUARE, at)])
@pytest.mark.parametrize("noise", [1e-3, 1e-2, 0.05])
@pytest.mark.parametrize("count", [300, 3000])
def test_planted_scatter_is_estimated(curve, noise: float, count: int) -> None:  # type: ignore[no-untyped-def]
    """On curves drawn evenly or not, with corners or not, to within 40 %."""
    for at in (np.linspace(0, 1, count), uneven(count)):
        assert estimate_noise(scatter(curve(at), noise)) == pytest.approx(noise, rel=0.4)


@pytest.mark.parametrize("curve", SMOOTH)
@pytest.mark.parametrize("count", [20, 80, 1000])
def test_a_smooth_stroke_has_no_noise(curve, count: int) -> None:  # type: ignore[no-untyped-def]
    """Bends are not taken for scatter, however coarse the samples; so nothing is moved."""
    for at in (np.linspace(0, 1, count), uneven(count)):
        points = curve(at)
        assert estimate_noise(points) == 0.0
        assert (clean_stroke(points, straight=True).points == points).all()


def test_a_zigzag_is_a_drawing() -> None:
    """A regular zigzag has the second differences of noise, but not their correlation."""
    teeth = np.stack([np.arange(64.0), np.arange(64) % 2], axis=1)
    assert estimate_noise(teeth) == 0.0


def test_the_digitised_pen_strokes_are_kept() -> None:
    """The Hershey strokes, all coarse and clean, come out sample by sample."""
    data = Path(__file__).parents[1] / "data" / "strokes.json"
    items = json.loads(data.read_text())["items"]
    for item in items:
        for drawn in item["strokes"]:
            rows = np.array(drawn, dtype=float)
            distinct = rows[np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])]
            stroke = clean_stroke(drawn, straight=True)
            assert (stroke.points == distinct).all(), item["name"]


@given(strokes(), st.integers(-30, 30))
def test_noise_has_the_units_of_the_points(stroke: Array, power: int) -> None:
    """Scaling by a power of two scales the estimate."""
    keep = np.concatenate([[True], (stroke[1:] != stroke[:-1]).any(axis=1)])
    rows = stroke[keep]
    expected = 2.0**power * estimate_noise(rows)
    assert estimate_noise(2.0**power * rows) == pytest.approx(expected, rel=1e-6, abs=1e-300)


@pytest.mark.parametrize("noise", [0.0, 1e-3, 1e-2])
@pytest.mark.parametrize("count", [300, 3000, 30000])
def test_planted_corners_are_found(noise: float, count: int) -> None:
    """The three inner corners of a square, wherever the samples fall, and no others."""
    for k, at in enumerate((np.linspace(0, 1, count), uneven(count, 5.0))):
        stroke = clean_stroke(scatter(along(SQUARE, at), noise, seed=k))
        found = stroke.points[stroke.corners]
        step = 4 * float(np.diff(at).max())
        for corner in ([1, 0], [1, 1], [0, 1]):
            off = np.linalg.norm(found - corner, axis=1)
            assert off.min() <= 4 * noise + step
        # a corner between two samples may turn at both
        assert len(found) <= (3 if noise else 6)


@pytest.mark.parametrize("curve", SMOOTH)
@pytest.mark.parametrize("noise", [0.0, 1e-3, 1e-2, 0.03])
@pytest.mark.parametrize("count", [100, 1000, 10000])
def test_smooth_strokes_have_no_corners(curve, noise: float, count: int) -> None:  # type: ignore[no-untyped-def]
    """No bend and no scatter is taken for a corner."""
    for k, at in enumerate((np.linspace(0, 1, count), uneven(count, 5.0))):
        assert not clean_stroke(scatter(curve(at), noise, seed=k)).corners.size


@given(strokes())
def test_sharp_turns_of_clean_strokes_are_the_corners(stroke: Array) -> None:
    """Without noise each turn of the angle or more is a corner."""
    cleaned = clean_stroke(stroke, noise=0.0, straight=True)
    steps = np.diff(cleaned.points, axis=0)
    turns = angles_between(steps[:-1], steps[1:])
    assert set(np.flatnonzero(turns >= FIFTY) + 1) <= set(cleaned.corners.tolist())
    assert ((cleaned.corners > 0) & (cleaned.corners < len(cleaned.points) - 1)).all()


def test_the_angle_and_the_window_decide() -> None:
    """A bend of 60 degrees is a corner from 50 on, not from 70; a wide window sees cut corners."""
    turn = np.radians(60)
    bent = along([[0, 0], [1, 0], [1 + np.cos(turn), np.sin(turn)]], np.linspace(0, 1, 201))
    assert find_corners(bent, angle=FIFTY).tolist() == [100]
    assert not find_corners(bent, angle=np.radians(70)).size
    rounded = np.concatenate([bent[:95], bent[106:]])
    assert find_corners(rounded, angle=np.radians(40), window=0.5).size == 1


def test_corners_in_space() -> None:
    """In three dimensions as in two."""
    corner = along([[0, 0, 0], [1, 0, 0], [1, 1, 1]], np.linspace(0, 1, 400))
    stroke = clean_stroke(scatter(corner, 0.01))
    assert len(stroke.corners) == 1
    assert np.linalg.norm(stroke.points[stroke.corners[0]] - [1, 0, 0]) < 0.04
