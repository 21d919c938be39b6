"""Fewer vertices for the same polyline, their deviation known: fits then cost less."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray

__all__ = ["simplified"]

#: At most so many rounds of cutting groups that deviate; what still does is kept vertex by vertex.
ROUNDS = 40
#: Rounds of merging neighbouring groups, the last one when it leaves more than such a part.
MERGES = 6
GOING_ON = 0.97


def simplified(t: Array, points: Array, limit: Array | float) -> tuple[IntArray, Array]:
    """Choose vertices so that the polyline through them stays within limits of the given one.

    Parameters
    ----------
    t : (m + 1,) array
        Strictly increasing.
    points : (m + 1, d) array
    limit : (m,) array or float
        Positive: how far the new polyline may be off on each chord.

    Returns
    -------
    kept : (k + 1,) indices
        Vertices of the simpler polyline, the first and the last among them.
    deviation : (k,) array
        Largest distance at equal parameter between both polylines on each new chord; it is
        attained at a vertex left out, so it is exact (up to rounding, which is added).

    Notes
    -----
    Curvature decides where vertices are laid out at first; groups that deviate are cut at their
    worst vertex, neighbours that fit on one chord are merged. A few passes over all vertices.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0, 1, 9)
    >>> line = np.stack([t, np.abs(t - 0.5)], axis=1)
    >>> kept, deviation = simplified(t, line, 1e-6)
    >>> kept.tolist(), bool((deviation < 1e-14).all())
    ([0, 4, 8], True)
    """
    if compiled.active:
        limits, same = (limit, 0.0) if isinstance(limit, np.ndarray) else (None, limit)
        found = compiled.core.thin(t, points, limits, same, ROUNDS, MERGES, GOING_ON)
        return np.frombuffer(found[0], dtype=np.intp), np.frombuffer(found[1])
    at_vertices = np.minimum(limit[1:], limit[:-1]) if isinstance(limit, np.ndarray) else limit
    count = len(t)
    kept = _laid_out(t, points, at_vertices)
    for _ in range(ROUNDS):
        beyond, worst = _beyond(t, points, at_vertices, kept)
        if not beyond.any():
            break
        kept = np.union1d(kept, worst[beyond])
    else:
        kept = np.arange(count)
    for side in range(MERGES):
        before = len(kept)
        kept = _merged(t, points, at_vertices, kept, side % 2)
        if len(kept) > GOING_ON * before:
            break
    return kept, _absolute(t, points, kept)


def _laid_out(t: Array, points: Array, limit: Array | float) -> IntArray:
    """Spread vertices so that each chord has about the allowed sagitta."""
    steps = np.diff(t)
    slopes = np.diff(points, axis=0) / steps[:, None]
    kinks = np.diff(slopes, axis=0)
    jump = np.sqrt(np.einsum("md,md->m", kinks, kinks))
    # Each vertex stands for a kink J over the mean h of its two steps: h sqrt(J / h / (8 limit)).
    share = np.sqrt(jump * (steps[1:] + steps[:-1]) / (16 * limit))
    sums = np.concatenate(([0.0], np.minimum(share, 1.0).cumsum()))
    whole = np.floor(sums)
    inner = np.flatnonzero(whole[1:] > whole[:-1]) + 1
    return np.concatenate(([0], inner, [len(t) - 1]))


def _off(t: Array, points: Array, kept: IntArray) -> Array:
    """Squared distance at equal parameter of each vertex from the chord of its group."""
    sizes = np.diff(kept)
    group = np.arange(len(sizes)).repeat(sizes)
    start, stop = t[kept[:-1]], t[kept[1:]]
    slope = (points[kept[1:]] - points[kept[:-1]]) / (stop - start)[:, None]
    off = points[:-1] - points[kept[:-1]][group]
    off -= (t[:-1] - start[group])[:, None] * slope[group]
    squares: Array = np.einsum("md,md->m", off, off)
    squares[kept[:-1]] = 0.0
    return squares


def _beyond(
    t: Array, points: Array, limit: Array | float, kept: IntArray
) -> tuple[npt.NDArray[np.bool_], IntArray]:
    """Whether a vertex of each group is beyond its limit, and the one that is most beyond it."""
    far, most = _off(t, points, kept), 1.0
    if isinstance(limit, float):
        most = limit * limit
    else:
        far[1:] /= limit * limit
    largest = np.maximum.reduceat(far, kept[:-1])
    hits = np.flatnonzero(far == largest.repeat(np.diff(kept)))
    return largest > most, hits[hits.searchsorted(kept[:-1])]


def _merged(t: Array, points: Array, limit: Array | float, kept: IntArray, side: int) -> IntArray:
    """Merge groups 2i + side and 2i + 1 + side where one chord serves both."""
    dropped = np.arange(1 + side, len(kept) - 1, 2)
    if not len(dropped):
        return kept
    mask = np.ones(len(kept), dtype=bool)
    mask[dropped] = False
    coarse = kept[mask]
    beyond, _ = _beyond(t, points, limit, coarse)
    # Vertex kept[j] (j dropped) lies in the coarse group that starts at kept[j - 1].
    group = coarse.searchsorted(kept[dropped], "right") - 1
    mask[dropped[beyond[group]]] = True
    return kept[mask]


def _absolute(t: Array, points: Array, kept: IntArray) -> Array:
    largest = np.sqrt(np.maximum.reduceat(_off(t, points, kept), kept[:-1]))
    slack = 16 * np.finfo(np.float64).eps * np.sqrt(points.shape[1]) * float(np.abs(points).max())
    return np.asarray(np.where(np.diff(kept) > 1, largest + slack, 0.0))
