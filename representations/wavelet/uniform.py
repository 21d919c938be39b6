"""From the graded curve to the uniform curve of one level, exactly or as the nearest in L2."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvariantError
from multirep.representations.wavelet.filters import point_count, refine_uniform
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.splines.basis import basis_functions
from multirep.splines.evaluation import evaluate
from multirep.splines.polar import refine

__all__ = ["uniform_points"]


def uniform_points(curve: Graded, level: int) -> Array:
    """Return control points of level ``level``, (2**level + 3, d).

    Parameters
    ----------
    curve : Graded
    level : int

    Returns
    -------
    (2**level + 3, d) array
        Of the same curve if no knot is finer than the level, by inserting knots up to the finest
        one there is and halving all spans from there on; else of its orthogonal projection.

    Notes
    -----
    Linear in control points + 2**level. The projection integrates products of cubics with four
    Gauss nodes on every piece between knots of either kind, which is exact, and solves a system of
    seven diagonals. Projections on coarser levels are those of this one, as the levels are nested:
    so the pyramid up to any level is the lower part of the pyramid that the finest level would
    have.

    Examples
    --------
    >>> from multirep.interval import Interval
    >>> u = clamped(np.array([0.0, 0.25, 0.5, 1.0]))
    >>> line = Graded.of(Interval(0, 1), u, np.array([0, 1, 3, 7, 10, 12])[:, None] / 12)
    >>> uniform_points(line, 1)[1:, 0].round(12)
    array([0.16666667, 0.5       , 0.83333333, 1.        ])
    """
    points, finest = np.asarray(curve.points), curve.level
    if finest > level:
        return _projected(np.asarray(curve.u), points, _knots(level))
    if len(points) < point_count(finest):
        points = refine(np.asarray(curve.u), points, 3, _knots(finest))
    for _ in range(level - finest):
        points = refine_uniform(points)
    return points


def _knots(level: int) -> Array:
    return clamped(np.arange((1 << level) + 1) / (1 << level))


def _projected(u: Array, points: Array, knots: Array) -> Array:
    from scipy.linalg.lapack import dpbsv

    nodes, weights = np.polynomial.legendre.leggauss(4)
    breaks = np.union1d(u[3:-3], knots[3:-3])
    half = 0.5 * (breaks[1:] - breaks[:-1])
    t = (0.5 * (breaks[1:] + breaks[:-1])[:, None] + half[:, None] * nodes).ravel()
    rows_weight = (half[:, None] * weights).ravel()
    origin = points[len(points) // 2]
    values = evaluate(u, points - origin, 3, t)
    spans = knots.searchsorted(t, "right") - 1
    basis = basis_functions(knots, 3, t, spans)
    weighted = basis * rows_weight[:, None]
    both = np.concatenate((basis, values), axis=1)
    starts = np.concatenate(([0], np.flatnonzero(spans[1:] > spans[:-1]) + 1))
    sums = np.stack(
        [np.add.reduceat(weighted[:, j, None] * both, starts, axis=0) for j in range(4)], axis=1
    )
    count = len(knots) - 7
    band, right = np.zeros((4, count + 3)), np.zeros((count + 3, points.shape[1]))
    for j in range(4):
        right[j : j + count] += sums[:, j, 4:]
        for k in range(j + 1):
            band[j - k, k : k + count] += sums[:, j, k]
    _, solution, info = dpbsv(band, right, lower=1)
    if info:
        raise InvariantError("the Gram matrix of a level is not positive definite", info)
    projected: Array = solution + origin
    return projected
