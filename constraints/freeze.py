"""A frozen stretch: it stays as it is in every representation, bit by bit."""

from __future__ import annotations

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.constraint import Constraint
from multirep.constraints.painting import painted
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_interval, as_points, finite_points, positive
from multirep.interval import Interval
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList


@frozen
class Freeze(Constraint[Polyline]):
    """Nothing may change a stretch of the curve any more (Grimm-Ayers 5.2).

    Give either the interval, or paint: what lies within the radius of a stroke is frozen. Unlike
    the paper, which puts the old samples back after each edit, an edit that reaches in is solved
    on what is free or faded out before the border; see :mod:`multirep.blending`.

    Parameters
    ----------
    interval : pair of float, optional
        The stretch of T. Where a representation cannot stop exactly there (dyadic knots), a sliver
        around it is frozen too.
    stroke : sequence of points, optional
        A brush stroke along the curve.
    radius : float, optional
        Of the brush.

    Examples
    --------
    >>> import multirep as mr
    >>> zigzag = Polyline([0, 1, 2, 3], [[0, 0], [1, 1], [2, 0], [3, 1]])
    >>> curve = mr.MultiRepresentation(zigzag, tolerance=1e-3, kinds=[Polyline])
    >>> framework = mr.Framework()
    >>> framework.add("zigzag", curve)
    >>> name, outcome = framework.constrain("zigzag", Freeze(interval=(0, 1)))
    >>> curve.commit(Polyline, curve.view(Polyline).move_vertex(1, [1, 2]))
    Traceback (most recent call last):
        ...
    multirep.errors.FrozenError: polyline would change [0,1], which 'freeze' keeps frozen
    """

    name = "freeze"
    needs = Polyline

    interval: tuple[float, float] | None = field(default=None, converter=optional(as_interval))
    """The stretch of T."""
    stroke: tuple[tuple[float, ...], ...] | None = field(
        default=None, converter=optional(as_points), validator=validators.optional(finite_points)
    )
    """A brush stroke along the curve."""
    radius: float | None = field(
        default=None, converter=optional(float), validator=validators.optional(positive)
    )
    """Of the brush."""

    def __attrs_post_init__(self) -> None:
        if (self.interval is None) == (self.stroke is None):
            found = "neither" if self.interval is None else "both"
            raise ValueError(f"give either 'interval' or 'stroke' with 'radius'; got {found}")
        if (self.stroke is None) != (self.radius is None):
            raise ValueError("'stroke' and 'radius' belong together")

    def frozen(self, value: Polyline) -> SpliceList:
        """Return the stretches, on the curve as it is.

        Raises
        ------
        EditError
            When the interval leaves T, or the brush misses the curve.
        """
        if self.stroke is not None and self.radius is not None:
            return painted(value, self.stroke, self.radius)
        assert self.interval is not None
        interval = Interval.of(self.interval)
        if not value.domain.contains(interval):
            raise EditError(f"cannot freeze {interval}: the domain is {value.domain}")
        return SpliceList([interval])

    def region(self, value: Polyline) -> Interval:
        """Return the hull of the stretches."""
        return self.frozen(value).hull

    def residual(self, value: Polyline) -> float:
        """Return 0: the kernel lets nothing change there."""
        return 0.0

    def enforce(self, value: Polyline, change: SpliceList, scene: Scene) -> Edit[Polyline]:
        """Change nothing; there is never a need to."""
        return Edit(value, SpliceList.EMPTY)
