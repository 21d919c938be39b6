"""What a brush stroke covers of a polyline."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array, ArrayLike, Flags, Indices
from multirep.errors import EditError
from multirep.representations.polyline import Polyline
from multirep.splices import SpliceList

#: Points of a stroke that are closer than this part of the radius to the last one are skipped; the
#: brush is wider than what that loses by a factor of 16.
SPACING = 1 / 16
#: So many segments of a stroke are compared with the curve at once. More cost memory where the
#: curve is dense, fewer cost calls.
TOGETHER = 64


def painted(curve: Polyline, stroke: ArrayLike, radius: float) -> SpliceList:
    """Return where a polyline is within ``radius`` of a stroke.

    Parameters
    ----------
    curve : Polyline
    stroke : (m, d) array_like
        Joined by straight lines; repeated points and single ones are fine.
    radius : float
        Above 0.

    Returns
    -------
    SpliceList
        Exact but for the skipped points: a segment meets the convex hull of two discs in one
        interval.

    Raises
    ------
    EditError
        When the stroke has another dimension or nothing is covered.

    Notes
    -----
    O(n) for the bounding box of the stroke; then 64 segments of it at a time against those of the
    curve in reach of them that are not covered yet.

    Examples
    --------
    >>> line = Polyline([0, 1], [[0, 0], [4, 0]])
    >>> print(painted(line, [[1, 0.5], [2, 0.5]], 0.5))
    [1/4,1/2]
    """
    brush = _thinned(np.asarray(stroke, dtype=np.float64), SPACING * radius)
    if brush.shape[1] != curve.dimension:
        raise EditError(f"a stroke in {brush.shape[1]} coordinates on a curve in {curve.dimension}")
    t, points = np.asarray(curve.t), np.asarray(curve.points)
    begins, ends = points[:-1], points[1:]
    k = _near(begins, ends, brush, radius)
    covered: list[tuple[float, float]] = []
    for first in range(0, len(brush) - 1, TOGETHER):
        strip = brush[first : first + TOGETHER + 1]
        near = k[_near(begins[k], ends[k], strip, radius)]
        low, high = np.minimum(strip[1:], strip[:-1]), np.maximum(strip[1:], strip[:-1])
        meets = _boxed(begins[near], ends[near], low[:, None] - radius, high[:, None] + radius)
        of, hit = meets.nonzero()
        hit = near[hit]
        a, w = strip[of], strip[of + 1] - strip[of]
        start, stop = _inside(begins[hit], ends[hit] - begins[hit], a, w, radius)
        inside = stop > start
        hit, start, stop = hit[inside], start[inside], stop[inside]
        span = t[hit + 1] - t[hit]
        lows = np.where(start <= 0, t[hit], t[hit] + start * span)
        highs = np.where(stop >= 1, t[hit + 1], t[hit] + stop * span)
        covered += _joined(lows, highs)
        # What is covered already need not be looked at again: people paint to and fro.
        k = k[~np.isin(k, hit[(start <= 0) & (stop >= 1)])]
    if not covered:
        raise EditError(f"the stroke of radius {radius:g} covers nothing of the curve")
    return SpliceList(covered)


def _thinned(points: Array, spacing: float) -> Array:
    """Drop points closer than ``spacing`` to the last one kept; at least two remain."""
    rows = points.tolist()  # one depends on the other: Python is ten times faster without arrays
    kept, last = [0], rows[0]
    for k, row in enumerate(rows):
        if math.dist(row, last) >= spacing:
            kept.append(k)
            last = row
    if kept[-1] != len(points) - 1 or len(kept) == 1:
        kept.append(len(points) - 1)
    return points[kept]


def _joined(starts: Array, stops: Array) -> list[tuple[float, float]]:
    """Join intervals that overlap; most of those under one strip of the brush do."""
    order = starts.argsort()
    starts, reach = starts[order], np.maximum.accumulate(stops[order])
    apart = np.flatnonzero(starts[1:] > reach[:-1])
    first, last = np.append(0, apart + 1), np.append(apart, len(starts) - 1)
    return (
        list(zip(starts[first].tolist(), reach[last].tolist(), strict=True)) if len(reach) else []
    )


def _near(begins: Array, ends: Array, brush: Array, radius: float) -> Indices:
    """Return the indices of the segments in reach of the box of a part of the brush."""
    low, high = brush.min(axis=0) - radius, brush.max(axis=0) + radius
    return _boxed(begins, ends, low, high).nonzero()[0]


def _boxed(one: Array, other: Array, low: Array, high: Array) -> Flags:
    """Say which segments have a box that meets a box."""
    meets = (np.maximum(one, other) >= low) & (np.minimum(one, other) <= high)
    return np.asarray(meets.all(axis=-1))


def _inside(p: Array, v: Array, a: Array, w: Array, radius: float) -> tuple[Array, Array]:
    """Parts s in [0, 1] of the segments p + s v within ``radius`` of those from a to a + w.

    Row by row; the hull of what lies in the two discs at the ends and in the cylinder between them.
    """
    starts, stops = [], []
    for centre in (a, a + w):
        start, stop = _below(v, p - centre, radius)
        starts.append(start)
        stops.append(stop)
    square = np.einsum("md,md->m", w, w)
    # Distance from the axis, and the place along it, which must be between 0 and 1.
    with np.errstate(divide="ignore", invalid="ignore"):
        along = np.einsum("md,md->m", v, w) / square
        shift = np.einsum("md,md->m", p - a, w) / square
        start, stop = _below(v - along[:, None] * w, p - a - shift[:, None] * w, radius)
        ends = np.stack([-shift / along, (1 - shift) / along])
        level = along == 0
        between = (shift >= 0) & (shift <= 1)
        low = np.where(level, np.where(between, 0.0, 2.0), np.fmin(*ends))
        high = np.where(level, np.where(between, 1.0, -1.0), np.fmax(*ends))
        # a brush that stands still is a disc
        starts.append(np.where(square > 0, np.maximum(start, low), 2.0))
        stops.append(np.where(square > 0, np.minimum(stop, high), -1.0))
    begin, end = np.stack(starts).clip(0, None), np.stack(stops).clip(None, 1)
    empty = end <= begin
    return (
        np.where(empty, np.inf, begin).min(axis=0),
        np.where(empty, -np.inf, end).max(axis=0),
    )


def _below(v: Array, u: Array, radius: float) -> tuple[Array, Array]:
    """Where ``|u + s v| <= radius``, as [start, stop]; reversed when nowhere."""
    a = np.einsum("md,md->m", v, v)
    b = np.einsum("md,md->m", v, u)
    c = np.einsum("md,md->m", u, u) - radius * radius
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        start, stop = (-b - root) / a, (-b + root) / a
    never = b * b - a * c < 0
    still = a == 0
    inside = c <= 0
    start = np.where(still, np.where(inside, 0.0, 2.0), np.where(never, 2.0, start))
    stop = np.where(still, np.where(inside, 1.0, -1.0), np.where(never, -1.0, stop))
    return start, stop
