"""The pyramid: a base of four control points and details by level (Finkelstein-Salesin 1994)."""

from __future__ import annotations

import math

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.errors import EditError
from multirep.representations.wavelet.analysis import MAX_LEVEL, analyse
from multirep.representations.wavelet.filters import (
    add_details,
    level_of,
    refine_uniform,
    unit_scale,
)

__all__ = ["MAX_LEVEL", "USUAL_LEVEL", "Pyramid"]

#: A pyramid that is asked for without a level goes up to this one at most: deeper ones are large.
USUAL_LEVEL = 16


@attrs.frozen(eq=False)
class Pyramid:
    """A uniform cubic curve of level n as base and details (immutable).

    Make one with :meth:`of`.

    Parameters
    ----------
    centre : (d,) array
        A point near the curve; everything else is relative to it, so that details keep all their
        digits however far the curve is from the origin.
    coarse : (4, d) array
        Control points of level 0, relative to the centre.
    details : tuple of (2**l, d) arrays
        ``details[l]`` leads from level l to level l + 1. A detail is the displacement that it
        adds at the peak of its wavelet, in the units of the points.

    Examples
    --------
    >>> pyramid = Pyramid.of([[0, 0], [1, 2], [2, 0], [3, 2], [4, 0]])
    >>> pyramid.level, pyramid.base.shape, pyramid.details[0].shape
    (1, (4, 2), (1, 2))
    >>> pyramid.control_points().round(12).tolist()
    [[0.0, 0.0], [1.0, 2.0], [2.0, 0.0], [3.0, 2.0], [4.0, 0.0]]
    """

    centre: Array = attrs.field(converter=frozen_array)
    coarse: Array = attrs.field(converter=frozen_array)
    details: tuple[Array, ...]

    @classmethod
    def of(cls, points: ArrayLike) -> Pyramid:
        """Analyse the control points of a uniform curve.

        Parameters
        ----------
        points : (2**n + 3, d) array_like
            Control points of level n, 0 <= n <= 20.

        Notes
        -----
        O(points); 16 levels of 65 539 points in about 2.5 ms, 20 levels of a million in 50 ms;
        without the compiled core 5 ms and 65 ms.
        """
        coarse: Array = np.array(points, dtype=np.float64)
        # column by column: numpy is slow down the columns of a narrow array
        centre = np.array([0.5 * (column.min() + column.max()) for column in coarse.T])
        coarse -= centre
        details = []
        for _ in range(level_of(len(coarse))):
            coarse, detail = analyse(coarse)
            detail.setflags(write=False)
            details.append(detail)
        return cls(centre, coarse, tuple(reversed(details)))

    @property
    def level(self) -> int:
        """The finest level n."""
        return len(self.details)

    @property
    def base(self) -> Array:
        """Control points of level 0, (4, d)."""
        return self.coarse + self.centre

    def control_points(self, level: float | None = None) -> Array:
        """Control points of the curve of a level, also between two levels.

        Parameters
        ----------
        level : float, optional
            0 <= level <= n; default n. At j + u the curve is ``P c(j) + u Q d(j)``, which goes
            continuously from level j to level j + 1.

        Returns
        -------
        (2**ceil(level) + 3, d) array

        Raises
        ------
        EditError
            When there is no such level.
        """
        level = float(self.level if level is None else level)
        if not 0.0 <= level <= self.level:
            raise EditError(f"the pyramid has the levels 0 to {self.level}, asked for {level:g}")
        points = np.array(self.coarse)
        for step in range(math.ceil(level)):
            points = refine_uniform(points)
            add_details(points, self.details[step], min(1.0, level - step))
        points += self.centre
        return points

    def truncated(self, level: int) -> Pyramid:
        """Return the pyramid without the details above ``level``: the best approximation in L2."""
        if not 0 <= level <= self.level:
            raise EditError(f"the pyramid has the levels 0 to {self.level}, asked for {level}")
        return attrs.evolve(self, details=self.details[:level])

    def unit_details(self, level: int) -> Array:
        """Return details (2**level, d) for wavelets of unit L2 norm on [0, 1], as in the primer."""
        return self.details[level] * unit_scale(level + 1)[:, None]
