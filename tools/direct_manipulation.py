"""Pulling a point of a NURBS to another place by the smallest change of control points."""

from __future__ import annotations

import operator

import numpy as np
from attrs import converters, field, frozen, validators

from multirep.arrays import Array, Flags
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_point, finite_point
from multirep.place import PlacedTool
from multirep.representations.nurbs import Nurbs
from multirep.representations.nurbs.borders import acts_on, bends_at, halfway_knots
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.splines import basis_functions

#: Control points that all have less influence than this are not moved: they would have to move by
#: a million times as much as the point that is pulled.
SMALLEST_INFLUENCE = 1e-6
#: Beside a frozen stretch, knots are inserted until some free control point has this influence:
#: they move by twenty times as much as the point at most.
ENOUGH_INFLUENCE = 0.05
#: How often they are inserted, each time halving the spans around the point.
REFINEMENTS = 6


@frozen
class DirectManipulation(PlacedTool[Nurbs]):
    """Move the point C(t) of the curve to a given place (Bartels-Beatty 1989).

    Of all changes of the chosen control points that bring C(t) there, it makes the one whose
    squares sum to the least: control point i moves by R_i(t) / sum R_j(t)^2 of the way, where R is
    the rational basis (eqs. e 4 and e 6, section 3; their recursion for B-splines has the second
    numerator reversed). Beside a frozen stretch only control points move that do not bend the curve
    at its border; knots are inserted around the point where there are none.

    Parameters
    ----------
    t : float, optional
        Which point of the curve. Either this or ``at``.
    at : tuple of float, optional
        The point of the curve nearest to this.
    to : tuple of float
        Where it is pulled to; hit up to rounding.
    hold_ends : bool
        Whether the first and the last control point stay, and so the ends of the curve.
    control_points : int, optional
        How many control points move, from 1 to degree + 1: those with the most influence on C(t).
        Fewer keep the change more local. Default: all that have any.

    Examples
    --------
    >>> line = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 0], [2, 0]])
    >>> edit = DirectManipulation(t=0.5, to=[1, 1]).edit(line, Scene())
    >>> edit.value(0.5), edit.value.points[1]
    (array([1., 1.]), array([1., 2.]))
    """

    name = "direct-manipulation"
    edits = Nurbs

    to: tuple[float, ...] = field(kw_only=True, converter=as_point, validator=finite_point)
    """Where it is pulled to."""
    hold_ends: bool = field(default=True, validator=validators.instance_of(bool))
    """Whether the first and the last control point stay."""
    control_points: int | None = field(
        default=None,
        converter=converters.optional(operator.index),
        validator=validators.optional(validators.ge(1)),
    )
    """How many control points move; default all that matter."""

    def edit(self, nurbs: Nurbs, scene: Scene) -> Edit[Nurbs]:
        """Return the curve that passes through ``to`` at t.

        Raises
        ------
        EditError
            When nothing is left to move, or the parameters make no sense for this curve.
        """
        p = nurbs.degree
        if len(self.to) != nurbs.dimension:
            raise EditError(
                f"the curve has {nurbs.dimension} coordinates, 'to' has {len(self.to)}: {self.to}"
            )
        if self.control_points is not None and self.control_points > p + 1:
            raise EditError(
                f"at most {p + 1} control points matter at one point of a curve of degree {p}; "
                f"cannot move {self.control_points}"
            )
        t = self.place(nurbs)
        if scene.frozen and not scene.frozen.contains(t):  # else the framework says who froze it
            return self._beside_ice(nurbs, t, scene.frozen)
        first, influence = self._influence(nurbs, t, np.ones(p + 1, dtype=bool))
        return self._pulled(nurbs, t, first, influence)

    def _influence(self, nurbs: Nurbs, t: float, free: Flags) -> tuple[int, Array]:
        """Return the first of the p + 1 control points that act at t, and their shares."""
        p = nurbs.degree
        first = nurbs.span(t) - p
        influence = rational_basis(nurbs, t) * free
        if self.hold_ends:
            if first == 0:
                influence[0] = 0.0
            if first + p == nurbs.size - 1:
                influence[p] = 0.0
        if self.control_points is not None:
            least = np.argsort(influence, kind="stable")[: p + 1 - self.control_points]
            influence[least] = 0.0
        return first, influence

    def _pulled(self, nurbs: Nurbs, t: float, first: int, influence: Array) -> Edit[Nurbs]:
        if not influence.max() > SMALLEST_INFLUENCE:
            raise EditError(
                f"nothing is left to move at t = {t!r}: only control points that are held have "
                "influence there; let go of them with hold_ends = false"
            )
        rows = nurbs.points[first : first + len(influence)]
        way = np.asarray(self.to) - nurbs(t)
        share = influence / (influence @ influence)
        return nurbs.move_control_points(first, rows + share[:, None] * way)

    def _beside_ice(self, nurbs: Nurbs, t: float, frozen: SpliceList) -> Edit[Nurbs]:
        """Move what is free; it had better not bend the curve at the border of a frozen stretch.

        Where only that would be left, knots are inserted around t, halving the spans, a few times.
        """
        count = nurbs.degree + 1
        curve, splices = nurbs, SpliceList.EMPTY
        for _ in range(REFINEMENTS):
            first = curve.span(t) - curve.degree
            free = ~acts_on(curve, first, count, frozen)
            gentle = free & ~bends_at(curve, first, count, frozen)
            first, influence = self._influence(curve, t, gentle)
            knots = halfway_knots(curve, [t], frozen)
            if influence.max() > ENOUGH_INFLUENCE or not knots:
                break
            edit = curve.insert_knots(knots)
            curve, splices = edit.value, splices | edit.splices
        else:
            curve, splices = nurbs, SpliceList.EMPTY
            first = curve.span(t) - curve.degree
            first, influence = self._influence(curve, t, ~acts_on(curve, first, count, frozen))
        edit = self._pulled(curve, t, first, influence)
        return Edit(edit.value, splices | edit.splices)


def rational_basis(nurbs: Nurbs, t: float) -> Array:
    """Evaluate the p + 1 rational basis functions that do not vanish at t; they sum to 1."""
    p = nurbs.degree
    first = nurbs.span(t) - p
    knots = nurbs.knots[first : first + 2 * p + 2]
    values: Array = basis_functions(knots, p, np.array([t]), np.array([p]))[0].copy()
    if nurbs.is_rational:
        values *= nurbs.weights[first : first + p + 1]
        values /= values.sum()
    return values
