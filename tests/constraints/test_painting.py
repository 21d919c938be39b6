"""Painting with a brush: what of a curve a stroke covers, and at what cost."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.constraints import Freeze, painting
from multirep.constraints.painting import painted
from multirep.constraints.pairing import TOGETHER
from multirep.errors import EditError
from multirep.representations import Polyline
from multirep.splices import SpliceList
from multirep.tools import DirectManipulation


def session() -> mr.Session:
    """A wave from x = 0 to 6."""
    made = mr.Session()
    x = np.linspace(0, 6, 80)
    points = np.column_stack([x, np.sin(x)])
    made.add("c", mr.MultiRepresentation.from_points(points, tolerance=1e-3))
    return made


def covered(polyline: Polyline, stroke: Any, radius: float, t: np.ndarray) -> np.ndarray:
    """By definition: distance of points to the segments of a stroke."""
    points, brush = polyline(t), np.asarray(stroke, dtype=float)
    best = np.full(len(t), np.inf)
    for a, b in pairwise(brush):
        w = b - a
        s = np.clip((points - a) @ w / (w @ w or 1.0), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - s[:, None] * w, axis=1))
    return best <= radius


@given(
    st.lists(st.tuples(st.integers(-8, 56), st.integers(-16, 16)), min_size=2, max_size=6),
    st.integers(1, 8),
)
def test_painting_covers_what_lies_under_the_brush(
    stroke: list[tuple[int, int]], radius: int
) -> None:
    """Compared point by point with the definition."""
    x = np.linspace(0, 6, 90)
    polyline = Polyline.from_points(np.column_stack([x, np.sin(x)]))
    path = np.asarray(stroke) / 8
    t = np.linspace(0, 1, 2001)
    try:
        found = painted(polyline, path, radius / 8)
    except EditError:
        assert covered(polyline, path, radius / 8, t).sum() <= 1
        return
    inside = np.array([found.contains(float(s)) for s in t])
    wrong = inside != covered(polyline, path, radius / 8, t)
    # only where a sample falls on the rim
    rim = covered(polyline, path, radius / 8 * (1 + 1e-6), t) != covered(
        polyline, path, radius / 8 * (1 - 1e-6), t
    )
    assert not (wrong & ~rim).any()


@pytest.mark.parametrize(
    "stroke",
    [
        [[1.0, 0.8]],
        [[1.0, 0.8], [1.0, 0.8], [1.0, 0.8]],
        [[0.9 + 1e-6 * k, 0.8] for k in range(1000)],
    ],
)
def test_strokes_as_people_draw_them(stroke: Any) -> None:
    """A dot, repeated points, a thousand points in one place."""
    x = np.linspace(0, 6, 90)
    polyline = Polyline.from_points(np.column_stack([x, np.sin(x)]))
    assert 0.02 < painted(polyline, stroke, 0.2).length < 0.2


def pair_by_pair(polyline: Polyline, stroke: Any, radius: float) -> SpliceList:
    """Each segment against each hull of two discs, and their union."""
    brush = painting._thinned(np.asarray(stroke, dtype=float), radius / 16)
    t, points = np.asarray(polyline.t), np.asarray(polyline)
    found = SpliceList.EMPTY
    for a, b in pairwise(brush):
        axis = np.repeat([a, b - a], [len(t) - 1, len(t) - 1], axis=0).reshape(2, len(t) - 1, -1)
        low, high = painting._inside(points[:-1], np.diff(points, axis=0), *axis, radius)
        span = np.diff(t)
        starts = np.where(low <= 0, t[:-1], t[:-1] + low * span)
        stops = np.where(high >= 1, t[1:], t[:-1] + high * span)
        found |= SpliceList(
            (x, y) for x, y, some in zip(starts, stops, high > low, strict=True) if some
        )
    return found


@given(
    st.integers(1, 3),
    st.integers(2, 300),
    st.integers(1, 80),
    st.sampled_from([2.0**-6, 0.125, 1.0, 8.0]),
    st.integers(0, 2**32 - 1),
)
def test_boxes_leave_out_nothing_that_counts(
    dimension: int, count: int, samples: int, radius: float, seed: int
) -> None:
    """From coarse to fine gives the bits of each pair by itself, wherever curve and brush go."""
    rng = np.random.default_rng(seed)
    steps = rng.integers(-8, 9, (count, dimension)) / rng.choice([8, 64, 512], (count, 1))
    steps[-1, 0] = 1
    polyline = Polyline(np.arange(count), steps.cumsum(axis=0))
    stroke = polyline.points[rng.integers(0, count)] + np.cumsum(
        rng.integers(-4, 5, (samples, dimension)) / rng.choice([4, 32, 256], (samples, 1)), axis=0
    )
    expected = pair_by_pair(polyline, stroke, radius)
    if expected:
        assert painted(polyline, stroke, radius) == expected
    else:
        with pytest.raises(EditError, match="covers nothing"):
            painted(polyline, stroke, radius)


def test_only_what_is_at_the_rim_is_looked_at_closely(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pairs of a segment and a piece of brush: some at the rim, a few per piece of a thin brush."""
    looked: list[int] = []

    def counted(p: Any, *others: Any) -> Any:
        looked.append(len(p))
        return inside(p, *others)

    inside = painting._inside
    monkeypatch.setattr(painting, "_inside", counted)
    n = 20_001
    line = Polyline(np.linspace(0, 1, n), np.linspace([0, 0], [10, 0], n))
    there = np.linspace([2, 0.1], [7, 0.1], 6_401)
    once = painted(line, there, 0.5)
    assert sum(looked) <= 500
    looked.clear()
    many = painted(line, np.concatenate([there, there[::-1]] * 10), 0.5)
    assert list(many.hull) == pytest.approx(list(once.hull), abs=0.05 / 16)  # of skipped points
    assert len(many) == 1
    assert sum(looked) <= 20 * 500
    looked.clear()
    painted(line, there - [0, 0.1], 2.0**-10)
    assert sum(looked) <= 8 * n
    assert max(looked) <= TOGETHER


def test_a_stroke_far_away_is_refused() -> None:
    """It says that nothing is covered."""
    made = session()
    with pytest.raises(EditError, match="covers nothing"):
        made.constrain("c", Freeze(stroke=[[0, 50], [1, 50]], radius=0.1))
    assert not made.curve("c").frozen


def test_a_painted_stretch_is_frozen_as_it_was_when_it_was_painted() -> None:
    """The curve may move under the stroke later; what is frozen stays the same stretch."""
    made = session()
    made.constrain("c", Freeze(stroke=[[1.0, 0.9], [2.0, 0.9]], radius=0.3), name="paint")
    frozen = made.curve("c").frozen
    made.apply("c", DirectManipulation(t=0.6, to=(1.5, 0.9)))
    assert made.curve("c").frozen == frozen
