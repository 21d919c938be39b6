"""Where one stroke comes nearest to another."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.nearest import distance_to_chords
from multirep.sampled import interpolate

#: Stations along a stroke from which its direction and distance are read. More steady the vote of
#: wriggly strokes; each costs one pass over the other stroke.
STATIONS = 24


def nearest_lengths(points: Array, lengths: Array, queries: Array) -> tuple[Array, Array]:
    """Places on a polyline nearest to a few points.

    Parameters
    ----------
    points, lengths : (n, d) and (n,) arrays
        The polyline and the length up to each vertex.
    queries : (k, d) array

    Returns
    -------
    (k,) and (k,) arrays
        Lengths along the polyline, and distances. Cost: O(k n).
    """
    where, far = np.empty(len(queries)), np.empty(len(queries))
    for i, query in enumerate(queries):  # stations and ends: a few, whatever the strokes
        u, distance = distance_to_chords(points[:-1], points[1:], query)
        k = int(distance.argmin())
        where[i] = lengths[k] + u[k] * (lengths[k + 1] - lengths[k])
        far[i] = distance[k]
    return where, far


def runs_backwards(points: Array, lengths: Array, other: Array, other_lengths: Array) -> bool:
    """Whether ``other`` was drawn against the direction of the first stroke.

    Stations along the other stroke vote: each step between neighbours counts by which way their
    nearest places move. Closed shapes, where ends are no guide, and crossings are outvoted.

    Examples
    --------
    >>> from multirep.strokes.arc_length import arc_lengths
    >>> line = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])
    >>> back = line[::-1] + [0.0, 0.1]
    >>> runs_backwards(line, arc_lengths(line), back, arc_lengths(back))
    True
    """
    stations = interpolate(other_lengths, other, np.linspace(0.0, other_lengths[-1], STATIONS))
    where, _ = nearest_lengths(points, lengths, stations)
    return int(np.sign(np.diff(where)).sum()) < 0
