"""Lengths and directions along strokes, for coordinates of any size."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Flags


def norms(vectors: Array) -> Array:
    """Lengths of the rows, (m, d) -> (m,); tiny and huge ones neither vanish nor overflow."""
    largest = float(np.abs(vectors).max(initial=0.0))
    if largest == 0.0:
        return np.zeros(len(vectors))
    scaled = vectors / largest
    lengths: Array = np.sqrt(np.einsum("ij,ij->i", scaled, scaled)) * largest
    return lengths


def arc_lengths(points: Array) -> Array:
    """Length of the polyline through (n, d) points up to each of them, (n,); the first is 0.

    Examples
    --------
    >>> arc_lengths(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 5.0]]))
    array([0., 5., 6.])
    """
    lengths: Array = np.concatenate([[0.0], norms(points[1:] - points[:-1]).cumsum()])
    return lengths


def angles_between(one: Array, two: Array) -> Array:
    """Angles between the rows of two (m, d) arrays, (m,) in radians; 0 where a row is 0.

    By Kahan's formula, which keeps small angles and those near pi exact.

    Examples
    --------
    >>> angles_between(np.array([[2.0, 0.0]]), np.array([[0.0, 3.0]])).round(4)
    array([1.5708])
    """
    (a, moves), (b, turns) = _units(one), _units(two)
    apart, along = a - b, a + b
    squares = np.einsum("ij,ij->i", apart, apart), np.einsum("ij,ij->i", along, along)
    angles: Array = 2 * np.arctan2(*np.sqrt(squares))
    if not (moves.all() and turns.all()):
        angles[~(moves & turns)] = 0.0
    return angles


def _units(vectors: Array) -> tuple[Array, Flags]:
    """Rows of length 1, and which are none because they are 0."""
    largest = np.abs(vectors).max(axis=1, keepdims=True)
    moves = largest[:, 0] > 0
    if not moves.all():
        largest[~moves] = 1.0
    units: Array = vectors / largest
    lengths = np.sqrt(np.einsum("ij,ij->i", units, units))[:, None]
    if not moves.all():
        lengths[~moves] = 1.0
    units /= lengths
    return units, moves
