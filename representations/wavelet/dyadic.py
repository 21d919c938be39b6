"""Dyadic knots k / 2**l in [0, 1]: exact numbers, where to halve a span, the level of a knot.

All of these are exact in float64 down to level 46 and three levels beyond, which the rows of a fit
use.
"""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array, Indices
from multirep.interval import Interval
from multirep.splines import compiled

__all__ = [
    "FINEST_LEVEL",
    "clusters",
    "coarsest_between",
    "finest_level",
    "halves",
    "level_counts",
    "levels",
    "parameters",
    "recounted",
    "starting",
]

#: No knot is finer than k / 2**46, 64 units in the last place of a parameter near 1. Far coarser
#: ones resolve a corner to 1e-12 of the curve already, where rounding of the coordinates begins.
FINEST_LEVEL = 46
#: Spans shorter than so many units in the last place of a parameter are not made.
_ULPS = 64


def parameters(u: Array, domain: Interval) -> Array:
    """Map dyadic numbers from [0, 1] to T, both ends exactly; they are T's own if T is [0, 1].

    Examples
    --------
    >>> parameters(np.array([0.0, 0.5, 1.0]), Interval(-1.0, 2.0))
    array([-1. ,  0.5,  2. ])
    """
    if domain.start == 0.0 and domain.stop == 1.0:
        return u
    mapped: Array = (1.0 - u) * domain.start + u * domain.stop
    return mapped


def finest_level(domain: Interval) -> int:
    """Return the finest level whose knots stay well apart as float64 numbers in T.

    Examples
    --------
    >>> finest_level(Interval(0.0, 1.0)), finest_level(Interval(1e6, 1e6 + 1))
    (46, 27)
    """
    largest = max(abs(domain.start), abs(domain.stop))
    resolved = math.log2(domain.length / (_ULPS * math.ulp(largest)))
    return max(0, min(FINEST_LEVEL, math.floor(resolved)))


def halves(starts: Array, stops: Array) -> Array:
    """Return the knots that halve spans: near the middle, and as coarse as they can be there.

    The middle itself for a dyadic span; otherwise a coarse knot in the middle half.

    Parameters
    ----------
    starts, stops : (n,) arrays
        Dyadic numbers.

    Returns
    -------
    (n,) array

    Examples
    --------
    >>> halves(np.array([0.0, 0.0]), np.array([0.5, 0.875]))
    array([0.25, 0.5 ])
    """
    if compiled.active:
        middles = np.empty(len(starts))
        compiled.core.halves(starts, stops, middles)
        return middles
    lengths = stops - starts
    middle = starts + 0.5 * lengths
    # The largest power of two <= length: its multiple nearest to the middle, or else one of half of
    # it.
    step = np.ldexp(0.5, np.frexp(lengths)[1])
    coarse = np.rint(middle / step) * step
    step *= 0.5
    fine = np.rint(middle / step) * step
    chosen: Array = np.where(np.abs(coarse - middle) <= 0.25 * lengths, coarse, fine)
    return chosen


def coarsest_between(low: float, high: float) -> float:
    """Return the dyadic number of the lowest level in [low, high], 0 <= low < high <= 1.

    Examples
    --------
    >>> coarsest_between(0.3, 0.4), coarsest_between(0.3, 0.6)
    (0.375, 0.5)
    """
    step = 2.0 ** math.floor(math.log2(high - low))
    found = math.ceil(low / step) * step
    while True:
        step *= 2.0
        coarser = math.ceil(low / step) * step
        if coarser > high or step > 1.0:
            return found
        found = coarser


def clusters(centres: Array, widths: Array, parts: int = 1) -> Array:
    """Return dyadic knots (3 k,): near each centre, and about its width before and behind it.

    Parameters
    ----------
    centres, widths : (k,) arrays
        In [0, 1].

    Examples
    --------
    >>> clusters(np.array([1 / 3]), np.array([0.01]))
    array([0.3203125 , 0.33203125, 0.34375   ])
    """
    # A grain of a quarter to a half of the width: coarse numbers, near their places.
    grain = np.ldexp(0.25, np.frexp(widths)[1])
    centre = np.rint(centres / grain) * grain
    width = np.rint(widths / grain) * grain
    found: Array = np.concatenate((centre - width, centre, centre + width))
    return found


def starting(start: float, stop: float, first: float, last: float) -> Array:
    """Return knots beside two ends, both included: three spans of about the given lengths at each.

    Examples
    --------
    >>> starting(0.0, 1.0, 0.01, 1.0)
    array([0.        , 0.00976562, 0.01953125, 0.02929688, 1.        ])
    """
    whole = stop - start
    steps = []
    for length, sign, end in ((first, 1.0, start), (last, -1.0, stop)):
        if 6.0 * length < whole:
            grain = math.ldexp(1.0, math.frexp(length)[1] - 3)
            origin = round(end / grain) * grain
            step = sign * round(length / grain) * grain
            steps += [origin + step, origin + 2 * step, origin + 3 * step]
    return np.array(sorted({start, *steps, stop}))


def levels(u: Array) -> Indices:
    """Return the level of each dyadic number: the l of k / 2**l with odd k, 0 for 0 and 1.

    Examples
    --------
    >>> levels(np.array([0.0, 0.5, 0.375, 1.0]))
    array([0, 1, 3, 0])
    """
    scaled = (u * 2.0**52).astype(np.int64)
    lowest = (scaled & -scaled).astype(np.float64)
    # frexp of a power of two 2**k is (0.5, k + 1); of 0 it is (0, 0).
    found = np.maximum(53 - np.frexp(lowest)[1], 0)
    found[scaled == 0] = 0
    exponents: Indices = found.astype(np.intp)
    return exponents


def level_counts(u: Array) -> Indices:
    """Count knots by level, (53,).

    Examples
    --------
    >>> level_counts(np.array([0.25, 0.5, 0.75]))[:4].tolist()
    [0, 1, 2, 0]
    """
    return recounted(np.zeros(53, dtype=np.intp), u, u[:0])


def recounted(counts: Indices, added: Array, removed: Array) -> Indices:
    """Return the counts after an edit put some knots in and took some out.

    Examples
    --------
    >>> recounted(level_counts(np.array([0.25, 0.5])), np.array([0.75]), np.array([0.5]))[:3]
    array([0, 0, 2])
    """
    if compiled.active:
        found = counts.copy()
        compiled.core.recount(added, removed, found)
        return found
    changed: Indices = counts + np.bincount(levels(added), minlength=53)
    changed -= np.bincount(levels(removed), minlength=53)
    return changed
