"""Test doubles: a representation that is trivially right, ones that watch, tools that go wrong.

:class:`LoopbackRepresentation` is a real plugin, as short as one can be: read it before you write
your own. The others are partners for tests of the kernel and of plugins.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any, ClassVar, Self

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, interpolate
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.tool import Tool


@attrs.frozen(eq=False)
class LoopbackRepresentation(Representation):
    """Stores the samples that it is given, verbatim: always exact, never small.

    Parameters
    ----------
    t : (n,) array_like
        Strictly increasing.
    points : (n, d) array_like

    Examples
    --------
    >>> line = LoopbackRepresentation([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    >>> line(0.5)
    array([0.5, 0.5])
    """

    name = "loopback"
    summary = "Stores samples verbatim; for tests."

    t: Array = attrs.field(converter=frozen_array)
    points: Array = attrs.field(converter=frozen_array)

    def __attrs_post_init__(self) -> None:
        SampledSplice(self.t, self.points)  # validates

    @classmethod
    def from_points(cls, points: ArrayLike, *, t: ArrayLike | None = None) -> Self:
        """Join points by straight lines; without ``t``, their parameters are even in [0, 1]."""
        rows = np.asarray(points, dtype=np.float64)
        return cls(np.linspace(0, 1, len(rows)) if t is None else t, rows)

    # -- the contract ------------------------------------------------------------------------------

    @property
    def domain(self) -> Interval:  # type: ignore[override]
        """From the first parameter to the last."""
        return Interval(float(self.t[0]), float(self.t[-1]))

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of coordinates."""
        return int(self.points.shape[1])

    def __call__(self, t: ArrayLike) -> Array:
        """Points at parameters."""
        return interpolate(self.t, self.points, self.parameters(t))

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Return the vertices on ``interval``; exact, so the bound is 0 for any tolerance."""
        a, b = self.parameters([*interval])
        i, j = self.t.searchsorted(a, side="right"), self.t.searchsorted(b, side="left")
        t = np.concatenate([[a], self.t[i:j], [b]])
        return SampledSplice(t, self(t), 0.0, tuple(self.t[i:j].tolist()))

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Store the samples; at an end inside T the curve stays where it is (the end gap)."""
        if sampled.dimension != self.dimension:
            raise InvalidCurveError(f"{sampled.dimension} coordinates, not {self.dimension}")
        a, b = self.parameters([*sampled.interval])
        i, j = self.t.searchsorted(a, side="left"), self.t.searchsorted(b, side="right")
        allowance, points = sampled.allowance(tolerance), np.array(sampled.points)
        start, stop, bound = float(a), float(b), 0.0
        for end, inside in ((0, i > 0), (-1, j < len(self.t))):
            if inside:
                points[end] = self(sampled.t[end])
                gap = float(np.linalg.norm(points[end] - sampled.points[end]))
                if gap > allowance[end]:
                    raise ToleranceError(
                        f"the curve ends {gap:g} away from the samples at t = {sampled.t[end]:g}",
                        tolerance=tolerance,
                        where=float(sampled.t[end]),
                    )
                bound = max(bound, gap)
        if i > 0 and self.t[i] != a:  # the chord that is cut evaluates differently in its last bits
            start = float(self.t[i - 1])
        if j < len(self.t) and self.t[j - 1] != b:
            stop = float(self.t[j])
        value = attrs.evolve(
            self,
            t=np.concatenate([self.t[:i], sampled.t, self.t[j:]]),
            points=np.concatenate([self.points[:i], points, self.points[j:]]),
        )
        return Edit(value, SpliceList([(start, stop)]), bound)

    @classmethod
    def fit(cls, sampled: SampledSplice, *, tolerance: float, **options: Any) -> Self:
        """Store the samples."""
        return cls(sampled.t, sampled.points, **options)

    # -- what may be overridden --------------------------------------------------------------------

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Prefer vertices as ends, for then no chord is cut."""
        i = self.t.searchsorted(interval.start, side="right") - 1
        j = self.t.searchsorted(interval.stop, side="left")
        nicer = Interval(float(self.t[i]), float(self.t[j]))
        return nicer if within.contains(nicer) else interval

    def changes(self, other: Self) -> SpliceList:
        """From the first different vertex to the last, with the chords beside them."""
        mine, theirs = (np.column_stack([v.t, v.points]).view(np.int64) for v in (self, other))
        n = min(len(mine), len(theirs))
        head = int(np.append((mine[:n] != theirs[:n]).any(axis=1), True).argmax())
        if head == len(mine) == len(theirs):
            return SpliceList.EMPTY
        m = n - head
        tail = int(
            np.append(
                (mine[len(mine) - m :] != theirs[len(theirs) - m :]).any(axis=1)[::-1], True
            ).argmax()
        )
        stop = self.t[len(mine) - tail] if tail else self.t[-1]
        return SpliceList([(float(self.t[max(head - 1, 0)]), float(stop))])

    @property
    def size(self) -> int:
        """Number of vertices."""
        return len(self.t)

    @property
    def magnitude(self) -> float:
        """The largest |coordinate|."""
        return float(np.abs(self.points).max())

    def to_dict(self) -> dict[str, Any]:
        """Return ``t`` and ``points`` as lists."""
        return {"t": self.t.tolist(), "points": self.points.tolist()}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Read what :meth:`to_dict` wrote."""
        return cls(data["t"], data["points"])

    # -- its one primitive operation ---------------------------------------------------------------

    def move(self, index: int, to: ArrayLike) -> Edit[Self]:
        """Move one vertex; the two chords beside it change."""
        if not 0 <= index < len(self.t):
            raise EditError(f"no vertex {index}: there are {len(self.t)}")
        points = np.array(self.points)
        points[index] = to
        if not np.isfinite(points[index]).all():
            raise EditError(f"a vertex must be finite, got {to!r}")
        ends = self.t[max(index - 1, 0)], self.t[min(index + 1, len(self.t) - 1)]
        return Edit(attrs.evolve(self, points=points), SpliceList([ends]))


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
        return LoopbackRepresentation.sample(self, interval, tolerance=tolerance)

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Splice and write it down."""
        self.log.append(("splice", sampled.interval))
        return LoopbackRepresentation.splice(self, sampled, tolerance=tolerance)


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
        return LoopbackRepresentation.sample(self, interval, tolerance=tolerance)


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
    offset: tuple[float, ...] = attrs.field(converter=lambda v: tuple(map(float, v)))
    calls: list[tuple[LoopbackRepresentation, Scene]] = attrs.field(
        factory=list, init=False, eq=False, repr=False
    )

    @offset.validator
    def _finite(self, attribute: Any, value: tuple[float, ...]) -> None:
        if not np.isfinite(value).all():
            raise EditError(f"offset must be finite, got {value!r}")

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

    interval: Interval = attrs.field(converter=Interval.of)
    points: Array = attrs.field(converter=frozen_array)

    @classmethod
    def on(cls, value: Representation, interval: Interval) -> Self:
        """Veto changes of ``value`` on ``interval``."""
        return cls(interval, value(np.linspace(*interval, 33)))

    def region(self, value: Representation) -> Interval:
        """Return the interval."""
        return self.interval

    def residual(self, value: Representation) -> float:
        """How far the curve has moved."""
        t = np.linspace(*self.interval, len(self.points))
        return float(np.linalg.norm(value(t) - self.points, axis=1).max())

    def enforce(self, value: Any, change: SpliceList, scene: Scene) -> Edit[Any]:
        """Refuse."""
        raise EditError(f"changes on {self.interval} are vetoed")


def follower_of(value: Representation) -> type[LoopbackRepresentation]:
    """Return a kind of loopback that is not the kind of ``value``: a partner that follows it."""
    return CountingRepresentation if value.name == "loopback" else LoopbackRepresentation


def faulty_tools(
    kind: type[Representation], operation: Callable[[Any], Edit[Any]]
) -> dict[str, Tool[Any]]:
    """Tools that make a sound edit and then spoil it, each in one way, by what they do.

    Parameters
    ----------
    kind : class
        The representation that they edit.
    operation : callable
        A sound edit of a value of ``kind`` that changes the curve.

    Returns
    -------
    dict of str to Tool
        None of them may change a curve; each error must name the tool.

    Examples
    --------
    >>> tools = faulty_tools(LoopbackRepresentation, lambda line: line.move(1, [1, 1]))
    >>> tools["returns None"].name
    'returns-none'
    """

    def raises(value: Any) -> Edit[Any]:
        operation(value)
        raise ZeroDivisionError("a bug in the tool")

    def beyond(value: Any) -> Edit[Any]:
        edit, stop = operation(value), value.domain.stop
        return Edit(edit.value, edit.splices | SpliceList([(stop, stop + 1)]))

    def half(value: Any) -> Edit[Any]:
        edit = operation(value)
        return Edit(
            edit.value, edit.splices - SpliceList([(edit.splices.hull.middle, value.domain.stop)])
        )

    faults: dict[str, Callable[[Any], Any]] = {
        "raises": raises,
        "returns None": lambda value: None,
        "returns the bare value": lambda value: operation(value).value,
        "returns another kind": lambda value: Edit(_other_kind(value), operation(value).splices),
        "returns splices of a wrong type": lambda value: Edit(
            operation(value).value,
            list(operation(value).splices),  # type: ignore[arg-type]
        ),
        "returns NaN": lambda value: _spoilt(operation(value), np.nan),
        "returns infinity": lambda value: _spoilt(operation(value), np.inf),
        "reports nothing": lambda value: Edit(operation(value).value, SpliceList.EMPTY),
        "reports half of what it changed": half,
        "reports splices outside T": beyond,
    }

    def tool(what: str, fault: Callable[[Any], Any]) -> Tool[Any]:
        body = {
            "__slots__": (),
            "__doc__": f"A tool that {what}.",
            "name": what.lower().replace(" ", "-"),
            "edits": kind,
            "edit": lambda self, value, scene: fault(value),
        }
        return attrs.frozen(type("FaultyTool", (Tool,), body))()  # type: ignore[no-any-return]

    return {what: tool(what, fault) for what, fault in faults.items()}


def _other_kind(value: Representation) -> Representation:
    t = np.linspace(*value.domain, 5)
    if type(value) is LoopbackRepresentation:
        return CountingRepresentation(t, value(t))
    return LoopbackRepresentation(t, value(t))


def _spoilt(edit: Edit[Any], number: float) -> Edit[Any]:
    """Return the edit with one coordinate of its value replaced by ``number``."""
    value = copy.copy(edit.value)
    points = np.array(value.points)
    points[len(points) // 2, 0] = number
    stored = value.points
    spoilt = stored.replaced(0, len(points), points) if hasattr(stored, "replaced") else points
    for name in _attribute_names(value):
        if getattr(value, name, None) is stored:
            object.__setattr__(value, name, spoilt)
            return Edit(value, SpliceList([value.domain]))
    raise TypeError(f"cannot find where a {type(value).__name__} stores its points")


def _attribute_names(value: object) -> set[str]:
    slots = (name for kind in type(value).__mro__ for name in getattr(kind, "__slots__", ()))
    return {*slots, *getattr(value, "__dict__", {})}
