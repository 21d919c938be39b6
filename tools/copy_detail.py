"""Copying detail: the character of one curve on the sweep of another."""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any, Literal

from attrs import Attribute, field, frozen, validators

from multirep.edit import Edit
from multirep.fields import a_name
from multirep.representations.wavelet import WaveletBSpline
from multirep.representations.wavelet.character import detailed
from multirep.scene import Scene
from multirep.tool import Tool


def _as_levels(value: Iterable[int]) -> tuple[int, ...]:
    """Convert whole numbers; what is none is left for the validator to name."""
    try:
        return tuple(sorted({operator.index(level) for level in value}))
    except TypeError:
        return value  # type: ignore[return-value]  # the validator names the field


def _levels(instance: object, attribute: Attribute[Any], value: object) -> None:
    if not isinstance(value, tuple) or not value or min(value) < 0:
        raise ValueError(
            f"{attribute.name!r} must be a list of one whole number from 0 or more: {value!r}"
        )


@frozen
class CopyDetail(Tool[WaveletBSpline]):
    """Replace details by those of another curve (Grimm-Ayers 2.2.4; Finkelstein-Salesin 1994, 3.5).

    The sweep of this curve and its details of other levels stay as they are. Details correspond by
    their place on T, as a part of it, and keep their size in the units of the points. Levels at
    which the other curve has no details lose theirs here.

    Parameters
    ----------
    source : str
        Name of the other curve.
    levels : tuple of int
        Which ones: level l holds the details, 2**l of them, that lead from level l to l + 1; the
        low ones are broad, the high ones fine. From 0 to 15.
    frame : "curve" or "axes"
        Whether each detail keeps its direction relative to the curve, so that bumps point outward
        along any sweep, or relative to the axes of coordinates.

    Notes
    -----
    The frame of a detail is that of the curve without this detail and the finer ones, at the middle
    of its wavelet: direction and left normal in the plane; in space a frame that does not turn
    about the curve, see `multirep.representations.wavelet.frames`. Frozen stretches stay as they
    are; the change fades out before them over four spans of the lowest level, at most a third of
    what is free.

    Examples
    --------
    >>> import multirep as mr
    >>> from multirep.representations import Polyline
    >>> framework, kinds = mr.Framework(), [Polyline, WaveletBSpline]
    >>> line = WaveletBSpline([[0, 0], [0, 1], [0, 2], [0, 3]])
    >>> bumpy = WaveletBSpline([[k, 0.1 * (k % 2)] for k in range(67)])
    >>> for name, curve in (("line", line), ("bumpy", bumpy)):
    ...     framework.add(name, mr.MultiRepresentation(curve, tolerance=1e-3, kinds=kinds))
    >>> outcome = framework.apply("line", CopyDetail(source="bumpy", levels=[5]))
    >>> copied = framework.curve("line").view("wavelet")
    >>> bool(0.01 < abs(copied.pyramid().details[5][:, 0]).max() < 0.1)
    True
    """

    name = "copy-detail"
    edits = WaveletBSpline

    source: str = field(validator=a_name)
    """Name of the other curve."""
    levels: tuple[int, ...] = field(converter=_as_levels, validator=_levels)
    """Which levels, from 0, broad, to 15, fine."""
    frame: Literal["curve", "axes"] = field(
        default="curve", validator=validators.in_(("curve", "axes"))
    )
    """Whether details keep their direction relative to the curve or to the axes."""

    def edit(self, curve: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        """Return the curve with the details of the other one.

        Raises
        ------
        UnknownNameError
            When there is no such curve.
        EditError
            When it has another number of coordinates, a level is above 15, frames do not exist, or
            there is no room for a change beside what is frozen.
        """
        source = scene.view(self.source, WaveletBSpline)
        return detailed(curve, source, self.levels, self.frame, scene.frozen)
