"""Deleting a vertex of the polyline."""

from __future__ import annotations

import operator

from attrs import field, frozen, validators

from multirep.aim import Aim
from multirep.edit import Edit
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class DeleteVertex(Tool[Polyline]):
    """Delete a vertex, but not an end of the curve; affected is the interval of its neighbours.

    Parameters
    ----------
    index : int
        Which vertex, counted from 0.

    Examples
    --------
    >>> corner = Polyline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    >>> DeleteVertex(index=1).edit(corner, Scene()).value(1.0)
    array([1., 0.])
    """

    name = "delete-vertex"
    edits = Polyline

    index: int = field(converter=operator.index, validator=validators.ge(0))
    """Which vertex, counted from 0."""

    def aims(self, polyline: Polyline) -> tuple[Aim, ...]:
        """Return where the vertex is: it is not deleted from a frozen border either."""
        inside = 0 <= self.index < polyline.size
        return (Aim(float(polyline.t[self.index])),) if inside else ()

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the polyline without the vertex; EditError for an end of the curve."""
        return polyline.delete_vertex(self.index)
