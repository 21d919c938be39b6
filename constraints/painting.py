"""What a brush stroke covers of a polyline."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from multirep.arrays import Array, ArrayLike, Indices
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
    One pass over the segments in the bounding box of the stroke for each of its own; O(n) for the
    box.

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
    low, high = brush.min(axis=0) - radius, brush.max(axis=0) + radius
    k = _boxed(points[:-1], points[1:], low, high)
    covered: list[tuple[float, float]] = []
    for a, b in pairwise(brush):
        near = k[
            _boxed(points[k], points[k + 1], np.minimum(a, b) - radius, np.maximum(a, b) + radius)
        ]
        start, stop = _inside(points[near], points[near + 1] - points[near], a, b - a, radius)
        hit = stop > start
        near, start, stop = near[hit], start[hit], stop[hit]
        span = t[near + 1] - t[near]
        begin = np.where(start <= 0, t[near], t[near] + start * span)
        end = np.where(stop >= 1, t[near + 1], t[near] + stop * span)
        covered += list(zip(begin.tolist(), end.tolist(), strict=True))
    if not covered:
        raise EditError(f"the stroke of radius {radius:g} covers nothing of the curve")
    return SpliceList(covered)


def _thinned(points: Array, spacing: float) -> Array:
    """Drop points closer than ``spacing`` to the last one kept; at least two remain."""
    kept = [0]
    for k in range(1, len(points)):
        if np.linalg.norm(points[k] - points[kept[-1]]) >= spacing:
            kept.append(k)
    if kept[-1] != len(points) - 1 or len(kept) == 1:
        kept.append(len(points) - 1)
    return points[kept]


def _boxed(one: Array, other: Array, low: Array, high: Array) -> Indices:
    """Return the indices of the segments whose box meets a box."""
    meets = (np.maximum(one, other) >= low) & (np.minimum(one, other) <= high)
    return np.flatnonzero(meets.all(axis=1))


def _inside(p: Array, v: Array, a: Array, w: Array, radius: float) -> tuple[Array, Array]:
    """Parts s in [0, 1] of the segments p + s v within ``radius`` of the one from a to a + w.

    The hull of what lies in the two discs at the ends and in the cylinder between them.
    """
    starts, stops = [], []
    for centre in (a, a + w):
        start, stop = _below(v, p - centre, radius)
        starts.append(start)
        stops.append(stop)
    square = float(w @ w)
    if square > 0:
        # Distance from the axis, and the place along it, which must be between 0 and 1.
        along, shift = v @ w / square, (p - a) @ w / square
        start, stop = _below(v - along[:, None] * w, p - a - shift[:, None] * w, radius)
        with np.errstate(divide="ignore", invalid="ignore"):
            ends = np.stack([-shift / along, (1 - shift) / along])
        level = along == 0
        inside = (shift >= 0) & (shift <= 1)
        low = np.where(level, np.where(inside, 0.0, 2.0), np.fmin(*ends))
        high = np.where(level, np.where(inside, 1.0, -1.0), np.fmax(*ends))
        starts.append(np.maximum(start, low))
        stops.append(np.minimum(stop, high))
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
