"""One attempt of a fit: given the knots of a stretch, solve, and prove how far the result is off.

The marks of an attempt are its knots, the quarters of its spans and the vertices of the polyline.
Least squares counts the distance at each mark with the length of the pieces beside it. On a piece
between neighbouring marks the difference R - L is one cubic, and its four Bernstein coefficients
bound it: the deviation is *proved* for every parameter.
"""

from __future__ import annotations

from typing import NamedTuple

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import InvariantError, ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import parameters
from multirep.representations.wavelet.target import Target
from multirep.splines import compiled
from multirep.splines.polar import blossom

__all__ = ["Attempt", "Frame", "Problem", "frame_pieces"]

#: Rows per span that carry no vertex. Fewer make the certificate loose and the solve singular.
_ROWS = 4
#: Rounding of the certificate and of any float64 evaluation of the curve, in units of the largest
#: coordinate.
_ROUNDING = 64 * float(np.finfo(np.float64).eps)


class Frame(NamedTuple):
    """What lies around the stretch: the knots, and the old curve that must be joined."""

    before: Array
    """(3,) parameters: the knots before the stretch; its start three times at the start of T."""
    after: Array
    """(3,) parameters: the knots behind it."""
    pieces: tuple[Array, Array] | None
    """Knots (15,) and points (11, d) of the old pieces to be joined, see :func:`frame_pieces`."""
    left: bool
    """Whether the curve continues before the stretch."""
    right: bool
    """Whether it continues behind it."""


class Attempt(NamedTuple):
    """What a set of knots achieves."""

    u: Array
    """(n + 1,) dyadic knots from the start to the stop of the stretch."""
    x: Array
    """(n + 1,) the same as parameters."""
    points: Array
    """(d, n + 3) control points about the target's origin; three at a joined end are dictated."""
    arguments: Array
    """(6, 3) knots that define the dictated ones."""
    nets: Array
    """(4, d, n) Bernstein coefficients of the spans."""
    ratios: Array
    """(n,) proved: the largest deviation on each span in terms of what is allowed there."""
    bound: float
    """Proved: the largest deviation of all, rounding included."""


@attrs.frozen(eq=False)
class Problem:
    """A stretch that is to be fitted.

    Parameters
    ----------
    target : Target
        Covers the stretch.
    domain : Interval
        T, onto which dyadic numbers are mapped.
    frame : Frame
        The surroundings.
    slack : float
        What rounding may add to a deviation.
    limits : (m,) array
        The target's allowances less the slack.
    """

    target: Target
    domain: Interval
    frame: Frame
    slack: float
    limits: Array

    @classmethod
    def of(cls, target: Target, domain: Interval, frame: Frame, magnitude: float) -> Problem:
        """Make a problem, coordinates up to ``magnitude``.

        Raises
        ------
        ToleranceError
            When an allowance is below what rounding alone may cost.
        """
        slack = _ROUNDING * magnitude
        limits = target.allowances - slack
        if not limits.min() > 0.0:
            raise ToleranceError(
                f"a tolerance of {target.allowances.min():.3g} is below the rounding of "
                f"coordinates up to {magnitude:.3g}; the smallest that can be proved is "
                f"{2 * slack:.3g}",
                tolerance=float(target.allowances.min()),
                reachable=2 * slack,
            )
        return cls(target, domain, frame, slack, limits)

    def attempt(self, u: Array) -> Attempt:
        """Solve with the knots ``u`` (n + 1,); n >= 3 if an end is joined. Linear in marks."""
        if compiled.active:
            return self._attempt_at_once(u)
        stretch = _lay_out(self.target, u, self.domain, self.frame)
        pins, arguments = _dictate(stretch.x, self.frame, self.target.origin)
        points = _solve(stretch, pins, self.frame, self.limits)
        nets = np.einsum("jkn,kdn->jdn", stretch.maps, _windows(points))
        ratios, bound = _certify(stretch, nets, self.limits)
        return Attempt(u, stretch.x, points, arguments, nets, ratios, bound + self.slack)

    def _attempt_at_once(self, u: Array) -> Attempt:
        """Solve and prove in the compiled core."""
        target, frame, x = self.target, self.frame, parameters(u, self.domain)
        pins, arguments = _dictate(x, frame, target.origin)
        points, first, last = _pinned(pins, frame, len(x) - 1, len(target.origin))
        nets = np.empty((4, len(target.origin), len(x) - 1))
        ratios = np.empty(len(x) - 1)
        bound = compiled.core.attempt(
            target.t,
            target.points,
            target.slopes,
            self.limits,
            frame.before,
            x,
            frame.after,
            first,
            last,
            points,
            nets,
            ratios,
        )
        if bound is None:
            raise _undetermined(x)
        return Attempt(u, x, points, arguments, nets, ratios, bound + self.slack)


