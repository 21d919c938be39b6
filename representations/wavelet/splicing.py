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
from multirep.errors import InvalidCurveError, ParameterError
from multirep.interval import Interval
from multirep.representations.wavelet.attempt import Frame, Piece, Problem
from multirep.representations.wavelet.beginning import beginning, gap_error
from multirep.representations.wavelet.dyadic import coarsest_between, finest_level, parameters
from multirep.representations.wavelet.fitting import fit_stretch, thinned
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.representations.wavelet.target import Target
from multirep.sampled import SampledSplice
from multirep.splines.deviation import spline_chord_deviation
from multirep.splines.evaluation import evaluate
from multirep.splines.pieces import largest_coordinate
from multirep.splines.simplification import simplified

__all__ = ["fit", "splice"]

#: First fits of more chords than this leave out vertices first, and what part of the allowance that
#: may use. Larger saves time and costs control points.
_MANY_CHORDS = 4096
_SIMPLIFYING_SHARE = 0.05
#: So many old knots beside an end that is a knot are kept where they can be.
_KEPT = 2
#: The old curve leads in over at most this part of the interval.
_LEAD_IN = 1 / 8
#: How much nearer to the end the next try is when the old curve leaves the allowance on its
#: lead-in.
_NEARER = 1 / 4
#: Rounds of thinning after a splice. Without them, curves that are edited all over keep a fifth
#: more control points; what later rounds find is not worth the time of a drag step.
_THINNINGS = 3


class _End(NamedTuple):
    """Where the new curve joins the old one."""

    u: float
    """Dyadic knot at which the free stretch begins (or ends)."""
    span: int
    """Index of the old span whose piece continues up to there."""
    joined: bool
    """False at an end of T."""
    stays: bool
    """Whether it is a knot already."""
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
    frame = Frame(ends[[0, 0, 0]], ends[[1, 1, 1]], None, None)
    problem = Problem.of(target, domain, frame, largest_coordinate(sampled.points))
    shortest = 2.0 ** -finest_level(domain)
    u = beginning(target, (np.array([0.0]), np.array([1.0])), domain, frame, shortest)
    fitted = thinned(problem, fit_stretch(problem, u, shortest=shortest))
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


