"""What a NURBS stores, and how it is read: immutable arrays, points, derivatives, samples, data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self

import numpy as np

from multirep.arrays import ArrayLike, frozen_array
from multirep.blocks import BlockArray
from multirep.capsules import Known, Tree
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.patches import patch_of, patched
from multirep.representations.nurbs import changes, controls
from multirep.representations.nurbs.sizes import Sizes, sizes_of
from multirep.representations.nurbs.validation import validated
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.spline_curve import SplineCurve, Window
from multirep.spline_tree import spline_tree
from multirep.splines.rational import Side, homogeneous

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


class NurbsValue(SplineCurve):
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
        new = object.__new__(type(self))
        state: dict[str, Any] = vars(new)
        state.update(self.__dict__)
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
        """Return the knot span that a parameter lies in, one that is not empty; O(log n)."""
        at = self._knots.searchsorted(t, side) - 1
        return min(max(at, self.degree), len(self._points) - 1)

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
        knots, points, weights = self._window(self.span(start), self.span(stop))
        rational = weights is not None and bool((weights != 1.0).any())
        rows = homogeneous(points, weights) if rational and weights is not None else points
        try:
            t, found, bounds = sample_spline(
                knots, rows, self.degree, start, stop, tolerance=tolerance, rational=rational
            )
        except ValueError as error:
            raise ToleranceError(str(error), tolerance=tolerance) from None
        last = len(knots) - self.degree + 1
        full = knots[:last][knots[:last] == knots[self.degree - 1 :]]
        if len(full):
            full = np.unique(full[(full > start) & (full < stop)])
        return SampledSplice.unchecked(
            t,
            found,
            bound=float(bounds.max()),
            breaks=tuple(full.tolist()),
            chord_bounds=bounds,
        )

    def _window(self, first: int, last: int) -> Window:
        low = first - self.degree
        weights = self._weights
        return (
            self._knots.window(low, last + self.degree + 2),
            self._points.window(low, last + 1),
            None if weights is None else weights.window(low, last + 1),
        )

    def _in_blocks(self) -> tuple[BlockArray, BlockArray, BlockArray | None]:
        return self._knots, self._points, self._weights

    def _tree(self) -> Tree:
        return spline_tree(self._known, self.degree, *self._in_blocks())

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

    def patched(self, patch: bytes) -> tuple[Self, bytes | None]:
        """Return the value that gave ``patch`` beside this one; O(control points in the patch)."""
        (knots, points, *weights), back = patched(self._stored, patch)
        value = self._with(knots=knots, points=points, weights=weights[0] if weights else None)
        return value, back

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
