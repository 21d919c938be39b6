"""Splices: follow a polyline on any interval, leave the curve outside as it is.

The interval [a, b] need not end at knots. Where it does not, the piece of the old curve that leads in is kept up to a
dyadic number a' just behind a, as far as it stays within the allowance; a' becomes a knot. The control points that act
on the old piece are dictated by it (polar forms, so the join is C2); the free ones act only inside. The knots inside are
chosen anew, from the data alone: what an earlier, finer shape left behind is gone.
"""

from __future__ import annotations

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import (
    coarsest_between,
    finest_level,
    graded_between,
    halves,
    parameters,
)
from multirep.representations.wavelet.fitting import Fitted, Frame, fit_stretch, frame_pieces
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.representations.wavelet.prediction import predict
from multirep.representations.wavelet.target import Target
from multirep.sampled import SampledSplice
from multirep.splines.deviation import spline_chord_deviation
from multirep.splines.evaluation import evaluate
from multirep.splines.polar import blossom

__all__ = ["fit", "splice"]

#: Spans to begin with where both ends are joined: three would leave nothing free.
_FEWEST_SPANS = 4
#: The old curve leads in over at most this part of the interval.
_LEAD_IN = 1 / 8
#: How much nearer to the end the next try is when the old curve leaves the allowance on its lead-in.
_NEARER = 1 / 4


class _End(NamedTuple):
    """Where the new curve joins the old one."""

    u: float
    """Dyadic knot at which the free stretch begins (or ends)."""
    span: int
    """Index of the old span whose piece continues up to there."""
    joined: bool
    """False at an end of T."""
    bound: float
    """Proved deviation of the old piece between here and the end of the interval."""


def fit(sampled: SampledSplice, *, tolerance: float) -> tuple[Graded, float]:
    """Fit a curve over the whole interval from nothing; returns it with its proved deviation.

    Raises
    ------
    ToleranceError
        When the tolerance cannot be proved with knots down to level 40.
    """
    domain = sampled.interval
    target = Target.of(sampled, tolerance)
    ends = np.array([domain.start, domain.stop])
    frame = Frame(ends[[0, 0, 0]], ends[[1, 1, 1]], None, False, False)
    fitted = _fit(target, 0.0, 1.0, domain, frame, float(np.abs(sampled.points).max()))
    return Graded.of(domain, clamped(fitted.u), fitted.points.T + target.origin), fitted.bound


def splice(curve: Graded, sampled: SampledSplice, *, tolerance: float) -> tuple[Graded, float]:
    """Follow a polyline on its interval; returns the new curve with its proved deviation there.

    Parameters
    ----------
    curve : Graded
        Unchanged outside, but for the representation of the pieces that are joined.
    sampled : SampledSplice
        On any interval inside T.
    tolerance : float
        As in :meth:`SampledSplice.allowance`.

    Raises
    ------
    ToleranceError
        When an end of the interval is off by more than its allowance already, or the tolerance cannot be proved.

    Notes
    -----
    Costs what the window costs. If the old curve is within the allowance everywhere it is returned as it is.
    """
    interval = sampled.interval
    if not curve.domain.contains(interval):
        raise ParameterError(f"the splice {interval} leaves the domain {curve.domain}")
    if sampled.dimension != curve.points.shape[1]:
        raise InvalidCurveError(
            f"a splice in {sampled.dimension} coordinates does not fit a curve in {curve.points.shape[1]}"
        )
    target = Target.of(sampled, tolerance)
    first, last = curve.span_at(interval.start), curve.span_at(interval.stop, "left")
    off = _already(curve, sampled, target, first, last)
    if isinstance(off, float):
        return curve, off
    start = _start(curve, target, interval.start, first, float(off[0]))
    stop = _stop(curve, target, interval.stop, last, float(off[-1]))
    frame, inner, kept = _frame(curve, start, stop, target.origin)
    magnitude = max(float(np.abs(sampled.points).max()), float(np.abs(kept).max(initial=0.0)))
    fitted = _fit(target, start.u, stop.u, curve.domain, frame, magnitude)
    rows = fitted.points.T + target.origin
    if start.joined:
        same = (fitted.arguments[:3] == inner[:3]).all(axis=1)
        rows[:3][same] = kept[:3][same]
    if stop.joined:
        same = (fitted.arguments[3:] == inner[3:]).all(axis=1)
        rows[-3:][same] = kept[3:][same]
    spliced = curve.replaced(
        (start.span + 1, stop.span + 1), fitted.u, (start.span - 2, stop.span), rows
    )
    return spliced, max(fitted.bound, start.bound, stop.bound)


