"""The curve has a derivative at a parameter, on one side or on both."""

from __future__ import annotations

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.constraints.condition import Condition
from multirep.constraints.linear import LinearConstraint
from multirep.errors import EditError
from multirep.fields import as_point, finite_number, finite_point
from multirep.representations.nurbs import Nurbs


@frozen
class DerivativeConstraint(LinearConstraint):
    """The curve arrives at ``t`` with one derivative and leaves with another (Grimm-Ayers 5.1.1).

    With both sides equal the curve is smooth there. With one side alone, or two that differ, the
    knot at t gets full multiplicity, so that the other side need not follow: a corner.

    Parameters
    ----------
    t : float
        Where on T; at the ends of T only the side inside makes sense.
    left : tuple of float, optional
        Derivative by t from the left.
    right : tuple of float, optional
        Derivative by t from the right.

    Examples
    --------
    >>> from multirep.scene import Scene
    >>> from multirep.splices import SpliceList
    >>> line = Nurbs(degree=3, knots=[0, 0, 0, 0, 1, 1, 1, 1],
    ...              points=[[0, 0], [1, 0], [2, 0], [3, 0]])
    >>> up = DerivativeConstraint(t=0.5, left=(3, 0), right=(0, 3))
    >>> edit = up.enforce(line, SpliceList([(0, 1)]), Scene())
    >>> edit.value.derivative(0.5, side="left").round(9), edit.value.derivative(0.5).round(9)
    (array([3., 0.]), array([0., 3.]))
    """

    name = "derivative"

    t: float = field(converter=float, validator=finite_number)
    """Where on T."""
    left: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t from the left."""
    right: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t from the right."""

    def __attrs_post_init__(self) -> None:
        if self.left is None and self.right is None:
            raise ValueError("a derivative needs 'left' or 'right' or both")

    def conditions(self, curve: Nurbs) -> tuple[Condition, ...]:
        """Return a condition for each side."""
        return sides(self.t, self.left, self.right, curve, breaks=self.left != self.right)


def sides(
    t: float,
    left: tuple[float, ...] | None,
    right: tuple[float, ...] | None,
    curve: Nurbs,
    *,
    breaks: bool,
) -> tuple[Condition, ...]:
    """Conditions on one-sided derivatives; EditError for a side that lies outside T."""
    if left is not None and t == curve.domain.start:
        raise EditError(f"there is no curve to the left of t = {t!r}, where it begins")
    if right is not None and t == curve.domain.stop:
        raise EditError(f"there is no curve to the right of t = {t!r}, where it ends")
    found = []
    if left is not None:
        found.append(Condition(t, 1, left, "left", breaks))
    if right is not None:
        found.append(Condition(t, 1, right, "right", breaks))
    return tuple(found)
