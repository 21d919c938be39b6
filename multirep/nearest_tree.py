"""The nearest places in a tree of capsules, for one point and for many at once.

Both go down the levels with all capsules that may still hold the answer: those that begin before
the nearest one ends (`multirep.capsules`). The pieces that are left are decided by
`multirep.splines.closest`. The core goes down into the nearest first: what begins behind a place
that it has found there, it need not look into.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from multirep.arrays import Array, Indices
from multirep.capsules import FAN, UNIT, Leaf, Pieces, Tree, distances
from multirep.errors import InvariantError
from multirep.splines import compiled
from multirep.splines.closest import NOISE, least_on_piece, least_on_pieces, not_clear, squared

__all__ = ["nearest_parameter", "nearest_parameters"]

#: So many points are looked at together: more do not stay in the cache.
_TOGETHER = 256
#: The groups of so many leaves are looked at without asking their leaves first.
_HANDFUL = 4

_CHILDREN = np.arange(FAN)


def nearest_parameter(tree: Tree, point: Array) -> float:
    """Return the parameter of a place nearest to ``point``, (d,).

    Cost: in the core a microsecond or two; else some ten numpy calls for each of three levels, and
    some microseconds for each piece that may hold the answer. Of several equally near places, any.
    """
    if compiled.active:
        return _by_core(tree, point).item()
    column = point[:, None]
    near: Sequence[Leaf] = tree.filled
    if len(near) > _HANDFUL:
        near = [near[k] for k in _kept(tree.tops, column)[0].tolist()]
    if len(near) == 1 and len(near[0].pieces.starts) <= FAN * FAN:
        found, u, least = _kept(near[0].pieces.nodes, column)
        places = [(near[0].pieces, found)]
    else:
        rows = _rows(near, column)
        nodes = _joined([pieces.nodes.take(which, axis=1) for pieces, which in rows])
        found, u, least = _kept(nodes, column)
        places = [(pieces, which.take(mine)) for pieces, which, mine in _dealt(rows, found)]
    if places[0][0].hulls is None:
        best = int(least.argmin())
        at = float(u[best])
    else:
        hulls = [part.hulls.take(which, axis=2) for part, which in places if part.hulls is not None]
        joined = hulls[0] if len(hulls) == 1 else np.concatenate(hulls, axis=2)
        best, at = _decided(tree, joined, column, u, least)
    for part, rows_of_part in places:
        if best < len(rows_of_part):
            row = int(rows_of_part[best])
            return _between(float(part.starts[row]), float(part.stops[row]), at)
        best -= len(rows_of_part)
    raise InvariantError("a place in no piece", best)


def _rows(near: Sequence[Leaf], column: Array) -> list[tuple[Pieces, Indices]]:
    """Return the pieces, leaf by leaf, whose groups may hold the nearest place."""
    groups = [leaf.groups for leaf in near]
    kept = _kept(_joined(groups), column)[0]
    found = []
    parts = [(leaf.pieces, group[0]) for leaf, group in zip(near, groups, strict=True)]
    for pieces, _, mine in _dealt(parts, kept):
        which = (FAN * mine[:, None] + _CHILDREN).ravel()
        if which[-1] >= len(pieces.starts):
            which = which[: which.searchsorted(len(pieces.starts))]
        found.append((pieces, which))
    return found


def _dealt(
    parts: Sequence[tuple[Pieces, Any]], found: Indices
) -> Iterator[tuple[Pieces, Any, Indices]]:
    """Deal numbers out to the parts that they are of, laid end to end: counted from each."""
    if len(parts) == 1:
        yield *parts[0], found
        return
    low, first = 0, 0
    for pieces, which in parts:
        low, begin = low + len(which), low
        stop = int(found.searchsorted(low))
        if stop > first:
            yield pieces, which, found[first:stop] - begin
            first = stop


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


def _slack(tree: Tree, points: Array) -> Array:
    """How much nearer than the answer a place may be, for each column of ``points``."""
    slack: Array = tree.slack + UNIT * np.abs(points).max(axis=0)
    return slack


def _decided(tree: Tree, hulls: Array, column: Array, u: Array, least: Array) -> tuple[int, float]:
    """Return which of some pieces holds the nearest place, and where on it."""
    offsets, f, g = squared(hulls, column)
    slack = float(_slack(tree, column)[0])
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
            left = left[clear.min(axis=0) < NOISE * f[:, left].max(axis=0)]
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
    """Return the parameters (m,) of places nearest to ``points``, (m, d)."""
    if compiled.active and len(points):
        return _by_core(tree, points)
    found = np.empty(len(points))
    columns = np.ascontiguousarray(points.T)
    for start in range(0, len(points), _TOGETHER):
        part = slice(start, start + _TOGETHER)
        found[part] = _nearest_together(tree, columns[:, part])
    return found


def _by_core(tree: Tree, points: Array) -> Array:
    """Do the same in the core; pieces that it has not seen before are made first."""
    found, leaves = np.empty(1 if points.ndim == 1 else len(points)), tree.read
    while missing := compiled.core.nearest(
        tree.levels, leaves, FAN, points, tree.slack, UNIT, found
    ):
        for k in missing:
            leaves[k] = tree.filled[k].read
    return found


def _nearest_together(tree: Tree, points: Array) -> Array:
    leaves: Sequence[Leaf] = tree.filled
    if _few(leaves):
        near = _all_kept(leaves[0].pieces.nodes, points)
    elif len(leaves) <= _HANDFUL:
        near = _all_kept(_joined([leaf.groups for leaf in leaves]), points)
    else:
        near = _all_kept(tree.levels[0], points)
        for level in tree.levels[1:]:
            count = level.shape[1]
            near = _kept_pairs(level, points, *_children(near, np.arange(0, count, FAN), count))
    if len(leaves) > _HANDFUL:
        used, which = np.unique(near.which, return_inverse=True)
        leaves = [leaves[k] for k in used.tolist()]
        ends = np.cumsum([leaf.groups.shape[1] for leaf in leaves])
        pairs = _children(near._replace(which=which), np.append(0, ends[:-1]), int(ends[-1]))
        near = _kept_pairs(_joined([leaf.groups for leaf in leaves]), points, *pairs)
    parts = [leaf.pieces for leaf in leaves]
    if not _few(leaves):
        nodes = _joined([pieces.nodes for pieces in parts])
        sizes = [len(pieces.starts) for pieces in parts]
        lows = (np.cumsum(sizes) - sizes).tolist()
        begins = np.concatenate(
            [np.arange(low, low + size, FAN) for low, size in zip(lows, sizes, strict=True)]
        )
        near = _kept_pairs(nodes, points, *_children(near, begins, nodes.shape[1]))
    query, which, u, away = near
    firsts = _firsts(query)
    if parts[0].hulls is not None:
        hulls = [pieces.hulls for pieces in parts if pieces.hulls is not None]
        joined = hulls[0] if len(hulls) == 1 else np.concatenate(hulls, axis=2)
        u, away = _decided_pairs(tree, joined, points, near, firsts)
    least = np.minimum.reduceat(away, firsts).take(query)
    hits = (away == least).nonzero()[0]
    hits = hits[_firsts(query.take(hits))]
    which = which.take(hits)
    starts = np.concatenate([pieces.starts for pieces in parts]).take(which)
    stops = np.concatenate([pieces.stops for pieces in parts]).take(which)
    t: Array = starts + u.take(hits) * (stops - starts)
    return np.asarray(np.minimum(np.maximum(t, starts), stops))


class Pairs(NamedTuple):
    """Points and capsules that may hold their nearest places, by point in ascending order."""

    query: Indices
    which: Indices
    u: Array
    away: Array


def _few(leaves: Sequence[Leaf]) -> bool:
    """Whether it pays to look at all pieces at once."""
    return len(leaves) == 1 and len(leaves[0].pieces.starts) <= 6 * FAN


def _firsts(query: Indices) -> Indices:
    """Return the first pair of each point."""
    return np.flatnonzero(np.append(True, query[1:] > query[:-1]))


def _children(near: Pairs, begins: Indices, stop: int) -> tuple[Indices, Indices]:
    """Go from capsules to the ones they hold, which begin at ``begins``; the last at ``stop``."""
    many = np.diff(begins, append=stop).take(near.which)
    ends = many.cumsum()
    inner = np.arange(ends[-1]) + (begins.take(near.which) - (ends - many)).repeat(many)
    return near.query.repeat(many), inner


def _all_kept(nodes: Array, points: Array) -> Pairs:
    """Pair all points with all capsules; keep those that may hold the answer."""
    u, away = distances(nodes[:, None], points[:, :, None])
    radius = nodes[-1]
    reach = (away + radius).min(axis=1)
    query, which = (away - radius <= reach[:, None]).nonzero()
    return Pairs(query, which, u[query, which], away[query, which])


def _kept_pairs(nodes: Array, points: Array, query: Indices, which: Indices) -> Pairs:
    """Keep the pairs that may hold the answer of their point."""
    pairs = nodes.take(which, axis=1)
    u, away = distances(pairs, points.take(query, axis=1))
    firsts = _firsts(query)
    radius = pairs[-1]
    reach = np.minimum.reduceat(away + radius, firsts)
    counts = np.diff(firsts, append=len(query))
    kept = (away - radius <= reach.repeat(counts)).nonzero()[0]
    return Pairs(query.take(kept), which.take(kept), u.take(kept), away.take(kept))


def _decided_pairs(
    tree: Tree, hulls: Array, points: Array, near: Pairs, firsts: Indices
) -> tuple[Array, Array]:
    """Return (u, distance) of each pair: right for the pairs that hold the answer."""
    d, slack = len(points), _slack(tree, points)
    pairs = hulls.take(near.which, axis=2)
    offsets, f, g = squared(pairs, points.take(near.query, axis=1))
    weights = None if g is None else pairs[:, d]
    distance, at = least_on_pieces(offsets, weights, f, g, near.u)
    best = np.minimum.reduceat(distance, firsts)
    order = near.query  # every point has pairs
    nearest, slacks = best.take(order), slack.take(order)
    floor = np.maximum(nearest - slacks, 0.0) ** 2
    clear = f - (floor if g is None else floor * g)
    clear -= NOISE * f.max(axis=0)
    doubtful = ((clear.min(axis=0) < 0.0) & (nearest > slacks)).nonzero()[0]
    if len(doubtful):
        doubtful = doubtful[not_clear(clear.take(doubtful, axis=1), at.take(doubtful))]
    # Newton's method may have stayed in the wrong valley: that is seen, and mended one by one.
    for k in doubtful.tolist():
        least = float(best[order[k]])
        found = _least(pairs, offsets, f, g, k, float(at[k]), least, float(slacks[k]))
        if found is not None:
            distance[k], at[k] = found
            best[order[k]] = found[0]
    return at, distance
