"""What a NURBS stores, and how it is read: immutable arrays, points, derivatives, samples, data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.blocks import BlockArray
from multirep.capsules import Known
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.nearest import nearest_in_tree
from multirep.patches import patch_of, patched
from multirep.representation import Nearest, Representation
from multirep.representations.nurbs import changes, controls, evaluation
from multirep.representations.nurbs.evaluation import (
    Side,
    homogeneous,
    settled_at_corners,
    window_points,
)
from multirep.representations.nurbs.proximity import tree
from multirep.representations.nurbs.sizes import Sizes, sizes_of
from multirep.representations.nurbs.validation import validated
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

#: Parameters that are farther apart than this many spans each are evaluated one by one: scipy walks
#: through all spans between them, 2.6 ns each, and one evaluation of its own costs 7 us.
SCATTERED = 2000


class NurbsValue(Representation):
    """Degree, knots, control points and weights of a NURBS; see :class:`Nurbs` for all of it."""

    degree: int
    _knots: BlockArray
    _points: BlockArray
    _weights: BlockArray | None
    _sizes: Sizes | None
    _known: Known

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
        )

    def _set(
        self,
        degree: int,
        knots: BlockArray,
        points: BlockArray,
        weights: BlockArray | None,
        domain: Interval,
        sizes: Sizes | None = None,
        known: Known | None = None,
    ) -> None:
        vars(self).update(
            degree=degree,
            domain=domain,
            dimension=points.shape[1],
            _knots=knots,
            _points=points,
            _weights=weights,
            _sizes=sizes,
            _known=Known() if known is None else known,
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
        state = vars(new)
        state.update(vars(self))
        if degree is not None:
            state["degree"] = degree
        if knots is not None:
            state["_knots"] = knots
        if points is not None:
            state["_points"] = points
        if weights is not None:
            state["_weights"] = weights
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
        """Largest |coordinate| of a control point, so of the curve too; O(changed blocks)."""
        sizes = sizes_of(self._points, self._sizes)
        vars(self)["_sizes"] = sizes  # a cache: the value stays what it is
        return max(sizes.wholes)

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
        if isinstance(t, float) and self.domain.start <= t <= self.domain.stop:
            return self._point(t)
        at = self.parameters(t)
        if at.ndim == 0:
            return self._point(float(at))
        shape = at.shape
        flat = at.ravel()
        if not len(flat):
            return np.empty((*shape, self.dimension))
        window = self._span_window(float(flat.min()), float(flat.max()))
        if window[1] - window[0] > SCATTERED * len(flat):
            values = np.stack([self._point(s) for s in flat.tolist()])
        else:
            values = self._evaluated(flat, *self._arrays(*window))
        return values if at.ndim == 1 else values.reshape(*shape, -1)

    def derivative(self, t: ArrayLike, order: int = 1, side: str = "right") -> Array:
        """Differentiate by t, to any order, from the right or the left; shapes as for calls.

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

        start, stop = self.ends(interval)
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
        return SampledSplice.unchecked(
            t,
            found,
            bound=float(bounds.max()),
            breaks=tuple(np.unique(full).tolist()) if len(full) else (),
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

    def _point(self, t: float) -> Array:
        """Evaluate one parameter, as `window_points` would, with little around it."""
        p, points, weights = self.degree, self._points, self._weights
        first = min(max(self._knots.searchsorted(t, "right") - 1, p), len(points) - 1)
        low = first - p
        knots, rows = self._knots.window(low, first + p + 2), points.window(low, first + 1)
        if t == knots[p] and t == knots[1]:
            return np.array(rows[0])
        if t == knots[p + 1] and t == knots[2 * p]:
            return np.array(rows[p])
        from scipy.interpolate import BSpline

        if weights is not None:
            w = weights.window(low, first + 1)
            if w.tolist().count(1.0) <= p:
                found = BSpline.construct_fast(knots, homogeneous(rows, w), p)(t)
                return np.asarray(found[:-1] / found[-1])
        found = BSpline.construct_fast(knots, rows, p)(t)
        return np.asarray(found)

    def _evaluated(self, t: Array, knots: Array, points: Array, weights: Array | None) -> Array:
        values = window_points(knots, points, weights, self.degree, t)
        return settled_at_corners(values, knots, points, self.degree, t)

    def nearest(self, point: ArrayLike) -> Nearest:
        """Return the nearest place, or those of many points; see `Representation.nearest`."""
        return nearest_in_tree(self, lambda: tree(self), point)

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

    def patch(self, other: Self) -> bytes | None:
        """Return what makes this value of ``other``; see `Representation.patch`."""
        mine, theirs = self._stored, other._stored
        if self.degree != other.degree or self.domain != other.domain or len(mine) != len(theirs):
            return None
        return patch_of(mine, theirs)

    def patched(self, patch: bytes) -> Self:
        """Return the value that gave ``patch`` beside this one; O(control points in the patch)."""
        knots, points, *weights = patched(self._stored, patch)
        return self._with(knots=knots, points=points, weights=weights[0] if weights else None)

    @property
    def _stored(self) -> tuple[BlockArray, ...]:
        """Knots, points, and weights if there are any."""
        some = self._knots, self._points
        return some if self._weights is None else (*some, self._weights)

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
