"""Real outlines: proved, and with fewer control points than halving spans alone would take."""

from __future__ import annotations

import numpy as np
import pytest
from corpus import items, unpack

from multirep import SampledSplice
from multirep.bounds import spline_chord_deviation
from multirep.representations import WaveletBSpline
from multirep.representations.polyline import chord_length

#: Control points on graded knots of the published sketch (a least-squares fit, every failing span
#: halved, looked at and not proved), for fits within 0.375 of 1e-2, 1e-3, 1e-4 of the box.
SKETCHED = {"land-10m/ring6@-61.1,82.3": (674, 3422, 12446), "e636": (23, 52, 176)}


def points_of(name: str) -> np.ndarray:
    if name.startswith("land"):
        (ring,) = (item for item in items("coastlines") if item["name"] == name)
        return np.array(unpack(ring))
    (foil,) = (item for item in items("airfoils") if item["name"] == name)
    return np.array(foil["points"])


@pytest.mark.parametrize("name", SKETCHED)
@pytest.mark.parametrize("place", [0, 1, 2])
def test_outlines_take_fewer_control_points_than_the_sketch(name, place):
    """Within the tolerance by an independent proof, with 85 per cent of the sketch at most."""
    found = chord_length(points_of(name))
    t, points = np.asarray(found.t), np.asarray(found.points)
    tolerance = 0.375 * 10.0 ** -(2 + place) * np.ptp(points, axis=0).max()
    fitted = WaveletBSpline.fit(SampledSplice(t, points), tolerance=tolerance)
    proved = spline_chord_deviation(
        np.asarray(fitted.knots), np.asarray(fitted.points), 3, t, points, splits=4
    )
    assert proved.max() <= 1.002 * tolerance
    assert fitted.size <= 0.85 * SKETCHED[name][place]
