"""The tree of capsules of a spline in block arrays, and that of its next version."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray
from multirep.capsules import Known, Leaf, Tree, capsules
from multirep.splines.polar import bernstein

__all__ = ["changed_spans", "spline_leaf", "spline_tree"]

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
        if weights is not None:
            w = weights.window(first, stop + p)[:, None]
            rows = np.concatenate((rows * w, w), axis=1)
        return spline_leaf(window, rows, p, known.size, rational=weights is not None)

    tree: Tree | None = None
    if len(known.arrays) == len(arrays) and known.degree == p:
        old = known.arrays
        change = changed_spans(p, (old[0], knots), list(zip(old[1:], arrays[1:], strict=True)))
        tree = known.tree.renewed(build, *change)
    else:
        low, high = (
            np.array([edge(block, axis=0) for block in points.blocks]) for edge in (np.min, np.max)
        )
        known.size = float((high.max(axis=0) - low.min(axis=0)).max())
        tree = Tree.of(build, len(points) - p)
    known.learn(arrays, tree, p)
    return tree


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
    shift = len(theirs) - len(mine)
    low, high, other = mine.difference(theirs)
    equal = low == high == other
    first, stop = (n, p) if equal else (low - p, high + p - 1)
    for here, there in rows:
        low, high, other = here.difference(there)
        if not low == high == other:
            first, stop = min(first, low), max(stop, high + p)
    return max(first, p) - p, min(stop, n) - p, shift


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
