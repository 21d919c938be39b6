"""The knots that a fit begins with: what the ends need, what corners need, what is predicted."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array
from multirep.errors import ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet.attempt import Frame, Piece
from multirep.representations.wavelet.dyadic import clusters, halves, parameters, starting
from multirep.representations.wavelet.prediction import MARGIN, predict, projection
from multirep.representations.wavelet.target import Target
from multirep.splines import compiled

__all__ = ["beginning", "gap_error"]

#: Spans to begin with where no, one or both ends are joined: three would leave nothing free between
#: two joins.
_FEWEST_SPANS = (1, 3, 4)
#: Kept spans may be longer by this factor than the turn from the old piece to the target needs.
_ABOUT = 1.5
#: Where the old pieces are compared with the target, in parts of the stretch from the joined end.
_STEPS = np.concatenate(([0.0], 2.0 ** np.arange(-38.0, 0.0)))


def beginning(
    target: Target, ends: tuple[Array, Array], domain: Interval, frame: Frame, shortest: float
) -> Array:
    """Choose knots for a first attempt.

    Parameters
    ----------
    target : Target
    ends : pair of (k,) arrays
        Dyadic knots: the ends of the stretch, each with the old knots inside that should stay. They
        do unless the curve must turn to the target on shorter spans.
    domain : Interval
        T, onto which dyadic numbers are mapped.
    frame : Frame
        The surroundings.
    shortest : float
        Spans shorter than this (as dyadic numbers) are not made.

    Returns
    -------
    (n + 1,) array
        Dyadic knots from the start to the stop of the stretch.

    Raises
    ------
    ToleranceError
        When an old piece is off at its end by more than is allowed there, or knots would be needed
        that are finer than the finest.
    """
    if compiled.active:
        found = compiled.core.beginning(
            target.t,
            target.points,
            target.slopes,
            target.allowances,
            target.corners,
            target.widths,
            *ends,
            *frame.arrays,
            _FEWEST_SPANS[frame.joined],
            domain.start,
            domain.stop,
            shortest,
            MARGIN,
            *projection(),
        )
        if found is not None:
            return np.frombuffer(found)
        # out of reach: numpy finds out why
    first, last = ends
    u = np.array([first[0], last[-1]])
    if frame.joined:
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
        u = np.unique(np.concatenate((u, sharp[(sharp > u[0]) & (sharp < u[-1])])))
    while len(u) <= _FEWEST_SPANS[frame.joined]:
        u = np.sort(np.concatenate((u, halves(u[:-1], u[1:]))))
    if (u[1:] - u[:-1]).min() < shortest:
        raise _fineness_error(target, domain)
    more = predict(target, u[:-1], u[1:], shortest, domain)
    u = np.concatenate((first[:-1], u, more, last[1:]))
    u.sort()
    return u


def _first_spans(target: Target, ends: Array, frame: Frame) -> tuple[float, float]:
    """Return how long the first and last span may be for the curve to turn to the target.

    As far as the old piece, continued, departs from the target by 3/2 of the room there is (0 where
    it does so at once): a curve that leaves it with all derivatives but the third is off by 0.6 s h
    on spans of length h if the target leaves at the slope s.
    """
    start, stop = ends.tolist()
    steps = (stop - start) * _STEPS
    return (
        _turn(target, frame.left, start, steps),
        _turn(target, frame.right, stop, -steps),
    )


def _turn(target: Target, piece: Piece | None, end: float, steps: Array) -> float:
    """Return the last step from an end at which the old piece is not too far off; all if none is.

    Raises ToleranceError when it is off by more than is allowed at the end itself.
    """
    if piece is None:
        return float(abs(2.0 * steps[-1]))
    t = end + steps
    values, chords = target.at(t)
    away = piece.polar(t[:, None].repeat(3, axis=1)).T - values
    gap = math.sqrt(float(np.square(away[:, 0]).sum()))
    allowance = float(target.allowances[chords[0]])
    if gap > allowance:
        raise gap_error(target, end, gap, int(chords[0]))
    square = np.square(away - away[:, :1]).sum(axis=0)
    far = square > (1.5 * max(allowance - gap, allowance / 8)) ** 2
    return float(abs(steps[far.argmax() - 1] if far.any() else 2.0 * steps[-1]))


def gap_error(target: Target, end: float, gap: float, chord: int) -> ToleranceError:
    """Say that the curve outside is too far off at an end."""
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
