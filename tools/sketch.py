"""Sketching: strokes become the curve (Grimm-Ayers 2.2.3)."""

from __future__ import annotations

from typing import Any

from attrs import Attribute, field, frozen, validators
from attrs.converters import optional

from multirep.arrays import ArrayLike
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_points, finite_points
from multirep.representations.polyline import Polyline, chord_length
from multirep.scene import Scene
from multirep.strokes.cleaning import CORNER_ANGLE
from multirep.strokes.from_strokes import sketched
from multirep.strokes.options import length, length_or_zero
from multirep.tool import Tool


def _as_strokes(strokes: ArrayLike) -> tuple[tuple[tuple[float, ...], ...], ...]:
    """Convert a sequence of strokes; what is none is left for the validator to name."""
    try:
        return tuple(as_points(stroke) for stroke in strokes)  # type: ignore[union-attr]
    except TypeError:
        return strokes  # type: ignore[return-value]  # the validator names the field


def _finite_strokes(instance: object, attribute: Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a non-empty tuple of strokes."""
    if not isinstance(value, tuple) or not value:
        raise ValueError(f"{attribute.name!r} must be a list of one stroke or more: {value!r}")
    for stroke in value:
        finite_points(instance, attribute, stroke)


@frozen
class Sketch(Tool[Polyline]):
    """Draw the curve anew: a stroke, or the mean of several over each other, becomes all of it.

    The noise of the pen is removed and corners stay; parameters follow the chord length over the
    same domain. Strokes may be drawn in any direction. A later one that covers only a part of
    those before refines that part, one that goes beyond an end extends it, and each counts once.

    Parameters
    ----------
    stroke : tuple of points
        Where the pen went, one row a sample; or else
    strokes : tuple of strokes
        several of them, over each other.
    noise : float, optional
        How much samples scatter (standard deviation of each coordinate); 0 keeps every sample. By
        default estimated from the stroke.
    corner_angle : float
        Turns from so many degrees on are corners.
    corner_window : float, optional
        Length of stroke on either side by which a corner is judged; by default as short as the
        noise allows.
    straight : bool
        Whether samples are joined by straight lines; by default a smooth curve goes through them,
        from corner to corner.

    Examples
    --------
    >>> line = Polyline([0, 2], [[0, 0], [1, 0]])
    >>> edit = Sketch(stroke=[[0, 0], [0, 3], [0, 3], [4, 3]]).edit(line, Scene())
    >>> print(edit.splices, edit.value.t, edit.value(2.0))
    [0,2] BlockArray(shape=(3,), blocks=1) [4. 3.]
    """

    name = "sketch"
    edits = Polyline

    stroke: tuple[tuple[float, ...], ...] | None = field(
        default=None, converter=optional(as_points), validator=validators.optional(finite_points)
    )
    """Where the pen went, one row a sample."""
    strokes: tuple[tuple[tuple[float, ...], ...], ...] | None = field(
        default=None,
        kw_only=True,
        converter=optional(_as_strokes),
        validator=validators.optional(_finite_strokes),
    )
    """Several of them, over each other."""
    noise: float | None = field(
        default=None,
        kw_only=True,
        converter=optional(float),
        validator=validators.optional(length_or_zero),
    )
    """How much samples scatter; by default estimated."""
    corner_angle: float = field(
        default=CORNER_ANGLE,
        kw_only=True,
        converter=float,
        validator=[validators.gt(0), validators.le(180)],
    )
    """Turns from so many degrees on are corners."""
    corner_window: float | None = field(
        default=None,
        kw_only=True,
        converter=optional(float),
        validator=validators.optional(length),
    )
    """Length of stroke on either side by which a corner is judged."""
    straight: bool = field(default=False, kw_only=True, validator=validators.instance_of(bool))
    """Whether samples are joined by straight lines."""

    def __attrs_post_init__(self) -> None:
        if (self.stroke is None) == (self.strokes is None):
            found = "neither" if self.stroke is None else "both"
            raise EditError(f"give either 'stroke' or 'strokes'; got {found}")

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the drawn polyline over the same domain; the splice is all of it.

        Raises
        ------
        InvalidCurveError
            When a stroke is no curve: one place only, or no numbers.
        EditError
            When it has another number of coordinates than the curve, is all noise, or when strokes
            do not lie over each other.
        """
        strokes = (self.stroke,) if self.strokes is None else self.strokes
        assert strokes[0] is not None
        drawn = sketched(
            [stroke for stroke in strokes if stroke is not None],
            noise=self.noise,
            corner_angle=self.corner_angle,
            corner_window=self.corner_window,
            straight=self.straight,
        ).points
        if drawn.shape[1] != polyline.dimension:
            raise EditError(
                f"the stroke has {drawn.shape[1]} coordinates, the curve {polyline.dimension}"
            )
        t, points, _ = chord_length(drawn, domain=polyline.domain)
        return polyline.replace(0, polyline.size, t, points)
