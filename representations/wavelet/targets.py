"""Sweeping several points of a curve to their targets at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from multirep.arrays import Array, Flags, Indices
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.memory import Memory, factored_once
from multirep.representations.wavelet import details
from multirep.representations.wavelet.dyadic import finest_level, parameters
from multirep.representations.wavelet.graded import Graded
from multirep.splices import SpliceList
from multirep.splines.basis import basis_functions

if TYPE_CHECKING:
    from multirep.arrays import ArrayLike
    from multirep.edit import Edit
    from multirep.representations.wavelet.bspline import WaveletBSpline

__all__ = ["swept_together"]

#: Conditions nearer to a combination of others than this (as unit rows) are refused: the curve
#: would swing out by a thousand times the offsets.
_QUALITY = 1e-3
#: Beside a frozen stretch the change is rather faded out than let swing so wide.
_QUALITY_BESIDE = 0.1


def swept_together(
    curve: WaveletBSpline,
    t: ArrayLike,
    to: ArrayLike,
    level: float,
    frozen: SpliceList = SpliceList.EMPTY,
    memory: Memory | None = None,
) -> Edit[WaveletBSpline]:
    """Move the curve at several parameters to points, by the smallest change of a level.

    Parameters
    ----------
    curve : WaveletBSpline
    t : (m,) array_like
        Distinct parameters in T.
    to : (m, d) array_like
        Where the curve shall be there; its present place holds it.
    level : float
        As for one point, see :meth:`WaveletBSpline.sweep`.
    frozen : SpliceList
        Where nothing may change: only control points of the level move that do not act there. If
        these cannot do it well, all of them move, and the caller has to fade the change out.
    memory : Memory, optional
        Of a gesture: systems that it knows are not factored anew.

    Returns
    -------
    Edit
        All targets are hit up to rounding; details of finer levels ride along.

    Raises
    ------
    ParameterError
        For a parameter outside T.
    EditError
        When shapes do not fit, there is no such level, or not all targets can be reached: they
        stand too close for the level. The message names those concerned.

    Notes
    -----
    ``dc = B^T (B B^T)^-1 (to - f(t))`` (Bartels-Beatty 1989; NURBS book 11.76), B the rows of the
    four functions of the level that act at each t: solved over those control points only, in bands.
    Between two levels it is the mix of the solutions of both, which hits the targets as well.

    Examples
    --------
    >>> from multirep.representations import WaveletBSpline
    >>> curve = WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])
    >>> edit = swept_together(curve, [0.25, 0.5], [curve(0.25), [2, 1]], level=2)
    >>> bool(abs(edit.value([0.25, 0.5]) - [curve(0.25), [2, 1]]).max() < 1e-15)
    True
    """
    at = np.atleast_1d(curve.parameters(t))
    points = np.asarray(to, dtype=np.float64)
    if at.ndim != 1 or points.shape != (len(at), curve.dimension) or not np.isfinite(points).all():
        raise EditError(
            f"expected one finite point of {curve.dimension} coordinates for each of "
            f"{len(at)} parameters, got the shape {points.shape}"
        )
    finest = finest_level(curve.domain)
    if not 0 <= level <= finest:
        raise EditError(f"a sweep needs a level from 0 to {finest}, got {level:g}")
    order = at.argsort(kind="stable")
    at, offsets = at[order], (points - curve(at))[order]
    graded, memory = curve._graded, memory or Memory()
    coarse, share = int(level), level % 1.0
    for j, part in ((coarse, 1.0 - share), (coarse + 1, share)):
        if part:
            columns, change = _solved(graded, at, offsets, j, frozen, memory)
            graded = _plus(graded, j, columns, part * change)
    return curve._edit(graded)


def _solved(
    curve: Graded, t: Array, offsets: Array, level: int, frozen: SpliceList, memory: Memory
) -> tuple[Indices, Array]:
    """Control points (k,) of the level that act at the parameters, and their changes (k, d)."""
    spans = 1 << level
    domain = curve.domain
    span = np.clip((t - domain.start) / domain.length * spans, 0, spans - 1).astype(np.intp)
    places = np.clip(span[:, None] + np.arange(-3, 5), 0, spans) / spans
    knots = np.asarray(parameters(places, domain))
    rows = basis_functions(np.concatenate(knots), 3, t, 8 * np.arange(len(t)) + 3)
    columns, starts = np.unique(span[:, None] + np.arange(4), return_inverse=True)
    starts = starts.reshape(len(t), 4)
    free = _free(curve, columns, level, frozen)
    # On ice, what stays where it is needs no condition.
    acting = free[starts].any(axis=1) | (offsets != 0.0).any(axis=1)
    if not acting.any():
        return columns, np.zeros((len(columns), offsets.shape[1]))
    found = factored_once(memory, starts[acting, 0], rows[acting], free).solve(offsets[acting])
    if not free.all() and found.quality < _QUALITY_BESIDE:
        acting, free = np.ones_like(acting), np.ones_like(free)
        found = factored_once(memory, starts[:, 0], rows, free).solve(offsets)
    if found.quality < _QUALITY:
        culprits = ", ".join(f"{value:.6g}" for value in t[acting][found.culprits].tolist())
        raise EditError(
            f"not all targets can be reached at level {level}: those at t = {culprits} stand so "
            f"close that its control points, {len(columns)} for {len(t)} targets in all, cannot "
            "tell them apart; take a higher level, or fewer targets"
        )
    return columns, found.change


def _free(curve: Graded, columns: Indices, level: int, frozen: SpliceList) -> Flags:
    """Whether control points of a level, given by their numbers, keep off what is frozen."""
    free = np.ones(len(columns), dtype=bool)
    spans = 1 << level
    ends = np.clip(columns[:, None] + np.array([-3, 1]), 0, spans) / spans
    starts, stops = np.asarray(parameters(ends, curve.domain)).T
    for stretch in frozen:
        # Two knots beside a frozen stretch stay, so that no control point beyond is written anew.
        low, high = _border(curve, stretch)
        free &= (stops <= low) | (starts >= high)
    return free


def _border(curve: Graded, frozen: Interval) -> tuple[float, float]:
    """Return the second knots outside a stretch, or the ends of T."""
    first = curve.span_at(frozen.start) if frozen.start > curve.domain.start else 5
    last = curve.span_at(frozen.stop, "left") + 1
    last = last if frozen.stop < curve.domain.stop else curve.size - 2
    return float(curve.knots(first - 2, first - 1)[0]), float(curve.knots(last + 2, last + 3)[0])


def _plus(curve: Graded, level: int, columns: Indices, rows: Array) -> Graded:
    """Add rows to control points of a level, run by run of those that change."""
    some = (rows != 0.0).any(axis=1)
    columns, rows = columns[some], rows[some]
    apart = np.flatnonzero(columns[1:] > columns[:-1] + 1) + 1
    for run, part in zip(np.split(columns, apart), np.split(rows, apart), strict=True):
        if len(run):
            curve = details.plus(curve, level, int(run[0]), part)
    return curve
