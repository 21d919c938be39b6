"""Dropping samples that a straight line replaces, certified at equal t (Grimm-Ayers 6.1)."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.sampled import interpolate
from multirep.splines import compiled

Mask: TypeAlias = npt.NDArray[np.bool_]

#: Evaluating a deviation rounds: at most 8 half ulps of the largest coordinate in each of d
#: coordinates.
ROUNDING = 8 * 2.0**-53
#: Rounds of merging. Each halves the number of vertices on a straight stretch, so that 64 are never
#: needed; the limit keeps the cost linear whatever the input is.
ROUNDS = 64
#: Samples that are tested in full at once; more are sifted first. Larger does more work a round on
#: long input, smaller has more overhead on short splices.
FEW = 256


def simplify(
    t: Array, values: Array, targets: Array, allowed: Array, keep: Indices
) -> tuple[Indices, float]:
    """Choose as few vertices as it can find for a polyline that follows samples.

    The polyline through the chosen ``values`` differs from the polyline through all ``targets`` by
    a piecewise linear function with corners at ``t`` only. Its norm is convex on each chord, so
    what is allowed at the samples is a certificate for all t, and for the parametric distance,
    which is what counts here.

    Neighbouring chords are merged in rounds, as many pairs at a time as do not touch each other.

    Parameters
    ----------
    t : (m,) array
        Strictly increasing.
    values : (m, d) array
        The vertices to choose from; the first and the last are always taken.
    targets : (m, d) array
        The samples; they equal ``values`` but for pinned ends.
    allowed : (m - 1,) array
        Largest distance on each chord.
    keep : (j,) array of int
        Samples that must stay, corners for instance.

    Returns
    -------
    kept : (k,) array of int
        Indices of the chosen samples, in order. Cost: O(m) a round; two or three rounds on curved
        stretches.
    deviation : float
        Proved: how far the new polyline is from the samples at most, but for pinned ends.

    Examples
    --------
    >>> t = np.linspace(0, 1, 9)
    >>> line = np.stack([t, np.abs(t - 0.5)], axis=1)
    >>> kept, deviation = simplify(t, line, line, np.full(8, 1e-6), np.empty(0, dtype=np.intp))
    >>> kept, deviation < 1e-14
    (array([0, 4, 8]), True)
    """
    if compiled.active:
        found = compiled.core.simplify(t, values, targets, allowed, keep, ROUNDING, ROUNDS)
        return np.frombuffer(found[0], dtype=np.intp), found[1]
    at_samples = np.zeros(len(t))
    at_samples[1:-1] = np.minimum(allowed[1:], allowed[:-1]) - _rounding(values)
    kept = _kept(t, values, targets, at_samples, keep)
    return kept, deviation(t, values, targets, kept) if len(kept) < len(t) else 0.0


def deviation(t: Array, values: Array, targets: Array, kept: Indices) -> float:
    """Return how far the polyline through some values is from the inner samples at most, proved."""
    off = interpolate(t[kept], values[kept], t[1:-1]) - targets[1:-1]
    return float(np.sqrt(np.einsum("ij,ij->i", off, off).max())) + _rounding(values)


def _rounding(values: Array) -> float:
    return ROUNDING * float(np.abs(values).max()) * math.sqrt(values.shape[1])


def _kept(t: Array, values: Array, targets: Array, allowed: Array, keep: Indices) -> Indices:
    kept: Indices = np.arange(len(t))
    free = np.ones(len(t), dtype=bool)
    free[keep] = False
    free[0] = free[-1] = False
    # one table, so that a test gathers three times and not eight
    table = np.concatenate([t[:, None], values, targets], axis=1)
    squares = np.where(allowed > 0, allowed * allowed, -1.0)
    position = np.flatnonzero(free)  # of the samples whose removal has not been refused yet
    for _ in range(ROUNDS):
        left, right = kept[position - 1], kept[position + 1]
        if len(position) > FEW:  # most are refused by a look at themselves
            fits = _fits(table, squares, kept[position], left, right)
            position, left, right = position[fits], left[fits], right[fits]
        if position.size:
            position = position[_all_fit(table, squares, left, right)]
        if not position.size:
            break
        chosen = position[every_other(position)]
        remaining = np.ones(len(kept), dtype=bool)
        remaining[chosen] = False
        kept = kept[remaining]
        # new neighbours of what was removed may go next; chosen[i] has i removed ones before it
        after = chosen - np.arange(len(chosen))
        untested = np.zeros(len(kept), dtype=bool)
        untested[after - 1] = untested[after] = True
        position = np.flatnonzero(untested & free[kept])
    return kept


def _fits(table: Array, squares: Array, at: Indices, left: Indices, right: Indices) -> Mask:
    """Whether the chord left-right is within the allowance of the sample ``at``; all (k,)."""
    d = table.shape[1] // 2
    here, start, stop = table.take(at, 0), table.take(left, 0), table.take(right, 0)
    u = (here[:, 0] - start[:, 0]) / (stop[:, 0] - start[:, 0])
    first = start[:, 1 : d + 1]
    off = first + u[:, None] * (stop[:, 1 : d + 1] - first) - here[:, d + 1 :]
    result: Mask = np.einsum("ij,ij->i", off, off) <= squares.take(at)
    return result


def _all_fit(table: Array, squares: Array, left: Indices, right: Indices) -> Mask:
    """Whether each chord is within the allowance of every sample between its ends, (k,)."""
    counts = right - left - 1
    ends = counts.cumsum()
    starts = ends - counts
    total = int(ends[-1])
    if total == len(left):
        return _fits(table, squares, left + 1, left, right)
    chord = np.arange(len(left)).repeat(counts)
    at = np.arange(total) + (left + 1 - starts)[chord]
    fits = _fits(table, squares, at, left[chord], right[chord])
    result: Mask = np.logical_and.reduceat(fits, starts)
    return result


def every_other(position: Indices) -> Mask:
    """Every other one of each run of neighbouring positions, so that no two touch."""
    order = np.arange(len(position))
    begins = np.ones(len(position), dtype=bool)
    begins[1:] = position[1:] - position[:-1] > 1
    first = np.maximum.accumulate(order * begins)
    result: Mask = (order - first) % 2 == 0
    return result
