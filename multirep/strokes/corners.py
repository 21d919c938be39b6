"""Corners of a stroke: turns that the bend on either side does not explain."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.sampled import interpolate
from multirep.spacing import clearance
from multirep.strokes.arc_length import angles_between, arc_lengths, norms

#: Segments on either side that a window may take in; the smallest that scatter allows is taken.
#: Small windows see small features, wide ones see through the scatter.
WINDOWS = (6, 8, 12, 16, 24, 32)
#: The estimated turn may err by this part of the angle that makes a corner (standard deviation):
#: five of them are one false corner in millions.
STEADY = 1 / 5
#: A corner that falls between two samples turns at both and hardly beside them: at most this part.
BESIDE = 1 / 8
#: Cells on either side over which a window averages. More than three, for a parabola on each side.
CELLS = 6


def find_corners(
    points: Array,
    *,
    angle: float,
    noise: Array | float = 0.0,
    window: float | None = None,
) -> Indices:
    """Find the inner samples at which a stroke turns abruptly.

    Two rules, and what either finds is a corner. Where neighbouring segments are long against the
    scatter, the angle between them counts (or that between the two around a segment that cuts the
    corner). Elsewhere a parabola is fitted to either side of the sample, both through one point,
    and the angle between their tangents counts: on a smooth bend of whatever radius the parabolas
    agree, at a corner they do not.

    Parameters
    ----------
    points : (n, d) array
        Neighbours differ.
    angle : float
        Radians; turns from here on are corners.
    noise : float or (n,) array, optional
        Standard deviation of each sample per coordinate.
    window : float, optional
        Arc length of the parabolas on either side. By default as few segments as make the angle
        certain enough, from 6 to 32.

    Returns
    -------
    (k,) array of int
        Increasing. Cost: O(n log n) at worst, O(n) on strokes with few bends.

    Examples
    --------
    >>> s = np.linspace(0, 2, 41)
    >>> hook = np.stack([np.minimum(s, 1), np.maximum(s - 1, 0)], axis=1)
    >>> find_corners(hook, angle=1.0)
    array([20])
    """
    n = len(points)
    if n < 3:
        return np.empty(0, dtype=np.intp)
    scatter = np.broadcast_to(np.asarray(noise, dtype=np.float64), (n,))
    s = arc_lengths(points)
    sharp = _sharp(points, s, angle, scatter)
    half = _windows(s, angle, scatter, window)
    inner = np.arange(n)
    # the turn between the chords over the window exceeds half the corner's
    at = inner[(half > 0) & ~sharp]
    if at.size:
        before = interpolate(s, points, s[at] - half[at])
        after = interpolate(s, points, s[at] + half[at])
        at = at[angles_between(points[at] - before, after - points[at]) >= 0.5 * angle]
    chosen = np.flatnonzero(sharp)
    if at.size:
        turns = _turns(points, s, at, half[at])
        at, turns = at[turns >= angle], turns[turns >= angle]
        # beside a sharp corner a window sees that corner
        clear = clearance(s[at], s[chosen]) > half[at]
        at, turns = at[clear], turns[clear]
        at = at[_peaks(s[at], turns, half[at])]
        chosen = np.union1d(chosen, at)
    return chosen


def _sharp(points: Array, s: Array, angle: float, scatter: Array) -> npt.NDArray[np.bool_]:
    """Where angles between segments are certain and large enough, (n,)."""
    steps = points[1:] - points[:-1]
    turns = angles_between(steps[:-1], steps[1:])
    chords = norms(steps)
    shorter = np.minimum(chords[1:], chords[:-1])
    error = 6**0.5 * np.maximum(np.maximum(scatter[:-2], scatter[2:]), scatter[1:-1])
    certain = error <= STEADY * angle * shorter
    sharp = np.zeros(len(points), dtype=bool)
    sharp[1:-1] = certain & (turns >= angle)
    if len(points) > 4:  # a corner between two samples: half the turn at each, none beside them
        both = certain[1:-2] & certain[2:-1] & (turns[1:-2] < angle) & (turns[2:-1] < angle)
        both &= angles_between(steps[1:-3], steps[3:-1]) >= angle
        both &= np.maximum(turns[:-3], turns[3:]) <= BESIDE * (turns[1:-2] + turns[2:-1])
        at = np.flatnonzero(both) + 2
        sharp[np.where(turns[at - 1] >= turns[at], at, at + 1)] = True
    return sharp


def _windows(s: Array, angle: float, scatter: Array, window: float | None) -> Array:
    """Half width of each sample's window as an arc length, (n,); 0 where none will do."""
    n = len(s)
    room = np.minimum(s - s[0], s[-1] - s)
    if window is not None:
        return np.where(room >= window, window, 0.0)
    half = np.zeros(n)
    for k in WINDOWS:
        if 2 * k >= n:
            break
        # the jump of slope of two parabolas over m samples each has the variance 384 sigma^2/m/L^2
        width = np.maximum(s[2 * k :] - s[k:-k], s[k:-k] - s[: -2 * k])
        error = 384**0.5 * scatter[k:-k] / (width * k**0.5)
        fits = (half[k:-k] == 0) & (error <= STEADY * angle) & (width <= room[k:-k])
        half[k:-k][fits] = width[fits]
    return half


