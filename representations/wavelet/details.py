"""Changes by what lives on one level: sweeps, wavelet details, halved spans.

All are deltas on the graded control points: knots of the level are inserted where the curve is
coarser, then the change is expressed there. Details of other levels do not change, and control
points outside of the support keep their bits.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import finest_level, halves, parameters
from multirep.representations.wavelet.filters import columns
from multirep.representations.wavelet.graded import Graded
from multirep.representations.wavelet.pyramid import USUAL_LEVEL as FINEST_ANALYSED
from multirep.splines import compiled
from multirep.splines.basis import basis_functions
from multirep.splines.polar import blossom

__all__ = ["FINEST_ANALYSED", "added", "check_detail", "halved", "plus", "swept"]


def swept(curve: Graded, t: float, offset: Array, level: float) -> Graded:
    """Move the curve at ``t`` by ``offset``, over seven spans of a level.

    Parameters
    ----------
    curve : Graded
    t : float
        In T.
    offset : (d,) array
    level : float
        At least 0. At j + u the change is ``1 - u`` times that of level j plus ``u`` times that of
        level j + 1.

    Raises
    ------
    EditError
        When there is no such level.
    """
    finest = finest_level(curve.domain)
    if not 0 <= level <= finest:
        raise EditError(f"a sweep needs a level from 0 to {finest}, got {level:g}")
    coarse = int(level)
    share = level - coarse
    for j, part in ((coarse, 1.0 - share), (coarse + 1, share)):
        if part:
            first, basis = _basis_at(curve.domain, t, j)
            rows = basis[:, None] * (offset * (part / float(basis @ basis)))
            curve = plus(curve, j, first, rows)
    return curve


def _basis_at(domain: Interval, t: float, level: int) -> tuple[int, Array]:
    """First of the four functions of a level that do not vanish at ``t``, and their values."""
    spans = 1 << level
    guess = int((t - domain.start) / domain.length * spans)
    # Rounding may put t beside its span; then its values there are those of the neighbour, as they
    # should be.
    span = min(max(guess, 0), spans - 1)
    knots = _uniform_knots(domain, level, span, span + 4)
    return span, basis_functions(knots, 3, np.array([t]), np.array([3]))[0]


def _uniform_knots(domain: Interval, level: int, first: int, stop: int) -> Array:
    """Return the knots that points first..stop-1 of the uniform curve of a level depend on."""
    places, spans = np.arange(first - 3, stop + 1), 1 << level
    if first < 3 or stop > spans:
        places = np.minimum(np.maximum(places, 0), spans)
    return parameters(places / spans, domain)


def plus(curve: Graded, level: int, first: int, rows: Array) -> Graded:
    """Add ``rows`` to the control points first, first + 1, .. of the uniform curve of a level.

    Knots of the level are inserted where they act; O(rows + control points there).
    """
    spans = 1 << level
    low, high = max(first - 3, 0), min(first + len(rows), spans)
    curve = curve.refined(np.arange(max(low, 1), min(high + 1, spans)) / spans)
    # The control points whose support lies in the support of the change.
    i = 0 if low == 0 else curve.u.searchsorted(low / spans)
    j = curve.size if high == spans else curve.u.searchsorted(high / spans) - 3
    u = curve.u.window(i, j + 4)
    knots = parameters(u, curve.domain)
    uniform = _uniform_knots(curve.domain, level, first - 3, first + len(rows) + 3)
    changed = curve.points.window(i, j).copy()
    if compiled.active:
        compiled.core.plus(u, knots, spans, first, uniform, rows, changed)
    else:
        changed += _expressed(u, knots, spans, first, uniform, rows)
    return curve.replaced((4, 4), np.empty(0), (i, j), changed)


def _expressed(
    u: Array, knots: Array, spans: int, first: int, uniform: Array, rows: Array
) -> Array:
    """Express a change by ``rows`` of a level on the knots u (n + 4,), in T: (n, d).

    Each is the polar form, at its inner knots, of the piece of the change in the middle of its
    support.
    """
    count = len(u) - 4
    wide = u[1:] > u[:-1]
    filled = np.zeros(count, dtype=np.intp)
    for part in (3, 1, 2):  # the last that has a length decides: the middle ones first
        filled[wide[part : part + count]] = part
    starts = u.take(np.arange(count) + filled)
    stops = u.take(np.arange(count) + filled + 1)
    pieces = (0.5 * (starts + stops) * spans).astype(np.intp)
    nothing = np.zeros((3, rows.shape[1]))
    padded = np.concatenate((nothing, rows, nothing))
    arguments = knots.take(np.arange(count)[:, None] + np.arange(1, 4))
    return blossom(uniform, padded, 3, pieces - first + 6, arguments)


def check_detail(curve: Graded, level: int, index: int) -> None:
    """Raise EditError unless there is a detail ``index`` from ``level`` to ``level + 1``."""
    finest = finest_level(curve.domain) - 1
    if not 0 <= level <= finest:
        raise EditError(f"details lead from levels 0 to {finest} to the next, got {level}")
    if not 0 <= index < 1 << level:
        raise EditError(f"level {level} has details 0 to {(1 << level) - 1}, got {index}")


def added(curve: Graded, level: int, index: int, offset: Array) -> Graded:
    """Add ``offset`` times wavelet ``index`` of ``level`` to ``level + 1``, whose peak is 1."""
    check_detail(curve, level, index)
    ends, interior = columns(level + 1)
    count = 1 << level
    mirrored = count - 1 - index
    if index < len(ends):
        first, column = index, ends[index]
    elif mirrored < len(ends):
        column = ends[mirrored][::-1]
        first = 2 * count + 3 - mirrored - len(column)
    else:
        first, column = 2 * index - 3, interior
    return plus(curve, level + 1, first, column[:, None] * offset)


def halved(curve: Graded, interval: Interval) -> Graded:
    """Insert the middle of every span that meets an interval, if it can be halved."""
    first, last = curve.span_at(interval.start), curve.span_at(interval.stop, "left")
    u = curve.u.window(first, last + 2)
    long = np.flatnonzero(u[1:] - u[:-1] > 2.0 ** -finest_level(curve.domain))
    return curve.refined(halves(u.take(long), u.take(long + 1)))
