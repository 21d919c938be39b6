"""Dropping samples that a straight line replaces, certified at equal t (Grimm-Ayers 6.1)."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices

Mask: TypeAlias = npt.NDArray[np.bool_]

#: Rounds of merging. Each halves the number of vertices on a straight stretch, so that 64 are never
#: needed; the limit keeps the cost linear whatever the input is.
ROUNDS = 64


def simplify(t: Array, values: Array, targets: Array, allowed: Array, keep: Mask) -> Indices:
    """Choose the vertices of a polyline that follows samples with as few of them as it can find.

    The polyline through the chosen ``values`` differs from the polyline through all ``targets`` by
    a piecewise linear function with corners at ``t`` only. Its norm is convex on each chord, so
    ``allowed`` at the samples is a certificate for all t, and for the parametric distance, which is
    what counts here.

    Neighbouring chords are merged in rounds, as many pairs at a time as do not touch each other.

    Parameters
    ----------
    t : (m,) array
        Strictly increasing.
    values : (m, d) array
        The vertices to choose from; the first and the last are always taken.
    targets : (m, d) array
        The samples; they equal ``values`` but for pinned ends.
    allowed : (m,) array
        Largest distance at each sample, rounding included.
    keep : (m,) bool array
        Samples that must stay, corners for instance.

    Returns
    -------
    (k,) array of int
        Indices of the chosen samples, in order. Cost: O(m) a round; two or three rounds on curved
        stretches.

    Examples
    --------
    >>> t = np.linspace(0, 1, 9)
    >>> line = np.stack([t, np.abs(t - 0.5)], axis=1)
    >>> simplify(t, line, line, np.full(9, 1e-6), np.zeros(9, bool))
    array([0, 4, 8])
    """
    kept: Indices = np.arange(len(t))
    free = ~keep
    free[0] = free[-1] = False
    untested = free.copy()  # per chosen sample: whether its removal has not been refused yet
    for _ in range(ROUNDS):
        position = np.flatnonzero(untested)
        if not position.size:
            break
        left, right = kept[position - 1], kept[position + 1]
        fits = _fits(t, values, targets, allowed, kept[position], left, right)
        position, left, right = position[fits], left[fits], right[fits]
        many = right - left > 2
        if many.any():  # chords over more than one sample: look at every one of them
            fits = ~many
            fits[many] = _all_fit(t, values, targets, allowed, left[many], right[many])
            position = position[fits]
        if not position.size:
            break
        chosen = position[every_other(position)]
        untested[:] = False
        untested[chosen - 1] = untested[chosen + 1] = True
        remaining = np.ones(len(kept), dtype=bool)
        remaining[chosen] = False
        kept, untested = kept[remaining], untested[remaining]
        untested &= free[kept]
    return kept


def _fits(
    t: Array,
    values: Array,
    targets: Array,
    allowed: Array,
    at: Indices,
    left: Indices,
    right: Indices,
) -> Mask:
    """Whether the chord left-right is within the allowance of the sample ``at``; all (k,)."""
    u = ((t[at] - t[left]) / (t[right] - t[left]))[:, None]
    start = values[left]
    off = start + u * (values[right] - start) - targets[at]
    result: Mask = np.sqrt(np.einsum("ij,ij->i", off, off)) <= allowed[at]
    return result


def _all_fit(
    t: Array, values: Array, targets: Array, allowed: Array, left: Indices, right: Indices
) -> Mask:
    """Whether each chord is within the allowance of every sample between its ends, (k,)."""
    counts = right - left - 1
    ends = counts.cumsum()
    chord = np.repeat(np.arange(len(left)), counts)
    at = np.arange(ends[-1]) - (ends - counts)[chord] + left[chord] + 1
    fits = _fits(t, values, targets, allowed, at, left[chord], right[chord])
    result: Mask = np.logical_and.reduceat(fits, ends - counts)
    return result


def every_other(position: Indices) -> Mask:
    """Every other one of each run of neighbouring positions, so that no two touch."""
    order = np.arange(len(position))
    begins = np.ones(len(position), dtype=bool)
    begins[1:] = position[1:] - position[:-1] > 1
    first = np.maximum.accumulate(np.where(begins, order, 0))
    result: Mask = (order - first) % 2 == 0
    return result