class _Stretch(NamedTuple):
    """All about one set of knots that does not depend on the control points; marks come last."""

    x: Array
    """(n + 1,) knots."""
    marks: Array
    """(m,) parameters, the knots among them."""
    spans: Indices
    """(m,), the span of each mark."""
    starts: Indices
    """(n,), the first mark of each span."""
    basis: Array
    """(2, 4, m): Bernstein polynomials of the spans there, and a third of their derivatives."""
    maps: Array
    """(4, 4, n): matrices from the four control points of a span to its Bernstein coefficients."""
    values: Array
    """(d, m): the target."""
    chords: Indices
    """(m,), the chord of the target at each mark."""


def _lay_out(target: Target, u: Array, domain: Interval, frame: Frame) -> _Stretch:
    """Place the marks and express the basis there."""
    x = parameters(u, domain)
    lengths = x[1:] - x[:-1]
    first, last = target.t.searchsorted(x[0], side="right"), target.t.searchsorted(x[-1])
    grid = x[:-1] + lengths * _QUARTERS
    marks = np.concatenate((grid.ravel(), x[-1:], target.t[first:last]))
    marks.sort()
    distinct = np.empty(len(marks), dtype=bool)
    distinct[0] = True
    np.greater(marks[1:], marks[:-1], out=distinct[1:])
    marks = marks[distinct]
    starts = marks.searchsorted(x[:-1])
    spans = np.zeros(len(marks), dtype=np.intp)
    spans[starts[1:]] = 1
    spans = spans.cumsum()
    local = (marks - x.take(spans)) / lengths.take(spans)
    values, chords = target.at(marks)
    return _Stretch(x, marks, spans, starts, _bernstein(local), _maps(x, frame), values, chords)


def _bernstein(local: Array) -> Array:
    """Tabulate cubic Bernstein polynomials and a third of their derivatives, (2, 4, m)."""
    table = np.zeros((2, 4, len(local)))
    other = 1.0 - local
    square, mixed, other_square = local * local, 2.0 * local * other, other * other
    np.multiply(other_square, other, out=table[0, 0])
    np.multiply(other_square, 3.0 * local, out=table[0, 1])
    np.multiply(square, 3.0 * other, out=table[0, 2])
    np.multiply(square, local, out=table[0, 3])
    np.negative(other_square, out=table[1, 0])
    np.subtract(other_square, mixed, out=table[1, 1])
    np.subtract(mixed, square, out=table[1, 2])
    table[1, 3] = square
    return table


def _maps(x: Array, frame: Frame) -> Array:
    """Matrices (4, 4, n) from the control points of a span to its Bernstein coefficients."""
    count = len(x) - 1
    knots = np.concatenate((frame.before, x, frame.after))
    # Of span k: knots k+1 .. k+6 are two before it, its ends, two behind it.
    lowest, low, start, stop, high, highest = (knots[j : j + count] for j in range(1, 7))
    length, wide = stop - start, high - low
    maps = np.zeros((4, 4, count))
    np.divide(high - start, wide, out=maps[1, 1])
    np.divide(start - low, wide, out=maps[1, 2])
    np.divide(high - stop, wide, out=maps[2, 1])
    np.divide(stop - low, wide, out=maps[2, 2])
    # At its start: the polar form at (start, start, start), from those at (low, start, start) and
    # b1.
    share = length / (stop - low)
    inner = share * (length / (stop - lowest))
    maps[0, 0] = inner
    maps[0, 2] = (1.0 - share) * maps[1, 2]
    maps[0, 1] = 1.0 - inner - maps[0, 2]
    share = length / (high - start)
    inner = share * (length / (highest - start))
    maps[3, 3] = inner
    maps[3, 1] = (1.0 - share) * maps[2, 1]
    maps[3, 2] = 1.0 - inner - maps[3, 1]
    return maps


def frame_pieces(left: tuple[Array, Array], right: tuple[Array, Array]) -> tuple[Array, Array]:
    """Put two old pieces side by side, so that one call evaluates the polar forms of both.

    Parameters
    ----------
    left, right : pairs of (6,) and (4, d) arrays
        The six knots around the span of each piece, and its four control points.

    Examples
    --------
    >>> knots, points = np.arange(6.0), np.zeros((4, 2))
    >>> [array.shape for array in frame_pieces((knots, points), (knots, points))]
    [(15,), (11, 2)]
    """
    gap = np.zeros((3, left[1].shape[1]))
    knots = np.concatenate((left[0][:1], left[0], right[0][:1], right[0], right[0][-1:]))
    return knots, np.concatenate((left[1], gap, right[1]))


