"""Pushing the polyline with a round spatula."""

from __future__ import annotations

import numpy as np
from attrs import field, frozen, validators

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_points, finite_points
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.tool import Tool
from multirep.tools.spatula.flow import windows
from multirep.tools.spatula.sand import SPLIT, Sand

#: Longest stroke, in steps of a quarter of the radius; each takes about 0.1 ms.
STEPS = 100_000


@frozen
class Spatula(Tool[Polyline]):
    """Push the curve, as if it were sand, with a circle that moves along a path (Grimm-Ayers 5.1).

    Vertices inside the circle go to the nearest point of its boundary. Segments in contact are
    never longer than a quarter of the radius: longer ones are halved (sand is added). Pushed
    vertices between two segments that are together shorter than an eighth are removed. The motion
    is cut into steps of a quarter of the radius, so that nothing jumps through. An open curve stays
    open: its ends may be pushed, but keep their parameters.

    Parameters
    ----------
    radius : float
        Of the circle.
    path : tuple of points
        Where its centre moves; one point is a dab.

    Examples
    --------
    >>> line = Polyline([0, 1], [[0, 0], [8, 0]])
    >>> edit = Spatula(radius=1.0, path=[[4, -2], [4, 1]]).edit(line, Scene())
    >>> print(edit.splices, edit.value.points[:].max(axis=0))
    [0,1] [8. 2.]
    """

    name = "spatula"
    edits = Polyline

    radius: float = field(validator=validators.gt(0))
    """Of the circle."""
    path: tuple[tuple[float, ...], ...] = field(converter=as_points, validator=finite_points)
    """Where its centre moves; one point is a dab."""

    def __attrs_post_init__(self) -> None:
        if self.radius == float("inf"):
            raise ValueError("'radius' must be finite: inf")

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the polyline after the stroke; the splices run between untouched vertices.

        Cost: what the stroke touches, about 0.1 ms a step; plus O(blocks of the curve).

        Raises
        ------
        EditError
            When the curve or the path is not planar, when the radius is below the resolution of the
            coordinates, when the stroke has more than 100 000 steps, or when a stretch has no
            parameters left for new vertices.
        """
        path = self._path(polyline)
        centres, ahead = self._steps(path)
        sand = Sand(polyline, path, self.radius)
        for centre, forward in zip(centres, ahead, strict=True):
            sand.push(centre, forward)
        value, splices = polyline, SpliceList.EMPTY
        for window in reversed(windows(sand)):
            edit = value.replace(window.start, window.stop, window.t, window.points)
            value, splices = edit.value, splices | edit.splices
        return Edit(value, splices)

    def _path(self, polyline: Polyline) -> Array:
        """Return the path as a (k, 2) array of two points or more."""
        for what, dimension in (("curve", polyline.dimension), ("path", len(self.path[0]))):
            if dimension != 2:
                raise EditError(
                    f"the spatula works in the plane; this {what} has {dimension} coordinates"
                )
        path = np.array(self.path)
        return np.concatenate([path, path]) if len(path) == 1 else path

    def _steps(self, path: Array) -> tuple[Array, Array]:
        """Return the centres of the circle, step by step, and the directions of the motion."""
        legs = path[1:] - path[:-1]
        lengths = np.hypot(legs[:, 0], legs[:, 1])
        counts = np.ceil(lengths / (SPLIT * self.radius))
        if not counts.sum() <= STEPS:
            raise EditError(
                f"the path of {lengths.sum():g} is too long for radius {self.radius:g}: "
                f"at most {STEPS} steps of a quarter of the radius"
            )
        each = counts.astype(int)
        leg = np.repeat(np.arange(len(legs)), each)
        number = np.arange(len(leg)) - (each.cumsum() - each)[leg] + 1
        # the ends of the legs come out exactly
        part = (number / counts[leg])[:, None]
        centres = np.where(part == 1.0, path[leg + 1], path[leg] + part * legs[leg])
        ahead = legs / np.where(lengths > 0, lengths, 1.0)[:, None]
        moving = np.flatnonzero(lengths > 0)
        first = ahead[moving[0]] if moving.size else np.array([0.0, 1.0])
        return np.concatenate([path[:1], centres]), np.concatenate([first[None], ahead[leg]])
