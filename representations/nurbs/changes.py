"""Which parameters an edit touches: the supports of control points, and the spans that read a knot.

The piece on span k depends on control points k - p .. k and on knots k - p + 1 .. k + p, on nothing
else. So a changed control point i touches [u_i, u_(i+p+1)].
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.splices import SpliceList


def merged(starts: Array, stops: Array, domain: Interval) -> SpliceList:
    """Return the union of intervals whose starts and stops both do not decrease, inside T.

    Cost: O(intervals) in numpy, and Python only for the disjoint ones that result.
    """
    starts = np.maximum(starts, domain.start)
    stops = np.minimum(stops, domain.stop)
    some = starts < stops
    starts, stops = starts[some], stops[some]
    if not len(starts):
        return SpliceList.EMPTY
    apart = np.flatnonzero(starts[1:] > stops[:-1])
    firsts = starts[np.concatenate(([0], apart + 1))]
    lasts = stops[np.concatenate((apart, [len(stops) - 1]))]
    return SpliceList(zip(firsts.tolist(), lasts.tolist(), strict=True))


def supports(knots: BlockArray, degree: int, rows: Indices, domain: Interval) -> SpliceList:
    """Return the union of the supports of control points ``rows`` (increasing)."""
    if not len(rows):
        return SpliceList.EMPTY
    first = int(rows[0])
    window = knots.window(first, int(rows[-1]) + degree + 2)
    at = rows - first
    return merged(window[at], window[at + degree + 1], domain)


def unmatched_rows(old: Array, new: Array, degree: int) -> tuple[Indices, Indices]:
    """Match control points of a refined knot vector to the old ones with the same inner knots.

    Parameters
    ----------
    old, new : (n + p + 1,), (N + p + 1,) arrays
        Knots of a window before and after insertion; new contains old.
    degree : int

    Returns
    -------
    changed : (c,) indices
        New control points whose p inner knots belong to no old control point.
    source : (N,) indices
        For each other one, which old control point it is.
    """
    count = len(new) - degree - 1
    rows = np.arange(count)
    first = new[1 : count + 1]
    source = rows + old.searchsorted(first, "right") - new.searchsorted(first, "right")
    inner = np.arange(1, degree + 1)
    same = old.take(source[:, None] + inner, mode="clip") == new.take(rows[:, None] + inner)
    fits = (source >= 0) & (source < len(old) - degree - 1) & same.all(axis=1)
    return np.flatnonzero(~fits), source


def difference(
    degree: int,
    domain: Interval,
    knots: tuple[BlockArray, BlockArray],
    rows: tuple[tuple[BlockArray, BlockArray], ...],
) -> SpliceList:
    """Where two curves of one degree and domain may differ; O(changed blocks).

    Parameters
    ----------
    degree : int
    domain : Interval
    knots : pair of BlockArray
        Of this curve and of the other.
    rows : pairs of BlockArray
        Control points, and weights if there are any.

    Returns
    -------
    SpliceList
        One interval around everything that differs, or nothing.
    """
    low, high, other_high = knots[0].difference(knots[1])
    while (
        min(high, other_high) > 0
        and knots[0][high - 1] == knots[1][other_high - 1]
        and not (low == high == other_high)
    ):  # a knot put beside its equals: from the right, the first of them is the new one
        high, other_high = high - 1, other_high - 1
    equal = low == high and len(knots[0]) == len(knots[1])
    count, other = len(knots[0]), len(knots[1])
    # Spans before `first` read no changed knot and no changed row, neither do those from `last` on.
    first = count if equal else low - degree
    last = 0 if equal else high + degree - 1
    for mine, theirs in rows:
        low, high, _ = mine.difference(theirs)
        if low == high and len(mine) == len(theirs):
            continue
        equal = False
        first, last = min(first, low), max(last, high + degree)
    if equal:
        return SpliceList.EMPTY
    n = min(count, other) - degree - 1
    start = domain.start if first <= degree else float(knots[0][min(first, n)])
    last = max(last, first)
    stop = domain.stop if last >= count - degree - 1 else float(knots[0][last])
    if not start < stop:  # only knots or control points that no point of T depends on
        return SpliceList.EMPTY
    return SpliceList([Interval(start, stop)])
