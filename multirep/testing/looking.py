"""Where to look: the parameters at which mistakes show, and the largest distance seen."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.testing.elements import ElementsOf, default_elements

#: Parameters of a dense grid over T. More find more and cost more.
GRID = 257
#: Stored parameters compared at most; those nearest to the ends of the splices come first.
STORED = 4000


def seen_deviation(
    one: Representation,
    two: Representation,
    *,
    tolerance: float,
    elements: ElementsOf = default_elements,
) -> tuple[float, float]:
    """Return the largest distance found at equal t, and where: (distance, t).

    Looked at are all parameters of :func:`dense_parameters`, those of samples of either curve
    within ``tolerance``, and then more around the largest local maxima.
    """
    t = np.concatenate(
        [
            dense_parameters(one, SpliceList.EMPTY, two, elements=elements),
            *(curve.sample(curve.domain, tolerance=tolerance).t for curve in (one, two)),
        ]
    )
    t = np.unique(t)
    for _ in range(2):
        apart = np.linalg.norm(one(t) - two(t), axis=1)
        tops = np.flatnonzero((apart[1:-1] >= apart[:-2]) & (apart[1:-1] >= apart[2:])) + 1
        peaks = np.unique(np.r_[tops[np.argsort(apart[tops])[-16:]], 1, len(t) - 2])
        closer = np.linspace(t[peaks - 1], t[peaks + 1], 33)
        t = np.union1d(t, closer.ravel())
    apart = np.linalg.norm(one(t) - two(t), axis=1)
    return float(apart.max()), float(t[apart.argmax()])


def dense_parameters(
    value: Representation,
    splices: SpliceList,
    *others: Representation,
    elements: ElementsOf = default_elements,
) -> Array:
    """Parameters where a mistake would show: a grid, stored ones, and beside the ends of splices.

    Returns
    -------
    (m,) array
        Sorted, inside T.
    """
    start, stop = value.domain
    ends = np.array([end for splice in splices for end in splice])
    stored = [
        column for v in (value, *others) for e in elements(v) for column in (e.starts, e.stops)
    ]
    known = np.unique(np.concatenate(stored)) if stored else np.empty(0)
    known = known[(start <= known) & (known <= stop)]
    if len(known) > STORED:
        far = np.abs(known[:, None] - ends).min(axis=1) if len(ends) else np.arange(len(known)) % 97
        known = np.sort(known[np.argsort(far, kind="stable")[:STORED]])
    beside = [ends, np.nextafter(ends, -np.inf), np.nextafter(ends, np.inf)]
    for part in (1e-9, 1e-6, 1e-3):
        beside += [ends - part * (stop - start), ends + part * (stop - start)]
    middles = 0.5 * (known[1:] + known[:-1])
    t = np.concatenate([np.linspace(start, stop, GRID), known, middles, *beside])
    unique: Array = np.unique(t[(start <= t) & (t <= stop)])
    return unique


def even(interval: Interval, count: int) -> Array:
    """Return ``count`` even parameters from end to end of an interval.

    Examples
    --------
    >>> even(Interval(0, 1), 3).tolist()
    [0.0, 0.5, 1.0]
    """
    return np.linspace(interval.start, interval.stop, count)
