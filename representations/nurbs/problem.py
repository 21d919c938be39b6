"""The problem behind a fit: a polyline, what stands fixed at its ends, a trial on given knots.

A trial is a banded weighted least-squares fit against the polyline (not against its vertices
alone: rows are placed between them too) and the residuals that it leaves, span by span, in units
of what is allowed. Residuals guide the choice of knots; `proved` decides.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.bounds import spline_chord_deviation
from multirep.sampled import SampledSplice
from multirep.splines import compiled, evaluate
from multirep.splines.least_squares import most_rows, polyline_rows, solve_window, undetermined
from multirep.splines.rational import homogeneous

#: How much more a row counts that lies on a knot of full multiplicity: so corners are met almost
#: exactly. Larger would cost digits in the normal equations.
CORNER_WEIGHT = 1e4
#: Rows on each span, times the degree. With fewer, splines with as many knots as the polyline has
#: vertices swing between the rows; more only cost time.
ROWS_PER_DEGREE = 2


#: Only beside a vertex that stands out by this many allowances a fit is looked at between the
#: vertices of a chord, and only there a corner that was stays one. The vertices of a sampled smooth
#: curve stand out by half an allowance.
KINK_HEIGHT = 1.0
#: A vertex that stands out by so many allowances becomes a corner at once. Around one of height H
#: simple knots need about log(H) of them more, a corner p - 1. Measured on coastlines and on
#: outlines of icons: a quarter more control points at 1, the same between 8 and 20.
CORNER_HEIGHT = 10.0


class Course(NamedTuple):
    """A polyline to be followed, and how closely."""

    t: Array
    """(m + 1,)"""
    points: Array
    """(m + 1, d)"""
    allowance: Array
    """(m,), positive: what the fit may be off by on each chord."""
    tightest: float
    """The smallest allowance."""
    uniform: bool
    """Whether all allowances are the same."""
    largest: float
    """The largest coordinate, but for its sign."""
    heights: Array
    """(m - 1,): how far each inner vertex stands from the line between its neighbours at equal t,
    over its allowance. The kink J times h1 h2 / (h1 + h2); four sagittas on a smooth curve."""
    row_t: Array
    row_points: Array
    """The same polyline with the middles of chords beside kinks as vertices, for rows of a fit."""

    @classmethod
    def of(cls, t: Array, points: Array, allowance: Array) -> Course:
        """Make a course of a polyline and what is allowed on each chord."""
        if compiled.active:
            heights = np.empty(len(t) - 2)
            tightest, loosest, largest, finer = compiled.core.course(
                t, points, allowance, KINK_HEIGHT, heights
            )
            row_t, row_points = t, points
            if finer is not None:
                row_t, row_points = (np.frombuffer(numbers) for numbers in finer)
                row_points = row_points.reshape(len(row_t), -1)
        else:
            tightest, loosest = float(allowance.min()), float(allowance.max())
            largest = float(np.abs(points).max())
            heights, row_t, row_points = _looked_at(t, points, allowance)
        uniform = tightest == loosest
        return cls(t, points, allowance, tightest, uniform, largest, heights, row_t, row_points)

    @classmethod
    def from_sampled(cls, sampled: SampledSplice, tolerance: float) -> Course:
        """Make the course that a sampled splice and a tolerance ask for."""
        return cls.of(sampled.t, sampled.points, sampled.allowance(tolerance))

    @property
    def corners(self) -> Array:
        """The parameters of vertices that stand out so far that a fit needs a corner there."""
        return self.t[1:-1][self.heights > CORNER_HEIGHT]

    def allowed(self, at: Array) -> Array | float:
        """Return what is allowed at parameters; at a vertex the smaller of both chords."""
        if self.uniform:
            return self.tightest
        last = len(self.allowance) - 1
        right = np.minimum(self.t.searchsorted(at, "right") - 1, last)
        left = np.maximum(self.t.searchsorted(at, "left") - 1, 0)
        return np.minimum(self.allowance.take(left), self.allowance.take(right))


def _looked_at(t: Array, points: Array, allowance: Array) -> tuple[Array, Array, Array]:
    """Return heights, and the polyline with middles beside kinks as vertices; see `Course`."""
    share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    off = points[2:] - points[:-2]
    off *= share[:, None]
    off += points[:-2]
    off -= points[1:-1]
    heights = np.sqrt(np.einsum("md,md->m", off, off))
    heights /= np.minimum(allowance[:-1], allowance[1:])
    kinked = heights > KINK_HEIGHT
    if not kinked.any():
        return heights, t, points
    beside = np.zeros(len(t) - 1, dtype=bool)
    beside[:-1] = kinked
    beside[1:] |= kinked
    at = np.flatnonzero(beside)
    middle = 0.5 * (t[at] + t[at + 1])
    some = (t[at] < middle) & (middle < t[at + 1])
    at, middle = at[some], middle[some]
    between = 0.5 * points[at] + 0.5 * points[at + 1]
    return heights, np.insert(t, at + 1, middle), np.insert(points, at + 1, between, axis=0)


class Breakpoints(NamedTuple):
    """Distinct knots from one end of the window to the other, and how often each stands there."""

    at: Array
    """(s + 1,), strictly increasing."""
    times: Indices
    """(s + 1,)"""


class Ends(Protocol):
    """What stands fixed at the ends of the window."""

    def knots(self, breakpoints: Breakpoints) -> Array:
        """Return the knots of the window: p + 1 up to its start, the inner ones, p + 1 after."""
        ...

    def fixed(self, knots: Array, breakpoints: Breakpoints) -> tuple[Array, slice, Array | None]:
        """Return control points with the fixed rows filled in, the free slice, and weights."""
        ...

    def roomy(self, breakpoints: Breakpoints) -> Breakpoints:
        """Return breakpoints with so many knots that the rows fixed at both ends do not overlap."""
        ...


class Trial(NamedTuple):
    """A fit on given knots, and how well it follows."""

    breakpoints: Breakpoints
    knots: Array
    """(n + p + 1,), of the window."""
    points: Array
    """(n, d)"""
    weights: Array | None
    """(n,)"""
    rows: Array
    """(r,): the parameters at which residuals were taken."""
    ratios: Array
    """(r,): residual over allowance."""
    firsts: Indices
    """(s + 1,): the row at each breakpoint."""
    worst: Array
    """(s,): the largest ratio on each span."""

    @property
    def size(self) -> int:
        """Number of control points."""
        return len(self.points)


@attrs.frozen(eq=False)
class Problem:
    """Follow ``course`` with a spline of ``degree`` between ``ends``."""

    degree: int
    course: Course
    ends: Ends

    def tried(self, breakpoints: Breakpoints, emphasis: Array | None = None) -> Trial:
        """Fit on given knots.

        Parameters
        ----------
        breakpoints : Breakpoints
        emphasis : (r,) array, optional
            Factors of the rows' weights; r as in an earlier trial with these breakpoints.

        Raises
        ------
        numpy.linalg.LinAlgError
            When the knots are so close that the equations lose their rank.
        """
        p, course = self.degree, self.course
        knots = self.ends.knots(breakpoints)
        fixed, free, weights = self.ends.fixed(knots, breakpoints)
        if compiled.active:
            return self._tried_at_once(breakpoints, knots, fixed, free, weights, emphasis)
        rows, targets, row_weights = polyline_rows(
            knots, p, course.row_t, course.row_points, per_span=ROWS_PER_DEGREE * p + 1
        )
        at = breakpoints.at
        firsts = rows.searchsorted(at)
        corners = (breakpoints.times[1:-1] >= p).nonzero()[0]
        if len(corners):
            row_weights[firsts[1:-1][corners]] *= CORNER_WEIGHT
        if not course.uniform:
            allowed = course.allowed(rows)
            row_weights /= (allowed / course.tightest) ** 2
        else:
            allowed = course.tightest
        if emphasis is not None:
            row_weights *= emphasis
        points = solve_window(knots, p, fixed, free, rows, targets, row_weights, weights)
        if weights is None:
            there = evaluate(knots, points, p, rows)
        else:
            there = evaluate(knots, homogeneous(points, weights), p, rows)
            there = there[:, :-1] / there[:, -1:]
        there -= targets
        ratios = np.sqrt(np.einsum("md,md->m", there, there)) / allowed
        worst = np.maximum.reduceat(ratios, firsts[:-1])
        worst = np.maximum(worst, ratios.take(firsts[1:]))
        return Trial(breakpoints, knots, points, weights, rows, ratios, firsts, worst)

    def _tried_at_once(
        self,
        breakpoints: Breakpoints,
        knots: Array,
        points: Array,
        free: slice,
        weights: Array | None,
        emphasis: Array | None,
    ) -> Trial:
        """Fit in the compiled core; ``points`` is filled in where free."""
        p, course, at = self.degree, self.course, breakpoints.at
        per_span = ROWS_PER_DEGREE * p + 1
        points = np.ascontiguousarray(points)
        rows, ratios = np.empty((2, most_rows(knots, course.row_t, per_span)))
        firsts, worst = np.empty(len(at), dtype=np.intp), np.empty(len(at) - 1)
        found = compiled.core.fit(
            knots,
            p,
            free.start,
            free.stop,
            weights,
            course.row_t,
            course.row_points,
            at,
            breakpoints.times,
            CORNER_WEIGHT,
            course.t,
            None if course.uniform else course.allowance,
            course.tightest,
            emphasis,
            per_span,
            points,
            rows,
            ratios,
            firsts,
            worst,
        )
        if found < 0:
            raise undetermined(len(rows), free.stop - free.start)
        return Trial(
            breakpoints, knots, points, weights, rows[:found], ratios[:found], firsts, worst
        )

    def proved(self, trial: Trial, splits: int = 1) -> Array:
        """Return the certified deviation on each chord of the course, (m,)."""
        weights, course = trial.weights, self.course
        rows = trial.points if weights is None else homogeneous(trial.points, weights)
        return spline_chord_deviation(
            trial.knots,
            rows,
            self.degree,
            course.t,
            course.points,
            rational=weights is not None,
            splits=splits,
            allowance=course.tightest if course.uniform else course.allowance,
        )
