"""Inserting a knot into a NURBS."""

from __future__ import annotations

import operator

from attrs import field, frozen, validators

from multirep.edit import Edit
from multirep.fields import finite_number
from multirep.representations.nurbs import Nurbs
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class InsertKnot(Tool[Nurbs]):
    """Insert a knot: more control points in one place, the same curve (Grimm-Ayers 6.2, refining).

    Parameters
    ----------
    t : float
        Where, inside the domain.
    times : int
        How often; a knot may stand in one place as often as the degree says.

    Examples
    --------
    >>> arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    >>> edit = InsertKnot(t=0.5).edit(arch, Scene())
    >>> print(edit.value.size, edit.splices, edit.value(0.5))
    4 [0,1] [1.  0.5]
    """

    name = "insert-knot"
    edits = Nurbs

    t: float = field(converter=float, validator=finite_number)
    """Where, inside the domain."""
    times: int = field(default=1, converter=operator.index, validator=validators.ge(1))
    """How often."""

    def edit(self, nurbs: Nurbs, scene: Scene) -> Edit[Nurbs]:
        """Return the same curve with the knot; EditError when it cannot stand there so often."""
        return nurbs.insert_knot(self.t, self.times)
