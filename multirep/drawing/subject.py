"""What is drawn: curves with their representations, deviations, and changed stretches."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

from multirep.arrays import Array
from multirep.deviation import Deviation
from multirep.representation import Representation
from multirep.splices import SpliceList


@frozen(eq=False)
class CurveSubject:
    """One curve.

    Parameters
    ----------
    name : str
    tolerance : float
    representations : mapping of str to Representation
        Up to date; in the order in which they are shown.
    deviations : mapping of (str, str) to Deviation
        For pairs of them.
    changed : SpliceList
        Where the edits changed the curve.
    before : Representation or None
        The curve before the edits.
    strokes : tuple of (n, d) arrays
        Where the pen went.
    frozen : SpliceList
        Where nothing may change.
    marks : tuple of (float, float)
        The parameters of left and right marks.
    pins : tuple of float
        Parameters at which constraints hold the curve.
    """

    name: str
    tolerance: float
    representations: Mapping[str, Representation]
    deviations: Mapping[tuple[str, str], Deviation]
    changed: SpliceList = SpliceList.EMPTY
    before: Representation | None = None
    strokes: tuple[Array, ...] = ()
    frozen: SpliceList = SpliceList.EMPTY
    marks: tuple[tuple[float, float], ...] = ()
    pins: tuple[float, ...] = ()


@frozen(eq=False)
class Subject:
    """Everything that one picture shows; without ``y_up`` the y axis points down, as in SVG."""

    title: str
    curves: tuple[CurveSubject, ...]
    edits: int = 0
    y_up: bool = False

    @property
    def kinds(self) -> tuple[str, ...]:
        """The representations that occur, in order."""
        names = [name for curve in self.curves for name in curve.representations]
        return tuple(dict.fromkeys(names))
