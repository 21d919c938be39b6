"""The nearest places in a tree of capsules, for one point and for many at once.

Both go down the levels with all capsules that may still hold the answer: those that begin before
the nearest one ends (`multirep.capsules`). The pieces that are left are decided by
`multirep.splines.closest`.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.capsules import FAN, Leaf, Tree, distances
from multirep.splines.closest import all_clear, least_on_piece, least_on_pieces, squared

__all__ = ["ACCURACY", "nearest_parameter", "nearest_parameters"]

#: An answer is no farther than the true one plus this part of the curve's size ...
ACCURACY = 1e-10
#: ... plus so many units in the last place of the coordinates.
_ULPS = 64
#: So many capsules are looked at together, points times capsules: what stays in the cache.
_TOGETHER = 1 << 14

_EPS = float(np.finfo(np.float64).eps)
_CHILDREN = np.arange(FAN)


def nearest_parameter(tree: Tree, point: Array) -> float:
    """Return the parameter of a place nearest to ``point``, (d,).

    Cost: some ten numpy calls for each of three levels, and some microseconds for each piece that
    may hold the answer; of several equally near places, any.
    """
    column = point[:, None]
    near = list(tree.filled)
    if len(near) > 1:
        near = [near[k] for k in _kept(tree.tops, column)[0].tolist()]
    # Which of the groups, then which of their pieces; places in the leaves laid end to end.
    ends = np.cumsum([leaf.groups.shape[1] for leaf in near])
    groups = _kept(_joined([leaf.groups for leaf in near]), column)[0]
    rows: list[Indices] = []
    leaves: list[Leaf] = []
    low = 0
    for leaf, end in zip(near, ends.tolist(), strict=True):
        mine = groups[groups.searchsorted(low) : groups.searchsorted(end)] - low
        low = end
        if len(mine):
            which = (FAN * mine[:, None] + _CHILDREN).ravel()
            rows.append(which[: which.searchsorted(len(leaf.starts))])
            leaves.append(leaf)
    parts = [leaf.nodes.take(which, axis=1) for leaf, which in zip(leaves, rows, strict=True)]
    found, u, least = _kept(_joined(parts), column)
    ends = np.cumsum([len(which) for which in rows])
    owners = ends.searchsorted(found, "right")
    whole = np.concatenate(rows) if len(rows) > 1 else rows[0]
    which = whole.take(found)
    if leaves[0].hulls is None:
        best = int(least.argmin())
        at = float(u[best])
    else:
        hulls = [
            leaf.hulls.take(which[owners == k] if len(leaves) > 1 else which, axis=2)
            for k, leaf in enumerate(leaves)
            if leaf.hulls is not None
        ]
        best, at = _decided(tree, np.concatenate(hulls, axis=2), column, u, least)
    leaf, row = leaves[int(owners[best])], int(which[best])
    return _between(float(leaf.starts[row]), float(leaf.stops[row]), at)


def _joined(parts: list[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=1)


def _kept(nodes: Array, column: Array) -> tuple[Indices, Array, Array]:
    """Return the capsules that may hold the nearest place; of them, u and the least distance."""
    u, away = distances(nodes, column)
    radius = nodes[-1]
    least = away - radius
    found = (least <= (away + radius).min()).nonzero()[0]
    return found, u.take(found), least.take(found)


def _between(start: float, stop: float, at: float) -> float:
    return min(max(start + at * (stop - start), start), stop)


def _slack(tree: Tree, points: Array) -> float:
    size = float(np.abs(points).max()) + tree.magnitude
    return ACCURACY * tree.extent + _ULPS * _EPS * size


def _decided(
    tree: Tree, hulls: Array, column: Array, u: Array, least: Array
) -> tuple[int, float]:
    """Return which of some pieces holds the nearest place, and where on it."""
    offsets, f, g = squared(hulls, column)
    slack = _slack(tree, column)
    best, at, distance = 0, 0.0, np.inf
    left = least.argsort(kind="stable")
    while len(left):
        k, left = int(left[0]), left[1:]
        if least[k] <= distance:
            nearer = _least(hulls, offsets, f, g, k, float(u[k]), distance, slack)
            if nearer is not None:
                (distance, at), best = nearer, k
        if len(left):
            left = left[least[left] <= distance]
            floor = max(distance - slack, 0.0) ** 2
            clear = f[:, left] - (floor if g is None else floor * g[:, left])
            left = left[clear.min(axis=0) < 0.0]
    return best, at


def _least(
    hulls: Array,
    offsets: Array,
    f: Array,
    g: Array | None,
    k: int,
    u: float,
    distance: float,
    slack: float,
) -> tuple[float, float] | None:
    rows = offsets[:, :, k]
    if g is not None:
        rows = np.concatenate((rows, hulls[:, -1:, k]), axis=1)
    weights = None if g is None else g[:, k].tolist()
    return least_on_piece(rows.tolist(), f[:, k].tolist(), weights, u, distance, slack)


def nearest_parameters(tree: Tree, points: Array) -> Array:
    """Return the parameters (m,) of places nearest to ``points``, (m, d); some 5 us each."""
    found = np.empty(len(points))
    leaves = tree.filled
    size = max(_TOGETHER // max(len(leaves), FAN * FAN // 4), 1)
    columns = np.ascontiguousarray(points.T)
    for start in range(0, len(points), size):
        part = slice(start, start + size)
        found[part] = _nearest_together(tree, leaves, columns[:, part])
    return found


def _nearest_together(tree: Tree, leaves: tuple[Leaf, ...], points: Array) -> Array:
    m = points.shape[1]
    query = np.arange(m).repeat(len(leaves))
    which = np.tile(np.arange(len(leaves)), m)
    if len(leaves) > 1:
        query, which, _, _ = _kept_pairs(tree.tops, points, query, which)
        used, which = np.unique(which, return_inverse=True)
        near = [leaves[k] for k in used.tolist()]
    else:
        near = list(leaves)
    # All groups of those leaves end to end, then all pieces.
    counts = np.array([leaf.groups.shape[1] for leaf in near])
    query, which = _children(query, which, counts.cumsum() - counts, counts)
    groups = _joined([leaf.groups for leaf in near])
    query, which, _, _ = _kept_pairs(groups, points, query, which)
    sizes = np.array([len(leaf.starts) for leaf in near])
    begins = np.concatenate([low + np.arange(0, n, FAN) for low, n in zip(
        (sizes.cumsum() - sizes).tolist(), sizes.tolist(), strict=True)])
    widths = np.diff(np.append(begins, sizes.sum()))
    query, which = _children(query, which, begins, widths)
    nodes = _joined([leaf.nodes for leaf in near])
    query, which, u, away = _kept_pairs(nodes, points, query, which)
    firsts = np.flatnonzero(np.append(True, query[1:] > query[:-1]))
    if near[0].hulls is None:
        chosen = _first_least(away, query, firsts)
    else:
        hulls = np.concatenate([leaf.hulls for leaf in near if leaf.hulls is not None], axis=2)
        u, distance = _decided_pairs(tree, hulls, points, query, which, u, firsts)
        chosen = _first_least(distance, query, firsts)
    starts = np.concatenate([leaf.starts for leaf in near]).take(which[chosen])
    stops = np.concatenate([leaf.stops for leaf in near]).take(which[chosen])
    t: Array = starts + u[chosen] * (stops - starts)
    return np.minimum(np.maximum(t, starts), stops)


def _children(
    query: Indices, which: Indices, begins: Indices, counts: Indices
) -> tuple[Indices, Indices]:
    """Go from capsules to the ones they hold: ``counts`` of them, from ``begins`` on."""
    many = counts.take(which)
    ends = many.cumsum()
    inner = np.arange(ends[-1]) + (begins.take(which) - (ends - many)).repeat(many)
    return query.repeat(many), inner


def _kept_pairs(
    nodes: Array, points: Array, query: Indices, which: Indices
) -> tuple[Indices, Indices, Array, Array]:
    """Keep the pairs of a point and a capsule that may hold its answer; ``query`` ascends."""
    pairs = nodes.take(which, axis=1)
    u, away = distances(pairs, points.take(query, axis=1))
    firsts = np.flatnonzero(np.append(True, query[1:] > query[:-1]))
    radius = pairs[-1]
    reach = np.minimum.reduceat(away + radius, firsts)
    counts = np.diff(np.append(firsts, len(query)))
    kept = (away - radius <= reach.repeat(counts)).nonzero()[0]
    return query.take(kept), which.take(kept), u.take(kept), away.take(kept)


def _first_least(values: Array, query: Indices, firsts: Indices) -> Indices:
    """Return the pair of each point with the least value."""
    least = np.minimum.reduceat(values, firsts).take(query)
    hits = (values == least).nonzero()[0]
    return hits[np.append(True, query[hits][1:] > query[hits][:-1])]


def _decided_pairs(
    tree: Tree,
    hulls: Array,
    points: Array,
    query: Indices,
    which: Indices,
    u: Array,
    firsts: Indices,
) -> tuple[Array, Array]:
    """Return (u, distance) of each pair: right for the pairs that hold the answer."""
    d, slack = len(points), _slack(tree, points)
    pairs = hulls.take(which, axis=2)
    offsets, f, g = squared(pairs, points.take(query, axis=1))
    weights = None if g is None else pairs[:, d]
    distance, at = least_on_pieces(offsets, weights, f, g, u)
    best = np.minimum.reduceat(distance, firsts)
    # Newton's method may have stayed in the wrong valley: that is seen, and repaired one by one.
    order = query - query[0] if len(best) == query[-1] - query[0] + 1 else (
        np.repeat(np.arange(len(best)), np.diff(np.append(firsts, len(query)))))
    floor = (np.maximum(best - slack, 0.0) ** 2).take(order)
    clear = f - (floor if g is None else floor * g)
    open_ = ((clear.min(axis=0) < 0.0) & (best.take(order) > slack)).nonzero()[0]
    open_ = open_[~all_clear(clear.take(open_, axis=1), at.take(open_))]
    for k in open_.tolist():
        nearest = float(best[order[k]])
        found = _least(pairs, offsets, f, g, k, float(at[k]), nearest, slack)
        if found is not None:
            distance[k], at[k] = found
            best[order[k]] = found[0]
    return at, distance
