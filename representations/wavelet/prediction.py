"""Predict how fine the knots must be, from the polyline alone and without solving anything.

A span is fine enough when one cubic polynomial, fitted to the polyline over the span and a quarter
of its length on either side, stays within the allowance: about what a smooth spline achieves on
such spans, at corners too (errors for a fourth derivative f: f h**4 / 607 predicted, f h**4 / 768
for the best spline; for a jump J of the slope both J h / 20). The fit that follows corrects the few
spans where this is wrong; starting from here takes it 2 to 5 solves where halving step by step
takes as many as there are levels, and leaves a third fewer control points at corners.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import halves, parameters
from multirep.representations.wavelet.target import Target
from multirep.splines import compiled

__all__ = ["MARGIN", "predict", "projection"]

#: Samples of a span and its margins. More see narrower features (which the fit would find anyway),
#: fewer cost less.
_SAMPLES = 13
#: How far a span looks beyond its ends, in its lengths: so that a corner at a knot is seen from
#: both sides.
MARGIN = 0.25


#: What no quintic explains counts so much: it comes from corners, which cost a spline more than a
#: single polynomial.
_CORNER = 2.0


def predict(
    target: Target,
    starts: Array,
    stops: Array,
    shortest: float,
    domain: Interval,
) -> Array:
    """Halve spans until each is predicted to be fine enough.

    Parameters
    ----------
    target : Target
        The polyline and its allowances.
    starts, stops : (n,) arrays
        The spans, dyadic numbers in [0, 1].
    shortest : float
        Spans not longer than this are left.
    domain : Interval
        T, onto which [0, 1] is mapped.

    Returns
    -------
    (k,) array
        The new knots, unsorted.

    Notes
    -----
    Looks at 13 places of each span that still fails; without the compiled core, in one vectorised
    pass for each level.

    Examples
    --------
    A bend needs short spans, and only there.

    >>> from multirep.sampled import SampledSplice
    >>> t = np.linspace(0, 1, 65)
    >>> bend = SampledSplice(t, np.hypot(t - 1 / 3, 1 / 32)[:, None])
    >>> target = Target.of(bend, 1 / 512)
    >>> np.sort(predict(target, np.array([0.0]), np.array([1.0]), 2.0**-40, Interval(0, 1)))
    array([0.25  , 0.3125, 0.375 , 0.5   ])
    """
    projections, places = projection()
    if compiled.active:
        knots = compiled.core.predict(
            target.t,
            target.points,
            target.slopes,
            target.allowances,
            target.corners,
            starts,
            stops,
            shortest,
            domain.start,
            domain.stop,
            MARGIN,
            projections,
            places,
        )
        return np.frombuffer(knots)
    found: list[Array] = []
    while len(starts):
        low, high = parameters(starts, domain), parameters(stops, domain)
        failing = _unexplained(target, low, high) > 1.0
        if not failing.any():
            break
        failing &= stops - starts > shortest
        starts, stops = starts[failing], stops[failing]
        middles = halves(starts, stops)
        found.append(middles)
        starts, stops = np.concatenate((starts, middles)), np.concatenate((middles, stops))
    return np.concatenate(found) if found else np.empty(0)


def _unexplained(target: Target, low: Array, high: Array) -> Array:
    """Square what single polynomials leave of the target on spans, in terms of what is allowed."""
    projections, places = projection()
    walls = np.concatenate((target.t[:1], target.corners, target.t[-1:]))
    margin = MARGIN * (high - low)
    side = target.corners.searchsorted(low + 0.5 * margin)
    low = np.maximum(low - margin, walls.take(side))
    high = np.minimum(high + margin, walls.take(side + 1))
    values, chords = target.at(low + (high - low) * places)
    off = projections @ values
    off *= off
    square = off.sum(axis=0).reshape(2, _SAMPLES, -1).max(axis=0)
    square /= np.square(target.allowances).take(chords)
    found: Array = square.max(axis=0)
    return found


@cache
def projection() -> tuple[Array, Array]:
    """Return projections (26, 13) onto what no cubic, no quintic explains; the places (13, 1)."""
    places = np.linspace(0.0, 1.0, _SAMPLES)[:, None]
    projections = []
    for degree, factor in ((3, 1.0), (5, _CORNER)):
        basis = np.linalg.qr((places - 0.5) ** np.arange(degree + 1))[0]
        projections.append(factor * (np.eye(_SAMPLES) - basis @ basis.T))
    projection = np.concatenate(projections)
    projection.setflags(write=False)
    places.setflags(write=False)
    return projection, places