def _already(
    curve: Graded, sampled: SampledSplice, target: Target, first: int, last: int
) -> float | Array:
    """Return the proved deviation if the old curve is within the allowances; else how far it is at the vertices."""
    knots, points = curve.window(first, last)
    away = evaluate(knots, points, 3, sampled.t) - sampled.points
    off: Array = np.sqrt(np.einsum("md,md->m", away, away))
    if bool((np.maximum(off[:-1], off[1:]) <= target.allowances).all()):
        proved = spline_chord_deviation(
            knots, points, 3, sampled.t, sampled.points, allowance=target.allowances
        )
        if bool((proved <= target.allowances).all()):
            return float(proved.max())
    return off


def _start(curve: Graded, target: Target, a: float, span: int, gap: float) -> _End:
    """Find where the free stretch begins."""
    if a == curve.domain.start:
        return _End(0.0, 2, False, 0.0)
    if curve.knots(span, span + 1)[0] == a:
        return _End(float(curve.u[span]), span - 1, True, 0.0)
    return _lead_in(curve, target, a, span, gap, forwards=True)


def _stop(curve: Graded, target: Target, b: float, span: int, gap: float) -> _End:
    """Find where the free stretch ends."""
    if b == curve.domain.stop:
        return _End(1.0, curve.size, False, 0.0)
    if curve.knots(span + 1, span + 2)[0] == b:
        return _End(float(curve.u[span + 1]), span + 1, True, 0.0)
    return _lead_in(curve, target, b, span, gap, forwards=False)


def _lead_in(
    curve: Graded, target: Target, end: float, span: int, gap: float, *, forwards: bool
) -> _End:
    """Find a dyadic number near ``end`` up to which the old piece is proved to be within the allowances."""
    knots, points = curve.window(span, span)
    t, domain = target.t, curve.domain
    chord = 0 if forwards else -1
    room = float(target.allowances[chord]) - gap
    if room <= 0.0:
        raise _gap_error(target, end, gap, chord)
    next_knot = float(knots[4] if forwards else knots[3])
    reach = min(abs(next_knot - end), _LEAD_IN * float(t[-1] - t[0]))
    slope = evaluate(knots, points, 3, np.array([end]), order=1)[0] - target.slopes[:, chord]
    steep = math.sqrt(float(slope @ slope))
    if steep * reach > 0.35 * room:
        reach = 0.35 * room / steep
    sign = 1.0 if forwards else -1.0
    shortest = domain.length * 2.0 ** -finest_level(domain)
    while reach >= shortest:
        ends = sorted(((end + sign * part * reach - domain.start) / domain.length) for part in (2.0**-40, 1.0))
        u = coarsest_between(*ends)
        near = float(parameters(np.array([u]), domain)[0])
        low, high = (end, near) if forwards else (near, end)
        if low == high:
            return _End(u, span, True, 0.0)
        if low < high and abs(near - end) <= reach:
            inner = t[t.searchsorted(low, "right") : t.searchsorted(high)]
            marks = np.concatenate(([low], inner, [high]))
            values, chords = target.at(marks)
            proved = spline_chord_deviation(knots, points, 3, marks, values.T + target.origin)
            if bool((proved <= target.allowances.take(chords[:-1])).all()):
                return _End(u, span, True, float(proved.max()))
        reach *= _NEARER
    raise _gap_error(target, end, gap, chord)


def _gap_error(target: Target, end: float, gap: float, chord: int) -> ToleranceError:
    allowance = float(target.allowances[chord])
    return ToleranceError(
        f"at t = {end:.6g}, where the splice must join the curve outside, that is {gap:.3g} from the samples already; "
        f"{allowance:.3g} is allowed and the rest of it too little to lead in",
        tolerance=allowance,
        where=end,
    )