def _dictate(x: Array, frame: Frame, origin: Array) -> tuple[Array, Array]:
    """Dictated control points (6, d) at the joined ends, and the knots (6, 3) that define them."""
    if frame.pieces is None:
        return np.zeros((6, len(origin))), np.zeros((6, 3))
    around = np.concatenate((frame.before[1:], x[:3], x[-3:], frame.after[:2]))
    arguments = around.take(_ARGUMENTS)
    return blossom(*frame.pieces, 3, _PIECES, arguments), arguments


def _pinned(pins: Array, frame: Frame, count: int, dimension: int) -> tuple[Array, int, int]:
    """Control points (d, n + 3) with the dictated ones in place, and the range of the free ones."""
    points = np.zeros((dimension, count + 3))
    if frame.left:
        points[:, :3] = pins[:3].T
    if frame.right:
        points[:, -3:] = pins[3:].T
    return points, 3 * frame.left, count + 3 - 3 * frame.right


def _undetermined(x: Array) -> InvariantError:
    return InvariantError("the rows of a fit do not determine its control points", x)


def _solve(stretch: _Stretch, pins: Array, frame: Frame, limits: Array) -> Array:
    """Least squares for the control points (d, n + 3) that are not dictated."""
    from scipy.linalg.lapack import dpbsv

    count = len(stretch.x) - 1
    points, first, last = _pinned(pins, frame, count, len(stretch.values))
    rows = np.einsum("jm,jkm->km", stretch.basis[0], stretch.maps.take(stretch.spans, axis=2))
    wanted = stretch.values
    if frame.left or frame.right:
        held = _windows(points).take(stretch.spans, axis=2)
        wanted = wanted - np.einsum("km,kdm->dm", rows, held)
    if first >= last:
        return points
    # The length of the pieces on either side, in terms of what is allowed there.
    counts = (stretch.marks[1:] - stretch.marks[:-1]) * np.square(limits.min() / limits).take(
        stretch.chords[:-1]
    )
    weights = np.zeros(len(stretch.marks))
    weights[:-1] = counts
    weights[1:] += counts
    both = np.concatenate((rows, wanted))
    rows *= weights
    sums = np.add.reduceat(rows[:, None] * both, stretch.starts, axis=2)
    band = np.zeros((4, count + 3))
    right = np.zeros_like(points)
    for j in range(4):
        right[:, j : j + count] += sums[j, 4:]
        for k in range(j + 1):
            band[j - k, k : k + count] += sums[j, k]
    _, solution, info = dpbsv(band[:, first:last], right[:, first:last].T, lower=1)
    if info:
        raise _undetermined(stretch.x)
    points[:, first:last] = solution.T
    return points


def _certify(stretch: _Stretch, nets: Array, limits: Array) -> tuple[Array, float]:
    """Largest proved deviation of each span in terms of its limit, and the largest of all."""
    off, turns = np.einsum("ijm,jdm->idm", stretch.basis, nets.take(stretch.spans, axis=2))
    off -= stretch.values
    # The Bernstein coefficients of R - L on each piece: its ends, and from there a third of the
    # slope times the length.
    square = np.square(off).sum(axis=0)
    bound = square.max()
    allowed = np.square(limits).take(stretch.chords[:-1])
    # A mark belongs to both pieces: where little is allowed on one side, the other side must give
    # way.
    square[1:-1] /= np.minimum(allowed[1:], allowed[:-1])
    square[0] /= allowed[0]
    square[-1] /= allowed[-1]
    worst = np.maximum(square[1:], square[:-1])
    parts = stretch.marks[1:] - stretch.marks[:-1]
    parts /= (stretch.x[1:] - stretch.x[:-1]).take(stretch.spans[:-1])
    rise = (stretch.values[:, 1:] - stretch.values[:, :-1]) / 3.0
    inner = turns[:, :-1] * parts
    inner -= rise
    inner += off[:, :-1]
    beyond = np.square(inner, out=inner).sum(axis=0)
    # The piece before a knot needs the slope of its own span: what the next one says, if that is
    # far shorter, carries a far larger rounding error.
    turns[:, stretch.starts[1:]] = nets[3, :, :-1] - nets[2, :, :-1]
    inner = turns[:, 1:] * parts
    inner -= rise
    inner -= off[:, 1:]
    np.maximum(beyond, np.square(inner, out=inner).sum(axis=0), out=beyond)
    bound = max(bound, beyond.max())
    beyond /= allowed
    np.maximum(worst, beyond, out=worst)
    return np.sqrt(np.maximum.reduceat(worst, stretch.starts)), float(bound) ** 0.5


def _windows(points: Array) -> Array:
    """Return the control points (4, d, n) of each span, given all (d, n + 3)."""
    count = points.shape[1] - 3
    return np.array([points[:, k : k + count] for k in range(4)])


_QUARTERS = (np.arange(_ROWS) / _ROWS)[:, None]
_ARGUMENTS = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4], [5, 6, 7], [6, 7, 8], [7, 8, 9]])
_PIECES = np.array([3, 3, 3, 10, 10, 10])
