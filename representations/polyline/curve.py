"""The polyline: vertices at increasing parameters, joined by lines (Grimm-Ayers 6.1)."""

from __future__ import annotations

from typing import Any, ClassVar, Self

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.blocks import BlockArray
from multirep.capsules import Known
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ParameterError
from multirep.interval import Interval
from multirep.nearest import nearest_in_tree
from multirep.patches import patch_of, patched
from multirep.representation import Nearest, Representation
from multirep.representations.polyline.boxes import BlockBoxes
from multirep.representations.polyline.chord_length import chord_length
from multirep.representations.polyline.differences import changed_stretches
from multirep.representations.polyline.evaluation import evaluate, evaluate_one, slopes
from multirep.representations.polyline.holding import NOTHING, held, released
from multirep.representations.polyline.proximity import tree
from multirep.representations.polyline.sampling import sample_stretch
from multirep.representations.polyline.splicing import follow
from multirep.representations.polyline.validation import (
    checked_parameters,
    checked_points,
    checked_replacement,
    checked_row,
    checked_rows,
    two_distinct,
)
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList


@attrs.frozen(eq=False, init=False, repr=False)
class Polyline(Representation):
    """Vertices with strictly increasing parameters, linear in between; an immutable value.

    Parameters
    ----------
    t : (n,) array_like
        Strictly increasing; the first and the last are the ends of T.
    points : (n, d) array_like
        Finite, at least two distinct ones; neighbours may coincide.

    Raises
    ------
    InvalidCurveError
        When the data are anything else; the message says what and where.

    Examples
    --------
    >>> polyline = Polyline([0, 1, 3], [[0, 0], [1, 1], [3, 1]])
    >>> polyline(2.0), polyline.size
    (array([2., 1.]), 3)
    >>> edit = polyline.move_vertex(1, [1, 2])
    >>> print(edit.splices, edit.value.points[1])
    [0,3] [1. 2.]
    """

    name: ClassVar[str] = "polyline"
    summary: ClassVar[str] = "vertices joined by straight lines"

    #: (n,) parameters.
    t: BlockArray
    #: (n, d) vertices.
    points: BlockArray
    domain: Interval
    dimension: int
    #: Boxes of this value or an earlier version, from which those of this one are renewed when
    #: somebody asks.
    _known_boxes: BlockBoxes | None
    #: What all versions share to find nearest places.
    _known: Known

    def __init__(self, t: ArrayLike, points: ArrayLike) -> None:
        rows = checked_points(points)
        values = checked_parameters(t, len(rows))
        if (rows == rows[0]).all():
            raise InvalidCurveError(
                "a polyline needs two distinct points or more, "
                f"got {len(rows)} times {rows[0].tolist()}"
            )
        domain = Interval(float(values[0]), float(values[-1]))
        self._set(BlockArray.of(values), BlockArray.of(rows), domain, None, Known())

    @classmethod
    def from_points(
        cls,
        points: ArrayLike,
        *,
        t: ArrayLike | None = None,
        domain: Interval | tuple[float, float] = (0.0, 1.0),
    ) -> Self:
        """Join points by straight lines.

        Parameters
        ----------
        points : (n, d) array_like
            Without ``t``, consecutive repeated points are merged (:func:`chord_length` says how
            many).
        t : (n,) array_like, optional
            Parameters; by default in proportion to the length of the polyline, over ``domain``.
        domain : Interval or pair, optional
            T.

        Examples
        --------
        >>> Polyline.from_points([[0, 0], [3, 0], [3, 0], [3, 1]]).t
        BlockArray(shape=(3,), blocks=1)
        """
        if t is not None:
            return cls(t, points)
        parameters, rows, _ = chord_length(points, domain=Interval.of(domain))
        return cls(parameters, rows)

    def _with(self, t: BlockArray, points: BlockArray) -> Self:
        """Return another version over the same T; nothing is checked."""
        new = object.__new__(type(self))
        new._set(t, points, self.domain, self._known_boxes, self._known)
        return new

    def _set(
        self,
        t: BlockArray,
        points: BlockArray,
        domain: Interval,
        boxes: BlockBoxes | None,
        known: Known,
    ) -> None:
        put = object.__setattr__
        put(self, "t", t)
        put(self, "points", points)
        put(self, "domain", domain)
        put(self, "dimension", points.row_shape[0])
        put(self, "_known_boxes", boxes)
        put(self, "_known", known)

    # -- the contract ------------------------------------------------------------------------------

    def __call__(self, t: ArrayLike) -> Array:
        """Points at parameters: scalar -> (d,), (m,) -> (m, d); vertices bit by bit."""
        if isinstance(t, float) and self.domain.start <= t <= self.domain.stop:
            return evaluate_one(self.t, self.points, t)
        at = self.parameters(t)
        if at.ndim == 0:
            return evaluate_one(self.t, self.points, float(at))
        values = evaluate(self.t, self.points, at.reshape(-1))
        return values.reshape(*at.shape, self.dimension)

    def derivative(self, t: ArrayLike, order: int = 1, side: str = "right") -> Array:
        """Return the derivative by t from one side (at the ends of T from inside).

        Examples
        --------
        >>> polyline = Polyline([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
        >>> polyline.derivative(1.0, side="left"), polyline.derivative(1.0, order=2)
        (array([1., 1.]), array([0., 0.]))
        """
        if side not in ("left", "right"):
            raise ValueError(f"side must be 'left' or 'right', got {side!r}")
        if order < 0:
            raise ValueError(f"order must be >= 0, got {order!r}")
        at = self.parameters(t)
        if order == 0:
            return self(at)
        if order > 1:
            return np.zeros((*at.shape, self.dimension))
        return slopes(self.t, self.points, at.reshape(-1), side).reshape(*at.shape, self.dimension)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Return the stretch itself: exact, with its vertices as samples.

        The bound is 0, or the rounding of the point where an end of ``interval`` cuts a segment.
        ``breaks`` are the vertices whose kink no smooth curve can hide at this tolerance. Cost:
        O(vertices inside).
        """
        if not (self.domain.contains(interval) and interval.start < interval.stop):
            raise ParameterError(f"{interval} is not a stretch of the domain {self.domain}")
        return sample_stretch(self.t, self.points, interval, tolerance)

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Replace the vertices on an interval by as few samples as the allowance needs.

        An end inside T keeps its place on this curve; where it is no vertex it becomes one, which
        changes the rest of that segment by rounding, so the reported splice reaches to the next
        vertex. See :meth:`Representation.splice`.

        Raises
        ------
        ToleranceError
            When an end stands farther from the samples than allowed.
        """
        a, b = sampled.interval
        if not self.domain.contains(sampled.interval):
            raise ParameterError(f"{sampled.interval} lies outside the domain {self.domain}")
        if sampled.dimension != self.dimension:
            raise InvalidCurveError(
                f"samples with {sampled.dimension} coordinates for a curve with {self.dimension}"
            )
        first, last = self.t.searchsorted(a), self.t.searchsorted(b)
        on_first, on_last = float(self.t[first]) == a, float(self.t[last]) == b
        start = stop = None
        if a > self.domain.start:
            start = self.points[first] if on_first else self(a)
        if b < self.domain.stop:
            stop = self.points[last] if on_last else self(b)
        new = follow(sampled, tolerance, start, stop)
        reported = (
            a if on_first else float(self.t[first - 1]),
            b if on_last else float(self.t[last]),
        )
        return self._replaced(first, last + on_last, new.t, new.points, reported, bound=new.bound)

    @classmethod
    def fit(cls, sampled: SampledSplice, *, tolerance: float, **options: Any) -> Self:
        """Return the polyline over T with as few samples as the allowance needs."""
        cls.check_options(options)
        new = follow(sampled, tolerance, None, None)
        return cls(new.t, new.points)

    # -- what it offers beyond ---------------------------------------------------------------------

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Grow to existing vertices where ``within`` lets it: splices there insert none."""
        low = float(self.t[max(self.t.searchsorted(interval.start, "right") - 1, 0)])
        high = float(self.t[min(self.t.searchsorted(interval.stop), len(self.t) - 1)])
        return Interval(
            low if low >= within.start else interval.start,
            high if high <= within.stop else interval.stop,
        )

    def held(self, interval: Interval, keep: SpliceList = NOTHING) -> tuple[Edit[Self], Interval]:
        """Make vertices of the ends; see `Representation.held`."""
        return held(self, interval, keep)

    def released(self, t: float, count: int) -> Edit[Self]:
        """Delete the vertex at ``t`` if it lies on the line between its neighbours."""
        return released(self, t)

    def changes(self, other: Self) -> SpliceList:
        """Where two versions may differ: the segments that they do not share; O(changed blocks)."""
        if self.domain != other.domain or self.dimension != other.dimension:
            return SpliceList([self.domain.hull(other.domain)])
        return changed_stretches(self.t, self.points, other.t, other.points)

    def patch(self, other: Self) -> bytes | None:
        """Return what makes this value of ``other``; see `Representation.patch`."""
        same = self.domain == other.domain
        return patch_of((self.t, self.points), (other.t, other.points)) if same else None

    def patched(self, patch: bytes) -> tuple[Self, bytes | None]:
        """Return the value that gave ``patch`` beside this one; O(vertices in the patch)."""
        arrays, back = patched((self.t, self.points), patch)
        return self._with(*arrays), back

    def nearest(self, point: ArrayLike) -> Nearest:
        """Return the nearest place, exact up to rounding, or those of many points."""
        return nearest_in_tree(self, lambda: tree(self._known, self.t, self.points), point)

    @property
    def boxes(self) -> BlockBoxes:
        """Bounding boxes of the blocks; made when first asked for, renewed after edits."""
        boxes = BlockBoxes.of(self.points, self._known_boxes)
        if boxes is not self._known_boxes:
            object.__setattr__(self, "_known_boxes", boxes)  # a cache: the value stays what it is
        return boxes

    @property
    def size(self) -> int:
        """Number of vertices."""
        return len(self.t)

    @property
    def magnitude(self) -> float:
        """The largest |coordinate|, exact; O(changed blocks) after an edit."""
        return self.boxes.magnitude

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        return self.points.__array__(dtype, copy)

    def to_dict(self) -> dict[str, Any]:
        """Return ``{"t": [...], "points": [[...], ...]}``, in full precision."""
        return {"t": self.t.tolist(), "points": self.points.tolist()}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Read what :meth:`to_dict` wrote; InvalidCurveError for anything else."""
        if set(data) != {"t", "points"}:
            raise InvalidCurveError(
                f"a polyline is written as t and points, got {sorted(map(str, data))[:9]}"
            )
        return cls(data["t"], data["points"])

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (np.asarray(self.t), np.asarray(self.points))

    def __repr__(self) -> str:
        return f"Polyline({self.size} vertices in {self.dimension} coordinates over {self.domain})"

    # -- primitive operations (Grimm-Ayers 6.1) ----------------------------------------------------

    def move_vertex(self, index: int, to: ArrayLike) -> Edit[Self]:
        """Move one vertex; affected is the interval between its neighbours."""
        return self.move_vertices(index, checked_row(to, self.dimension))

    def move_vertices(self, start: int, rows: ArrayLike) -> Edit[Self]:
        """Move the vertices ``start``, ``start`` + 1, ... to ``rows``, (k, d)."""
        new = checked_rows(rows, self.dimension)
        stop = self._index(start) + len(new)
        if stop > self.size:
            raise EditError(
                f"vertices {start} to {stop - 1} of a polyline with vertices 0 to {self.size - 1}"
            )
        if (self.points.window(start, stop) == new).all():
            return Edit(self, SpliceList.EMPTY)
        points = self.points.replaced(start, stop, new)
        return self._edit(self.t, points, self._between(start, stop))

    def insert_vertex(self, t: float, point: ArrayLike | None = None) -> Edit[Self]:
        """Insert a vertex, by default on the curve; affected is the segment it divides."""
        at = float(self.parameters(t))
        k = self.t.searchsorted(at)
        if float(self.t[k]) == at:
            raise EditError(f"there is a vertex at t = {at!r} already: vertex {k}")
        row = self(at)[None] if point is None else checked_row(point, self.dimension)
        return self.replace(k, k, [at], row)

    def delete_vertex(self, index: int) -> Edit[Self]:
        """Delete an inner vertex; affected is the interval between its neighbours."""
        if self._index(index) in (0, self.size - 1):
            raise EditError(f"vertex {index} is an end of the curve and cannot be deleted")
        return self.replace(index, index + 1, [], np.empty((0, self.dimension)))

    def replace(self, start: int, stop: int, t: ArrayLike, points: ArrayLike) -> Edit[Self]:
        """Replace the vertices ``start`` .. ``stop`` - 1 by others, more or fewer.

        Parameters
        ----------
        start, stop : int
            0 <= start <= stop <= n.
        t : (k,) array_like
            Strictly increasing, between the parameters of the vertices around; the ends of T stay.
        points : (k, d) array_like

        Raises
        ------
        EditError
            When the result would be no polyline over T.
        """
        values, rows, reported = checked_replacement(self, start, stop, t, points)
        return self._replaced(start, stop, values, rows, reported)

    def _replaced(
        self,
        start: int,
        stop: int,
        t: Array,
        rows: Array,
        reported: tuple[float, float],
        *,
        bound: float = 0.0,
    ) -> Edit[Self]:
        new_t, points = self.t.replaced(start, stop, t), self.points.replaced(start, stop, rows)
        return self._edit(new_t, points, SpliceList([reported]), bound)

    def _edit(
        self, t: BlockArray, points: BlockArray, splices: SpliceList, bound: float = 0.0
    ) -> Edit[Self]:
        if not two_distinct(points):
            raise EditError(
                "all vertices would fall into one point; a curve needs two distinct ones"
            )
        return Edit(self._with(t, points), splices, bound)

    def _between(self, start: int, stop: int) -> SpliceList:
        """Return the interval from the vertex before ``start`` to the one at ``stop``."""
        return SpliceList(
            [(float(self.t[max(start - 1, 0)]), float(self.t[min(stop, self.size - 1)]))]
        )

    def _index(self, index: int) -> int:
        if not 0 <= index < self.size:
            raise EditError(
                f"there is no vertex {index}: this polyline has vertices 0 to {self.size - 1}"
            )
        return index
