"""Detail in a few places costs control points there and nowhere else, however long the curve is."""

import numpy as np
import pytest

import multirep as mr
from multirep.representations import Polyline, WaveletBSpline

TOLERANCE = 1e-4
#: Where the curve is rough, and for how long.
PLACES, WIDTH = (0.125, 0.3, 0.71, 0.9), 2e-4


def detailed(n, places=PLACES):
    """An arc with bursts of waves 20 vertices long at n = 10^6."""
    t = np.linspace(0, 1, n)
    points = np.column_stack([np.cos(3 * t), np.sin(3 * t)])
    for place in places:
        near = np.abs(t - place) < WIDTH
        rise = np.cos(0.5 * np.pi * (t[near] - place) / WIDTH) ** 2
        points[near, 1] += 0.01 * rise * np.sin(2 * np.pi * (t[near] - place) / 2e-5)
    return t, points


def test_a_million_vertices_store_only_what_they_need():
    """A hundredth of a per cent of the uniform level; the pyramid's finest level only at bursts."""
    t, points = detailed(1_000_000)
    curve = mr.MultiRepresentation.from_points(points, t=t, tolerance=TOLERANCE)
    wavelet = curve.view(WaveletBSpline)
    assert wavelet.level >= 17
    assert wavelet.size <= 2000 < 2**wavelet.level // 64
    knots = np.asarray(wavelet.knots)
    near = np.min([np.abs(knots - place) for place in PLACES], axis=0) < 2 * WIDTH
    assert (~near).sum() <= 150
    assert curve.deviation(Polyline, WaveletBSpline).upper <= TOLERANCE


@pytest.mark.parametrize("places", [0, 1, 2, 4])
def test_size_grows_with_the_detail(places):
    """Each burst costs the same, whether or not there are others."""
    sizes = []
    for some in (PLACES[:places], ()):
        t, points = detailed(200_000, some)
        curve = mr.MultiRepresentation.from_points(points, t=t, tolerance=TOLERANCE)
        sizes.append(curve.view(WaveletBSpline).size)
    assert sizes[0] - sizes[1] <= 500 * places


def test_an_edit_of_a_fine_level_costs_its_window():
    """At level 16 in a burst among a million vertices: a few control points, and that stretch."""
    t, points = detailed(1_000_000)
    curve = mr.MultiRepresentation.from_points(points, t=t, tolerance=TOLERANCE)
    wavelet = curve.view(WaveletBSpline)
    edit = wavelet.sweep(PLACES[1], wavelet(PLACES[1]) + np.array([0.0, 0.01]), 16)
    assert edit.splices.length <= 16 * 2.0**-16
    assert edit.value.size <= wavelet.size + 40
    curve.commit(WaveletBSpline, edit)
    with curve.listening() as events:
        after = curve.view(Polyline)
    fitted = [event for event in events if type(event).__name__ == "Fitted"]
    assert sum(event.interval.length for event in fitted) <= 64 * 2.0**-16
    assert curve.deviation(Polyline, WaveletBSpline, edit.splices.hull).upper <= TOLERANCE
    assert abs(after.size - 1_000_000) < 200
