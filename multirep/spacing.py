"""How far parameters are from each other, and which are too close for anything between them."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices

#: Numbers that are left between neighbouring parameters, at the least, so that vertices and knots
#: can be inserted between them later (each halving takes one bit).
ROOM = 2.0**9


def room(start: float, stop: float) -> float:
    """Return the least distance of neighbouring parameters in [start, stop]."""
    return ROOM * float(np.spacing(max(abs(start), abs(stop))))


def told_apart(t: Array) -> Indices:
    """Choose parameters that keep their distance.

    Parameters
    ----------
    t : (m,) array
        Non-decreasing, m >= 2, from one end of a stretch to the other.

    Returns
    -------
    (k,) array of int
        Indices, increasing, with the first and the last; all of them when none are too close. Of a
        crowd some stay, at least one to every three times the least distance.

    Examples
    --------
    >>> told_apart(np.array([0.0, 0.25, 0.25, 0.25 + 1e-15, 1.0]))
    array([0, 1, 4])
    """
    least = room(float(t[0]), float(t[-1]))
    if (t[1:] - t[:-1] >= least).all():
        return np.arange(len(t))
    cell = np.floor((t - t[0]) / (2 * least))
    kept = np.flatnonzero(np.concatenate([[True], cell[1:] > cell[:-1]]))
    # neighbours in adjacent cells may be close; then the next is not
    kept = kept[np.concatenate([[True], t[kept[1:]] - t[kept[:-1]] >= least])]
    kept = kept[t[kept] <= t[-1] - least]
    return np.concatenate([[0], kept[kept > 0], [len(t) - 1]])


def clearance(values: Array, others: Array) -> Array:
    """Return how far each value is from the nearest of ``others``, (m,).

    Parameters
    ----------
    values : (m,) array
    others : (n,) array
        Increasing; when there are none the distance is infinite.

    Examples
    --------
    >>> clearance(np.array([0.0, 2.5, 9.0]), np.array([1.0, 2.0]))
    array([1. , 0.5, 7. ])
    """
    if not others.size:
        return np.full(len(values), np.inf)
    k = others.searchsorted(values)
    before = np.abs(values - others[np.maximum(k - 1, 0)])
    after = np.abs(others[np.minimum(k, len(others) - 1)] - values)
    nearest: Array = np.minimum(before, after)
    return nearest
