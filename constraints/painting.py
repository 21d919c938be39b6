"""What a brush stroke covers of a polyline."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array, ArrayLike, Flags, Indices
from multirep.constraints.pairing import Boxes, near_pairs
from multirep.errors import EditError
from multirep.representations.polyline import Polyline
from multirep.splices import SpliceList

#: Points of a stroke that are closer than this part of the radius to the last one are skipped; the
#: brush is wider than what that loses by a factor of 16.
SPACING = 1 / 16


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
    A hull of two discs is convex, so a box of segments that lies in one is covered, and nobody
    looks into it; segments at its rim are cut. O(n + m) but for what runs along the rim.

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
    near = _in_reach(points, brush, radius)
    begins, ends, first, last = points[near], points[near + 1], t[near], t[near + 1]
    axes, steps = brush[:-1], brush[1:] - brush[:-1]
    segments = Boxes.of(np.minimum(begins, ends), np.maximum(begins, ends))
    discs = Boxes.of(np.minimum(axes, brush[1:]), np.maximum(axes, brush[1:]))

    def inside(level: int, of: Indices, by: Indices) -> Flags:
        """Whether boxes of segments lie in the hull in the middle of each run of the brush."""
        low, high = (side[of] for side in segments.at(level))
        by = discs.middles(level, by)
        off = 0.5 * (low + high) - axes[by]
        step = steps[by]
        square = np.einsum("md,md->m", step, step)
        along = np.einsum("md,md->m", off, step) / np.where(square > 0, square, 1.0)
        off -= np.clip(along, 0.0, 1.0)[:, None] * step
        reach = radius - 0.5 * np.sqrt(np.einsum("md,md->m", high - low, high - low))
        return np.asarray((reach > 0) & (np.einsum("md,md->m", off, off) <= reach * reach))

    starts, stops = [], []
    covered = np.zeros(len(near), dtype=bool)
    for of, by in near_pairs(segments, discs, radius, inside, covered):
        start, stop = _inside(begins[of], ends[of] - begins[of], axes[by], steps[by], radius)
        covered[of[(start <= 0) & (stop >= 1)]] = True
        some = stop > start
        of, start, stop = of[some], start[some], stop[some]
        span = last[of] - first[of]
        starts.append(np.where(start <= 0, first[of], first[of] + start * span))
        stops.append(np.where(stop >= 1, last[of], first[of] + stop * span))
    found = _joined(
        np.concatenate([first[covered], *starts]), np.concatenate([last[covered], *stops])
    )
    if not found:
        raise EditError(f"the stroke of radius {radius:g} covers nothing of the curve")
    return SpliceList(found)


def _in_reach(points: Array, brush: Array, radius: float) -> Indices:
    """Return the segments whose box meets that of the brush."""
    low, high = brush.min(axis=0) - radius, brush.max(axis=0) + radius
    below, above = points < low, points > high  # a segment is away if both its ends are
    away = (below[1:] & below[:-1]) | (above[1:] & above[:-1])
    return np.flatnonzero(~away.any(axis=1))


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
