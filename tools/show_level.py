"""Keeping a picture of one level of a curve, as a curve of its own."""

from __future__ import annotations

from attrs import field, frozen, validators

from multirep.edit import Edit
from multirep.fields import a_name, finite_number
from multirep.representations.wavelet import WaveletBSpline
from multirep.representations.wavelet.smoothing import shown
from multirep.scene import Scene
from multirep.tool import Tool


@frozen
class ShowLevel(Tool[WaveletBSpline]):
    """Make this curve the curve of one level of another (Grimm-Ayers 2.1.3, 6.3).

    The other curve stays as it is; this one, made for the purpose, shows its sweep at the level,
    with the 2**level + 3 control points that a sweep at this level moves. It is a copy: when the
    other curve changes, show the level again. To take details away from a curve itself, smooth it.

    Parameters
    ----------
    source : str
        Name of the other curve.
    level : float
        From 0, its base curve of four control points. Between two levels the upper details are
        there in part.

    Notes
    -----
    In Python, :meth:`WaveletBSpline.at_level` is the same without a second curve.

    Examples
    --------
    >>> import multirep as mr
    >>> framework = mr.Framework()
    >>> for name in ("zigzag", "sweep"):
    ...     points = [[k, k % 3] for k in range(20)]
    ...     curve = mr.MultiRepresentation.from_points(points, tolerance=1e-2)
    ...     framework.add(name, curve)
    >>> outcome = framework.apply("sweep", ShowLevel(source="zigzag", level=2))
    >>> framework.curve("sweep").view("wavelet").size
    7
    """

    name = "show-level"
    edits = WaveletBSpline

    source: str = field(validator=a_name)
    """Name of the other curve."""
    level: float = field(converter=float, validator=[finite_number, validators.ge(0)])
    """From 0, its base curve, to its finest level."""

    def edit(self, curve: WaveletBSpline, scene: Scene) -> Edit[WaveletBSpline]:
        """Return the level of the other curve over the domain of this one.

        Raises
        ------
        UnknownNameError
            When there is no such curve.
        EditError
            When it has another number of coordinates, or there is no room for a change beside what
            is frozen.
        """
        return shown(curve, scene.view(self.source, WaveletBSpline), self.level, scene.frozen)
