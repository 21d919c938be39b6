"""A representation as lines on the page: sampled as finely as the page can show."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representation import Representation

#: How far the drawn line may be from the curve, and how close two drawn points may be, in page
#: units.
DRAWN_WITHIN, CLOSEST = 0.08, 0.5


def trace(curve: Representation, interval: Interval, scale: float) -> tuple[Array, Array]:
    """Sample a stretch for drawing.

    Parameters
    ----------
    curve : Representation
    interval : Interval
    scale : float
        Page units per unit of the data.

    Returns
    -------
    t, points : arrays (n,) and (n, d)
        Certified within :data:`DRAWN_WITHIN` on the page; points that fall together there are left
        out.
    """
    # Far from the origin a finer sample than rounding allows cannot be proved, nor seen.
    rounding = 64 * np.finfo(float).eps * curve.magnitude
    sampled = curve.sample(interval, tolerance=max(DRAWN_WITHIN / scale, rounding))
    t, points = np.asarray(sampled.t), np.asarray(sampled.points)
    return (t, points) if len(t) <= 3 else _thinned(t, points, CLOSEST / scale)


def _thinned(t: Array, points: Array, distance: float) -> tuple[Array, Array]:
    """Leave out points of the same cell of a grid as the one before; the ends stay."""
    cells = np.floor((points - points[0]) / distance)
    kept = np.concatenate([[True], (cells[1:] != cells[:-1]).any(axis=1)])
    kept[-1] = True
    return t[kept], points[kept]