def _turns(points: Array, s: Array, at: Indices, half: Array) -> Array:
    """Angles between the tangents of the parabolas before and after samples ``at``, (m,)."""
    cells = np.linspace(-1.0, 1.0, 2 * CELLS + 1)
    edges = s[at][:, None] + half[:, None] * cells
    means = np.diff(_integral(points, s, edges), axis=1)
    before, after = means[:, CELLS - 1 :: -1], means[:, CELLS:]
    even, odd = after + before, after - before
    low, high = cells[CELLS:-1], cells[CELLS + 1 :]
    v, square = (low + high) / 2, (low * low + low * high + high * high) / 3  # means over a cell
    kink = np.linalg.pinv(np.stack([np.ones(CELLS), v, square], axis=1))[1]
    slope = np.linalg.pinv(np.stack([v, square], axis=1))[0]
    k, b = np.einsum("j,ijd->id", kink, even), np.einsum("j,ijd->id", slope, odd)
    return angles_between(b - k, b + k)


def _integral(points: Array, s: Array, at: Array) -> Array:
    """Integral of the polyline along its length up to ``at``: at.shape + (d,)."""
    steps = (s[1:] - s[:-1])[:, None]
    pieces = steps * (points[1:] + points[:-1]) / 2
    whole = np.concatenate([np.zeros((1, points.shape[1])), pieces.cumsum(axis=0)])
    at = np.clip(at, s[0], s[-1])
    k = np.clip(s.searchsorted(at, side="right") - 1, 0, len(s) - 2)
    rest = (at - s[k])[..., None]
    slope = np.divide(points[1:] - points[:-1], steps, out=np.zeros_like(pieces), where=steps > 0)
    result: Array = whole[k] + rest * (points[k] + rest * slope[k] / 2)
    return result


def _peaks(s: Array, heights: Array, reach: Array) -> npt.NDArray[np.bool_]:
    """Which candidates are the highest within their reach; of equal ones the first."""
    m = len(s)
    low, high = s.searchsorted(s - reach), s.searchsorted(s + reach, side="right")
    # maxima of runs of 2^j, so that any range is covered by two of them
    table = [heights]
    while 2 ** len(table) <= m:
        last, j = table[-1], 2 ** (len(table) - 1)
        table.append(np.maximum(last[:-j], last[j:]))
    level = np.frexp(high - low)[1] - 1
    highest = np.empty(m)
    for j, row in enumerate(table):
        mine = level == j
        highest[mine] = np.maximum(row[low[mine]], row[high[mine] - 2**j])
    peak = np.flatnonzero(heights >= highest)
    first = np.ones(len(peak), dtype=bool)
    first[1:] = s[peak[1:]] - s[peak[:-1]] > reach[peak[1:]]
    result = np.zeros(m, dtype=bool)
    result[peak[first]] = True
    return result
