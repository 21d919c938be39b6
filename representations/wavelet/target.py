"""What a fit follows: a polyline with an allowance on each chord, about a local origin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from multirep.arrays import Array, Indices
from multirep.sampled import SampledSplice
from multirep.splines import compiled

__all__ = ["Target"]


#: A vertex is a corner if its turn times the shorter chord beside it exceeds the allowance by this
#: factor: evenly spread knots, two to a chord, leave 1/14 to 1/25 of that product.
_CORNER = 20.0
#: Knots beside a corner are off it by so many allowances through the turn; three knots (-w, 0, w)
#: leave 1/6 of turn times w. Larger needs more knots, smaller higher levels.
_WIDTH = 2.5


class Target(NamedTuple):
    """The polyline L of a sampled splice, ready for many evaluations; coordinates come first.

    Examples
    --------
    >>> target = Target.of(SampledSplice([0, 1, 3], [[4.0], [6.0], [8.0]]), 0.5)
    >>> values, chords = target.at(np.array([0.5, 1.0, 2.0, 3.0]))
    >>> (values[0] + target.origin[0]).tolist(), chords.tolist()
    ([5.0, 6.0, 7.0, 8.0], [0, 1, 1, 1])
    """

    t: Array
    """(m + 1,) parameters."""
    points: Array
    """(d, m + 1), relative to the origin."""
    slopes: Array
    """(d, m), of the chords."""
    allowances: Array
    """(m,), how far the fit may be from each chord."""
    origin: Array
    """(d,), a vertex; fits keep their digits however far the curve is from zero."""
    corners: Array
    """(c,) parameters of vertices so sharp that they need knots much closer than the chords."""
    widths: Array
    """(c,), how far from its corner a knot on either side may be."""

    @classmethod
    def of(cls, sampled: SampledSplice, tolerance: float) -> Target:
        """Prepare a sampled splice."""
        return cls.along(sampled.t, sampled.points, sampled.allowance(tolerance))

    @classmethod
    def along(cls, t: Array, rows: Array, allowances: Array) -> Target:
        """Prepare a polyline, (m + 1,) and (m + 1, d), with what is allowed on each chord, (m,)."""
        origin = rows[0]
        if compiled.active:
            count, dimension = rows.shape
            points, slopes = np.empty((dimension, count)), np.empty((dimension, count - 1))
            corners, reach = compiled.core.target(
                t, rows, allowances, _CORNER, _WIDTH, points, slopes
            )
            ends = np.array(corners), np.array(reach)
            return cls(t, points, slopes, allowances, origin, *ends)
        points = np.ascontiguousarray((rows - origin).T)
        lengths = t[1:] - t[:-1]
        slopes = (points[:, 1:] - points[:, :-1]) / lengths
        turns = slopes[:, 1:] - slopes[:, :-1]
        turns *= turns
        sharp = np.sqrt(turns.sum(axis=0))
        room = np.minimum(allowances[1:], allowances[:-1])
        near = np.minimum(lengths[1:], lengths[:-1])
        found = np.flatnonzero(sharp * near > room * _CORNER)
        widths = room.take(found) * (_WIDTH / sharp.take(found))
        return cls(t, points, slopes, allowances, origin, t.take(found + 1), widths)

    def at(self, t: Array) -> tuple[Array, Indices]:
        """Return L about the origin, (d, *t.shape), and chords; a vertex belongs to the next."""
        if compiled.active:
            values = np.empty((len(self.points), *t.shape))
            chords = np.empty(t.shape, dtype=np.intp)
            compiled.core.follow(self.t, self.points, self.slopes, t, values, chords)
            return values, chords
        chords = self.t.searchsorted(t, side="right")
        chords -= 1
        np.minimum(chords, len(self.allowances) - 1, out=chords)
        values = self.slopes.take(chords, axis=1)
        values *= t - self.t.take(chords)
        values += self.points.take(chords, axis=1)
        return values, chords
