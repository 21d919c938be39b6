"""The nearest place, against brute force, and that it looks at little of a long curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nurbs_cases import curves, smooth_curve

from multirep.blocks import BLOCK_ROWS
from multirep.errors import InvalidCurveError
from multirep.nearest import nearest_by_sampling
from multirep.representations import Nurbs


@given(curves(), st.lists(st.integers(-320, 320), min_size=3, max_size=3))
def test_no_place_is_nearer(curve: Nurbs, numbers: list[int]) -> None:
    """Any degree, rational or not: as near as the nearest of 4001 points, and on the curve."""
    point = np.array(numbers[: curve.dimension]) / 64
    found = curve.nearest(point)
    there = curve(np.linspace(0, 1, 4001))
    assert found.distance <= np.linalg.norm(there - point, axis=1).min() + 1e-9
    assert (curve(found.t) == found.point).all()
    assert found.distance == pytest.approx(np.linalg.norm(found.point - point), abs=1e-12)
    if curve.magnitude:
        by_sampling = nearest_by_sampling(curve, point)
        assert found.distance == pytest.approx(by_sampling.distance, abs=1e-8)


def test_pieces_far_away_are_not_made() -> None:
    """On a long curve only the spans around the answer are cut into pieces."""
    curve = smooth_curve(12 * BLOCK_ROWS)
    found = curve.nearest(curve(0.3) + 1e-5)
    assert found.t == pytest.approx(0.3, abs=1e-4)
    assert sum("pieces" in vars(leaf) for leaf in curve._known.tree.leaves) <= 3


def test_spans_across_blocks() -> None:
    """The nearest place on a span whose control points lie in two blocks is found."""
    n = 3 * BLOCK_ROWS
    t = np.linspace(0, 1, n)
    points = np.stack([t, np.zeros(n)], axis=1)
    for peak in (BLOCK_ROWS - 2, BLOCK_ROWS - 1, BLOCK_ROWS, BLOCK_ROWS + 1):
        rows = points.copy()
        rows[peak, 1] = 1.0
        inner = np.linspace(0, 1, n - 2)[1:-1]
        curve = Nurbs(degree=3, knots=[*[0.0] * 4, *inner, *[1.0] * 4], points=rows)
        found = curve.nearest([t[peak], 1.0])
        assert found.distance == pytest.approx(1 / 3, abs=1e-6)


def test_nonsense_is_refused() -> None:
    """A point of another dimension, or none."""
    for point in ([0.0], [0.0, np.nan], [[0.0, 0.0, 0.0]]):
        with pytest.raises(InvalidCurveError, match="2 coordinates"):
            smooth_curve(9).nearest(point)
