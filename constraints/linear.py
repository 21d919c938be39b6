"""Constraints that are linear in the control points of the NURBS: one family, solved together."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from typing import Any, ClassVar

from multirep.constraint import Constraint
from multirep.constraints.condition import Condition, Rows
from multirep.constraints.solving import solved
from multirep.edit import Edit
from multirep.interval import Interval
from multirep.representations.nurbs import Nurbs
from multirep.scene import Scene
from multirep.splices import SpliceList


class LinearConstraint(Constraint[Nurbs]):
    """Base of the constraints that say what the curve shall do at single parameters.

    A subclass is a frozen attrs class that sets ``name`` and overrides :meth:`conditions`. Where
    the claims of several overlap, all their conditions are met in one solve, with the smallest
    change of the control points (NURBS book 11.5.1); see :mod:`multirep.constraints.solving`.

    Examples
    --------
    >>> import attrs
    >>> @attrs.frozen
    ... class Still(LinearConstraint):
    ...     name = "still"
    ...     t: float
    ...     def conditions(self, curve: Nurbs) -> tuple[Condition, ...]:
    ...         return (Condition(self.t, 1, (0.0,) * curve.dimension),)
    >>> line = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 0], [2, 0]])
    >>> edit = Still(0.5).enforce(line, SpliceList([line.domain]), Scene())
    >>> edit.value.derivative(0.5).round(12)
    array([0., 0.])
    """

    __slots__ = ()

    needs = Nurbs
    family: ClassVar[str | None] = "linear"

    @abc.abstractmethod
    def conditions(self, curve: Nurbs, /) -> tuple[Condition, ...]:
        """Return what the curve shall do, in the order of t; one condition or more."""

    def region(self, curve: Nurbs) -> Interval:
        """Return the supports of the control points that act at the parameters."""
        p, domain = curve.degree, curve.domain
        conditions = self.conditions(curve)
        curve.parameters([condition.t for condition in conditions])
        low = curve.span(conditions[0].t, "left") - p
        high = curve.span(conditions[-1].t) + p + 1
        start, stop = float(curve.knots[low]), float(curve.knots[high])
        return Interval(max(start, domain.start), min(stop, domain.stop))

    def residual(self, curve: Nurbs) -> float:
        """Return the largest miss, for a derivative times the length of the span beside."""
        return float(Rows.of(curve, self.conditions(curve)).missed.max())

    def enforce(self, curve: Nurbs, change: SpliceList, scene: Scene) -> Edit[Nurbs]:
        """Meet the conditions of this one alone."""
        return self.enforce_together({self.name: self}, curve, change, scene)

    @classmethod
    def enforce_together(
        cls, group: Mapping[str, Constraint[Any]], curve: Nurbs, change: SpliceList, scene: Scene
    ) -> Edit[Nurbs]:
        """Meet the conditions of the whole group in one solve.

        Raises
        ------
        ConflictError
            When they cannot all be met; it names those that exclude each other.
        FrozenError
            When one lies in a frozen stretch.
        """
        named = [
            (name, condition)
            for name, constraint in group.items()
            if isinstance(constraint, LinearConstraint)
            for condition in constraint.conditions(curve)
        ]
        return solved(curve, named, scene)
