"""A corner: the curve passes a point and may change its direction there."""

from __future__ import annotations

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.constraints.condition import Condition
from multirep.constraints.derivative import sides
from multirep.constraints.linear import LinearConstraint
from multirep.fields import as_point, finite_number, finite_point
from multirep.representations.nurbs import Nurbs


@frozen
class CornerConstraint(LinearConstraint):
    """The curve passes ``point`` at ``t``, arriving and leaving as told (Grimm-Ayers 5.1.1).

    The knot at t has full multiplicity in the NURBS; the other representations follow the corner
    within the tolerance.

    Parameters
    ----------
    t : float
        Where on T.
    point : tuple of float
        The base point.
    left : tuple of float, optional
        Derivative by t with which it arrives; free without it.
    right : tuple of float, optional
        Derivative by t with which it leaves; free without it.

    Examples
    --------
    >>> from multirep.scene import Scene
    >>> from multirep.splices import SpliceList
    >>> line = Nurbs(degree=3, knots=[0, 0, 0, 0, 1, 1, 1, 1],
    ...              points=[[0, 0], [1, 0], [2, 0], [3, 0]])
    >>> ear = CornerConstraint(t=0.5, point=(1.5, 1), left=(0, 4), right=(0, -4))
    >>> edit = ear.enforce(line, SpliceList([(0, 1)]), Scene())
    >>> edit.value(0.5), edit.value.derivative(0.5, side="left").round(9)
    (array([1.5, 1. ]), array([0., 4.]))
    """

    name = "corner"

    t: float = field(converter=float, validator=finite_number)
    """Where on T."""
    point: tuple[float, ...] = field(converter=as_point, validator=finite_point)
    """The base point."""
    left: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t with which it arrives; free without it."""
    right: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t with which it leaves; free without it."""

    def conditions(self, curve: Nurbs) -> tuple[Condition, ...]:
        """Return the point and the derivatives that are given."""
        left = sides(self.t, self.left, None, curve, breaks=True)
        right = sides(self.t, None, self.right, curve, breaks=True)
        return (*left, Condition(self.t, 0, self.point, breaks=True), *right)
