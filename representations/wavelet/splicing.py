"""Splices: follow a polyline on any interval, leave the curve outside as it is.

The interval [a, b] need not end at knots. Where it does not, the piece of the old curve that leads
in is kept up to a dyadic number a' just behind a, as far as it stays within the allowance; a'
becomes a knot. The control points that act on the old piece are dictated by it (polar forms, so the
join is C2); the free ones act only inside. The knots inside are chosen anew, from the data alone:
what an earlier, finer shape left behind is gone.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet.attempt import (
    Attempt,
    Frame,
    Problem,
    frame_pieces,
)
from multirep.representations.wavelet.dyadic import (
    clusters,
    coarsest_between,
    finest_level,
    halves,
    parameters,
    starting,
)
from multirep.representations.wavelet.fitting import fit_stretch
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.representations.wavelet.prediction import predict
from multirep.representations.wavelet.target import Target
from multirep.sampled import SampledSplice
from multirep.splines import compiled
from multirep.splines.deviation import spline_chord_deviation
from multirep.splines.evaluation import evaluate
from multirep.splines.pieces import largest_coordinate
from multirep.splines.polar import blossom
from multirep.splines.simplification import simplified

__all__ = ["fit", "splice"]

#: First fits of more chords than this leave out vertices first, and what part of the allowance that
#: may use. Larger saves time and costs control points.
_MANY_CHORDS = 4096
_SIMPLIFYING_SHARE = 0.05
#: Spans to begin with where no, one or both ends are joined: three would leave nothing free between
#: two joins.
_FEWEST_SPANS = (1, 3, 4)
#: So many old knots beside an end that is a knot are kept where they can be.
_KEPT = 2
#: Kept spans may be longer by this factor than the turn from the old piece to the target needs.
_ABOUT = 1.5
#: The old curve leads in over at most this part of the interval.
_LEAD_IN = 1 / 8
#: How much nearer to the end the next try is when the old curve leaves the allowance on its
#: lead-in.
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
        When the tolerance cannot be proved with the finest knots.
    """
    domain = sampled.interval
    target, left_out = _simpler(sampled, tolerance)
    ends = np.array([domain.start, domain.stop])
    frame = Frame(ends[[0, 0, 0]], ends[[1, 1, 1]], None, False, False)
    fitted = _fit(
        target,
        (np.array([0.0]), np.array([1.0])),
        domain,
        frame,
        largest_coordinate(sampled.points),
        thin=True,
    )
    curve = Graded.of(domain, clamped(fitted.u), fitted.points.T + target.origin)
    return curve, fitted.bound + left_out


