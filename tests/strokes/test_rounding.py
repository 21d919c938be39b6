"""A smooth curve through few samples: circles stay circles, corners and stems stay as they are."""

from __future__ import annotations

import numpy as np
import pytest
from drawn_strokes import distances, uneven
from hypothesis import given

from multirep.arrays import Array, Indices
from multirep.strokes import clean_stroke
from multirep.strokes.arc_length import angles_between
from multirep.strokes.rounding import FACET, rounded
from multirep.testing.strategies import strokes

NONE = np.empty(0, dtype=np.intp)


@given(strokes())
def test_all_samples_and_corners_stay(stroke: Array) -> None:
    """The given points are among the new ones in order, bit by bit, and so are the corners."""
    straight = clean_stroke(stroke, noise=0.0, straight=True)
    smooth = clean_stroke(stroke, noise=0.0)
    assert (smooth.points[smooth.corners] == straight.points[straight.corners]).all()
    at = 0
    for point in straight.points:
        while (smooth.points[at] != point).any():
            at += 1
    assert at == len(smooth.points) - 1


@given(strokes())
def test_nothing_turns_more_than_it_did(stroke: Array) -> None:
    """Between the corners the largest turn becomes no larger, and small where there is room."""
    straight = clean_stroke(stroke, noise=0.0, straight=True)
    smooth = clean_stroke(stroke, noise=0.0)

    def turns(points: Array, corners: Indices) -> Array:
        steps = np.diff(points, axis=0)
        angles = angles_between(steps[:-1], steps[1:])
        return np.delete(angles, corners - 1)

    before = turns(straight.points, straight.corners)
    after = turns(smooth.points, smooth.corners)
    assert after.max(initial=0.0) <= max(before.max(initial=0.0), 4 * FACET) + 1e-9


@pytest.mark.parametrize("count", [12, 24])
def test_points_of_a_circle_give_the_circle(count: int) -> None:
    """To the sixth power of the turn, whatever the radius and the place."""
    for radius in (1e-9, 1.0, 1e9):
        angle = np.arange(count) * 2 * np.pi / count
        centre = radius * np.array([3.0, -2.0])
        points = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        smooth, _ = rounded(points, NONE)
        off = np.abs(np.linalg.norm(smooth - centre, axis=1) / radius - 1)
        assert off.max() <= 4.3e-6 * (12 / count) ** 5


def test_uneven_samples_of_a_circle_stay_near_it() -> None:
    """Neighbouring chords of different length bend differently, by a part of the sagitta."""
    angle = 5 * uneven(60, 20.0)
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    dense = np.stack([np.cos(np.linspace(0, 5, 4001)), np.sin(np.linspace(0, 5, 4001))], axis=1)
    before = np.abs(np.linalg.norm((points[1:] + points[:-1]) / 2, axis=1) - 1).max()
    assert distances(rounded(points, NONE)[0], dense).max() <= 0.5 * before


def test_a_stem_stays_straight() -> None:
    """A long segment beside a small bow, as in J or U, does not bulge."""
    bow = np.stack([np.cos(np.linspace(0, -np.pi, 9)), np.sin(np.linspace(0, -np.pi, 9))], axis=1)
    letter = np.concatenate([[[1.0, 20.0]], bow, [[-1.0, 20.0]]])
    smooth, _ = rounded(letter, NONE)
    stem = smooth[smooth[:, 1] > 0.2]
    assert np.abs(np.abs(stem[:, 0]) - 1).max() <= 0.02
    bottom = smooth[smooth[:, 1] < -0.2]
    assert np.linalg.norm(bottom, axis=1) == pytest.approx(1.0, abs=0.01)


def test_dense_strokes_are_not_cut_finer() -> None:
    """Where neighbours turn by less than a facet nothing is added."""
    angle = np.linspace(0, 5, 200)
    points = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    assert rounded(points, NONE)[0] is points


def test_in_space() -> None:
    """A helix from twenty points."""
    angle = np.linspace(0, 6, 20)
    helix = np.stack([np.cos(angle), np.sin(angle), 0.2 * angle], axis=1)
    smooth, _ = rounded(helix, NONE)
    off = np.abs(np.linalg.norm(smooth[:, :2], axis=1) - 1)
    assert off.max() <= 2e-3
    assert len(smooth) > 2 * len(helix)
