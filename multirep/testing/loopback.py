"""The loopback: a representation that is trivially right, as short as a real plugin can be.

Read it before you write your own.
"""

from __future__ import annotations

from typing import Any, Self

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, interpolate
from multirep.splices import SpliceList


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
        """Store the samples; there are no options."""
        cls.check_options(options)
        return cls(sampled.t, sampled.points)

    # -- what may be overridden --------------------------------------------------------------------

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Prefer vertices as ends, for then no chord is cut."""
        i = self.t.searchsorted(interval.start, side="right") - 1
        j = self.t.searchsorted(interval.stop, side="left")
        nicer = Interval(float(self.t[i]), float(self.t[j]))
        return nicer if within.contains(nicer) else interval

    def changes(self, other: Self) -> SpliceList:
        """Where a vertex of one is not a vertex of the other, with the chords beside it."""
        rows = [
            np.ascontiguousarray(np.column_stack([v.t, v.points])).view(f"V{8 * (v.dimension + 1)}")
            for v in (self, other)
        ]
        shared = [np.isin(a[:, 0], b[:, 0]) for a, b in (rows, rows[::-1])]
        common, odd = self.t[shared[0]], np.concatenate([self.t[~shared[0]], other.t[~shared[1]]])
        marks = np.concatenate([self.t[:1], common, self.t[-1:]])
        k = common.searchsorted(odd)
        return SpliceList(zip(marks[k], marks[k + 1], strict=True))

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