def _frame(
    curve: Graded, start: _End, stop: _End, origin: Array
) -> tuple[Frame, Array, Array]:
    """Cut out the surroundings; also the inner knots (6, 3) and points (6, d) of the control points to keep if unmoved."""
    before = curve.knots(start.span - 2, start.span + 1)
    after = curve.knots(stop.span + 1, stop.span + 4)
    if not (start.joined or stop.joined):
        return Frame(before, after, None, False, False), np.empty((0, 3)), np.empty((0, 1))
    sides = [
        (curve.knots(end.span - 2, end.span + 4), curve.points.window(end.span - 3, end.span + 1))
        for end in ((start if start.joined else stop), (stop if stop.joined else start))
    ]
    (left_knots, left), (right_knots, right) = sides
    inner = np.concatenate((left_knots, right_knots)).take(_INNER)
    pieces = frame_pieces((left_knots, left - origin), (right_knots, right - origin))
    kept = np.concatenate((left[1:], right[:3]))
    return Frame(before, after, pieces, start.joined, stop.joined), inner, kept


def _fit(
    target: Target, start: float, stop: float, domain: Interval, frame: Frame, magnitude: float
) -> Fitted:
    """Predict the knots from ``start`` to ``stop``, then fit."""
    to_t = partial(parameters, domain=domain)
    shortest = 2.0 ** -finest_level(domain)
    u = np.array([start, stop])
    if frame.pieces is not None:
        first, last = _first_spans(target, to_t(u), frame)
        u = graded_between(start, stop, first / domain.length, last / domain.length)
    while len(u) <= (_FEWEST_SPANS if frame.left and frame.right else 1):
        u = np.sort(np.concatenate((u, halves(u[:-1], u[1:]))))
    if (u[1:] - u[:-1]).min() < shortest:
        raise ToleranceError(
            f"near the ends of the splice [{target.t[0]:.17g}, {target.t[-1]:.17g}] knots finer than the finest "
            f"on T = {domain} would be needed"
        )
    u = np.concatenate((u, predict(target, u[:-1], u[1:], shortest, to_t)))
    u.sort()
    return fit_stretch(target, u, to_t, frame, shortest=shortest, magnitude=magnitude)


def _first_spans(target: Target, ends: Array, frame: Frame) -> tuple[float, float]:
    """How long the first and the last span may be, so that the curve can turn from the old pieces to the target.

    As far as the old piece, continued, departs from the target by 3/2 of the room there is: a curve that leaves it
    with all derivatives but the third is off by 0.6 s h on spans of length h if the target leaves at the slope s.
    """
    assert frame.pieces is not None
    total = float(ends[1] - ends[0])
    steps = total * _STEPS
    count = len(steps)
    t = np.concatenate((ends[0] + steps, ends[1] - steps))
    values, chords = target.at(t)
    away = blossom(*frame.pieces, 3, _SIDES, t[:, None].repeat(3, axis=1)).T
    away -= values
    lengths = [total, total]
    for side, joined in enumerate((frame.left, frame.right)):
        if joined:
            here = away[:, side * count : (side + 1) * count]
            gap = math.sqrt(float(here[:, 0] @ here[:, 0]))
            allowance = float(target.allowances[chords[side * count]])
            square = np.square(here - here[:, :1]).sum(axis=0)
            far = square > (1.5 * max(allowance - gap, allowance / 8)) ** 2
            if far.any():
                lengths[side] = float(steps[far.argmax() - 1])
    return lengths[0], lengths[1]


#: Where the old pieces are compared with the target, in parts of the stretch from the joined end.
_STEPS = np.concatenate(([0.0], 2.0 ** np.arange(-38.0, 0.0)))
_SIDES = np.repeat([3, 10], len(_STEPS))
_INNER = np.array([[1, 2, 3], [2, 3, 4], [3, 4, 5], [6, 7, 8], [7, 8, 9], [8, 9, 10]])
