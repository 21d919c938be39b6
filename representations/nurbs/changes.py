"""Which parameters an edit touches: the supports of control points, and the spans that read a knot.

The piece on span k depends on control points k - p .. k and on knots k - p + 1 .. k + p, on nothing
else. So a changed control point i touches [u_i, u_(i+p+1)].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.splices import SpliceList
from multirep.spline_tree import changed_spans
from multirep.splines import compiled


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
    apart = (starts[1:] > stops[:-1]).nonzero()[0]
    firsts = starts[np.concatenate(([0], apart + 1))]
    lasts = stops[np.concatenate((apart, [len(stops) - 1]))]
    return SpliceList.unchecked(tuple(firsts.tolist()), tuple(lasts.tolist()))


def supports(knots: BlockArray, degree: int, rows: Indices, domain: Interval) -> SpliceList:
    """Return the union of the supports of control points ``rows`` (increasing)."""
    if not len(rows):
        return SpliceList.EMPTY
    first, last = int(rows[0]), int(rows[-1])
    window = knots.window(first, last + degree + 2)
    if last - first == len(rows) - 1:  # neighbours' supports overlap
        start, stop = float(window[0]), float(window[-1])
        return SpliceList([(max(start, domain.start), min(stop, domain.stop))])
    at = rows - first
    return merged(window[at], window[at + degree + 1], domain)


def difference(
    degree: int,
    domain: Interval,
    knots: tuple[BlockArray, BlockArray],
    rows: tuple[tuple[BlockArray, BlockArray], ...],
) -> SpliceList:
    """Where two curves of one degree and domain may differ.

    Shared blocks are not looked into; between the first and the last difference, span is compared
    with span: a span that reads the same knots and the same rows is the same to the last bit.

    Parameters
    ----------
    degree : int
    domain : Interval
    knots : pair of BlockArray
        Of this curve and of the other.
    rows : pairs of BlockArray
        Control points, and weights if there are any.
    """
    p, (mine, theirs) = degree, knots
    n = len(mine) - p - 1
    first, last, shift = changed_spans(degree, knots, list(rows))
    first, last = first + p, last + p
    if first >= last:
        return SpliceList.EMPTY
    # A span has the same number in both before the difference, and is shifted after it.
    other_first, other_last = min(first, n + shift - 1), max(last + shift, first + 1)
    a = mine.window(first - p, last + p + 1)
    b = theirs.window(other_first - p, min(other_last, n + shift) + p + 1)
    if compiled.active:
        end = other_first + len(b) - 2 * p - 1
        read = [
            (here.window(first - p, last), there.window(other_first - p, end))
            for here, there in rows
        ]
        return SpliceList(
            (max(start, domain.start), min(stop, domain.stop))
            for start, stop in compiled.core.changed_spans(p, a, b, read)
        )
    spans = (a[p : len(a) - p - 1] < a[p + 1 : len(a) - p]).nonzero()[0] + p
    found = b.searchsorted(a[spans], "right") - 1
    found = np.minimum(np.maximum(found, p), len(b) - p - 2)
    local = np.arange(1 - p, p + 1)
    same = (a.take(spans[:, None] + local) == b.take(found[:, None] + local)).all(axis=1)
    for here, there in rows:
        x = _bits(here.window(first - p, last))
        y = _bits(there.window(other_first - p, other_first + len(b) - 2 * p - 1))
        for offset in range(-p, 1):
            same &= (x.take(spans + offset, axis=0) == y.take(found + offset, axis=0)).all(axis=1)
    changed = spans[~same]
    return merged(a[changed], a[changed + 1], domain)


def _bits(rows: Array) -> NDArray[np.int64]:
    """Return rows as integers, (k, -1): -0.0 is not 0.0."""
    return np.ascontiguousarray(rows).view(np.int64).reshape(len(rows), -1)
