"""Points and derivatives of a spline with weights or without, from a window of its arrays.

Where all weights that matter are exactly 1 the curve is the polynomial spline, and is computed as
such: so that changing a weight leaves every point outside its support as it is, bit by bit, though
the curve was polynomial before.
"""

from __future__ import annotations

from math import comb
from typing import Literal

import numpy as np

from multirep.arrays import Array, Flags
from multirep.splines import compiled
from multirep.splines.basis import find_spans
from multirep.splines.evaluation import evaluate

__all__ = ["Side", "curve_derivative", "curve_point", "curve_points", "homogeneous"]

Side = Literal["left", "right"]

#: So few corners are compared with all parameters, which is faster than looking each up.
FEW_CORNERS = 4
#: So few rows are multiplied and divided at once.
FEW_ROWS = 64


def homogeneous(points: Array, weights: Array) -> Array:
    """Return ``(w x, w y, .., w)`` rows, (n, d + 1)."""
    n, d = points.shape
    rows = np.empty((n, d + 1))
    if n < FEW_ROWS:
        np.multiply(points, weights[:, None], out=rows[:, :d])
    else:  # column by column: numpy is slow along rows of two or three
        for k in range(d):
            np.multiply(points[:, k], weights, out=rows[:, k])
    rows[:, d] = weights
    return rows


def _polynomial_spans(weights: Array, degree: int) -> Flags | None:
    """Which spans k = p .. n - 1 of a window depend on weights 1 only, (n - p,); None: no span.

    Costs O(n), a few passes.
    """
    differs = weights != 1.0
    count = int(np.count_nonzero(differs))
    if count == len(weights):
        return None
    sums = np.concatenate(([0], differs.cumsum()))
    plain: Flags = sums[degree + 1 :] == sums[: len(sums) - degree - 1]
    return plain if bool(plain.any()) else None


def curve_points(
    knots: Array, points: Array, weights: Array | None, degree: int, t: Array
) -> Array:
    """Evaluate a spline at parameters in any order.

    Parameters
    ----------
    knots : (n + degree + 1,) array
    points : (n, d) array
    weights : (n,) array, or None for ones
    degree : int
    t : (m,) array
        In the domain.

    Returns
    -------
    (m, d) array
        The control point itself where a knot of full multiplicity stands: the curve passes it
        there, but evaluating the piece to the right may be one unit in the last place off, and off
        by another one when the next knot moves.

    Examples
    --------
    >>> knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.array([[1.0, 0], [1, 1], [0, 1]])
    >>> arc = curve_points(knots, points, np.array([1, np.sqrt(0.5), 1]), 2, np.array([0.3, 1]))
    >>> np.hypot(*arc.T).round(15)
    array([1., 1.])
    """
    if compiled.active:
        found = np.empty((len(t), points.shape[1]))
        compiled.core.points(knots, points, weights, degree, t, 0, False, True, found)
        return found
    values = _unsettled(knots, points, weights, degree, t)
    return _settled_at_corners(values, knots, points, degree, t)


def curve_point(knots: Array, points: Array, weights: Array | None, degree: int, t: float) -> Array:
    """Evaluate one parameter, (d,), in a window of one span; as `curve_points`, bit for bit."""
    if compiled.active:
        found = np.empty(points.shape[1])
        compiled.core.points(knots, points, weights, degree, t, 0, False, True, found)
        return found
    p = degree
    if t == knots[p] and t == knots[1]:
        return np.array(points[0])
    if t == knots[p + 1] and t == knots[2 * p]:
        return np.array(points[p])
    from scipy.interpolate import BSpline

    if weights is not None and weights.tolist().count(1.0) <= p:
        found = BSpline.construct_fast(knots, homogeneous(points, weights), p)(t)
        return np.asarray(found[:-1] / found[-1])
    return np.asarray(BSpline.construct_fast(knots, points, p)(t))


def _unsettled(knots: Array, points: Array, weights: Array | None, degree: int, t: Array) -> Array:
    if weights is None:
        return evaluate(knots, points, degree, t)
    values = evaluate(knots, homogeneous(points, weights), degree, t)
    w = values[:, -1]
    plain = _polynomial_spans(weights, degree)
    if plain is not None:
        spans = find_spans(knots, degree, t)
        w = np.where(plain[spans - degree], 1.0, w)
    if len(t) < FEW_ROWS:
        return np.asarray(values[:, :-1] / w[:, None])
    found = np.empty((len(t), points.shape[1]))
    for k in range(points.shape[1]):
        np.divide(values[:, k], w, out=found[:, k])
    return found


def _settled_at_corners(values: Array, knots: Array, points: Array, degree: int, t: Array) -> Array:
    """Put the control point itself where a knot of full multiplicity stands."""
    count = len(points)
    full = knots[1 : count + 1] == knots[degree : degree + count]
    if full.any():
        corners = knots[1 : count + 1][full]
        if len(corners) <= FEW_CORNERS:
            for corner, row in zip(corners.tolist(), np.flatnonzero(full).tolist(), strict=True):
                values[np.flatnonzero(t == corner)] = points[row]
            return values
        k = np.minimum(corners.searchsorted(t), len(corners) - 1)
        hit = corners[k] == t
        values[hit] = points[full][k[hit]]
    return values


def curve_derivative(
    knots: Array,
    points: Array,
    weights: Array | None,
    degree: int,
    t: Array,
    order: int,
    side: Side,
) -> Array:
    """Differentiate a spline ``order`` times at parameters (m,) of one side; (m, d).

    Notes
    -----
    Rational: with A = w C, Leibniz' rule gives C^(k) from A^(k) and the lower derivatives,
    ``C^(k) = (A^(k) - sum_i binom(k, i) w^(i) C^(k - i)) / w``.
    """
    if weights is None:
        return evaluate(knots, points, degree, t, order=order, side=side)
    rows = homogeneous(points, weights)
    plain = _polynomial_spans(weights, degree)
    is_plain = None
    if plain is not None:
        is_plain = plain[find_spans(knots, degree, t, side=side) - degree]
    found: list[Array] = []
    bottoms: list[Array] = []
    for k in range(order + 1):
        values = evaluate(knots, rows, degree, t, order=k, side=side)
        bottom = values[:, -1:]
        if is_plain is not None:
            bottom[is_plain] = 1.0 if k == 0 else 0.0
        bottoms.append(bottom)
        top = values[:, :-1]
        for i in range(1, k + 1):
            top = top - comb(k, i) * bottoms[i] * found[k - i]
        found.append(top / bottoms[0])
    return found[order]
