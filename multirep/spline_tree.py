"""The tree of capsules of a spline in block arrays, and that of its next version."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from multirep.arrays import Array, Flags, Indices
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.capsules import Known, Leaf, Pieces, Tree, capsule_around, capsules
from multirep.splines.polar import bernstein
from multirep.splines.rational import curve_points, homogeneous

__all__ = ["changed_spans", "spline_leaf", "spline_pieces", "spline_tree"]

#: Pieces that leave their chord by more than this part of the curve's size are halved, twice a
#: round and so many rounds at most.
FLAT = 1 / 512
_ROUNDS = 3
#: Rounding of the Bernstein form, in units in the last place.
_ULPS = 64
_EPS = float(np.finfo(np.float64).eps)


def spline_tree(
    known: Known,
    degree: int,
    knots: BlockArray,
    points: BlockArray,
    weights: BlockArray | None = None,
    parameters: Callable[[Array], Array] | None = None,
) -> Tree:
    """Return the tree of a spline, made from that of another version where there is one.

    Parameters
    ----------
    known : Known
        What the versions share; brought up to date.
    degree : int
    knots, points, weights : BlockArray
        (n + p + 1,), (n, d) and (n,).
    parameters : callable, optional
        From stored knots to parameters.

    Notes
    -----
    O(spans that differ from those of the version that ``known`` knows), and O(blocks).
    """
    p = degree
    arrays = (knots, points) if weights is None else (knots, points, weights)
    if known.is_of(arrays):
        return known.tree

    def build(first: int, stop: int) -> Leaf:
        window, rows = knots.window(first, stop + 2 * p + 1), points.window(first, stop + p)
        if parameters is not None:
            window = parameters(window)
        own = None if weights is None else weights.window(first, stop + p)
        return spline_leaf(window, rows, p, known.size, weights=own)

    tree: Tree | None = None
    if len(known.arrays) == len(arrays) and known.degree == p:
        old = known.arrays
        change = changed_spans(p, (old[0], knots), list(zip(old[1:], arrays[1:], strict=True)))
        tree = known.tree.renewed(build, *change)
    else:
        known.size = _size(points)
        tree = Tree.of(build, len(points) - p)
    known.learn(arrays, tree, p)
    return tree


def _size(points: BlockArray) -> float:
    """Return the longest edge of the bounding box."""
    edges = []
    for k in range(points.shape[1]):  # numpy is slow along short rows
        columns = [block[:, k] for block in points.blocks]
        edges.append(max([x.max() for x in columns]) - min([x.min() for x in columns]))
    return float(max(edges))


def changed_spans(
    degree: int,
    knots: tuple[BlockArray, BlockArray],
    rows: list[tuple[BlockArray, BlockArray]],
) -> tuple[int, int, int]:
    """Compare two versions of a spline.

    The piece on span k depends on control points k - p .. k and on knots k - p + 1 .. k + p, on
    nothing else. Spans are counted from the first of the domain, span p.

    Returns
    -------
    first, stop, shift : int
        The spans of the first version before ``first`` and from ``stop`` on are spans of the
        second too, those after moved by ``shift``. Nothing changed where ``first >= stop`` and the
        shift is 0.
    """
    p, (mine, theirs) = degree, knots
    n = len(mine) - p - 1
    first, stop = n, p
    if (change := _change(mine, theirs)) is not None:
        first, stop = change[0] - p, change[1] + p - 1
    for here, there in rows:
        if (change := _change(here, there)) is not None:
            first, stop = min(first, change[0]), max(stop, change[1] + p)
    return max(first, p) - p, min(stop, n) - p, len(theirs) - len(mine)


def _change(mine: BlockArray, theirs: BlockArray) -> tuple[int, int] | None:
    """Return rows low, high: before low both are equal, and from high on, counted from the end.

    Unlike those of `BlockArray.difference` the two may overlap: in a row of equal numbers nobody
    can tell where one more was inserted, but the other arrays of the spline can.
    """
    low, high, other = mine.difference(theirs)
    if low == high == other:
        return None
    if len(mine) == len(theirs):
        return low, high
    _, tail = mine.shared(theirs)
    count = min(len(mine), len(theirs)) - tail
    count = min(count, max(2 * BLOCK_ROWS, len(mine) - high - tail))
    a = mine.window(len(mine) - tail - count, len(mine) - tail)
    b = theirs.window(len(theirs) - tail - count, len(theirs) - tail)
    differs = (a.view(np.int64) != b.view(np.int64)).reshape(count, -1).any(axis=1)[::-1]
    tail += int(differs.argmax()) if differs.any() else count
    return low, len(mine) - tail


def spline_leaf(
    knots: Array, points: Array, degree: int, size: float, *, weights: Array | None = None
) -> Leaf:
    """Put a capsule around a window of a spline; its pieces are made when they are looked at.

    Parameters
    ----------
    knots : (n + degree + 1,) array
    points : (n, d) array
        Control points.
    degree : int
    size : float
        Of the curve; decides how finely spans are cut.
    weights : (n,) array, keyword-only, optional
        Positive.

    Returns
    -------
    Leaf
        Of n - p spans, empty ones included.
    """
    count = len(points)
    ends = knots[degree : count + 1 : count - degree]
    whole = None
    if ends[0] < ends[1]:
        start, stop = curve_points(knots, points, weights, degree, ends)
        whole = capsule_around(points.T, start, stop)
    make = partial(_window_pieces, knots, points, weights, degree, size)
    return Leaf(count - degree, whole, make)


def _window_pieces(
    knots: Array, points: Array, weights: Array | None, degree: int, size: float
) -> Pieces:
    rows = points if weights is None else homogeneous(points, weights)
    return spline_pieces(knots, rows, degree, size, weights is not None)


def spline_pieces(
    knots: Array, coefficients: Array, degree: int, size: float, rational: bool
) -> Pieces:
    """Cut the spans of a window into pieces that are nearly straight and put capsules around them.

    A piece lies in the convex hull of its Bernstein points, since weights are positive: so no
    farther from its chord than they. See `spline_leaf`.
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
    return Pieces(starts, stops, nodes, np.ascontiguousarray(hulls))


def _cut(spans: Indices, starts: Array, stops: Array, bent: Flags) -> tuple[Indices, Array, Array]:
    """Cut the bent pieces in four, where floating-point numbers allow it."""
    parts = np.where(
        bent & (stops - starts > 64 * np.spacing(np.abs(starts) + np.abs(stops))), 4, 1
    )
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
