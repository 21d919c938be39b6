"""Sweeping: pulling a point of the curve along, over a width that the level chooses."""

from __future__ import annotations

import numpy as np
from attrs import converters, field, frozen, validators

from multirep.aim import Aim
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_point, as_points, finite_number, finite_point, finite_points
from multirep.place import PlacedTool
from multirep.representations.wavelet import WaveletBSpline
from multirep.representations.wavelet.targets import swept_together
from multirep.scene import Scene


@frozen
class Sweep(PlacedTool[WaveletBSpline]):
    """Move a point of the curve, and as much of the curve with it as the level says.

    A low level moves the broad course of the curve and leaves its character alone: all finer detail
    rides along. A high level moves a narrow piece. The change is seven spans of 2**-level of T
    wide, and is the smallest change of control points of that level which reaches the target
    (Grimm-Ayers 5.3; Finkelstein-Salesin 1994; Bartels-Beatty 1989).

    Parameters
    ----------
    t : float, optional
        Which point of the curve. Either this or ``at``.
    at : tuple of float, optional
        The point of the curve nearest to this.
    to : tuple of float
        Where it shall be; hit up to rounding.
    level : float
        From 0, the whole curve, up to 46. Between two levels the width changes gradually.
    hold : tuple of float, optional
        Parameters at which the curve stays where it is: moving one point then leaves the others.
    targets : tuple of (t, x, y, ...), optional
        More points to move at once: a parameter each, and where the curve shall be there.

    Examples
    --------
    >>> curve = WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])
    >>> edit = Sweep(t=0.5, to=[2, 1], level=3).edit(curve, Scene())
    >>> print(edit.value(0.5), edit.splices)
    [2. 1.] [0,1]
    >>> both = Sweep(t=0.5, to=[2, 1], level=2, hold=[0.25], targets=[[1, 5, 0]])
    >>> offsets = both.edit(curve, Scene()).value([0.25, 0.5, 1]) - curve([0.25, 0.5, 1])
    >>> (offsets.round(12) + 0.0).tolist()
    [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]
    """

    name = "sweep"
    edits = WaveletBSpline

    to: tuple[float, ...] = field(kw_only=True, converter=as_point, validator=finite_point)
    """Where it shall be."""
    level: float = field(kw_only=True, converter=float, validator=[finite_number, validators.ge(0)])
    """How wide: 0 for the whole curve, each level more for half of it."""
    hold: tuple[float, ...] | None = field(
        default=None,
        kw_only=True,
        converter=converters.optional(as_point),
        validator=validators.optional(finite_point),
    )
    """Parameters at which the curve stays where it is."""
    targets: tuple[tuple[float, ...], ...] | None = field(
        default=None,
        kw_only=True,
        converter=converters.optional(as_points),
        validator=validators.optional(finite_points),
    )
    """More points to move: rows of a parameter and a place."""

    def edit(self, curve: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        """Return the curve that passes through ``to`` at t.

        Raises
        ------
        EditError
            When the dimension is wrong, the level is finer than knots can be on this T, or not all
            targets can be reached at this level.
        """
        if len(self.to) != curve.dimension:
            raise EditError(
                f"the curve has {curve.dimension} coordinates, 'to' has {len(self.to)}: {self.to}"
            )
        t = self.place(curve)
        if self.hold is None and self.targets is None and not scene.frozen:
            return curve.sweep(t, self.to, self.level)
        rows = np.array([(t, *self.to), *self._others(curve)])
        return swept_together(
            curve, rows[:, 0], rows[:, 1:], self.level, scene.frozen, scene.memory
        )

    def aims(self, curve: WaveletBSpline) -> tuple[Aim, ...]:
        """Return all targets, those that stay among them."""
        others = [Aim(row[0], row[1:]) for row in self._others(curve)]
        return (*super().aims(curve), *others)

    def _others(self, curve: WaveletBSpline) -> list[tuple[float, ...]]:
        """Return the targets beside the first one as (t, x, y, ...)."""
        for row in self.targets or ():
            if len(row) != curve.dimension + 1:
                raise EditError(
                    f"a target is a parameter and {curve.dimension} coordinates, got {row}"
                )
        held = self.hold or ()
        return [*((t, *curve(t).tolist()) for t in held), *(self.targets or ())]
