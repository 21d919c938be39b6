"""Certified distance of a spline from a polyline, at equal parameters."""

import numpy as np

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray
from multirep.splines.certificates import bernstein_bound, rational_bernstein_bound
from multirep.splines.curvature import second_derivative_coefficients
from multirep.splines.pieces import Pieces, Stretch, cut_pieces, cut_stretch, norms, rounding
from multirep.splines.polar import bernstein

__all__ = [
    "bernstein_deviation",
    "curvature_deviation",
    "spline_chord_deviation",
]

_EMPTY = np.empty(0)


def spline_chord_deviation(
    knots: Array,
    coefficients: Array,
    degree: int,
    sampled_t: Array,
    sampled_points: Array,
    *,
    rational: bool = False,
    splits: int = 1,
    allowance: float | Array | None = None,
) -> Array:
    """Bound ``||R(t) - L(t)||`` on each chord of a polyline L, for every t and not for samples.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Knots of the spline R; multiplicity up to the degree inside, so that R is continuous.
    coefficients : (n, d) array, or (n, d + 1) if rational
        Control points; of a rational spline homogeneous ones ``(w x, w y, .., w)`` with w > 0.
    degree : int
        Degree p of the spline, at least 1.
    sampled_t : (m + 1,) array
        Strictly increasing, within the domain of R. They need not be knots, nor the points on R.
    sampled_points : (m + 1, d) array
        Vertices of the polyline.
    rational : bool, keyword-only
        Whether the last coordinate of the coefficients is a weight.
    splits : int, keyword-only
        How often each piece between neighbouring knots and samples is halved before its convex hull
        is taken: the bound is up to 1.6, 1.07, 1.02, 1.01 times the true maximum for 0, 1, 2, 3.
    allowance : float or (m,) array, keyword-only, optional
        What may be enough. A cheaper bound is tried first, and only pieces that exceed their
        chord's allowance get the one that ``splits`` asks for. The result is an upper bound either
        way, just less sharp where it is below the allowance.

    Returns
    -------
    (m,) array
        The bound of each chord, with the rounding of its own computation and of a float64
        evaluation of R, (8p + 16) units in the last place of the largest coordinate, included.

    Notes
    -----
    R is one polynomial between neighbouring knots and samples, and L one line. There the
    difference is taken in Bernstein form; homogeneous for a rational, ``E = A - w L`` with
    ``||R - L|| <= max ||E_i|| / w_i``. Nothing is divided by the length of a piece, so pieces one
    unit in the last place wide are no special case. The cheaper bound for polynomials up to degree
    3: the difference at both ends of a piece, and the curve's sagitta between from S'', which is
    linear there. Linear in pieces; coordinates should be between 1e-140 and 1e140.

    Examples
    --------
    The parabola t**2 leaves the chord from 0 to 1 by 1/4.

    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> square = np.array([[0.0], [0.0], [1.0]])
    >>> t = np.array([0.0, 1.0])
    >>> spline_chord_deviation(knots, square, 2, t, t[:, None]).round(12)
    array([0.25])
    """
    if compiled.active:
        limits = _EMPTY if allowance is None else np.atleast_1d(np.asarray(allowance, np.float64))
        proved = np.empty(len(sampled_t) - 1)
        lines = sampled_t[:-1], sampled_t[1:], sampled_points[:-1], sampled_points[1:]
        compiled.core.chord_bounds(
            knots, coefficients, degree, rational, *lines, splits, limits, proved
        )
        return proved
    stretch = cut_stretch(knots, coefficients, degree, sampled_t[0], sampled_t[-1], rational)
    pieces = cut_pieces(stretch.breaks, sampled_t[:-1], sampled_t[1:])
    low, high = _lines(pieces, sampled_t, sampled_points)
    unit = rounding(stretch, sampled_points)
    slack = unit.take(pieces.cells) if isinstance(unit, np.ndarray) else np.full(len(low), unit)
    if allowance is None:
        bounds = bernstein_deviation(stretch, pieces, low, high, splits) + slack
    else:
        bounds = _cheaper_deviation(stretch, pieces, low, high) + slack
        limits = np.asarray(allowance, np.float64)
        above = (bounds > (limits.take(pieces.chords) if limits.ndim else limits)).nonzero()[0]
        if len(above):
            sharper = bernstein_deviation(stretch, pieces, low, high, splits, above)
            bounds[above] = np.minimum(bounds[above], sharper + slack.take(above))
    return np.asarray(np.maximum.reduceat(bounds, pieces.firsts))


def _lines(pieces: Pieces, t: Array, points: Array) -> tuple[Array, Array]:
    """Return where the polyline is at both ends of each piece."""
    chords = pieces.chords
    shares = (pieces.starts - t.take(chords)) / (t[1:] - t[:-1]).take(chords)
    steps = (points[1:] - points[:-1]).take(chords, axis=0)
    low = points.take(chords, axis=0) + shares[:, None] * steps
    # Where a chord ends, the next piece begins with its vertex; no need to interpolate there.
    return low, np.concatenate((low[1:], points[-1:]))


