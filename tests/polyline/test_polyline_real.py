"""The polyline on curves that people drew and surveyed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from corpus import items, unpack
from polyline_reference import check_edit, distance_on_chords

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representations.polyline import Polyline, chord_length


def curves() -> Iterator[tuple[str, Array]]:
    """Airfoils, all strokes, and the coastlines but for the largest."""
    for airfoil in items("airfoils"):
        yield airfoil["name"], np.array(airfoil["points"])
    for drawing in items("strokes"):
        for k, stroke in enumerate(drawing["strokes"]):
            yield f"{drawing['name']}/{k}", np.array(stroke, dtype=float)
    for ring in sorted(items("coastlines"), key=lambda ring: ring["n"])[:-1]:
        yield ring["name"], np.array(unpack(ring))


CURVES = dict(curves())


def test_every_curve_is_a_polyline() -> None:
    """Points become vertices, in order; repeats are merged and counted."""
    for points in CURVES.values():
        found = chord_length(np.repeat(points, 2, axis=0))
        assert len(found.t) + found.merged == 2 * len(points)
        assert (np.diff(found.t) > 0).all()
        assert found.points.tolist() == np.asarray(Polyline.from_points(points)).tolist()


@pytest.mark.parametrize("relative", [1e-2, 1e-3, 1e-4])
def test_a_second_polyline_follows_the_first(relative: float) -> None:
    """Fitted to exact samples, it stays within the tolerance and has fewer vertices."""
    for points in CURVES.values():
        first = Polyline.from_points(points)
        tolerance = relative * float(np.ptp(points, axis=0).max())
        sampled = first.sample(first.domain, tolerance=tolerance / 16)
        second = Polyline.fit(sampled, tolerance=tolerance)
        assert second.size <= first.size
        assert distance_on_chords(second, sampled).max() <= tolerance * (1 + 1e-12)
        assert set(sampled.breaks) <= set(second.t.tolist())


def test_splices_of_coastlines_into_their_simplifications() -> None:
    """Stretch by stretch the exact coast replaces the coarse one; the rest stays bit by bit."""
    rng = np.random.default_rng(8)
    points = max(CURVES.values(), key=len)
    exact = Polyline.from_points(points)
    tolerance = 1e-3 * float(np.ptp(points, axis=0).max())
    whole = exact.sample(exact.domain, tolerance=tolerance)
    coarse = Polyline.fit(whole, tolerance=tolerance)
    for _ in range(20):
        a, b = np.sort(rng.uniform(0, 1, 2)).tolist()
        sampled = exact.sample(Interval(a, b), tolerance=tolerance)
        coarse = check_edit(coarse, coarse.splice(sampled, tolerance=1.01 * tolerance))
        assert distance_on_chords(coarse, sampled).max() <= 1.01 * tolerance * (1 + 1e-12)
    assert coarse.size < exact.size / 2
