"""What stands fixed when a curve is changed on [a, b] only: the control points that reach outside.

Facts used: a control point is the blossom of any polynomial piece in its support at its p inner
knots. With s the last span before a, the control points s - p + 1 .. s read knots after u_s; all p
of them reach outside, so they are fixed: copied where their inner knots stayed, else blossoms of
the old piece on span s at the new inner knots. Then every piece up to a is the old polynomial, and
the join at a has p minus its multiplicity continuous derivatives. Likewise from the right.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from multirep.arrays import Array
from multirep.representations.nurbs.problem import Breakpoints
from multirep.representations.nurbs.refinement import merged_breakpoints
from multirep.splines import blossom, evaluate
from multirep.splines.rational import homogeneous

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs


class WeightError(ArithmeticError):
    """A fixed control point would need a weight that is not positive: its knots are too far."""


@attrs.frozen(eq=False)
class Window:
    """The part of a curve that a splice on [a, b] replaces, and what it must respect.

    Parameters
    ----------
    degree : int
    start, stop : Array or None
        The first or last point of the course where that end is an end of T; else None.
    first, last : int
        The span left of a and the span right of b (of the old curve): s and e.
    outer_left, outer_right : Array
        The p old knots up to u_s and from u_(e+1) on; empty at an end of T.
    local_knots, local_rows : Array
        Local arrays of the old pieces on s and on e: 2p + 1 knots and p + 1 control points each
        (homogeneous if ``rational``), one after the other, padded to equal length.
    rational : bool
        Whether weights vary around here; if they do not, the polynomial in the points is meant.
    old : tuple of (knots, weights)
        Of the old curve over [a, b], for weights inside; empty unless rational.
    """

    degree: int
    start: Array | None
    stop: Array | None
    first: int
    last: int
    outer_left: Array
    outer_right: Array
    local_knots: Array
    local_rows: Array
    dimension: int
    rational: bool
    old: tuple[Array, Array] | None

    @classmethod
    def of(cls, curve: Nurbs, start: float, stop: float, points: Array) -> Window:
        """Cut the window [start, stop] out of a curve; ``points`` are the course's."""
        p, domain = curve.degree, curve.domain
        open_left, open_right = start <= domain.start, stop >= domain.stop
        s = p - 1 if open_left else curve.span(start, "left")
        e = curve.size if open_right else curve.span(stop)
        low, high = max(s - p, 0), min(e + 1, curve.size)
        weights = None if curve._weights is None else curve._weights.window(low, high)
        rational = weights is not None and not bool((weights == weights[0]).all())
        size = 2 * p + 1
        knots = np.empty(2 * size)
        rows = np.zeros((2 * size, curve.dimension + rational))
        for at, closed, span in ((0, not open_left, s), (size, not open_right, e)):
            if closed:
                knots[at : at + size] = curve._knots.window(span - p, span + p + 1)
                local = curve._points.window(span - p, span + 1)
                if rational and weights is not None:
                    local = homogeneous(local, weights[span - p - low : span + 1 - low])
                rows[at : at + p + 1] = local
            else:  # harmless numbers: no row of this side is asked for
                knots[at : at + size] = np.arange(size)
        return cls(
            p,
            points[0] if open_left else None,
            points[-1] if open_right else None,
            s,
            e,
            np.empty(0) if open_left else knots[1 : p + 1],
            np.empty(0) if open_right else knots[size + p + 1 :],
            knots,
            rows,
            curve.dimension,
            rational,
            (curve._knots.window(low, high + p + 1), weights)
            if rational and weights is not None
            else None,
        )

    def knots(self, breakpoints: Breakpoints) -> Array:
        """Return the knots of the window: p outer ones, the breakpoints, p outer ones."""
        at, times = breakpoints
        return np.concatenate((self.outer_left, at.repeat(times), self.outer_right))

    def roomy(self, breakpoints: Breakpoints) -> Breakpoints:
        """Return breakpoints of which no fixed row belongs to both sides."""
        at = breakpoints.at
        if len(at) > self.degree or self.start is not None or self.stop is not None:
            return breakpoints
        missing = self.degree + 1 - int(breakpoints.times.sum())
        if missing <= 0:
            return breakpoints
        parts = -(-missing // (len(at) - 1)) + 1
        inner = at[:-1, None] + np.diff(at)[:, None] * (np.arange(1, parts) / parts)
        return merged_breakpoints(breakpoints, inner.ravel(), [], self.degree)

    def kept(self, knots: Array) -> tuple[int, int]:
        """Return how many rows at the left and at the right keep their inner knots.

        Those are bit-identical copies of old control points; at most p on each side, none at an
        end of T.
        """
        p, size = self.degree, 2 * self.degree + 1
        left = right = 0
        # Rows i < p on the left read knots 1 .. 2p - 1: so many of them as agree from the start.
        if self.start is None:
            same = (knots[p : 2 * p] == self.local_knots[p + 1 : size]).tolist()
            left = same.index(False) if False in same else p
        if self.stop is None:
            near = self.local_knots[size + 1 : size + p + 1]
            same = (knots[-2 * p : -p] == near).tolist()[::-1]
            right = same.index(False) if False in same else p
        return left, right

    def fixed(self, knots: Array, breakpoints: Breakpoints) -> tuple[Array, slice, Array | None]:
        """Fill in the fixed control points (Euclidean) and the weights; see `Ends`."""
        p, size, count = self.degree, 2 * self.degree + 1, len(knots) - self.degree - 1
        left, right = self.kept(knots)
        rows = np.zeros((count, self.dimension + self.rational))
        spans: list[int] = []
        places: list[int] = []
        if self.start is None:
            rows[:left] = self.local_rows[1 : left + 1]
            places += range(left, p)
            spans += [p] * (p - left)
        if self.stop is None:
            rows[count - right :] = self.local_rows[size + p - right : size + p]
            places += range(count - p, count - right)
            spans += [size + p] * (p - right)
        if places:
            at = np.array(places)
            inner = knots.take(at[:, None] + np.arange(1, p + 1))
            rows[at] = blossom(self.local_knots, self.local_rows, p, np.array(spans), inner)
        free = slice(p if self.start is None else 1, count - (p if self.stop is None else 1))
        points, weights = rows, None
        if self.rational:
            points, weights = self._euclidean(knots, rows, free)
        if self.start is not None:
            points[0] = self.start
        if self.stop is not None:
            points[-1] = self.stop
        return points, free, weights

    def _euclidean(self, knots: Array, rows: Array, free: slice) -> tuple[Array, Array]:
        """Divide fixed homogeneous rows by their weights, and continue the weights inside.

        Inside, the weights are the old weight function at the averages of p inner knots
        (Schoenberg's operator): near the old function where knots are dense, and always positive.
        """
        assert self.old is not None
        p, count = self.degree, len(rows)
        averages = sliding_window_view(knots[1:-1], p).mean(axis=1)
        averages = np.clip(averages, self.old[0][p], self.old[0][-p - 1])
        weights = evaluate(self.old[0], self.old[1][:, None], p, averages)[:, 0]
        fixed = np.ones(count, dtype=bool)
        fixed[free] = False
        fixed[0] &= self.start is None
        fixed[-1] &= self.stop is None
        weights[fixed] = rows[fixed, -1]
        if not (weights > 0).all():
            raise WeightError
        return rows[:, :-1] / weights[:, None], weights