def _simpler(sampled: SampledSplice, tolerance: float) -> tuple[Target, float]:
    """Leave out vertices that hardly matter, by how much; it is taken off the allowances."""
    left_out = 0.0
    t, points, allowances = sampled.t, sampled.points, sampled.allowance(tolerance)
    if len(allowances) > _MANY_CHORDS and allowances.min() > 0.0:
        kept, deviation = simplified(t, points, _SIMPLIFYING_SHARE * allowances)
        allowances = np.minimum.reduceat(allowances, kept[:-1]) - deviation
        t, points, left_out = t[kept], points[kept], float(deviation.max())
    return Target.along(t, points, allowances), left_out


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
        When an end of the interval is off by more than its allowance already, or the tolerance
        cannot be proved.

    Notes
    -----
    Costs what the window costs.
    """
    interval = sampled.interval
    if not curve.domain.contains(interval):
        raise ParameterError(f"the splice {interval} leaves the domain {curve.domain}")
    if sampled.dimension != curve.points.shape[1]:
        raise InvalidCurveError(
            f"a splice in {sampled.dimension} coordinates does not fit a curve "
            f"in {curve.points.shape[1]}"
        )
    target = Target.of(sampled, tolerance)
    first, last = curve.span_at(interval.start), curve.span_at(interval.stop, "left")
    start = _start(curve, target, interval.start, first)
    stop = _stop(curve, target, interval.stop, last)
    frame, inner, kept = _frame(curve, start, stop, target.origin)
    magnitude = largest_coordinate(sampled.points, kept)
    fitted = _fit(
        target, _knots_to_keep(curve, start, stop), curve.domain, frame, magnitude, thin=False
    )
    rows = np.add(fitted.points.T, target.origin, order="C")
    if frame.pieces is not None:
        same = (fitted.arguments == inner).all(axis=1, keepdims=True)
        if start.joined:
            np.copyto(rows[:3], kept[:3], where=same[:3])
        if stop.joined:
            np.copyto(rows[-3:], kept[3:], where=same[3:])
    spliced = curve.replaced(
        (start.span + 1, stop.span + 1), fitted.u, (start.span - 2, stop.span), rows
    )
    return spliced, max(fitted.bound, start.bound, stop.bound)


def _start(curve: Graded, target: Target, a: float, span: int) -> _End:
    """Find where the free stretch begins."""
    if a == curve.domain.start:
        return _End(0.0, 2, False, 0.0)
    if curve.knots(span, span + 1)[0] == a:
        return _End(float(curve.u[span]), span - 1, True, 0.0)
    return _lead_in(curve, target, a, span, forwards=True)


def _stop(curve: Graded, target: Target, b: float, span: int) -> _End:
    """Find where the free stretch ends."""
    if b == curve.domain.stop:
        return _End(1.0, curve.size, False, 0.0)
    if curve.knots(span + 1, span + 2)[0] == b:
        return _End(float(curve.u[span + 1]), span + 1, True, 0.0)
    return _lead_in(curve, target, b, span, forwards=False)


def _lead_in(curve: Graded, target: Target, end: float, span: int, *, forwards: bool) -> _End:
    """Find a dyadic number near ``end`` to which the old piece is proved to keep the allowances."""
    knots, points = curve.window(span, span)
    t, domain = target.t, curve.domain
    chord = 0 if forwards else -1
    at = np.array([end])
    away = evaluate(knots, points, 3, at)[0] - target.origin - target.points[:, chord]
    gap = math.sqrt(float(away @ away))
    room = float(target.allowances[chord]) - gap
    if room <= 0.0:
        raise _gap_error(target, end, gap, chord)
    next_knot = float(knots[4] if forwards else knots[3])
    reach = min(abs(next_knot - end), _LEAD_IN * float(t[-1] - t[0]))
    slope = evaluate(knots, points, 3, at, order=1)[0] - target.slopes[:, chord]
    steep = math.sqrt(float(slope @ slope))
    if steep * reach > 0.35 * room:
        reach = 0.35 * room / steep
    shortest = domain.length * 2.0 ** -finest_level(domain)
    if abs(next_knot - end) < shortest:  # no room for another knot between: all of the old piece
        bound = _led(knots, points, target, end, next_knot)
        if bound is not None:
            return _End(float(curve.u[span + 1 if forwards else span]), span, True, bound)
    sign = 1.0 if forwards else -1.0
    while reach >= shortest:
        ends = sorted(
            ((end + sign * part * reach - domain.start) / domain.length) for part in (2.0**-40, 1.0)
        )
        u = coarsest_between(*ends)
        near = float(parameters(np.array([u]), domain)[0])
        if near == end:
            return _End(u, span, True, 0.0)
        if (near > end) == forwards and abs(near - end) <= reach:
            bound = _led(knots, points, target, end, near)
            if bound is not None:
                return _End(u, span, True, bound)
        reach *= _NEARER
    raise _gap_error(target, end, gap, chord)


def _led(knots: Array, points: Array, target: Target, end: float, near: float) -> float | None:
    """Prove that an old piece keeps the allowances between two parameters; None if it does not."""
    t, (low, high) = target.t, sorted((end, near))
    inner = t[t.searchsorted(low, "right") : t.searchsorted(high)]
    marks = np.concatenate(([low], inner, [high]))
    values, chords = target.at(marks)
    proved = spline_chord_deviation(knots, points, 3, marks, values.T + target.origin)
    kept = bool((proved <= target.allowances.take(chords[:-1])).all())
    return float(proved.max()) if kept else None


def _gap_error(target: Target, end: float, gap: float, chord: int) -> ToleranceError:
    allowance = float(target.allowances[chord])
    return ToleranceError(
        f"at t = {end:.6g}, where the splice must join the curve outside, that is {gap:.3g} from "
        f"the samples already; {allowance:.3g} is allowed and the rest of it too little to lead in",
        tolerance=allowance,
        where=end,
    )


def _fineness_error(target: Target, domain: Interval) -> ToleranceError:
    return ToleranceError(
        f"near the ends of the splice [{target.t[0]:.17g}, {target.t[-1]:.17g}] knots finer "
        f"than the finest on T = {domain} would be needed"
    )


def _frame(curve: Graded, start: _End, stop: _End, origin: Array) -> tuple[Frame, Array, Array]:
    """Cut out the surroundings, and inner knots (6, 3) and rows (6, d) to keep if they stay."""
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


def _knots_to_keep(curve: Graded, start: _End, stop: _End) -> tuple[Array, Array]:
    """Return the ends of the free stretch, each with the two old knots that follow it inside.

    With these in place the dictated control points need not change.
    """
    first, last = np.array([start.u]), np.array([stop.u])
    i, j = start.span + 1, stop.span
    at_start = start.joined and start.u == curve.u[i]
    at_stop = stop.joined and stop.u == curve.u[j]
    inside = j - i + 1 - at_start - at_stop
    if at_start and inside >= _KEPT:
        first = curve.u.window(i, i + _KEPT + 1)
    if at_stop and inside >= _KEPT:
        last = curve.u.window(j - _KEPT, j + 1)
    if first[-1] >= last[0]:
        # Too few for both ends: the closer ones, which guard something.
        if first[-1] - first[0] <= last[-1] - last[0]:
            last = last[-1:]
        else:
            first = first[:1]
    return first, last


def _fit(
    target: Target,
    ends: tuple[Array, Array],
    domain: Interval,
    frame: Frame,
    magnitude: float,
    *,
    thin: bool,
) -> Attempt:
    """Predict the knots between the first and the last ones, then fit."""
    problem = Problem.of(target, domain, frame, magnitude)
    shortest = 2.0 ** -finest_level(domain)
    first, last = ends
    u = np.array([first[0], last[-1]])
    if frame.pieces is not None:
        lengths = _first_spans(target, parameters(u, domain), frame)
        if not min(lengths):
            # The old piece beside an end is a sliver; continued, it swings out at once.
            raise _fineness_error(target, domain)
        lengths = lengths[0] / domain.length, lengths[1] / domain.length
        if len(first) > 1 and float((first[1:] - first[:-1]).max()) > _ABOUT * lengths[0]:
            first = first[:1]
        if len(last) > 1 and float((last[1:] - last[:-1]).max()) > _ABOUT * lengths[1]:
            last = last[-1:]
        u = starting(float(first[-1]), float(last[0]), *lengths)
    if len(target.corners):
        sharp = clusters(
            (target.corners - domain.start) / domain.length,
            np.maximum(target.widths / domain.length, 8 * shortest),
        )
        u = np.concatenate((u, sharp[(sharp > u[0]) & (sharp < u[-1])]))
        u.sort()
        u = u[np.concatenate(([True], u[1:] > u[:-1]))]
    while len(u) <= _FEWEST_SPANS[frame.left + frame.right]:
        u = np.sort(np.concatenate((u, halves(u[:-1], u[1:]))))
    if (u[1:] - u[:-1]).min() < shortest:
        raise _fineness_error(target, domain)
    more = predict(target, u[:-1], u[1:], shortest, domain)
    u = np.concatenate((first[:-1], u, more, last[1:]))
    u.sort()
    return fit_stretch(problem, u, shortest=shortest, thin=thin)


def _first_spans(target: Target, ends: Array, frame: Frame) -> tuple[float, float]:
    """Return how long the first and last span may be for the curve to turn to the target.

    As far as the old piece, continued, departs from the target by 3/2 of the room there is (0 where
    it does so at once): a curve that leaves it with all derivatives but the third is off by 0.6 s h
    on spans of length h if the target leaves at the slope s.
    """
    assert frame.pieces is not None
    start, stop = ends.tolist()
    steps = (stop - start) * _STEPS
    lengths = [stop - start, stop - start]
    for side, joined in enumerate((frame.left, frame.right)):
        if joined:
            end = stop if side else start
            far, gap, chord = _departure(target, frame.pieces, side, end, -steps if side else steps)
            if gap > target.allowances[chord]:
                raise _gap_error(target, end, gap, chord)
            if far > 0:
                lengths[side] = float(steps[far - 1])
    return lengths[0], lengths[1]


def _departure(
    target: Target, pieces: tuple[Array, Array], side: int, end: float, steps: Array
) -> tuple[int, float, int]:
    """Return the first step where the old piece is too far off (or -1), the gap at 0, its chord."""
    if compiled.active:
        polyline = target.t, target.points, target.slopes, target.allowances
        return compiled.core.departure(*polyline, *pieces, _SPANS[side], end, steps)
    t = end + steps
    values, chords = target.at(t)
    spans = np.full(len(t), _SPANS[side])
    away = blossom(*pieces, 3, spans, t[:, None].repeat(3, axis=1)).T - values
    gap = math.sqrt(float(np.square(away[:, 0]).sum()))
    allowance = float(target.allowances[chords[0]])
    square = np.square(away - away[:, :1]).sum(axis=0)
    far = square > (1.5 * max(allowance - gap, allowance / 8)) ** 2
    return int(far.argmax()) if far.any() else -1, gap, int(chords[0])


#: Where the old pieces are compared with the target, in parts of the stretch from the joined end.
_STEPS = np.concatenate(([0.0], 2.0 ** np.arange(-38.0, 0.0)))
#: The spans of the old pieces, see `frame_pieces`.
_SPANS = (3, 10)
_INNER = np.array([[1, 2, 3], [2, 3, 4], [3, 4, 5], [6, 7, 8], [7, 8, 9], [8, 9, 10]])
