"""A marked stretch: everything else is frozen."""

from __future__ import annotations

from attrs import field, frozen

from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_interval
from multirep.interval import Interval
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList


@frozen
class Mark(Constraint[Polyline]):
    """Edits reach the stretch between two marks only; the rest is frozen (Grimm-Ayers 5.2).

    Parameters
    ----------
    interval : pair of float
        The left and the right mark, parameters in T.

    Examples
    --------
    >>> line = Polyline([0, 1], [[0, 0], [4, 0]])
    >>> print(Mark(interval=(0.25, 0.5)).frozen(line))
    [0,1/4] [1/2,1]
    """

    name = "mark"
    needs = Polyline

    interval: tuple[float, float] = field(converter=as_interval)
    """The left and the right mark, parameters in T."""

    def frozen(self, value: Polyline) -> SpliceList:
        """Return T without the interval; EditError when that leaves nothing free or frozen."""
        marked, domain = Interval.of(self.interval), value.domain
        if not domain.contains(marked):
            raise EditError(f"cannot mark {marked}: the domain is {domain}")
        return SpliceList([domain]) - SpliceList([marked])

    def region(self, value: Polyline) -> Interval:
        """Return all of T."""
        return value.domain

    def residual(self, value: Polyline) -> float:
        """Return 0: the kernel lets nothing change outside the marks."""
        return 0.0

    def enforce(self, value: Polyline, change: SpliceList, scene: Scene) -> Edit[Polyline]:
        """Change nothing; there is never a need to."""
        return Edit(value, SpliceList.EMPTY)
