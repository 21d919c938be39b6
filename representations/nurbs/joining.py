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
from multirep.representations.nurbs.evaluation import homogeneous
from multirep.representations.nurbs.problem import Breakpoints
from multirep.splines import blossom, evaluate

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
        inner = at if len(at) == times.sum() else at.repeat(times)
        return np.concatenate((self.outer_left, inner, self.outer_right))

    def fixed(
        self, knots: Array, breakpoints: Breakpoints
    ) -> tuple[Array, slice, Array | None]:
        """Fill in the fixed control points (Euclidean); see `Ends`."""
        points, weights, _, _ = self.pinned(knots)
        left = self.degree if self.start is None else 1
        right = self.degree if self.stop is None else 1
        return points, slice(left, len(points) - right), weights

    def pinned(self, knots: Array) -> tuple[Array, Array | None, int, int]:
        """Return points and weights with the fixed rows, and which rows are expressed anew.

        Returns
        -------
        points : (n, d) array
        weights : (n,) array or None
        first, last : int
            Rows before ``first`` and after ``last`` are bit-identical copies of old ones with the
            same inner knots.
        """
        p, size, count = self.degree, 2 * self.degree + 1, len(knots) - self.degree - 1
        points = np.zeros((count, self.dimension))
        index = np.arange(p)
        inner = index[:, None] + np.arange(1, p + 1)
        wanted = []
        first, last = 0, count - 1
        if self.start is None:
            here = knots.take(inner)
            changed = (here != self.local_knots.take(inner + 1)).any(axis=1)
            first = int(changed.argmax()) if changed.any() else p
            wanted.append((0, 1, first, p, p, here))
        if self.stop is None:
            here = knots.take(inner + (count - p))
            changed = (here != self.local_knots.take(inner + size)).any(axis=1)
            last = count - p - 1
            if changed.any():
                last += p - int(changed[::-1].argmax())
            wanted.append((count - p, size, 0, last - (count - p) + 1, size + p, here))
        weights: Array | None = None
        if self.rational:
            assert self.old is not None
            greville = sliding_window_view(knots[1:-1], p).mean(axis=1)
            greville = np.clip(greville, self.old[0][p], self.old[0][-p - 1])
            weights = evaluate(self.old[0], self.old[1][:, None], p, greville)[:, 0]
        for at, source, low, high, span, here in wanted:
            rows = self.local_rows[source : source + p].copy()
            if low < high:
                rows[low:high] = blossom(
                    self.local_knots, self.local_rows, p, np.full(high - low, span), here[low:high]
                )
            if weights is None:
                points[at : at + p] = rows
            else:
                w = rows[:, -1]
                if not (w > 0).all():
                    raise WeightError
                points[at : at + p] = rows[:, :-1] / w[:, None]
                weights[at : at + p] = w
        if self.start is not None:
            points[0] = self.start
        if self.stop is not None:
            points[-1] = self.stop
        return points, weights, first, last
