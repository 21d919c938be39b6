"""The curve passes a point at a parameter."""

from __future__ import annotations

from attrs import field, frozen

from multirep.constraints.condition import Condition
from multirep.constraints.linear import LinearConstraint
from multirep.fields import as_point, finite_number, finite_point
from multirep.representations.nurbs import Nurbs


@frozen
class PointConstraint(LinearConstraint):
    """The curve passes ``point`` at ``t`` (Grimm-Ayers 5.1.1, the base point constraint).

    Parameters
    ----------
    t : float
        Where on T.
    point : tuple of float
        What it passes there.

    Examples
    --------
    >>> from multirep.scene import Scene
    >>> from multirep.splices import SpliceList
    >>> line = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 0], [2, 0]])
    >>> edit = PointConstraint(t=0.5, point=(1, 1)).enforce(line, SpliceList([(0, 1)]), Scene())
    >>> edit.value(0.5), edit.value.points[1]
    (array([1., 1.]), array([1., 2.]))
    """

    name = "point"

    t: float = field(converter=float, validator=finite_number)
    """Where on T."""
    point: tuple[float, ...] = field(converter=as_point, validator=finite_point)
    """What the curve passes there."""

    def conditions(self, curve: Nurbs) -> tuple[Condition, ...]:
        """Return the one condition."""
        return (Condition(self.t, 0, self.point),)
