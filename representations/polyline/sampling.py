"""A stretch of a polyline as a sampled splice: itself, exactly."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.representations.polyline.splicing import UNIT
from multirep.sampled import SampledSplice, interpolate
from multirep.splines import compiled

#: A kink whose rounding off stays below this many sampling tolerances is no corner. A hop has room
#: for eight (the fit gets seven of them): larger leaves kinks to the fit that it can only follow
#: with many knots, smaller gives a smooth curve corners where it needs none.
HIDDEN = 4.0


def sample_stretch(
    t: BlockArray, points: BlockArray, interval: Interval, tolerance: float
) -> SampledSplice:
    """Sample [a, b], a stretch of positive length inside T.

    Returns
    -------
    SampledSplice
        Its bound is 0 when a and b are vertices. Else it is the rounding of the points there: with
        v the roundoff unit, evaluating p + u (q - p) costs five relative errors in u (q - p) and
        one in the sum, so at most v (5 ``|q - p|`` + ``|p + u (q - p)|``) in each coordinate.
    """
    a, b = interval
    first, last = t.searchsorted(a, "right"), t.searchsorted(b, "left")  # the vertices inside
    start, stop = max(first - 2, 0), min(last + 2, len(t))
    all_t, all_points = t.window(start, stop), points.window(start, stop)
    first, last = first - start, last - start
    corners = [c for c in _corners(all_t, all_points, tolerance).tolist() if a <= c <= b]
    if all_t[first - 1] == a and all_t[last] == b:  # ends at vertices: nothing is even copied
        rows = slice(first - 1, last + 1)
        return SampledSplice.unchecked(all_t[rows], all_points[rows], 0.0, tuple(corners))
    ends = interpolate(all_t, all_points, np.array([a, b]))
    bound = 0.0
    for k, end, at in ((first, 0, a), (last, 1, b)):
        if all_t[k - 1] != at and all_t[k] != at:
            rounding = 5 * np.abs(all_points[k] - all_points[k - 1]) + np.abs(ends[end])
            bound = max(bound, UNIT * math.sqrt(float(rounding @ rounding)))
    return SampledSplice.unchecked(
        np.concatenate([[a], all_t[first:last], [b]]),
        np.concatenate([ends[:1], all_points[first:last], ends[1:]]),
        bound,
        tuple(corners),
    )


def _corners(t: Array, points: Array, tolerance: float) -> Array:
    """Parameters of the inner vertices whose kink shows at this tolerance.

    With J the jump of the slope and h the shorter of the neighbouring segments, the smooth curve
    that leaves them at their middles and rounds the vertex off with a parabola passes it at a
    distance of J h / 8.
    """
    if compiled.active:
        return np.array(compiled.core.kinks(t, points, 8 * HIDDEN * tolerance))
    if len(t) < 3:
        return t[:0]
    steps, h = points[1:] - points[:-1], t[1:] - t[:-1]
    shorter = np.minimum(h[1:], h[:-1])
    # J h without dividing by h alone: slopes of tiny segments overflow
    jump = steps[1:] * (shorter / h[1:])[:, None] - steps[:-1] * (shorter / h[:-1])[:, None]
    shows = np.sqrt(np.einsum("ij,ij->i", jump, jump)) > 8 * HIDDEN * tolerance
    result: Array = t[1:-1][shows]
    return result
