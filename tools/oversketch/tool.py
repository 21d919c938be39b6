"""Sketching over a part of the curve."""

from __future__ import annotations

from typing import Literal

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_points, finite_points
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.strokes.blending import Join
from multirep.strokes.cleaning import clean_stroke
from multirep.strokes.options import length, length_or_zero
from multirep.tool import Tool
from multirep.tools.oversketch.filling import fill
from multirep.tools.oversketch.gap import find_gaps


@frozen
class Oversketch(Tool[Polyline]):
    """Draw a part of the curve anew: a stroke replaces the stretch between the places of its ends.

    The stretch runs between the places of the curve that are nearest to the ends of the stroke, in
    whichever direction that was drawn. Outside it nothing changes. A stroke that begins or ends
    beside an end of the curve, or beyond it, replaces everything up to that end, and the curve then
    ends where the stroke does: begun on the curve and drawn out beyond its end, it extends the
    curve. An open curve stays open, also where its ends meet; a stroke across that place is parted
    there and replaces a stretch at either end.

    Parameters
    ----------
    stroke : tuple of points
        Where the pen went, one row a sample.
    join : {"G1", "C0", "C2"}
        How it joins: in one place ("C0", a corner may remain), in one direction as well ("G1"), or
        with the first and second derivative by t ("C2").
    parameters : {"redistribute", "keep"}
        Whether the parameters of the stretch follow the length of the stroke, or keep the share of
        the length that each had, with a vertex at each.
    apron : float, optional
        Length of stroke over which either end is bent towards its join; the rest keeps its shape.
        By default a tenth of the stroke, or eight times the distance of that end from the curve if
        that is longer; never more than a third.
    reach : float, optional
        How far the ends of the stroke may be from the curve; by default a quarter of its length.
    noise : float, optional
        How much samples scatter (standard deviation of each coordinate); 0 keeps every sample. By
        default estimated.
    straight : bool
        Whether samples are joined by straight lines; by default a smooth curve goes through them,
        from corner to corner.

    Examples
    --------
    >>> line = Polyline([0, 1, 2, 3, 4], [[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])
    >>> bump = Oversketch(stroke=[[3, 0], [2, 1], [1, 0]], join="C0").edit(line, Scene())
    >>> print(bump.splices, bump.value(2.0))
    [1,3] [2. 1.]
    """

    name = "oversketch"
    edits = Polyline

    stroke: tuple[tuple[float, ...], ...] = field(converter=as_points, validator=finite_points)
    """Where the pen went, one row a sample."""
    join: Join = field(default="G1", kw_only=True, validator=validators.in_(("C0", "G1", "C2")))
    """How it joins: "C0", "G1" or "C2"."""
    parameters: Literal["redistribute", "keep"] = field(
        default="redistribute", kw_only=True, validator=validators.in_(("redistribute", "keep"))
    )
    """Whether the parameters of the stretch are redistributed or kept."""
    apron: float | None = field(
        default=None,
        kw_only=True,
        converter=optional(float),
        validator=validators.optional(length),
    )
    """Length of stroke over which either end is bent towards its join."""
    reach: float | None = field(
        default=None,
        kw_only=True,
        converter=optional(float),
        validator=validators.optional(length_or_zero),
    )
    """How far the ends of the stroke may be from the curve."""
    noise: float | None = field(
        default=None,
        kw_only=True,
        converter=optional(float),
        validator=validators.optional(length_or_zero),
    )
    """How much samples scatter; by default estimated."""
    straight: bool = field(default=False, kw_only=True, validator=validators.instance_of(bool))
    """Whether samples are joined by straight lines."""

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the polyline with the stretch replaced.

        The splice is the stretch, up to the next vertices outside where it begins or ends between
        two. Cost: O(stroke + stretch + blocks of the curve).

        Raises
        ------
        InvalidCurveError
            When the stroke is no curve: all in one place.
        EditError
            When it is far from the curve (says how far, and what is allowed), when both its ends
            mean one place of the curve, or when it has another number of coordinates.
        """
        drawn = clean_stroke(self.stroke, noise=self.noise, straight=self.straight).points
        if drawn.shape[1] != polyline.dimension:
            raise EditError(
                f"the stroke has {drawn.shape[1]} coordinates, the curve {polyline.dimension}"
            )
        value, splices = polyline, SpliceList.EMPTY
        for gap, part in find_gaps(polyline, drawn, self.reach):
            edit = fill(
                value,
                gap,
                part,
                join=self.join,
                keep=self.parameters == "keep",
                apron=self.apron,
            )
            value, splices = edit.value, splices | edit.splices
        return Edit(value, splices)
