"""Sweeping: pulling a point of the curve along, over a width that the level chooses."""

from __future__ import annotations

from attrs import converters, field, frozen, validators

from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_point, finite_number, finite_point
from multirep.place import locate
from multirep.representations.wavelet import WaveletBSpline
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class Sweep(Tool[WaveletBSpline]):
    """Move a point of the curve, and as much of the curve with it as the level says (Grimm-Ayers 5.3).

    A low level moves the broad course of the curve and leaves its character alone: all finer detail
    rides along. A high level moves a narrow piece. The change is seven spans of 2**-level of T
    wide, and is the smallest change of control points of that level which reaches the target
    (Finkelstein-Salesin 1994; Bartels-Beatty 1989).

    Parameters
    ----------
    t : float, optional
        Which point of the curve. Either this or ``at``.
    at : tuple of float, optional
        The point of the curve nearest to this.
    to : tuple of float
        Where it shall be; hit up to rounding.
    level : float
        From 0, the whole curve, up to 40. Between two levels the width changes gradually.

    Examples
    --------
    >>> curve = WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0], [4, 0]])
    >>> edit = Sweep(t=0.5, to=[2, 1], level=3).edit(curve, Scene())
    >>> print(edit.value(0.5), edit.splices)
    [2. 1.] [0,1]
    """

    name = "sweep"
    edits = WaveletBSpline

    t: float | None = field(
        default=None,
        converter=converters.optional(float),
        validator=validators.optional(finite_number),
    )
    """Which point of the curve."""
    at: tuple[float, ...] | None = field(
        default=None,
        converter=converters.optional(as_point),
        validator=validators.optional(finite_point),
    )
    """The point of the curve nearest to this."""
    to: tuple[float, ...] = field(kw_only=True, converter=as_point, validator=finite_point)
    """Where it shall be."""
    level: float = field(kw_only=True, converter=float, validator=[finite_number, validators.ge(0)])
    """How wide: 0 for the whole curve, each level more for half of it."""

    def edit(self, curve: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        """Return the curve that passes through ``to`` at t.

        Raises
        ------
        EditError
            When the dimension is wrong, or the level is finer than knots can be on this T.
        """
        if len(self.to) != curve.dimension:
            raise EditError(
                f"the curve has {curve.dimension} coordinates, 'to' has {len(self.to)}: {self.to}"
            )
        return curve.sweep(locate(curve, self.t, self.at), self.to, self.level)
