"""Chord-length parameters for bare points."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.representations.polyline.validation import checked_points

#: Parameters that fit between two neighbours, at the least: enough to insert vertices and knots
#: between them (each halving takes one bit). Larger flattens the speed of more short segments.
ROOM = 2.0**9


class ChordLength(NamedTuple):
    """Parameters ``t`` (n,), ``points`` (n, d), and how many repeats were ``merged``."""

    t: Array
    points: Array
    merged: int


def chord_length(points: ArrayLike, *, domain: Interval | None = None) -> ChordLength:
    """Give points parameters in proportion to the length of the polyline through them.

    Consecutive repeated points are merged. A segment so short that its parameters would (nearly)
    coincide in floating point, because it stands beside one 2^43 times longer, is treated as a
    little longer than it is; so the parameters always increase strictly, with :data:`ROOM` numbers
    between neighbours.

    Parameters
    ----------
    points : (n, d) array_like
        At least two distinct ones.
    domain : Interval, optional
        T; by default [0, 1].

    Returns
    -------
    ChordLength
        ``t[0]`` and ``t[-1]`` are exactly the ends of T. Cost: O(n).

    Raises
    ------
    InvalidCurveError
        For NaN, infinity, a wrong shape, fewer than two distinct points, or more points than T has
        numbers.

    Examples
    --------
    >>> t, points, merged = chord_length([[0, 0], [3, 4], [3, 4], [3, 9]])
    >>> t, merged
    (array([0. , 0.5, 1. ]), 1)
    """
    rows = checked_points(points)
    a, b = domain or Interval(0.0, 1.0)
    steps = rows[1:] - rows[:-1]
    moves = (steps != 0).any(axis=1)
    merged = len(moves) - int(np.count_nonzero(moves))
    if merged == len(moves):
        raise InvalidCurveError(
            f"a polyline needs two distinct points or more, got {len(rows)} times {rows[0]}"
        )
    if merged:
        rows = rows[np.concatenate([[True], moves])]
        steps = steps[moves]
    # scaled first: squares of tiny or huge coordinates must not underflow or overflow
    steps = steps / np.abs(steps).max()
    lengths = np.sqrt(np.einsum("ij,ij->i", steps, steps))
    resolution = np.spacing(max(abs(a), abs(b))) / (b - a) if b > a else np.inf
    shortest = ROOM * resolution
    if not shortest * (len(lengths) + 1) < 0.5:
        raise InvalidCurveError(
            f"the domain [{a!r}, {b!r}] has too few numbers for {len(rows)} parameters"
        )
    lengths = np.maximum(lengths, 2 * shortest * lengths.sum())
    t = np.concatenate([[0.0], lengths.cumsum()])
    t = a + (b - a) * (t / t[-1])
    t[-1] = b
    return ChordLength(t, rows, merged)
