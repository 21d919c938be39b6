"""Leaves of the nearest-place tree from windows of a spline."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.capsules import Leaf, capsules
from multirep.splines.polar import bernstein

__all__ = ["spline_leaf"]

#: Pieces that leave their chord by more than this part of the curve's size are halved, twice a
#: round and so many rounds at most.
FLAT = 1 / 512
_ROUNDS = 3
#: Rounding of the Bernstein form, in units in the last place.
_ULPS = 64
_EPS = float(np.finfo(np.float64).eps)


def spline_leaf(
    knots: Array, coefficients: Array, degree: int, size: float, *, rational: bool = False
) -> Leaf:
    """Cut the spans of a window into pieces and put capsules around them.

    Parameters
    ----------
    knots : (n + degree + 1,) array
    coefficients : (n, d) array, or (n, d + 1) if rational
        Homogeneous control points; weights are positive.
    degree : int
    size : float
        Of the curve; decides how finely spans are cut.
    rational : bool, keyword-only

    Returns
    -------
    Leaf
        Of n - p spans, empty ones included.

    Notes
    -----
    A piece lies in the convex hull of its Bernstein points, since weights are positive: so no
    farther from its chord than they.
    """
    count = len(coefficients)
    spans = np.flatnonzero(knots[degree:count] < knots[degree + 1 : count + 1]) + degree
    starts, stops = knots[spans], knots[spans + 1]
    for turn in range(_ROUNDS + 1):
        hulls = bernstein(knots, coefficients, degree, spans, starts, stops).transpose(1, 2, 0)
        points = hulls[:, :-1] / hulls[:, -1:] if rational else hulls
        nodes, radius = _around(points)
        bent = radius > FLAT * size
        if turn == _ROUNDS or not bent.any():
            break
        spans, starts, stops = _cut(spans, starts, stops, bent)
    nodes[-1] = radius
    return Leaf(count - degree, starts, stops, nodes, np.ascontiguousarray(hulls))


def _cut(
    spans: Indices, starts: Array, stops: Array, bent: Array
) -> tuple[Indices, Array, Array]:
    """Cut the bent pieces in four, where floating-point numbers allow it."""
    parts = np.where(bent & (stops - starts > 64 * np.spacing(np.abs(starts) + np.abs(stops))), 4, 1)
    ends = parts.cumsum()
    share = (np.arange(ends[-1]) - (ends - parts).repeat(parts)) / parts.repeat(parts)
    cuts = starts.repeat(parts) + share * (stops - starts).repeat(parts)
    after = np.append(cuts[1:], stops[-1:])
    last = ends - 1
    after[last] = stops
    return spans.repeat(parts), cuts, after


def _around(points: Array) -> tuple[Array, Array]:
    """Chords and radii of pieces with Euclidean Bernstein points (p + 1, d, m)."""
    nodes = capsules(points[0], points[-1], 0.0)
    dimension = points.shape[1]
    chords, inverse = nodes[dimension:-2], nodes[-2]
    radius = np.zeros(points.shape[2])
    for row in points[1:-1]:
        offsets = row - points[0]
        u = np.einsum("dm,dm->m", offsets, chords) * inverse
        np.clip(u, 0.0, 1.0, out=u)
        offsets -= u * chords
        np.maximum(radius, np.einsum("dm,dm->m", offsets, offsets), out=radius)
    radius = np.sqrt(radius) + nodes[-1]
    if points.size:
        radius += _ULPS * _EPS * np.abs(points).max(axis=(0, 1))
    return nodes, radius
