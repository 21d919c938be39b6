"""The stored truth: cubic control points on graded dyadic knots, in block arrays."""

from __future__ import annotations

from struct import Struct
from typing import Literal

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.patches import patch_of, patched, replacement
from multirep.representations.wavelet.dyadic import level_counts, parameters, recounted
from multirep.splices import SpliceList
from multirep.splines import compiled
from multirep.splines.evaluation import evaluate
from multirep.splines.pieces import largest_coordinate
from multirep.splines.polar import refine

__all__ = ["Graded", "clamped", "differences"]


_MAGNITUDE = Struct("=d")


@attrs.frozen(eq=False)
class Graded:
    """A cubic spline with knots k / 2**l of many levels (immutable).

    Make one with :meth:`of`.

    Parameters
    ----------
    domain : Interval
        T; the knots are mapped to it where they are used, and only there.
    u : (n + 4,) BlockArray
        Dyadic knots in [0, 1], fourfold at the ends, simple inside.
    points : (n, d) BlockArray
        Control points.
    counts : (53,) array
        How many interior knots each level has.
    magnitude : float
        At least the largest absolute value of a coordinate of a control point.
    """

    domain: Interval
    u: BlockArray
    points: BlockArray
    counts: Indices
    magnitude: float

    @classmethod
    def of(cls, domain: Interval, u: Array, points: Array) -> Graded:
        """Store knots (n + 4,) and control points (n, d); neither is checked."""
        return cls(
            domain,
            BlockArray.of(u),
            BlockArray.of(points),
            level_counts(u[4:-4]),
            largest_coordinate(points),
        )

    @property
    def size(self) -> int:
        """Number n of control points."""
        return len(self.points)

    @property
    def level(self) -> int:
        """The finest level of a knot; O(1)."""
        present = np.flatnonzero(self.counts)
        return int(present[-1]) if len(present) else 0

    @property
    def all_knots(self) -> BlockArray:
        """Knots (n + 4,) in T; O(n) unless T is [0, 1]."""
        if self.domain.start == 0.0 and self.domain.stop == 1.0:
            return self.u
        return BlockArray.of(parameters(np.asarray(self.u), self.domain))

    def knots(self, start: int, stop: int) -> Array:
        """Knots start..stop-1 as parameters in T."""
        return parameters(self.u.window(start, stop), self.domain)

    def span_at(self, t: float, side: Literal["left", "right"] = "right") -> int:
        """Return k with knot k <= t < knot k+1 (left: knot k < t <= knot k+1); O(log n)."""
        start, length = self.domain.start, self.domain.length
        k = self.u.searchsorted((t - start) / length, side) - 1
        k = min(max(k, 3), self.size - 1)
        if start != 0.0 or self.domain.stop != 1.0:
            # Mapping back and forth may be one off: the mapped knots decide.
            while k > 3 and self._behind(k, t, side):
                k -= 1
            while k < self.size - 1 and not self._behind(k + 1, t, side):
                k += 1
        return k

    def _behind(self, knot: int, t: float, side: Literal["left", "right"]) -> bool:
        at = float(self.knots(knot, knot + 1)[0])
        return at > t or (side == "left" and at == t)

    def window(self, first: int, last: int) -> tuple[Array, Array]:
        """Knots and control points that the spans first..last depend on: a spline of its own."""
        return self.knots(first - 3, last + 5), self.points.window(first - 3, last + 1)

    @property
    def stored(self) -> tuple[BlockArray, BlockArray, None] | None:
        """Knots, control points and no weights in their blocks, if the knots are parameters."""
        is_unit = self.domain.start == 0.0 and self.domain.stop == 1.0
        return (self.u, self.points, None) if is_unit else None

    def evaluate(self, t: Array) -> Array:
        """Points at some parameters (m,) of one stretch in T: (m, d)."""
        first, last = self.span_at(float(t.min())), self.span_at(float(t.max()))
        return evaluate(*self.window(first, last), 3, t)

    def replaced(
        self, knots: tuple[int, int], u: Array, points: tuple[int, int], rows: Array
    ) -> Graded:
        """Return the curve with ``u`` for one range of its knots, ``rows`` for one of its points.

        O(window): blocks outside are shared. Fourfold end knots in ``u`` must be all or none of
        each.
        """
        largest = largest_coordinate(rows)
        magnitude = self.magnitude if largest <= self.magnitude else largest  # NaN stays NaN
        changed = self.points.replaced(*points, rows)
        if not len(u) and knots[0] == knots[1]:
            return Graded(self.domain, self.u, changed, self.counts, magnitude)
        # Ends of T in both cancel; their level is 0 like that of no other knot.
        counts = recounted(self.counts, u, self.u.window(*knots))
        return Graded(self.domain, self.u.replaced(*knots, u), changed, counts, magnitude)

    def patch(self, other: Graded) -> bytes | None:
        """Return what makes this curve of ``other``, or None where that is no small thing."""
        if self.domain != other.domain:
            return None
        arrays = patch_of((self.u, self.points), (other.u, other.points))
        return None if arrays is None else _MAGNITUDE.pack(self.magnitude) + arrays

    def patched(self, patch: bytes) -> tuple[Graded, bytes | None]:
        """Return the curve that gave ``patch`` beside this one, and the patch back."""
        (magnitude,) = _MAGNITUDE.unpack_from(patch)
        patch = patch[_MAGNITUDE.size :]
        (u, points), back = patched((self.u, self.points), patch)
        counts = self.counts
        if u is not self.u:
            low, gone, come = replacement(patch)
            counts = recounted(counts, u.window(low, low + come), self.u.window(low, low + gone))
        made = Graded(self.domain, u, points, counts, magnitude)
        return made, None if back is None else _MAGNITUDE.pack(self.magnitude) + back

    def refined(self, u: Array) -> Graded:
        """Return the same curve with more knots.

        Parameters
        ----------
        u : (m,) array
            Sorted distinct dyadic numbers in (0, 1); those that are knots already are ignored.

        Notes
        -----
        Control points whose knots do not change stay bit-identical; the others are polar forms of
        the old pieces. O(window between the first and the last new knot).
        """
        if not len(u):
            return self
        first = min(max(self.u.searchsorted(u[0], "right") - 1, 3), self.size - 1)
        last = min(max(self.u.searchsorted(u[-1]) - 1, first), self.size - 1)
        old = self.u.window(first - 3, last + 5)
        if (old.take(old.searchsorted(u)) == u).all():
            return self
        # A knot at either end of the window is there already.
        finer = np.union1d(old[4:-4], u[(u > old[3]) & (u < old[-4])])
        finer = np.concatenate((old[:4], finer, old[-4:]))
        knots, points = self.window(first, last)
        rows = refine(knots, points, 3, parameters(finer, self.domain))
        return self.replaced((first + 1, last + 1), finer[4:-4], (first - 3, last + 1), rows)


