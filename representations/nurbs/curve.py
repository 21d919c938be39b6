"""The NURBS value: degree, knots, control points, weights; immutable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.blocks import BlockArray
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.representations.nurbs import (
    changes,
    controls,
    elevation,
    ends,
    evaluation,
    holding,
    insertion,
    moving,
    removal,
)
from multirep.representations.nurbs.evaluation import (
    Side,
    homogeneous,
    settled_at_corners,
    window_points,
)
from multirep.representations.nurbs.validation import validated
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

#: Parameters that are farther apart than this many spans each are evaluated one by one: scipy walks
#: through all spans between them, 2.6 ns each, and one evaluation of its own costs 7 us.
SCATTERED = 2000


class Nurbs(Representation):
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

    degree: int
    _knots: BlockArray
    _points: BlockArray
    _weights: BlockArray | None
    _peaks: tuple[float, ...]

    def __init__(
        self,
        *,
        degree: int,
        knots: ArrayLike,
        points: ArrayLike,
        weights: ArrayLike | None = None,
    ) -> None:
        p, u, rows, w = validated(degree, knots, points, weights)
        self._set(
            p,
            BlockArray.of(u),
            BlockArray.of(rows),
            None if w is None else BlockArray.of(w),
            Interval(float(u[p]), float(u[len(rows)])),
            (),
        )

    def _set(
        self,
        degree: int,
        knots: BlockArray,
        points: BlockArray,
        weights: BlockArray | None,
        domain: Interval,
        peaks: tuple[tuple[int, float], ...],
    ) -> None:
        known = dict(peaks)
        found = tuple(
            known[id(block)] if id(block) in known else max(float(block.max()), -float(block.min()))
            for block in points.blocks
        )
        self.__dict__.update(
            degree=degree,
            domain=domain,
            dimension=points.shape[1],
            _knots=knots,
            _points=points,
            _weights=weights,
            _peaks=found,
        )

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a Nurbs is immutable; cannot set {name!r}")

    def _with(
        self,
        *,
        knots: BlockArray | None = None,
        points: BlockArray | None = None,
        weights: BlockArray | None = None,
        degree: int | None = None,
    ) -> Self:
        """Return a value with other arrays and the same domain; internal, nothing is checked."""
        new = type(self).__new__(type(self))
        new._set(
            self.degree if degree is None else degree,
            self._knots if knots is None else knots,
            self._points if points is None else points,
            self._weights if weights is None else weights,
            self.domain,
            tuple(zip(map(id, self._points.blocks), self._peaks, strict=True)),
        )
        return new

    # -- reading -------------------------------------------------------------------------------

    @property
    def knots(self) -> BlockArray:
        """The knot vector, (n + p + 1,)."""
        return self._knots

    @property
    def points(self) -> BlockArray:
        """The Euclidean control points, (n, d)."""
        return self._points

    @property
    def weights(self) -> BlockArray:
        """The weights, (n,); ones for a polynomial spline."""
        return controls.ones(len(self._points)) if self._weights is None else self._weights

    @property
    def is_rational(self) -> bool:
        """Whether weights are stored, that is, some weight is or was other than 1."""
        return self._weights is not None

    @property
    def size(self) -> int:
        """Number of control points."""
        return len(self._points)

    @property
    def magnitude(self) -> float:
        """Largest |coordinate| of a control point, so of the curve too (convex hull)."""
        return max(self._peaks)

    def span(self, t: float, side: Side = "right") -> int:
        """Return k with knots[k] <= t < knots[k + 1] (left: knots[k] < t <= knots[k + 1]).

        Never an empty span, nor one outside T; O(log n).
        """
        at = self._knots.searchsorted(t, side) - 1
        return min(max(at, self.degree), len(self._points) - 1)

    def __call__(self, t: ArrayLike) -> Array:
        """Points at parameters: scalar -> (d,), (m,) -> (m, d).

        Cost: about 8 us for one parameter whatever n; scipy's time for many.

        Raises
        ------
        ParameterError
            Outside T.
        """
        at = self.parameters(t)
        if at.ndim == 0:
            return self._evaluated(at[None], *self._window(float(at), float(at)))[0]
        shape = at.shape
        flat = at.ravel()
        if not len(flat):
            return np.empty((*shape, self.dimension))
        window = self._span_window(float(flat.min()), float(flat.max()))
        if window[1] - window[0] > SCATTERED * len(flat):
            values = np.concatenate(
                [self._evaluated(flat[i : i + 1], *self._window(s, s))
                 for i, s in enumerate(flat.tolist())]
            )
        else:
            values = self._evaluated(flat, *self._arrays(*window))
        return values if at.ndim == 1 else values.reshape(*shape, -1)

    def derivative(self, t: ArrayLike, order: int = 1, side: str = "right") -> Array:
        """Derivative by t of any order, from the right or the left; shapes as for calls.

        Raises
        ------
        ParameterError
            Outside T.
        EditError
            For a negative order or an unknown side.
        """
        if side not in ("left", "right"):
            raise EditError(f"the side must be 'left' or 'right', got {side!r}")
        if order < 0:
            raise EditError(f"the order of a derivative must be 0 or more, got {order!r}")
        at = self.parameters(t)
        flat = at.ravel()
        if not len(flat):
            return np.empty((*at.shape, self.dimension))
        which: Side = "left" if side == "left" else "right"
        first, last = self.span(float(flat.min()), which), self.span(float(flat.max()), which)
        values = evaluation.window_derivative(
            *self._arrays(first, last), self.degree, flat, int(order), which
        )
        return values.reshape(*at.shape, self.dimension)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Return a polyline over ``interval``, certified (`multirep.splines.sample_spline`).

        Its breaks are the interior knots of full multiplicity.

        Raises
        ------
        ToleranceError
            When the tolerance is below what rounding allows.
        """
        from multirep.splines import sample_spline

        start, stop = self.parameters([interval.start, interval.stop]).tolist()
        knots, points, weights = self._window(start, stop)
        rational = weights is not None and bool((weights != 1.0).any())
        rows = homogeneous(points, weights) if rational and weights is not None else points
        try:
            t, found, bounds = sample_spline(
                knots, rows, self.degree, start, stop, tolerance=tolerance, rational=rational
            )
        except ValueError as error:
            raise ToleranceError(str(error), tolerance=tolerance) from None
        full = knots[: len(knots) - self.degree + 1]
        full = full[(full == knots[self.degree - 1 :]) & (full > start) & (full < stop)]
        return SampledSplice(
            t,
            found,
            bound=float(bounds.max()),
            breaks=tuple(np.unique(full).tolist()),
            chord_bounds=bounds,
        )

    def _window(self, start: float, stop: float) -> tuple[Array, Array, Array | None]:
        """Knots, points and weights that the curve depends on between two parameters."""
        return self._arrays(*self._span_window(start, stop))

    def _span_window(self, start: float, stop: float) -> tuple[int, int]:
        first = self.span(start)
        return first, first if stop == start else self.span(stop)

    def _arrays(self, first: int, last: int) -> tuple[Array, Array, Array | None]:
        low = first - self.degree
        weights = self._weights
        return (
            self._knots.window(low, last + self.degree + 2),
            self._points.window(low, last + 1),
            None if weights is None else weights.window(low, last + 1),
        )

    def _evaluated(
        self, t: Array, knots: Array, points: Array, weights: Array | None
    ) -> Array:
        if len(t) == 1 and weights is None and len(points) == self.degree + 1:
            from scipy.interpolate import BSpline

            values: Array = BSpline.construct_fast(knots, points, self.degree)(t)
        else:
            values = window_points(knots, points, weights, self.degree, t)
        return settled_at_corners(values, knots, points, self.degree, t)

    # -- following a polyline -------------------------------------------------------------------

    @classmethod
    def fit(
        cls, sampled: SampledSplice, *, tolerance: float, degree: int | None = None
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

        Notes
        -----
        Linear in the samples; see `multirep.representations.nurbs.fitting`.
        """
        from multirep.representations.nurbs.fitting import fitted_arrays

        p = cls.default_degree if degree is None else degree
        knots, points = fitted_arrays(sampled, tolerance, p)
        new = cls.__new__(cls)
        new._set(
            p, BlockArray.of(knots), BlockArray.of(points), None, sampled.interval, ()
        )
        return new

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Follow ``sampled`` on its interval [a, b] and stay as it is elsewhere.

        The control points whose support lies in [a, b] are free, and so are the knots in it; all
        others are pinned. The joins at a and b are C^(p - 1), as smooth as knots there allow, unless
        the new course leaves at an angle that matters. Where a or b is an end of T, it is met
        exactly. Knots are added where the fit fails and removed where they are not needed.

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
            near = self._knots.window(max(last - p, p), last)
            near = near[near >= within.start]
            a = float(near[0]) if len(near) else a
        if b < self.domain.stop:
            first = self._knots.searchsorted(b, "left")
            near = self._knots.window(first, min(first + p, len(self._points) + 1))
            near = near[near <= within.stop]
            b = float(near[-1]) if len(near) else b
        return Interval(a, b)

    def held(
        self, interval: Interval, keep: SpliceList = SpliceList.EMPTY
    ) -> tuple[Edit[Self], Interval]:
        """Raise the ends to p-fold knots, so that the interval can stay bit by bit.

        See :meth:`Representation.held` and `multirep.representations.nurbs.holding`.
        """
        return holding.held(self, interval, keep)

    def released(self, t: float, count: int) -> Edit[Self]:
        """Remove the knot at ``t`` up to ``count`` times, as far as that is a matter of rounding."""
        return holding.released(self, t, count)

    def changes(self, other: Self) -> SpliceList:
        """Where this value and ``other`` may differ; O(changed blocks)."""
        if (
            self.degree != other.degree
            or self.domain != other.domain
            or self.dimension != other.dimension
        ):
            return SpliceList([self.domain.hull(other.domain)])
        rows = [(self._points, other._points)]
        if self._weights is not None or other._weights is not None:
            rows.append((self.weights, other.weights))
        return changes.difference(
            self.degree, self.domain, (self._knots, other._knots), tuple(rows)
        )

    # -- primitive operations -------------------------------------------------------------------

    def move_control_point(self, index: int, to: ArrayLike) -> Edit[Self]:
        """Move one control point; touches its support [u_i, u_(i+p+1)] (NURBS book 11.1).

        Raises
        ------
        EditError
            When there is no such control point, or ``to`` is not a finite point.
        """
        return controls.moved_control_points(self, index, [to])

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
        return insertion.knots_inserted(self, [t] * insertion.times_of(times))

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

    # -- as data --------------------------------------------------------------------------------

    def to_dict(self) -> dict[str, Any]:
        """Plain data with every digit: degree, knots, points, weights."""
        return {
            "degree": self.degree,
            "knots": self._knots.tolist(),
            "points": self._points.tolist(),
            "weights": self.weights.tolist(),
        }

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Read what `to_dict` wrote; ``weights`` may be missing.

        Raises
        ------
        InvalidCurveError
            When something is missing, unknown or wrong.
        """
        unknown = sorted(set(data) - {"degree", "knots", "points", "weights"})
        missing = sorted({"degree", "knots", "points"} - set(data))
        if unknown or missing:
            found = f"unknown {unknown}" if unknown else f"missing {missing}"
            raise InvalidCurveError(f"a NURBS has degree, knots, points and weights; {found}")
        return cls(**data)

    @classmethod
    def from_scipy(cls, spline: BSpline) -> Self:
        """Make a value of a `scipy.interpolate.BSpline` with coefficients (n,) or (n, d).

        Raises
        ------
        InvalidCurveError
            When it is no curve of ours (see the class).
        """
        degree = int(spline.k)
        knots = frozen_array(spline.t)
        rows = np.asarray(spline.c, dtype=np.float64)[: len(knots) - degree - 1]
        return cls(degree=degree, knots=knots, points=rows[:, None] if rows.ndim == 1 else rows)

    def to_scipy(self) -> BSpline:
        """Return a `scipy.interpolate.BSpline` of the control points.

        Raises
        ------
        EditError
            When the curve is rational: scipy has no rational splines.
        """
        from scipy.interpolate import BSpline

        if self._weights is not None and bool((np.asarray(self._weights) != 1.0).any()):
            raise EditError(
                "scipy has no rational splines; make BSplines of weights * points and of weights "
                "and divide"
            )
        return BSpline(np.asarray(self._knots), np.asarray(self._points), self.degree)

    def __repr__(self) -> str:
        kind = "rational" if self.is_rational else "polynomial"
        return (
            f"<{type(self).__name__} {self.name!r}: {kind} of degree {self.degree}, "
            f"{self.size} control points in {self.dimension}-D over {self.domain}>"
        )
