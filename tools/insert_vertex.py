"""Inserting a vertex into the polyline."""

from __future__ import annotations

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.edit import Edit
from multirep.fields import as_point, finite_number, finite_point
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class InsertVertex(Tool[Polyline]):
    """Insert a vertex, on the curve or beside it; affected is the segment that it divides.

    Parameters
    ----------
    t : float
        Its parameter, unlike that of any other vertex.
    to : tuple of float, optional
        Its place; by default on the curve.

    Examples
    --------
    >>> line = Polyline([0, 1], [[0, 0], [2, 0]])
    >>> InsertVertex(t=0.25).edit(line, Scene()).value.points[1]
    array([0.5, 0. ])
    >>> InsertVertex(t=0.25, to=[1, 1]).edit(line, Scene()).value.size
    3
    """

    name = "insert-vertex"
    edits = Polyline

    t: float = field(converter=float, validator=finite_number)
    """Its parameter, unlike that of any other vertex."""
    to: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Its place; by default on the curve."""

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the polyline with one more vertex.

        Raises
        ------
        ParameterError
            When ``t`` lies outside the domain.
        EditError
            When there is a vertex at ``t`` already.
        """
        return polyline.insert_vertex(self.t, self.to)
