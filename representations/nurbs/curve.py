"""NURBS: the value and everything that can be done with it."""

from __future__ import annotations

from typing import Any, ClassVar, Self

import numpy as np

from multirep.arrays import ArrayLike
from multirep.blocks import BlockArray
from multirep.edit import Edit
from multirep.interval import Interval
from multirep.representations.nurbs import (
    controls,
    elevation,
    ends,
    holding,
    insertion,
    moving,
    removal,
)
from multirep.representations.nurbs.value import NurbsValue
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList


class Nurbs(NurbsValue):
    """A spline of any degree on any non-decreasing knots, polynomial or rational (Grimm-Ayers 6.2).

    Parameters
    ----------
    degree : int
        p >= 1 (the order minus one; Grimm and Ayers count one lower).
    knots : (n + p + 1,) array_like
        Non-decreasing. The domain T is [knots[p], knots[n]]; its ends may be knots up to p + 1
        times, all others up to p times.
    points : (n, d) array_like
        Euclidean control points.
    weights : (n,) array_like, optional
        Positive; all 1 is the same as none.

    Raises
    ------
    InvalidCurveError
        When the numbers describe no curve.

    Notes
    -----
    Knots, points and weights live in block arrays. Every operation below costs what the part that
    it changes costs, whatever n, and returns a new value that shares the rest. Each reports exactly
    the parameters it touches: elsewhere the curve evaluates to the same bits.

    Examples
    --------
    A quarter of a circle, exactly:

    >>> arc = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[1, 0], [1, 1], [0, 1]],
    ...             weights=[1, 0.5**0.5, 1])
    >>> np.linalg.norm(arc([0.0, 0.3, 0.9]), axis=1).round(15)
    array([1., 1., 1.])
    >>> edit = arc.move_control_point(1, [2, 2])
    >>> print(edit.splices)
    [0,1]
    """

    name = "nurbs"
    summary = "B-spline of any degree, rational or not, on any knots"
    #: Degree of a fit from nothing, unless it is asked for another.
    default_degree: ClassVar[int] = 3

    # -- following a polyline -------------------------------------------------------------------

    @classmethod
    def fit(
        cls,
        sampled: SampledSplice,
        *,
        tolerance: float,
        degree: int | None = None,
        **options: Any,
    ) -> Self:
        """Return a spline over T = ``sampled.interval`` within the allowance, with few knots.

        Parameters
        ----------
        sampled : SampledSplice
        tolerance : float, keyword-only
            Proved: ``||R(t) - L(t)|| <= sampled.allowance(tolerance)`` on each chord.
        degree : int, keyword-only, optional
            Default: ``default_degree`` of the class.

        Raises
        ------
        ToleranceError
            When that cannot be proved; it says what can.
        UnknownNameError
            For other options.

        Notes
        -----
        Linear in the samples; see `multirep.representations.nurbs.fitting`.
        """
        from multirep.representations.nurbs.fitting import fitted_arrays

        cls.check_options(options, ["degree"])
        p = cls.default_degree if degree is None else degree
        knots, points = fitted_arrays(sampled, tolerance, p)
        new = cls.__new__(cls)
        new._set(p, BlockArray.of(knots), BlockArray.of(points), None, sampled.interval)
        return new

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Follow ``sampled`` on its interval [a, b] and stay as it is elsewhere.

        The control points whose support lies in [a, b] are free, and so are the knots in it; all
        others are pinned. The joins at a and b are as smooth as the knots there allow (C^(p - 1)
        at new ones), unless the new course leaves at an angle that matters. Where a or b is an end
        of T, it is met exactly. Knots are added where the fit fails and removed where they are not
        needed.

        Returns
        -------
        Edit
            Its splices are [a, b] and, where knots beside a or b changed, the supports of the
            pinned control points that had to be expressed anew (the curve there is the same up to
            rounding). Its bound is the largest proved distance from L.

        Raises
        ------
        ToleranceError
            When this curve is farther from L at a or b than the allowance, or when the allowance
            is below rounding.

        Notes
        -----
        See `multirep.representations.nurbs.splicing`. The cost depends on the samples and on the
        knots in [a, b], not on n.
        """
        from multirep.representations.nurbs.splicing import spliced

        return spliced(self, sampled, tolerance)

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Prefer ends that are knots, p - 1 spans outside if there is room.

        From such ends a splice can leave the knots that the outside depends on as they are.
        """
        p, (a, b) = self.degree, interval
        if a > self.domain.start:
            last = self._knots.searchsorted(a, "right")
            near = self._knots.window(max(last - p, p), last).tolist()
            a = next((knot for knot in near if knot >= within.start), a)
        if b < self.domain.stop:
            first = self._knots.searchsorted(b, "left")
            near = self._knots.window(first, min(first + p, len(self._points) + 1)).tolist()
            b = next((knot for knot in reversed(near) if knot <= within.stop), b)
        return Interval(a, b)

    def held(
        self, interval: Interval, keep: SpliceList = SpliceList.EMPTY
    ) -> tuple[Edit[Self], Interval]:
        """Raise the ends to p-fold knots, so that the interval can stay bit by bit.

        See :meth:`Representation.held` and `multirep.representations.nurbs.holding`.
        """
        return holding.held(self, interval, keep)

    def released(self, t: float, count: int) -> Edit[Self]:
        """Remove the knot at ``t`` up to ``count`` times, if that is a matter of rounding."""
        return holding.released(self, t, count)

    # -- primitive operations -------------------------------------------------------------------

    def move_control_point(self, index: int, to: ArrayLike) -> Edit[Self]:
        """Move one control point; touches its support [u_i, u_(i+p+1)] (NURBS book 11.1).

        Raises
        ------
        EditError
            When there is no such control point, or ``to`` is not a finite point.
        """
        return controls.moved_control_points(self, index, np.asarray(to, dtype=np.float64)[None])

    def move_control_points(self, start: int, rows: ArrayLike) -> Edit[Self]:
        """Put ``rows`` (k, d) in place of control points start .. start + k - 1.

        Touches the supports of those that really change.

        Raises
        ------
        EditError
            When they do not exist, or the rows are not finite points.
        """
        return controls.moved_control_points(self, start, rows)

    def set_weight(self, index: int, weight: float) -> Edit[Self]:
        """Set one weight; touches [u_i, u_(i+p+1)] (NURBS book 11.18: points move along lines).

        Raises
        ------
        EditError
            When there is no such control point, or the weight is not positive and finite.
        """
        return controls.weight_set(self, index, weight)

    def insert_knot(self, t: float, times: int = 1) -> Edit[Self]:
        """Insert a knot; the curve stays the same up to rounding.

        Touches the supports of the control points that change.

        Raises
        ------
        EditError
            When ``t`` is not inside T, or would be a knot more than p times.
        """
        return insertion.knot_inserted(self, t, times)

    def insert_knots(self, knots: ArrayLike) -> Edit[Self]:
        """Insert many knots in one pass; repeat a value to insert it several times.

        Raises
        ------
        EditError
            When one is not inside T, or would be a knot more than p times.
        """
        return insertion.knots_inserted(self, knots)

    def remove_knot(self, t: float, *, tolerance: float, times: int = 1) -> Edit[Self]:
        """Remove a knot if the curve moves by no more than ``tolerance``, proved.

        Touches [u_(i-p), u_(i+p)] around each removed knot i. The edit's bound is what was proved.

        Raises
        ------
        EditError
            When ``t`` is no interior knot, or not so often.
        ToleranceError
            When the proved movement exceeds the tolerance; ``reachable`` says how large it is.
        """
        return removal.knot_removed(self, t, tolerance, insertion.times_of(times))

    def move_knot(self, index: int, to: float) -> Edit[Self]:
        """Move an interior knot between its neighbours; control points stay.

        Touches [u_(i-p), u_(i+p)] (Juhasz-Hoffmann section 2; Grimm-Ayers 6.2 say less).

        Raises
        ------
        EditError
            When the knot is not an interior one, or ``to`` lies outside the permissible region,
            which the message states.
        """
        return moving.knot_moved(self, index, to)

    def elevate_degree(self, times: int = 1) -> Edit[Self]:
        """Raise the degree; the curve stays the same up to rounding. Touches all of T: O(n).

        Raises
        ------
        EditError
            When the degree would become too high.
        """
        return elevation.elevated(self, insertion.times_of(times))

    def add_control_point(
        self, point: ArrayLike, *, end: str = "stop", weight: float = 1.0
    ) -> Edit[Self]:
        """Add a control point at an end of the curve; T stays (Grimm-Ayers 6.2).

        One knot is added in the middle of the last span of that end; nothing else moves. Touches
        the last p spans there (the paper says the last one only, but their basis functions change).

        Raises
        ------
        EditError
            When ``end`` is neither "start" nor "stop", or the point is not finite.
        """
        return ends.control_point_added(self, point, end, weight)

    def remove_control_point(self, *, end: str = "stop") -> Edit[Self]:
        """Remove the control point at an end, and the interior knot nearest to that end; T stays.

        Undoes `add_control_point`. Touches what were the last p + 1 spans there.

        Raises
        ------
        EditError
            When only p + 1 control points are left.
        """
        return ends.control_point_removed(self, end)
