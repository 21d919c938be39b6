"""Test doubles: representations that watch, a tool that records, a constraint that vetoes.

They are partners for tests of the kernel and of plugins; each passes the suite of its own kind.
"""

from __future__ import annotations

from typing import Any, ClassVar, Self

import attrs
import numpy as np

from multirep.arrays import Array, frozen_array
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_point, finite_point
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing.looking import even
from multirep.testing.loopback import LoopbackRepresentation
from multirep.tool import Tool


@attrs.frozen(eq=False)
class CountingRepresentation(LoopbackRepresentation):
    """A loopback that writes down how it is used: ``log`` is shared by all values made from one.

    Examples
    --------
    >>> line = CountingRepresentation([0, 1], [[0, 0], [1, 1]])
    >>> _ = line.sample(Interval(0, 0.5), tolerance=1e-3)
    >>> line.log
    [('sample', Interval(start=0.0, stop=0.5))]
    """

    name = "counting"

    log: list[tuple[str, Interval]] = attrs.field(factory=list, kw_only=True)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Sample and write it down."""
        self.log.append(("sample", Interval.of([*map(float, interval)])))
        return super().sample(interval, tolerance=tolerance)

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Splice and write it down."""
        self.log.append(("splice", sampled.interval))
        return super().splice(sampled, tolerance=tolerance)


@attrs.frozen(eq=False)
class NoTouchRepresentation(LoopbackRepresentation):
    """A loopback that raises when it is sampled outside ``touchable``.

    Examples
    --------
    >>> line = NoTouchRepresentation([0, 1], [[0, 0], [1, 1]]).touchable_on(SpliceList.EMPTY)
    >>> line.sample(Interval(0, 0.5), tolerance=1e-3)
    Traceback (most recent call last):
        ...
    AssertionError: NO TOUCH: sampled on [0, 0.5], outside nothing
    """

    name = "no-touch"

    touchable: SpliceList | None = attrs.field(default=None, kw_only=True)

    def touchable_on(self, splices: SpliceList) -> Self:
        """Return the same value that may be sampled on ``splices`` only."""
        return attrs.evolve(self, touchable=splices)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Sample where it is allowed."""
        if self.touchable is not None and not self.touchable.contains(interval):
            raise AssertionError(
                f"NO TOUCH: sampled on {interval}, outside {str(self.touchable) or 'nothing'}"
            )
        return super().sample(interval, tolerance=tolerance)


@attrs.frozen
class RecordingTool(Tool[LoopbackRepresentation]):
    """Move a vertex of a loopback by an offset, and write down every call.

    Parameters
    ----------
    index : int
        Which vertex, from 0.
    offset : tuple of float
        By how much.
    """

    name = "recording"
    edits = LoopbackRepresentation

    index: int = attrs.field(validator=[attrs.validators.instance_of(int), attrs.validators.ge(0)])
    offset: tuple[float, ...] = attrs.field(converter=as_point, validator=finite_point)
    calls: list[tuple[LoopbackRepresentation, Scene]] = attrs.field(
        factory=list, init=False, eq=False, repr=False
    )

    def edit(self, value: LoopbackRepresentation, scene: Scene) -> Edit[LoopbackRepresentation]:
        """Move the vertex."""
        self.calls.append((value, scene))
        if self.index >= value.size:
            raise EditError(f"no vertex {self.index}: there are {value.size}")
        return value.move(self.index, value.points[self.index] + np.array(self.offset))


@attrs.frozen(eq=False)
class VetoConstraint(Constraint[LoopbackRepresentation]):
    """Holds as long as the curve is on the given points, and refuses to do anything about it.

    Parameters
    ----------
    interval : Interval
        Where changes are vetoed.
    points : (m, d) array
        What the curve must be at m even parameters of ``interval``; see :meth:`on`.
    """

    name = "veto"
    needs: ClassVar[type[Representation]] = LoopbackRepresentation

    interval: Interval = attrs.field(validator=attrs.validators.instance_of(Interval))
    points: Array = attrs.field(converter=frozen_array)

    @classmethod
    def on(cls, value: Representation, interval: Interval) -> Self:
        """Veto changes of ``value`` on ``interval``."""
        return cls(interval, value(even(interval, 33)))

    def region(self, value: Representation) -> Interval:
        """Return the interval."""
        return self.interval

    def residual(self, value: Representation) -> float:
        """How far the curve has moved."""
        t = even(self.interval, len(self.points))
        return float(np.linalg.norm(value(t) - self.points, axis=1).max())

    def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
        """Refuse."""
        raise EditError(f"changes on {self.interval} are vetoed")


def follower_of(value: Representation) -> type[LoopbackRepresentation]:
    """Return a kind of loopback that is not the kind of ``value``: a partner that follows it."""
    return CountingRepresentation if value.name == "loopback" else LoopbackRepresentation
