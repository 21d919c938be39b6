"""Prepare a stretch to stay as it is, bit by bit, whatever splices end beside it.

A control point acts on four spans, so a splice that ends at a knot would move bits up to two knots
beyond it. Where a stretch is to be held, two knots are inserted just outside its end, as close as
knots can be. They mark the end as a place where splices can stop: these keep them, the control
points that act inside stay the same, and what the splice needs to turn it finds room for in
between.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import coarsest_between, finest_level, parameters
from multirep.representations.wavelet.graded import Graded
from multirep.splices import SpliceList

__all__ = ["held", "is_guarded", "reached", "tight"]

#: A splice reaches for the third knot outside, so that the two knots between can stay as they are.
_REACH = 3

#: An end that is no dyadic number moves outward to a coarse one, by at most this part of the span
#: around it.
_SLIVER = 2.0**-8


def tight(curve: Graded) -> float:
    """Return the distance of guarding knots: four shortest spans; nothing else makes two of it."""
    return 2.0 ** (2 - finest_level(curve.domain))


def is_guarded(curve: Graded, knot: int, side: int) -> bool:
    """Whether two guarding knots stand before (side -1) or behind (side 1) a knot."""
    if not 4 <= knot < curve.size:
        return False
    u = curve.u.window(knot - 2, knot + 1) if side < 0 else curve.u.window(knot, knot + 3)
    return bool(((u[1:] - u[:-1]) == tight(curve)).all())


def held(curve: Graded, interval: Interval, keep: SpliceList) -> tuple[Graded, Interval]:
    """Guard the ends of ``interval`` that lie inside T.

    Parameters
    ----------
    curve : Graded
    interval : Interval
    keep : SpliceList
        Not a bit may change here. Where an end of it is not guarded, guards stand farther out.

    Returns
    -------
    curve : Graded
        The same curve up to rounding.
    guard : Interval
        From guarded knot to guarded knot.

    Examples
    --------
    >>> from multirep.representations.wavelet.graded import clamped
    >>> u = clamped(np.arange(9) / 8)
    >>> curve = Graded.of(Interval(0, 1), u, np.zeros((11, 1)))
    >>> prepared, guard = held(curve, Interval(0.25, 0.7), SpliceList.EMPTY)
    >>> print(prepared.size - curve.size, guard)
    5 [0.25, 0.700195]
    >>> held(prepared, guard, SpliceList.EMPTY)[0] is prepared
    True
    """
    start, stop = interval
    for side in (-1, 1):
        end = start if side < 0 else stop
        if end == (curve.domain.start if side < 0 else curve.domain.stop):
            continue
        end, done = _outside(curve, end, side, keep)
        if not done:
            curve, end = _guarded(curve, end, side)
        start, stop = (end, stop) if side < 0 else (start, end)
    return curve, Interval(start, stop)


def _outside(curve: Graded, end: float, side: int, keep: SpliceList) -> tuple[float, bool]:
    """Move an end outward until guarding it changes no bit that is kept; True if it is guarded.

    With m the last parameter kept and knots k < m <= k + 1, what acts before m reads no knot beyond
    k + 3.
    """
    if side > 0:
        kept = [min(part.stop, end) for part in keep if part.start < end][-1:]
    else:
        kept = [max(part.start, end) for part in keep if part.stop > end][:1]
    if not kept:
        return end, False
    span = curve.span_at(kept[0], "left" if side > 0 else "right")
    knot, reads = (span + 1, span + 3) if side > 0 else (span, span - 2)
    beside = float(curve.knots(knot, knot + 1)[0])
    if is_guarded(curve, knot, side) and (end - beside) * side <= 0:
        return beside, True
    limit = float(curve.knots(max(reads, 3), max(reads, 3) + 1)[0])
    limit = min(limit, curve.domain.stop)
    farther = max(end, limit) if side > 0 else min(end, limit)
    return farther, farther in (curve.domain.start, curve.domain.stop)


def _guarded(curve: Graded, end: float, side: int) -> tuple[Graded, float]:
    """Guard one end; returns the curve and where the end is now."""
    domain = curve.domain
    span = curve.span_at(end, "right" if side < 0 else "left")
    low, high = curve.knots(span, span + 2).tolist()
    knot = span if side < 0 else span + 1
    at = low if side < 0 else high
    if at == end and is_guarded(curve, knot, side):
        return curve, end
    step = tight(curve)
    place = (end - domain.start) / domain.length
    u = round(place / step) * step
    if at == end:
        u = float(curve.u[knot])
    elif parameters(np.array([u]), domain)[0] != end:
        sliver = _SLIVER * (high - low) / domain.length
        u = coarsest_between(*sorted((place, place + side * sliver)))
    # One grain farther out if rounding left it inside.
    found = float(parameters(np.array([u]), domain)[0])
    if (found - end) * side < 0:
        u += side * step
        found = float(parameters(np.array([u]), domain)[0])
    guards = u + side * step * np.arange(3.0)
    if guards.min() <= 0.0 or guards.max() >= 1.0:
        return curve, domain.start if side < 0 else domain.stop
    return curve.refined(np.sort(guards)), found


def reached(curve: Graded, interval: Interval, within: Interval) -> Interval:
    """Return the ends that a splice would like: the third knot outside, or as far as it may go.

    Never between the knots that guard a held stretch, for what ends there moves bits of the
    stretch.

    Examples
    --------
    >>> from multirep.representations.wavelet.graded import clamped
    >>> curve = Graded.of(Interval(0, 1), clamped(np.arange(17) / 16), np.zeros((19, 1)))
    >>> print(reached(curve, Interval(0.45, 0.55), Interval(0.35, 1.0)))
    [0.375, 0.6875]
    """
    a, b = interval
    if a > curve.domain.start:
        k = curve.span_at(a)
        first = max(k + 1 - _REACH, 3)
        u = curve.u.window(first - 1, k + 1)
        a = _farthest(curve, u[1:], u[:-1], a, within)
    if b < curve.domain.stop:
        k = curve.span_at(b, "left") + 1
        last = min(k + _REACH, curve.size + 1)
        u = curve.u.window(k, last + 1)
        b = _farthest(curve, u[-2::-1], u[:0:-1], b, within)
    return Interval(a, b)


def _farthest(curve: Graded, u: Array, beyond: Array, end: float, within: Interval) -> float:
    """Choose the first of some knots from the outside on, given the knot beyond each; or ``end``.

    These are a few numbers only: lists are cheaper than arrays.
    """
    step = tight(curve)
    near: list[float] = parameters(u, curve.domain).tolist()
    for t, at, next_one in zip(near, u.tolist(), beyond.tolist(), strict=True):
        if within.start <= t <= within.stop and abs(next_one - at) != step:
            return t
    return end