def splice(
    curve: Graded, sampled: SampledSplice, *, tolerance: float
) -> tuple[Graded, Interval, float]:
    """Follow a polyline on its interval.

    Parameters
    ----------
    curve : Graded
        Unchanged outside, but for the representation of the pieces that are joined.
    sampled : SampledSplice
        On any interval inside T.
    tolerance : float
        As in :meth:`SampledSplice.allowance`.

    Returns
    -------
    curve : Graded
    changed : Interval
        Outside, not a bit is another.
    bound : float
        The proved deviation on the interval of the samples.

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
    frame = _frame(curve, start, stop, target.origin)
    old = curve.points.window(start.span - 2, stop.span)
    problem = Problem.of(target, curve.domain, frame, largest_coordinate(sampled.points, old))
    shortest = 2.0 ** -finest_level(curve.domain)
    ends = _knots_to_keep(curve, start, stop)
    u = beginning(target, ends, curve.domain, frame, shortest)
    fitted = fit_stretch(problem, u, shortest=shortest)
    stay = _staying(frame, fitted.x)
    inside = max(stay[0] - 1, 0), max(stay[1] - 1, 0)
    fitted = thinned(problem, fitted, kept=inside, rounds=_THINNINGS)
    rows = np.add(fitted.points.T, target.origin, order="C")
    # A dictated control point whose knots stay is the old one, bit by bit; the support of the next
    # one is where the change begins.
    begin, end = curve.domain
    if frame.left:
        rows[: stay[0]] = old[: stay[0]]
        begin = float(frame.left.knots[stay[0]])
    if frame.right:
        rows[len(rows) - stay[1] :] = old[len(old) - stay[1] :]
        end = float(frame.right.knots[5 - stay[1]])
    spliced = curve.replaced(
        (start.span + 1, stop.span + 1), fitted.u, (start.span - 2, stop.span), rows
    )
    return spliced, Interval(begin, end), max(fitted.bound, start.bound, stop.bound)


def _staying(frame: Frame, x: Array) -> tuple[int, int]:
    """Count the old knots that stay, three at most, from either end of the stretch on."""
    left, right = frame.left, frame.right
    return (
        _common(x[:3], left.knots[3:]) if left else 0,
        _common(x[:-4:-1], right.knots[2::-1]) if right else 0,
    )


def _common(new: Array, old: Array) -> int:
    pairs = zip(new.tolist(), old.tolist(), strict=True)
    return next((k for k, (a, b) in enumerate(pairs) if a != b), 3)


def _start(curve: Graded, target: Target, a: float, span: int) -> _End:
    """Find where the free stretch begins."""
    if a == curve.domain.start:
        return _End(0.0, 2, False, False, 0.0)
    if curve.knots(span, span + 1)[0] == a:
        return _End(float(curve.u[span]), span - 1, True, True, 0.0)
    return _lead_in(curve, target, a, span, forwards=True)


def _stop(curve: Graded, target: Target, b: float, span: int) -> _End:
    """Find where the free stretch ends."""
    if b == curve.domain.stop:
        return _End(1.0, curve.size, False, False, 0.0)
    if curve.knots(span + 1, span + 2)[0] == b:
        return _End(float(curve.u[span + 1]), span + 1, True, True, 0.0)
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
        raise gap_error(target, end, gap, chord)
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
            return _End(float(curve.u[span + 1 if forwards else span]), span, True, True, bound)
    sign = 1.0 if forwards else -1.0
    while reach >= shortest:
        ends = sorted(
            ((end + sign * part * reach - domain.start) / domain.length) for part in (2.0**-40, 1.0)
        )
        u = coarsest_between(*ends)
        near = float(parameters(np.array([u]), domain)[0])
        if near == end:
            return _End(u, span, True, False, 0.0)
        if (near > end) == forwards and abs(near - end) <= reach:
            bound = _led(knots, points, target, end, near)
            if bound is not None:
                return _End(u, span, True, near == next_knot, bound)
        reach *= _NEARER
    raise gap_error(target, end, gap, chord)


def _led(knots: Array, points: Array, target: Target, end: float, near: float) -> float | None:
    """Prove that an old piece keeps the allowances between two parameters; None if it does not."""
    t, (low, high) = target.t, sorted((end, near))
    inner = t[t.searchsorted(low, "right") : t.searchsorted(high)]
    marks = np.concatenate(([low], inner, [high]))
    values, chords = target.at(marks)
    proved = spline_chord_deviation(knots, points, 3, marks, values.T + target.origin)
    kept = bool((proved <= target.allowances.take(chords[:-1])).all())
    return float(proved.max()) if kept else None


def _frame(curve: Graded, start: _End, stop: _End, origin: Array) -> Frame:
    """Cut out the surroundings."""
    left, right = (_piece(curve, end, origin) if end.joined else None for end in (start, stop))
    before = left.knots[:3] if left else curve.knots(start.span - 2, start.span + 1)
    after = right.knots[3:] if right else curve.knots(stop.span + 1, stop.span + 4)
    return Frame(before, after, left, right)


def _piece(curve: Graded, end: _End, origin: Array) -> Piece:
    knots = curve.knots(end.span - 2, end.span + 4)
    return Piece(knots, curve.points.window(end.span - 3, end.span + 1) - origin)


def _knots_to_keep(curve: Graded, start: _End, stop: _End) -> tuple[Array, Array]:
    """Return the ends of the free stretch, each with the two old knots that follow it inside.

    With these in place the dictated control points need not change.
    """
    first, last = np.array([start.u]), np.array([stop.u])
    i, j = start.span + 1, stop.span
    inside = j - i + 1 - start.stays - stop.stays
    if start.stays and inside >= _KEPT:
        first = curve.u.window(i, i + _KEPT + 1)
    if stop.stays and inside >= _KEPT:
        last = curve.u.window(j - _KEPT, j + 1)
    if first[-1] >= last[0]:
        # Too few for both ends: the closer ones, which guard something.
        if first[-1] - first[0] <= last[-1] - last[0]:
            last = last[-1:]
        else:
            first = first[:1]
    return first, last
