"""Smoothing: taking the fine details away, everywhere or on a stretch."""

from __future__ import annotations

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.edit import Edit
from multirep.fields import as_interval, finite_number
from multirep.interval import Interval
from multirep.representations.wavelet import WaveletBSpline
from multirep.representations.wavelet.smoothing import smoothed
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class Smooth(Tool[WaveletBSpline]):
    """Take away the details above a level (Grimm-Ayers 2.2.3; Finkelstein-Salesin 1994, 3.3).

    What remains is the best approximation of the curve, in the L2 norm, with 2**level equal spans;
    between two whole levels the upper details are there in part, so the curve changes gradually
    with the level. A curve that is as smooth already stays as it is.

    Parameters
    ----------
    level : float
        From 0, a single cubic.
    interval : pair of float, optional
        Only there. At each end of it inside T the details fade out over an apron of two spans of
        the level, at most a third of the interval; outside not a bit of the curve changes, but see
        the notes.

    Notes
    -----
    Frozen stretches are left out, with aprons before them. Where the curve is too coarse to fade
    details out within an apron, the control points around it are written anew on more knots: the
    curve there is the same up to rounding, and the reported splices include it.

    Examples
    --------
    >>> zigzag = WaveletBSpline([[k, k % 2] for k in range(67)])
    >>> edit = Smooth(level=3, interval=(0.25, 0.75)).edit(zigzag, Scene())
    >>> print(edit.splices, edit.value([0.125, 0.5])[:, 1].round(3))
    [1/4,3/4] [0.667 0.501]
    """

    name = "smooth"
    edits = WaveletBSpline

    level: float = field(converter=float, validator=[finite_number, validators.ge(0)])
    """How smooth: from 0, a single cubic; each level more has twice as many spans."""
    interval: tuple[float, float] | None = field(default=None, converter=optional(as_interval))
    """Where on T; everywhere without it."""

    def edit(self, curve: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        """Return the curve without the details.

        Raises
        ------
        ParameterError
            When the interval leaves T.
        EditError
            When there is no room for a change in it.
        """
        interval = None if self.interval is None else Interval.of(self.interval)
        return smoothed(curve, self.level, interval, scene.frozen)
