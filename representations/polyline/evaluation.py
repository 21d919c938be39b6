"""Evaluating polylines in block arrays; blocks that are not asked for stay untouched."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.sampled import interpolate
from multirep.splines import compiled

#: Rows that may be cut out as one window however few parameters are asked for: joining a few blocks
#: is cheaper than going through them one by one.
NARROW = 16 * BLOCK_ROWS


def evaluate(t: BlockArray, points: BlockArray, at: Array) -> Array:
    """Points of the polyline at parameters in [t[0], t[-1]].

    Parameters
    ----------
    t, points : BlockArray
        (n,) strictly increasing and (n, d).
    at : (m,) array
        In any order.

    Returns
    -------
    (m, d) array
        At a vertex the vertex, bit by bit. Cost: O(m log n + blocks touched); a value depends on
        the two vertices around it only, however the parameters are grouped.
    """
    if not at.size:
        return np.empty((0, points.shape[1]))
    if compiled.active:
        found = np.empty((len(at), points.shape[1]))
        compiled.core.interpolate(t.rope, points.rope, at, found)
        return found
    start, stop = cover(t, float(at.min()), float(at.max()))
    if stop - start <= max(NARROW, 8 * len(at)):
        return interpolate(t.window(start, stop), points.window(start, stop), at)
    values = np.empty((len(at), points.shape[1]))
    lengths = np.array([len(block) for block in t.blocks])
    ends = lengths.cumsum()
    which = np.searchsorted([block[0] for block in t.blocks], at, side="right") - 1
    order = which.argsort(kind="stable")
    blocks, first = np.unique(which[order], return_index=True)
    for block, rows in zip(blocks.tolist(), np.split(order, first[1:]), strict=True):
        start = min(int(ends[block] - lengths[block]), len(t) - 2)
        stop = min(int(ends[block]) + 1, len(t))
        values[rows] = interpolate(t.window(start, stop), points.window(start, stop), at[rows])
    return values


def evaluate_one(t: BlockArray, points: BlockArray, at: float) -> Array:
    """One point, (d,), bit for bit as `evaluate` gives it; cheaper."""
    if compiled.active:
        found = np.empty(points.shape[1])
        compiled.core.interpolate(t.rope, points.rope, at, found)
        return found
    k = min(max(t.searchsorted(at, "right") - 1, 0), len(t) - 2)
    (start, stop), (low, high) = t.window(k, k + 2).tolist(), points.window(k, k + 2)
    u = (at - start) / (stop - start)
    return np.array(high) if u == 1.0 else np.asarray(low + u * (high - low))


def cover(t: BlockArray, low: float, high: float) -> tuple[int, int]:
    """Rows start..stop-1, two or more, whose parameters cover [low, high] and little else."""
    n = len(t)
    start = min(max(t.searchsorted(low, "right") - 1, 0), n - 2)
    stop = min(max(t.searchsorted(high, "left") + 1, start + 2), n)
    return start, stop


def slopes(t: BlockArray, points: BlockArray, at: Array, side: str) -> Array:
    """First derivatives, (m, d), from the right or the left (at the ends of T from inside)."""
    if not at.size:
        return np.empty((0, points.shape[1]))
    start, stop = cover(t, float(at.min()), float(at.max()))
    start, stop = max(start - 1, 0), min(stop + 1, len(t))
    window, rows = t.window(start, stop), points.window(start, stop)
    k: Indices = window.searchsorted(at, side="right" if side == "right" else "left") - 1
    k = np.clip(k, 0, len(window) - 2)
    values: Array = (rows[k + 1] - rows[k]) / (window[k + 1] - window[k])[:, None]
    return values
