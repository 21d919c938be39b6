"""The curve of one level, whole or fractional: what is left when all finer details are taken away.

Level j is the best approximation in the L2 norm with 2**j equal spans, as in the pyramid. But it is
computed, and stored, only where the curve is finer than that: the influence of a fine knot on the
best approximation fades by 0.535 a span (the largest root of the Gram symbol of cubic B-splines),
so 40 spans away 6e-12 of it is left. Between such windows the curve keeps its knots,
its control points and their bits, and no level is too deep.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from multirep.arrays import Array, Flags, Indices
from multirep.errors import EditError, InvariantError
from multirep.representations.wavelet.dyadic import levels
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.splines.basis import basis_functions
from multirep.splines.evaluation import evaluate
from multirep.splines.polar import blossom, refine

__all__ = ["at_level"]

#: Spans of a level over which a fine knot acts: beyond, 0.45 * 0.5353**40 = 6e-12 of it are left.
#: More would be exact to the last bit, and leave more control points behind.
MARGIN = 40


class _Spline(NamedTuple):
    """A cubic on dyadic knots in [0, 1], fourfold at its own ends."""

    u: Array
    points: Array


def at_level(curve: Graded, level: float, near: tuple[float, float] = (0.0, 1.0)) -> Graded:
    """Return the curve of a level, or of a part of it.

    Parameters
    ----------
    curve : Graded
    level : float
        At least 0. At j + x it is ``(1 - x)`` times level j plus ``x`` times level j + 1, which is
        ``P c(j) + x Q d(j)`` (Finkelstein-Salesin 1994, 3.4). From the finest level of the curve on
        it is the curve itself.
    near : pair of float
        Dyadic parameters, 0 for the start of T and 1 for its end: where it is wanted.

    Returns
    -------
    Graded
        Of T or, with ``near``, of some stretch around it; within that stretch it is right near
        ``near`` only. Where the curve is as coarse as the level, control points keep their bits.

    Raises
    ------
    EditError
        For a negative level.

    Notes
    -----
    Linear in the knots around ``near`` and in the spans that are finer than the level, plus 80
    spans of the level around each of these. Uniform curves of level n up to 16 give the control
    points of :meth:`~multirep.representations.wavelet.Pyramid.control_points`, up to rounding.

    Examples
    --------
    >>> from multirep.interval import Interval
    >>> u = clamped(np.array([0.0, 0.25, 0.5, 0.75, 1.0]))
    >>> zigzag = Graded.of(Interval(0, 1), u, np.array([[0, 2, 0, 2, 0, 2, 0.0]]).T)
    >>> at_level(zigzag, 0).size, at_level(zigzag, 0.5).size, at_level(zigzag, 2) is zigzag
    (4, 5, True)
    """
    if not level >= 0:
        raise EditError(f"levels begin at 0, the base curve; got {level:g}")
    if level >= curve.level:
        return curve
    coarse, share = int(level), level % 1.0
    part = _cut(curve, *_around(near, coarse))
    found = _projected(part, coarse)
    if found is part:  # nothing is finer there
        return curve
    if share:
        found = _mixed(found, _projected(part, coarse + 1), share)
    return Graded.of(curve.domain, found.u, found.points)


def _around(near: tuple[float, float], level: int) -> tuple[float, float]:
    """Widen a stretch by what acts on it, to knots of the level."""
    spans = 1 << level
    low, high = int(near[0] * spans) - MARGIN, -int(-near[1] * spans) + MARGIN
    return max(low, 0) / spans, min(high, spans) / spans


def _cut(curve: Graded, low: float, high: float) -> _Spline:
    """Cut a stretch out; control points whose knots lie inside keep their bits."""
    if low <= 0.0 and high >= 1.0:
        return _Spline(np.asarray(curve.u), np.asarray(curve.points))
    last = curve.size - 1
    i = min(max(curve.u.searchsorted(low, "right") - 1, 3), last)
    j = min(max(curve.u.searchsorted(high) - 1, i), last)
    u, points = curve.u.window(i - 3, j + 5), np.array(curve.points.window(i - 3, j + 1))
    inner = clamped(np.concatenate(([low], u[4:-4], [high])))
    ends = np.array([0, 1, 2, -3, -2, -1]) % len(points)
    spans = np.array([0, 0, 0, j - i, j - i, j - i]) + 3
    arguments = inner.take(ends[:, None] + np.arange(1, 4))
    points[ends] = blossom(u, points, 3, spans, arguments)
    return _Spline(inner, points)


def _projected(curve: _Spline, level: int) -> _Spline:
    """Project on one level wherever there are finer knots, and as far around as that matters."""
    u = curve.u
    fine = u[4:-4][levels(u[4:-4]) > level]
    if not len(fine):
        return curve
    starts, stops = _windows(fine, u[0], u[-1], level)
    counts = stops - starts + 1
    offsets = np.arange(counts.sum()) - np.repeat(counts.cumsum() - counts, counts)
    grid = (np.repeat(starts, counts) + offsets) * 2.0**-level
    kept = np.setdiff1d(u[3:-3], fine, assume_unique=True)
    breaks = np.union1d(kept, grid)
    knots, finer = clamped(breaks), clamped(np.union1d(breaks, fine))
    points = refine(u, curve.points, 3, finer)
    # Every other control point has no fine knot within reach: it is that of the finer knots.
    first = starts.searchsorted(knots[:-4] * 2.0**level, "right") - 1
    free = (first >= 0) & (knots[4:] * 2.0**level <= stops[np.maximum(first, 0)])
    held = points[np.arange(len(free)) + fine.searchsorted(knots[2:-2])]
    pieces = finer[3:-3]
    run = starts.searchsorted(pieces[:-1] * 2.0**level, "right") - 1
    inside = (run >= 0) & (pieces[1:] * 2.0**level <= stops[np.maximum(run, 0)])
    origin = held[len(held) // 2]
    solved = _best(
        _Spline(finer, points - origin),
        pieces[:-1][inside],
        pieces[1:][inside],
        knots,
        held - origin,
        free,
    )
    return _Spline(knots, np.where(free[:, None], solved + origin, held))


def _windows(fine: Array, low: float, high: float, level: int) -> tuple[Indices, Indices]:
    """Return first and last knots of the level, as integers, of the windows around fine knots."""
    scaled = fine * 2.0**level
    starts = np.maximum(np.floor(scaled) - MARGIN, low * 2.0**level).astype(np.intp)
    stops = np.minimum(np.ceil(scaled) + MARGIN, high * 2.0**level).astype(np.intp)
    apart = np.flatnonzero(starts[1:] > stops[:-1]) + 1
    return starts[np.append(0, apart)], stops[np.append(apart - 1, len(stops) - 1)]


def _best(
    curve: _Spline, starts: Array, stops: Array, knots: Array, held: Array, free: Flags
) -> Array:
    """Solve for the free control points on ``knots``: the best in L2 over the given pieces.

    Products of cubics are integrated exactly, by four Gauss nodes on each piece.
    """
    from scipy.linalg.lapack import dpbsv

    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = 0.5 * (stops - starts)
    t = (0.5 * (starts + stops)[:, None] + half[:, None] * nodes).ravel()
    spans = knots.searchsorted(t, "right") - 1
    basis = basis_functions(knots, 3, t, spans)
    both = np.concatenate((basis, evaluate(curve.u, curve.points, 3, t)), axis=1)
    basis = basis * (half[:, None] * weights).ravel()[:, None]
    first = np.flatnonzero(np.append(True, spans[1:] > spans[:-1]))
    place = spans[first] - 3
    count = len(free)
    gram, right = np.zeros((4, count)), np.zeros_like(held)
    for i in range(4):
        sums = np.add.reduceat(basis[:, i, None] * both, first, axis=0)
        right[place + i] += sums[:, 4:]
        for k in range(i + 1):
            gram[i - k, place + k] += sums[:, k]
    # Held control points go to the other side; an equation of their own keeps them in the system.
    known = np.where(free[:, None], 0.0, held)
    for k in range(1, 4):
        coupling = gram[k, :-k, None]
        right[:-k] -= coupling * known[k:]
        right[k:] -= coupling * known[:-k]
        gram[k, :-k] *= free[:-k] & free[k:]
    gram[0] = np.where(free, gram[0], 1.0)
    right[~free] = 0.0
    _, solution, info = dpbsv(gram, right, lower=1)
    if info:
        raise InvariantError("the Gram matrix of a level is not positive definite", info)
    best: Array = solution
    return best


def _mixed(one: _Spline, two: _Spline, share: float) -> _Spline:
    """Go from one curve to another by a share; where both have the same bits, so has the result."""
    u = clamped(np.union1d(one.u[3:-3], two.u[3:-3]))
    first, second = (refine(curve.u, curve.points, 3, u) for curve in (one, two))
    return _Spline(u, first + share * (second - first))
