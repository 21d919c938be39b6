"""A smooth curve through the samples of a stroke, as a finer polyline; corners stay.

A fast pen leaves few samples; joined by straight lines they make a polygon that nobody drew.
"""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array, Indices
from multirep.strokes.arc_length import angles_between, norms

#: Largest turn, in radians, from one segment of the result to the next on a bend. A facet of it
#: leaves its arc by 1/75 of its length; halving it doubles the vertices.
FACET = math.radians(6.0)
#: A tangent leaves its chord by no more than this; larger turns come of noise.
STEEPEST = math.radians(60.0)


def rounded(points: Array, corners: Indices) -> tuple[Array, Indices]:
    """Go smoothly through points, from corner to corner.

    Between neighbours runs a cubic whose tangents are parallel to the chord over each point
    (Catmull-Rom, Hughes 22.5), as long as those of a circular arc: points of a circle give the
    circle to the sixth power of the turn. A long chord beside short ones, as the stem of a letter,
    stays nearly straight. At an end and at a corner the curve goes on as on the other side of the
    segment. Segments that turn by less than :data:`FACET` are not cut.

    Parameters
    ----------
    points : (n, d) array
        Neighbours differ.
    corners : (k,) array of int
        Inner points, increasing.

    Returns
    -------
    points : (m, d) array
        All of the given ones among them, bit by bit.
    corners : (k,) array of int
        The same corners. Cost: O(m).

    Examples
    --------
    >>> octagon = np.array([[np.cos(k), np.sin(k)] for k in np.arange(8) * np.pi / 4])
    >>> circle, _ = rounded(octagon, np.empty(0, dtype=int))
    >>> len(circle), bool(np.abs(np.linalg.norm(circle, axis=1) - 1).max() < 5e-5)
    (57, True)
    """
    if len(points) < 3:
        return points, corners
    chords = points[1:] - points[:-1]
    lengths = norms(chords)
    units = chords / lengths[:, None]
    start, stop = _tangents(points, units, corners)
    turn = angles_between(start, units), angles_between(stop, units)
    pieces = np.maximum(np.ceil((turn[0] + turn[1]) / FACET - 1e-9), 1).astype(np.intp)
    if (pieces == 1).all():
        return points, corners
    # where on which segment each new vertex lies
    first = np.concatenate([[0], pieces.cumsum()])
    segment = np.repeat(np.arange(len(pieces)), pieces)
    u = ((np.arange(first[-1]) - first[segment]) / pieces[segment])[:, None]
    # the derivative that an arc has, which leaves its chord by this angle
    begin = start * (2 * lengths / (1 + np.cos(turn[0])))[:, None]
    end = stop * (2 * lengths / (1 + np.cos(turn[1])))[:, None]
    rest = 1.0 - u
    offset = u * (3 - 2 * u) * u * chords[segment]
    offset += u * rest * (rest * begin[segment] - u * end[segment])
    result = np.concatenate([points[segment] + offset, points[-1:]])
    result[first] = points
    return result, first[corners]


def _tangents(points: Array, units: Array, corners: Indices) -> tuple[Array, Array]:
    """Return unit tangents at the start and at the stop of each segment, (n - 1, d) each."""
    across = points[2:] - points[:-2]
    size = norms(across)
    inner = np.divide(across, size[:, None], out=units[:-1].copy(), where=size[:, None] > 0)
    start, stop = units.copy(), units.copy()
    start[1:], stop[:-1] = inner, inner
    free_start, free_stop = np.zeros(len(units), dtype=bool), np.zeros(len(units), dtype=bool)
    free_start[0] = free_stop[-1] = True
    free_start[corners] = free_stop[corners - 1] = True
    for tangent, free, other in ((start, free_start, stop), (stop, free_stop, start)):
        steep = angles_between(tangent, units) > STEEPEST
        tangent[free | steep] = units[free | steep]
        mirror = free & ~(free_start & free_stop) & (angles_between(other, units) <= STEEPEST)
        along = np.einsum("ij,ij->i", other[mirror], units[mirror])[:, None]
        tangent[mirror] = 2 * along * units[mirror] - other[mirror]
    return start, stop