def _cheaper_deviation(stretch: Stretch, pieces: Pieces, low: Array, high: Array) -> Array:
    """Bound the deviation on pieces that follow each other, at the least cost there is."""
    if stretch.rational or stretch.degree > 3:
        return bernstein_deviation(stretch, pieces, low, high, 0)
    off = stretch.at(np.concatenate((pieces.starts, pieces.stops[-1:])))
    off[:-1] -= low
    off[-1] -= high[-1]
    return curvature_deviation(stretch, pieces, norms(off))


def bernstein_deviation(
    stretch: Stretch,
    pieces: Pieces,
    low: Array,
    high: Array,
    splits: int,
    chosen: IntArray | None = None,
) -> Array:
    """Bound the deviation on pieces from Bernstein coefficients.

    Parameters
    ----------
    stretch : Stretch
        The spline.
    pieces : Pieces
        Where.
    low, high : (m, d) arrays
        The line at both ends of each piece.
    splits : int
        How often each piece is halved.
    chosen : integer array, optional
        Indices of the pieces that are wanted; default all.

    Returns
    -------
    (m,) or (len(chosen),) array
        Without rounding.
    """
    cells, starts, stops = pieces.cells, pieces.starts, pieces.stops
    if chosen is not None:
        cells, starts, stops = cells.take(chosen), starts.take(chosen), stops.take(chosen)
        low, high = low.take(chosen, axis=0), high.take(chosen, axis=0)
    degree = stretch.degree
    # (p + 1, m, D) from here on, as the rows lie in memory.
    rows = bernstein(
        stretch.knots, stretch.coefficients, degree, stretch.spans.take(cells), starts, stops
    ).transpose(1, 0, 2)
    share = np.arange(degree + 2)[:, None, None] / (degree + 1 if stretch.rational else degree)
    if not stretch.rational:
        share = share[: degree + 1]
        rows = rows - (1.0 - share) * low
        rows -= share * high
        return bernstein_bound(rows.transpose(1, 0, 2), splits=splits)
    weights = rows[..., -1:]
    raised = np.zeros((degree + 2, len(cells), rows.shape[2]))
    raised[:-1, :, :-1] = rows[..., :-1] - weights * low
    raised[:-1, :, -1:] = weights
    raised[:-1] *= 1.0 - share[:-1]
    after = np.concatenate((rows[..., :-1] - weights * high, weights), axis=2)
    raised[1:] += share[1:] * after
    raised = raised.transpose(1, 0, 2)
    return rational_bernstein_bound(raised[..., :-1], raised[..., -1], splits=splits)


def curvature_deviation(
    stretch: Stretch, pieces: Pieces, ends: Array, second: Array | None = None
) -> Array:
    """Bound the deviation on pieces of a polynomial spline up to degree 3 from its S''.

    Parameters
    ----------
    stretch : Stretch
        The spline.
    pieces : Pieces
        Where.
    ends : (m + 1,) array
        The deviation where each piece starts, and where the last one stops.
    second : array, optional
        `second_derivative_coefficients` of the stretch, if they are at hand.

    Returns
    -------
    (m,) array
        Without rounding. Never more than a few per cent above the true maximum where the curve
        bends one way and the polyline is inscribed.

    Notes
    -----
    On a piece of length h, with x from -1 to 1, S'' = M + x D. The deviation is at most its linear
    interpolation from the ends and h**2 / 8 (1 - x**2) (||M|| + |x| ||D|| / 3) on top: the sagitta,
    exact for a cubic whose M and D are parallel.
    """
    before, after = ends[:-1], ends[1:]
    degree = stretch.degree
    if degree == 1:
        return np.maximum(before, after)
    if second is None:
        second = second_derivative_coefficients(stretch.knots, stretch.coefficients, degree)
    # Of the nonzero coefficients of S'' on a span k, k - p is the first and k - 2 the last.
    first = stretch.spans.take(pieces.cells) - degree
    half = (pieces.stops - pieces.starts) / 2
    scale = half * half / 2
    middle = second.take(first, axis=0)
    if degree == 2:
        odd = np.zeros(len(half))
    else:
        left = stretch.breaks.take(pieces.cells)
        slope = second.take(first + 1, axis=0) - middle
        slope /= (stretch.breaks.take(pieces.cells + 1) - left)[:, None]
        middle += slope * (pieces.starts - left + half)[:, None]
        odd = norms(slope) * (half * scale / 3)
    even = norms(middle) * scale
    # The maximum over x of base + even (1 - x**2) + lean |x|, whose top may lie beyond x = 1.
    base = (before + after) / 2
    lean = np.abs(after - before) / 2 + odd
    inside = np.minimum(lean, 2 * even)
    base += even + (lean - inside)
    base += inside * inside / (4 * even + np.finfo(np.float64).tiny)
    return np.asarray(base)
