"""A stretch of a polyline as a sampled splice: itself, exactly."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.sampled import SampledSplice
from multirep.splines import compiled

#: A kink whose rounding off stays below this many sampling tolerances is no corner. A hop has room
#: for eight (the fit gets seven of them): larger leaves kinks to the fit that it can only follow
#: with many knots, smaller gives a smooth curve corners where it needs none.
HIDDEN = 4.0
#: Half an ulp, relative.
UNIT = 2.0**-53


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
    if all_t[first - 1] == a and all_t[last] == b:  # ends at vertices: nothing is even copied
        new_t, rows = all_t[first - 1 : last + 1], all_points[first - 1 : last + 1]
        to_fill: tuple[Array, Array] | tuple[None, None] = None, None
    else:
        to_fill = new_t, rows = (
            np.empty(last - first + 2),
            np.empty((last - first + 2, points.shape[1])),
        )
    cut = compiled.core.stretch if compiled.active else _cut
    limit = 8 * HIDDEN * tolerance
    bound, corners = cut(all_t, all_points, first, last, a, b, limit, UNIT, *to_fill)
    return SampledSplice.unchecked(new_t, rows, bound, tuple(corners))


def _cut(
    t: Array,
    points: Array,
    first: int,
    last: int,
    start: float,
    stop: float,
    limit: float,
    unit: float,
    new_t: Array | None,
    rows: Array | None,
) -> tuple[float, list[float]]:
    """Fill in a stretch, if asked to; return the rounding at its ends and its corners."""
    corners = [c for c in _corners(t, points, limit).tolist() if start <= c <= stop]
    if new_t is None or rows is None:
        return 0.0, corners
    new_t[1:-1], rows[1:-1] = t[first:last], points[first:last]
    bound = 0.0
    for end, k, at in ((0, first - 1, start), (-1, last - 1, stop)):
        low, high = points[k], points[k + 1]
        u = (at - t[k]) / (t[k + 1] - t[k])
        new_t[end], rows[end] = at, high if u == 1.0 else low + u * (high - low)
        if at not in (t[k], t[k + 1]):
            rounding = (5 * np.abs(high - low) + np.abs(rows[end])).tolist()
            bound = max(bound, unit * math.sqrt(sum([part * part for part in rounding])))
    return bound, corners


def _corners(t: Array, points: Array, limit: float) -> Array:
    """Parameters of the inner vertices whose kink shows at this limit.

    With J the jump of the slope and h the shorter of the neighbouring segments, the smooth curve
    that leaves them at their middles and rounds the vertex off with a parabola passes it at a
    distance of J h / 8; J h may not exceed the limit.
    """
    if len(t) < 3:
        return t[:0]
    steps, h = points[1:] - points[:-1], t[1:] - t[:-1]
    shorter = np.minimum(h[1:], h[:-1])
    # J h without dividing by h alone: slopes of tiny segments overflow
    jump = steps[1:] * (shorter / h[1:])[:, None] - steps[:-1] * (shorter / h[:-1])[:, None]
    result: Array = t[1:-1][np.sqrt(np.einsum("ij,ij->i", jump, jump)) > limit]
    return result
