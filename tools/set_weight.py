"""Setting one weight of a NURBS."""

from __future__ import annotations

import operator

from attrs import field, frozen, validators

from multirep.edit import Edit
from multirep.fields import finite_number
from multirep.representations.nurbs import Nurbs
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class SetWeight(Tool[Nurbs]):
    """Set one weight: a larger one pulls the curve towards its control point.

    Every point of the curve in the support moves on the line through the control point (NURBS book
    eqs. 11.18-11.20). A polynomial curve becomes rational; it stays bit-identical elsewhere.

    Parameters
    ----------
    index : int
        Which control point, counted from 0.
    weight : float
        Its new weight, positive.

    Examples
    --------
    >>> arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    >>> SetWeight(index=1, weight=3).edit(arch, Scene()).value(0.5)
    array([1.  , 0.75])
    """

    name = "set-weight"
    edits = Nurbs

    index: int = field(converter=operator.index, validator=validators.ge(0))
    """Which control point, counted from 0."""
    weight: float = field(converter=float, validator=[finite_number, validators.gt(0)])
    """Its new weight, positive."""

    def edit(self, nurbs: Nurbs, scene: Scene) -> Edit[Nurbs]:
        """Return the curve with the weight; EditError when there is no such control point."""
        return nurbs.set_weight(self.index, self.weight)
