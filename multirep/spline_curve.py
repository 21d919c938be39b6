"""How a B-spline in block arrays is read: points, derivatives, nearest places."""

from __future__ import annotations

import abc

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.blocks import BlockArray
from multirep.capsules import Tree
from multirep.errors import EditError
from multirep.nearest import nearest_in_tree
from multirep.representation import Nearest, Representation
from multirep.splines import compiled
from multirep.splines.rational import Side, curve_derivative, curve_point, curve_points

__all__ = ["SplineCurve", "Window"]

#: Parameters that are farther apart than this many spans each are evaluated one by one: going
#: through the spans between them takes longer.
SCATTERED = 2000

#: Knots (n + p + 1,), control points (n, d), weights (n,) or None for ones.
Window = tuple[Array, Array, Array | None]


class SplineCurve(Representation):
    """A B-spline, rational or not, of any degree; what it stores is up to the subclass."""

    degree: int

    @abc.abstractmethod
    def span(self, t: float, side: Side = "right") -> int:
        """Return k with knots[k] <= t < knots[k + 1] (left: knots[k] < t <= knots[k + 1]).

        Never an empty span, nor one outside T; O(log n).
        """

    @abc.abstractmethod
    def _window(self, first: int, last: int) -> Window:
        """Return what the spans first..last depend on: a spline of its own; O(window)."""

    @abc.abstractmethod
    def _in_blocks(self) -> tuple[BlockArray, BlockArray, BlockArray | None] | None:
        """Return the arrays of which windows are cut; None if their knots are no parameters."""

    @abc.abstractmethod
    def _tree(self) -> Tree:
        """Return the tree of capsules around the pieces."""

    def __call__(self, t: ArrayLike) -> Array:
        """Points at parameters: scalar -> (d,), (m,) -> (m, d).

        Cost: with the compiled core a microsecond for one parameter, whatever n; in bulk a third of
        scipy's time or, where it must fetch a span for each parameter, about all of it.

        Raises
        ------
        ParameterError
            Outside T.
        """
        if isinstance(t, float) and self.domain.start <= t <= self.domain.stop:
            return self._point_at(t)
        at = self.parameters(t)
        if at.ndim == 0:
            return self._point_at(float(at))
        values = self._points_at(at.reshape(-1))
        return values if at.ndim == 1 else values.reshape(*at.shape, self.dimension)

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
        values = self._derivatives_at(
            at.reshape(-1), int(order), "left" if side == "left" else "right"
        )
        return values.reshape(*at.shape, self.dimension)

    def nearest(self, point: ArrayLike) -> Nearest:
        """Return the nearest place, or those of many points; see `Representation.nearest`."""
        return nearest_in_tree(self, self._tree, point)

    def _point_at(self, t: float) -> Array:
        found = self._by_core(t, np.empty(self.dimension)) if compiled.active else None
        if found is not None:
            return found
        span = self.span(t)
        return curve_point(*self._window(span, span), self.degree, t)

    def _points_at(self, t: Array) -> Array:
        count = len(t)
        if not count:
            return np.empty((0, self.dimension))
        found = self._by_core(t, np.empty((count, self.dimension))) if compiled.active else None
        if found is not None:
            return found
        first, last = self.span(float(t.min())), self.span(float(t.max()))
        if last - first > SCATTERED * count:
            return np.stack([self._point_at(s) for s in t.tolist()])
        return curve_points(*self._window(first, last), self.degree, t)

    def _by_core(self, t: float | Array, found: Array) -> Array | None:
        """Evaluate where the blocks are, if their knots are parameters; as windows, bit for bit."""
        stored = self._in_blocks()
        if stored is None:
            return None
        knots, points, weights = stored
        own = None if weights is None else weights.rope
        compiled.core.points(knots.rope, points.rope, own, self.degree, t, 0, False, True, found)
        return found

    def _derivatives_at(self, t: Array, order: int, side: Side) -> Array:
        if not len(t):
            return np.empty((0, self.dimension))
        first, last = self.span(float(t.min()), side), self.span(float(t.max()), side)
        if last - first > SCATTERED * len(t):
            parts = np.split(t, len(t))
            return np.concatenate([self._derivatives_at(part, order, side) for part in parts])
        return curve_derivative(*self._window(first, last), self.degree, t, order, side)
