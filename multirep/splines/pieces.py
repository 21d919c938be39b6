"""A stretch of a spline, cut out of its arrays, and the polynomial pieces that chords meet on it.

What the certified bounds and the sampler share. A *cell* is a nonempty knot span of the stretch; a
*chord* is a parameter interval with a line above it; a *piece* is the part of a chord on one cell,
so that the spline is one polynomial and the polyline one line there.
"""

import math
from typing import NamedTuple

import numpy as np

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray
from multirep.splines.evaluation import evaluate

__all__ = ["Pieces", "Stretch", "cut_pieces", "cut_stretch"]

EPS = float(np.finfo(np.float64).eps)


def norms(rows: Array) -> Array:
    """Return the Euclidean norm of each row of an ``(m, d)`` array."""
    return np.asarray(np.sqrt(np.einsum("md,md->m", rows, rows)))


def project(values: Array, rational: bool) -> Array:
    """Divide homogeneous rows by their weight, if they are homogeneous."""
    return np.asarray(values[:, :-1] / values[:, -1:]) if rational else values


_NONE = np.empty(0)
_NONE.setflags(write=False)


class Stretch(NamedTuple):
    """The knots and coefficients that a spline depends on between two parameters."""

    knots: Array
    """Knots of the stretch with p more on each side, ``(n + p + 1,)``."""
    coefficients: Array
    """``(n, D)``, a view."""
    degree: int
    rational: bool
    breaks: Array
    """Distinct knots around the cells, ``(c + 1,)``."""
    spans: IntArray
    """Span index of each cell in ``knots``, ``(c,)``."""

    def at(self, t: Array, order: int = 0) -> Array:
        """Evaluate at sorted parameters of the stretch, bit for bit as `evaluate` does."""
        if order > self.degree:
            return np.zeros((len(t), self.coefficients.shape[1]))
        if compiled.active:
            return evaluate(self.knots, self.coefficients, self.degree, t, order=order)
        from scipy.interpolate import BSpline

        spline = BSpline.construct_fast(self.knots, self.coefficients, self.degree)
        return np.asarray(spline(t, order))

    def points(self, t: Array) -> Array:
        """Evaluate, and divide by the weight if the spline is rational."""
        return project(self.at(t), self.rational)

    def bending(self, t: Array) -> Array:
        """Evaluate ``||R''||``."""
        second = self.at(t, 2)
        if self.rational:
            values, first = self.at(t), self.at(t, 1)
            w = values[:, -1:]
            points = values[:, :-1] / w
            velocity = (first[:, :-1] - first[:, -1:] * points) / w
            second = second[:, :-1] - 2 * first[:, -1:] * velocity - second[:, -1:] * points
            second /= w
        return norms(second)


class Pieces(NamedTuple):
    """The pieces of some chords, in their order."""

    chords: IntArray
    """The chord of each piece, ``(m,)``."""
    cells: IntArray
    """The cell of each piece, ``(m,)``."""
    starts: Array
    stops: Array
    firsts: IntArray
    """The first piece of each chord."""


def cut_stretch(
    knots: Array, coefficients: Array, degree: int, start: float, stop: float, rational: bool
) -> Stretch:
    """Cut out what a spline depends on between ``start < stop``."""
    count = len(knots) - degree - 1
    low, high = max(start, float(knots[degree])), min(stop, float(knots[count]))
    first = int(knots.searchsorted(low, "right")) - 1
    last = int(knots.searchsorted(high, "left")) - 1
    window = knots[first - degree : last + degree + 2]
    inner = knots[first : last + 2]
    spans = (inner[:-1] < inner[1:]).nonzero()[0]
    breaks = np.concatenate((inner.take(spans), inner[-1:]))
    spans += degree
    return Stretch(window, coefficients[first - degree : last + 1], degree, rational, breaks, spans)


def cut_pieces(breaks: Array, starts: Array, stops: Array) -> Pieces:
    """Cut chords, ``breaks[0] <= starts[i] < stops[i] <= starts[i + 1]``, at the breaks."""
    first = breaks.searchsorted(starts, "right") - 1
    counts = breaks.searchsorted(stops, "left") - first
    ends = counts.cumsum()
    firsts = ends - counts
    chords = np.arange(len(starts)).repeat(counts)
    cells = np.arange(ends[-1]) + (first - firsts).take(chords)
    return Pieces(
        chords,
        cells,
        np.maximum(starts.take(chords), breaks.take(cells)),
        np.minimum(stops.take(chords), breaks.take(cells + 1)),
        firsts,
    )


def largest_coordinate(one: Array, other: Array = _NONE) -> float:
    """Return the largest absolute value in one or two arrays, 0 if there is none; NaN stays NaN.

    Examples
    --------
    >>> largest_coordinate(np.array([[1.0, -3.0]]), np.array([2.0]))
    3.0
    """
    if compiled.active:
        return compiled.core.largest(one, other)
    largest = np.abs(one).max(initial=0.0), np.abs(other).max(initial=0.0)
    return float(np.maximum(*largest))


def rounding_unit(degree: int, dimension: int) -> float:
    """Bound what rounding does to a computed deviation, as a part of the largest coordinate.

    ``(8 p + 16)`` units per coordinate: each of the 2p blending steps of the Bernstein form costs
    at most 4, the line and the difference the rest.
    """
    return (8 * degree + 16) * EPS * math.sqrt(dimension)


def rounding(stretch: Stretch, points: Array) -> Array | float:
    """Bound what rounding does to a computed deviation, for each cell or for all of them.

    See `rounding_unit`. A rational is a quotient whose weights may differ within a cell by their
    ratio.
    """
    coefficients, degree = stretch.coefficients, stretch.degree
    unit = rounding_unit(degree, points.shape[1])
    if not stretch.rational:
        return unit * largest_coordinate(coefficients, points)
    weights = coefficients[:, -1]
    largest = max(
        float(np.abs(coefficients[:, :-1] / weights[:, None]).max()), float(np.abs(points).max())
    )
    local = weights.take(np.arange(-degree, 1)[:, None] + stretch.spans)
    return np.asarray(unit * largest * (local.max(axis=0) / local.min(axis=0)))
