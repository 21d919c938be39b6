"""What is drawn: curves with their representations, deviations, and changed stretches."""

from __future__ import annotations

from collections.abc import Mapping

from attrs import frozen

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
    """

    name: str
    tolerance: float
    representations: Mapping[str, Representation]
    deviations: Mapping[tuple[str, str], Deviation]
    changed: SpliceList = SpliceList.EMPTY
    before: Representation | None = None


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