def clamped(u: Array) -> Array:
    """Repeat the ends of breaks (m + 1,) three times more: a knot vector (m + 7,).

    Examples
    --------
    >>> clamped(np.array([0.0, 0.5, 1.0]))
    array([0. , 0. , 0. , 0. , 0.5, 1. , 1. , 1. , 1. ])
    """
    knots: Array = np.concatenate((np.repeat(u[0], 3), u, np.repeat(u[-1], 3)))
    return knots


def differences(one: Graded, two: Graded) -> SpliceList:
    """Where two versions may differ: on the spans that read another knot or control point.

    Shared blocks are not looked into; between the first and the last difference span is compared
    with span, bit by bit. O(changed blocks).
    """
    low, high, _ = one.u.difference(two.u)
    first, stop, _ = one.points.difference(two.points)
    shift = two.size - one.size
    # Span k reads knots k - 2 .. k + 3 and control points k - 3 .. k.
    begin, end = one.size, 3
    if low < high or shift:
        begin, end = min(begin, low - 3), max(end, high + 2)
    if first < stop or shift:
        begin, end = min(begin, first), max(end, stop + 3)
    begin, end = max(begin, 3), min(end, one.size)
    if begin >= end:
        return SpliceList.EMPTY
    if compiled.active:
        rows = one.points.window(begin - 3, end), two.points.window(begin - 3, end + shift)
        read = one.u.window(begin - 3, end + 4), two.u.window(begin - 3, end + shift + 4)
        intervals = compiled.core.changed_spans(3, *read, [rows])
        starts, stops = parameters(np.array(intervals).reshape(-1, 2).T, one.domain).tolist()
        return SpliceList.unchecked(tuple(starts), tuple(stops))
    count, a = end - begin, one.u.window(begin - 2, end + 3)
    mine = one.points.window(begin - 3, end).view(np.int64)
    theirs = two.points.window(begin - 3, end + shift).view(np.int64)
    if low == high and not shift:
        kept = [(mine == theirs, 4)]
    else:
        b = two.u.window(begin - 2, end + shift + 3)
        # Where each knot has gone; those at the ends of T are several.
        moved = b.searchsorted(a) - np.arange(len(a))
        moved[a == 0.0] = 0
        moved[a == 1.0] = shift
        places = np.minimum(np.arange(len(a)) + moved, len(b) - 1)
        # Control point i goes with knot i + 1, which every span that reads it reads too.
        at = np.minimum(places[: len(mine)], len(theirs) - 1)
        kept = [
            (mine == theirs.take(at, axis=0), 4),
            (moved[1:, None] == moved[:-1, None], 5),
            (b.take(places)[:, None] == a[:, None], 6),
        ]
    same = np.ones(count, dtype=bool)
    for equal, width in kept:
        whole = equal.all(axis=1)
        for k in range(width):
            same &= whole[k : k + count]
    changed = (~same).nonzero()[0]
    if not len(changed):
        return SpliceList.EMPTY
    apart = (changed[1:] > changed[:-1] + 1).nonzero()[0]
    starts = changed[np.concatenate(([0], apart + 1))]
    stops = changed[np.concatenate((apart, [len(changed) - 1]))]
    knots = parameters(a[2:-2], one.domain)
    return SpliceList(zip(knots[starts].tolist(), knots[stops + 1].tolist(), strict=True))
