"""Moving one control point of a NURBS."""

from __future__ import annotations

import operator

from attrs import field, frozen, validators

from multirep.edit import Edit
from multirep.fields import as_point, finite_point
from multirep.representations.nurbs import Nurbs
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class MoveControlPoint(Tool[Nurbs]):
    """Move one control point; affected is the support of its basis function (Grimm-Ayers 6.2).

    All points of the curve in the support move in the same direction (NURBS book eq. 11.1).

    Parameters
    ----------
    index : int
        Which control point, counted from 0.
    to : tuple of float
        Where to.

    Examples
    --------
    >>> line = Nurbs(degree=1, knots=[0, 0, 1, 2, 2], points=[[0, 0], [1, 1], [2, 0]])
    >>> edit = MoveControlPoint(index=0, to=[0, 3]).edit(line, Scene())
    >>> print(edit.splices, edit.value(0.0))
    [0,1] [0. 3.]
    """

    name = "move-control-point"
    edits = Nurbs

    index: int = field(converter=operator.index, validator=validators.ge(0))
    """Which control point, counted from 0."""
    to: tuple[float, ...] = field(converter=as_point, validator=finite_point)
    """Where to."""

    def edit(self, nurbs: Nurbs, scene: Scene) -> Edit[Nurbs]:
        """Return the curve with the control point moved; EditError when there is no such one."""
        return nurbs.move_control_point(self.index, self.to)
