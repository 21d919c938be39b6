"""Data to page: one scale for both axes, y down as in SVG unless asked otherwise."""

from __future__ import annotations

import numpy as np
from attrs import frozen

from multirep.arrays import Array
from multirep.drawing.picture import Box

#: Rows are the page directions of x, y, z for spatial curves: seen from the front, right and above.
AXONOMETRIC = np.array([[0.866, 0.26], [0.0, -0.93], [-0.5, 0.45]])


@frozen(eq=False)
class Frame:
    """The similarity that takes data into a box of the page.

    Parameters
    ----------
    box : Box
        Where the data go, with the margin taken off already.
    lower, upper : array (2,)
        The corner of the flat data that are shown.
    """

    box: Box
    lower: Array
    upper: Array

    @property
    def scale(self) -> float:
        """Page units per unit of the data."""
        width, height = np.maximum(self.upper - self.lower, 0.0)
        fits = [
            side / size
            for side, size in ((self.box.width, width), (self.box.height, height))
            if size
        ]
        return float(min(fits, default=1.0))

    def __call__(self, flat: Array) -> Array:
        """Page coordinates (n, 2) of flat data (n, 2)."""
        middle = self.lower + (self.upper - self.lower) / 2
        center = [self.box.x + self.box.width / 2, self.box.y + self.box.height / 2]
        page: Array = (flat - middle) * self.scale + center
        return page


def flatten(t: Array, points: Array, *, y_up: bool = False) -> Array:
    """Return points of any dimension as (n, 2), y down.

    Curves in the plane stay as they are; functions (d = 1) are drawn over t; of more dimensions the
    first three are seen from the front, right and above.
    """
    d = points.shape[1]
    if d == 1:
        flat = np.column_stack([t, points[:, 0]])
    elif d == 2:
        flat = np.array(points)
    else:
        return np.asarray(points[:, :3] @ AXONOMETRIC)
    if y_up or d == 1:
        flat[:, 1] *= -1.0
    return flat
