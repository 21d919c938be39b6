"""Moving one vertex of the polyline."""

from __future__ import annotations

import operator

from attrs import field, frozen, validators

from multirep.aim import Aim
from multirep.edit import Edit
from multirep.fields import as_point, finite_point
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class MoveVertex(Tool[Polyline]):
    """Move one vertex; affected is the interval between its neighbours (Grimm-Ayers 6.1).

    Parameters
    ----------
    index : int
        Which vertex, counted from 0.
    to : tuple of float
        Where to.

    Examples
    --------
    >>> corner = Polyline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    >>> edit = MoveVertex(index=1, to=[1, 3]).edit(corner, Scene())
    >>> print(edit.splices, edit.value(1.0))
    [0,2] [1. 3.]
    """

    name = "move-vertex"
    edits = Polyline

    index: int = field(converter=operator.index, validator=validators.ge(0))
    """Which vertex, counted from 0."""
    to: tuple[float, ...] = field(converter=as_point, validator=finite_point)
    """Where to."""

    def aims(self, polyline: Polyline) -> tuple[Aim, ...]:
        """Return the vertex and its place, for constraints to heed or oppose."""
        if not 0 <= self.index < polyline.size or len(self.to) != polyline.dimension:
            return ()
        return (Aim(float(polyline.t[self.index]), self.to),)

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the polyline with the vertex moved; EditError when there is no such vertex."""
        return polyline.move_vertex(self.index, self.to)
