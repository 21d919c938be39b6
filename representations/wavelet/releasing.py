"""Take back the knots that a stretch needed to stay as it is; see `held` for what they are.

A knot across which the curve is a single cubic is not needed. The two control points that read
the parameters on both sides of such knots are the polar form of that cubic, taken from the longer
of the two pieces beside them; writing the result with the knots again proves that nothing moved.
"""

from __future__ import annotations

import numpy as np

from multirep.representations.wavelet.graded import Graded
from multirep.representations.wavelet.holding import is_guarded
from multirep.splines.polar import blossom

__all__ = ["released"]

#: Knots are taken back if that is proved to move the curve by no more than this part of its
#: coordinates: rounding, after the knots were inserted and the curve beside them left alone.
_ROUNDING = 2.0**-44


def released(curve: Graded, t: float, count: int) -> Graded:
    """Remove up to ``count`` of the knot at ``t`` and the knots that guard it.

    Those stay across which the curve is no single cubic any more, beyond rounding.

    Examples
    --------
    >>> from multirep.interval import Interval
    >>> from multirep.representations.wavelet.graded import clamped
    >>> from multirep.representations.wavelet.holding import held
    >>> from multirep.splices import SpliceList
    >>> rows = np.random.default_rng(1).normal(size=(11, 2))
    >>> curve = Graded.of(Interval(0, 1), clamped(np.arange(9) / 8), rows)
    >>> prepared, guard = held(curve, Interval(0, 0.7), SpliceList.EMPTY)
    >>> freed = released(prepared, guard.stop, prepared.size - curve.size)
    >>> prepared.size, freed.size, bool(abs(freed.points - curve.points).max() < 1e-14)
    (14, 11, True)
    """
    knot = curve.span_at(t)
    if not 3 < knot < curve.size or float(curve.knots(knot, knot + 1)[0]) != t:
        return curve
    before = curve.size
    for side, first in ((1, knot + 1), (-1, knot - 2)):
        if count >= 2 and is_guarded(curve, knot, side):
            freed = _without(curve, first, first + 2)
            knot += (freed.size - curve.size) * (side < 0)
            curve, count = freed, count - (curve.size - freed.size)
    free = not (is_guarded(curve, knot, 1) or is_guarded(curve, knot, -1))
    if count >= 1 and free and curve.size < before:
        curve = _without(curve, knot, knot + 1)
    return curve


def _without(curve: Graded, first: int, stop: int) -> Graded:
    """Remove the knots first..stop-1, or nothing if that moved the curve."""
    u = curve.u.window(first - 3, stop + 3)
    points = curve.points.window(first - 4, stop)
    removed = u[3:-3]
    # Local indices: the pieces before and behind what is removed.
    left, right = 2, len(u) - 4
    piece = left if u[left + 1] - u[left] >= u[right + 1] - u[right] else right
    beside = np.concatenate((u[1:3], u[-3:-1]))
    arguments = np.stack((beside[:3], beside[1:]))
    knots = np.concatenate((u[:1], u, u[-1:]))  # span k reads control points k - 3 .. k
    rows = blossom(knots, points, 3, np.full(2, piece + 1), arguments)
    freed = curve.replaced((first, stop), np.empty(0), (first - 3, stop - 1), rows)
    back = freed.refined(removed).points.window(first - 4, stop)
    moved = float(np.abs(back - points).max())
    return freed if moved <= _ROUNDING * curve.magnitude else curve
