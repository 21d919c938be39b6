"""One attempt of a fit: given the knots of a stretch, solve, and prove how far the result is off.

The marks of an attempt are its knots, the quarters of its spans and the vertices of the polyline.
Least squares counts the distance at each mark with the length of the pieces beside it. On a piece
between neighbouring marks the difference R - L is one cubic, and its four Bernstein coefficients
bound it: the deviation is *proved* for every parameter.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import InvariantError, ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import parameters
from multirep.representations.wavelet.target import Target
from multirep.splines import compiled
from multirep.splines.polar import blossom

__all__ = ["Attempt", "Frame", "Piece", "Problem"]

#: Rows per span that carry no vertex. Fewer make the certificate loose and the solve singular.
_ROWS = 4
#: Rounding of the certificate and of any float64 evaluation of the curve, in units of the largest
#: coordinate.
_ROUNDING = 64 * float(np.finfo(np.float64).eps)


Pieces: TypeAlias = tuple[Array | None, Array | None, Array | None, Array | None]


class Piece(NamedTuple):
    """One piece of the old curve."""

    knots: Array
    """(6,) parameters: the knots around its span, which lies between the third and the fourth."""
    points: Array
    """(4, d) control points, about the target's origin."""

    def polar(self, arguments: Array) -> Array:
        """Evaluate its polar form, (m, 3) -> (m, d)."""
        knots = np.concatenate((self.knots[:1], self.knots))  # no polar form reads the first
        return blossom(knots, self.points, 3, np.full(len(arguments), 3), arguments)


class Frame(NamedTuple):
    """What lies around the stretch: the knots, and the old curve that must be joined."""

    before: Array
    """(3,) parameters: the knots before the stretch; its start three times at the start of T."""
    after: Array
    """(3,) parameters: the knots behind it."""
    left: Piece | None
    """What the curve continues before the stretch; None at the start of T."""
    right: Piece | None
    """What continues it behind."""

    @property
    def joined(self) -> int:
        """How many ends are joined."""
        return (self.left is not None) + (self.right is not None)

    @property
    def arrays(self) -> Pieces:
        """Knots and points of the two pieces, for the compiled core."""
        left, right = self.left, self.right
        return (
            left and left.knots,
            left and left.points,
            right and right.knots,
            right and right.points,
        )


class Attempt(NamedTuple):
    """What a set of knots achieves."""

    u: Array
    """(n + 1,) dyadic knots from the start to the stop of the stretch."""
    x: Array
    """(n + 1,) the same as parameters."""
    points: Array
    """(d, n + 3) control points about the target's origin; three at a joined end are dictated."""
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
        points = _solve(stretch, self.frame, self.limits)
        nets = np.einsum("jkn,kdn->jdn", stretch.maps, _windows(points))
        ratios, bound = _certify(stretch, nets, self.limits)
        return Attempt(u, stretch.x, points, nets, ratios, bound + self.slack)

    def _attempt_at_once(self, u: Array) -> Attempt:
        """Solve and prove in the compiled core."""
        x = parameters(u, self.domain)
        count, dimension = len(x) - 1, len(self.target.origin)
        points, nets = np.empty((dimension, count + 3)), np.empty((4, dimension, count))
        ratios = np.empty(count)
        bound = compiled.core.attempt(*self.arrays, x, points, nets, ratios)
        if bound is None:
            raise _undetermined(x)
        return Attempt(u, x, points, nets, ratios, bound + self.slack)

    @property
    def arrays(self) -> tuple[Array, Array, Array, Array, Array, Array, *Pieces]:
        """What the compiled core reads of the target, its limits and its surroundings."""
        target, frame = self.target, self.frame
        return (
            target.t,
            target.points,
            target.slopes,
            self.limits,
            frame.before,
            frame.after,
            *frame.arrays,
        )


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


def _pinned(x: Array, frame: Frame, dimension: int) -> tuple[Array, int, int]:
    """Control points (d, n + 3) with the dictated ones in place, and the range of the free ones.

    Three at a joined end are polar forms of the old piece, so the join is C2.
    """
    points = np.zeros((dimension, len(x) + 2))
    first, stop = 0, len(x) + 2
    if frame.left is not None:
        around = np.concatenate((frame.before[1:], x[:3]))
        points[:, :3] = frame.left.polar(around.take(_ARGUMENTS)).T
        first = 3
    if frame.right is not None:
        around = np.concatenate((x[-3:], frame.after[:2]))
        points[:, -3:] = frame.right.polar(around.take(_ARGUMENTS)).T
        stop -= 3
    return points, first, stop


def _undetermined(x: Array) -> InvariantError:
    return InvariantError("the rows of a fit do not determine its control points", x)


def _solve(stretch: _Stretch, frame: Frame, limits: Array) -> Array:
    """Least squares for the control points (d, n + 3) that are not dictated."""
    from scipy.linalg.lapack import dpbsv

    count = len(stretch.x) - 1
    points, first, last = _pinned(stretch.x, frame, len(stretch.values))
    rows = np.einsum("jm,jkm->km", stretch.basis[0], stretch.maps.take(stretch.spans, axis=2))
    wanted = stretch.values
    if frame.joined:
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
#: Of the five knots around an end, those that define each dictated control point.
_ARGUMENTS = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]])
