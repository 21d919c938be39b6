"""The stretches of a polyline near a stroke, as sand that is split, pushed and merged."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array, Indices
from multirep.errors import EditError
from multirep.representations.polyline import Polyline
from multirep.representations.polyline.simplification import every_other

Mask: TypeAlias = npt.NDArray[np.bool_]

#: Longest segment in contact, in radii (Grimm-Ayers 5.1). Also the longest step of the motion: a
#: vertex in front of the circle is then pushed on, and no segment swallows the centre.
SPLIT = 1 / 4
#: Two segments together shorter than this, in radii, become one (Grimm-Ayers 5.1).
MERGE = 1 / 8
#: Pushed vertices that are closer than this, in radii, crowd; one of them stays in each stretch of
#: SPACED radii: more than half of MERGE, so that few need to merge after that, and with a crossing
#: segment less than all of it.
SPACED, CROWDED = 3 / 4 * MERGE, 3 / 16 * MERGE
#: Roundings of coordinates that a radius must exceed; below, segments of a quarter of it cannot be
#: told apart.
RESOLUTION = 2.0**12
#: Boxes that a stroke is described by when the blocks of the curve are looked through.
LEG_BOXES = 256
#: Entries of a table of points against legs that is worked on at a time.
TABLE = 2**16
#: Halvings of one segment; a segment 2^60 times too long has no parameters left either.
HALVINGS = 60


class Sand:
    """Rows of vertices, stretch after stretch; each operation works on all of them at once.

    Attributes
    ----------
    points : (k, 2) array
    t : (k,) array
        NaN for vertices that the stroke added.
    source : (k,) array of int
        The index of the vertex in the polyline; -1 for new ones.
    moved : (k,) bool array
        Whether the spatula pushed or added it.
    ends : (k,) bool array
        Whether no segment leads to the next row.
    """

    points: Array
    t: Array
    source: Indices
    moved: Mask
    ends: Mask

    def __init__(self, polyline: Polyline, path: Array, radius: float) -> None:
        self.radius = radius
        self.rounding = 4 * np.spacing(max(polyline.magnitude, float(np.abs(path).max()) + radius))
        if radius < RESOLUTION * self.rounding:
            raise EditError(
                f"radius {radius:g} is below the resolution of coordinates up to "
                f"{polyline.magnitude:g}; the smallest is {RESOLUTION * self.rounding:.3g}"
            )
        legs = path[:-1], path[1:]
        runs = polyline.boxes.runs(_near_boxes(*legs, radius))
        rows = np.concatenate([np.arange(*run) for run in runs] or [np.empty(0, dtype=np.intp)])
        self.source = rows
        self.t = np.concatenate([polyline.t.window(*run) for run in runs] or [np.empty(0)])
        self.points = np.concatenate([polyline.points.window(*run) for run in runs] or [path[:0]])
        self.ends = np.append(rows[1:] != rows[:-1] + 1, True)[: len(rows)]
        self.moved = np.zeros(len(rows), dtype=bool)
        self._keep_contacts(*legs)
        self._split_contacts(*legs)

    def __len__(self) -> int:
        return len(self.t)

    # -- preparing ---------------------------------------------------------------------------------

    def _keep_contacts(self, starts: Array, stops: Array) -> None:
        """Drop the vertices whose two segments stay away from the stroke."""
        segment = ~self.ends
        segment[:-1] &= self._in_contact(self.points[:-1], self.points[1:], starts, stops)
        needed = segment.copy()
        needed[1:] |= segment[:-1]
        self.ends = ~segment
        self._take(np.flatnonzero(needed))

    def _split_contacts(self, starts: Array, stops: Array) -> None:
        """Halve segments near the stroke until those in contact are short enough."""
        candidates = np.flatnonzero(~self.ends)
        for _ in range(HALVINGS):
            long = candidates[self._lengths()[candidates] > SPLIT * self.radius]
            long = self._contacts(starts, stops, long)
            if not long.size:
                return
            middle = 0.5 * (self.t[long] + self.t[long + 1])
            if ((middle <= self.t[long]) | (middle >= self.t[long + 1])).any():
                raise EditError(f"no parameters are left near t = {middle[0]!r} for new vertices")
            places = self._halve(long)
            self.t[places] = middle
            candidates = np.sort(np.concatenate([places - 1, places]))
        raise EditError("a segment is too long for a spatula of this radius")

    def _contacts(self, starts: Array, stops: Array, segments: Indices) -> Indices:
        """Return those of the segments that may come closer to the stroke than the radius."""
        if not segments.size:
            return segments
        near = self._in_contact(self.points[segments], self.points[segments + 1], starts, stops)
        return segments[near]

    def _in_contact(self, first: Array, second: Array, starts: Array, stops: Array) -> Mask:
        middle = 0.5 * (first + second)
        reach = self.radius + 0.5 * _norms(second - first) + self.rounding
        return _within(middle, reach, starts, stops)

    # -- the stroke --------------------------------------------------------------------------------

    def push(self, centre: Array, forward: Array) -> None:
        """Move the circle to ``centre``: vertices inside go to the nearest point of its boundary.

        Segments that this makes too long are halved, those that it makes too short are merged.
        """
        off = self.points - centre
        inside = np.flatnonzero(_norms(off) < self.radius - self.rounding)
        if not inside.size:
            return
        self._to_boundary(inside, centre, forward)
        for _ in range(HALVINGS):
            long = self._touched() & (self._lengths() > SPLIT * self.radius)
            if not long.any():
                break
            places = self._halve(np.flatnonzero(long))
            self.moved[places] = True
            deep = _norms(self.points[places] - centre) < self.radius - self.rounding
            self._to_boundary(places[deep], centre, forward)
        self._merge()

    def _to_boundary(self, rows: Indices, centre: Array, forward: Array) -> None:
        off = self.points[rows] - centre
        distance = _norms(off)
        central = distance <= self.rounding  # no nearest point: ahead, where the stroke goes
        off[central], distance[central] = forward, 1.0
        self.points[rows] = centre + off * (self.radius / distance)[:, None]
        self.moved[rows] = True

    def _merge(self) -> None:
        """Remove moved vertices between two segments that are short together."""
        rows = self._spaced()
        points, moved, ends = self.points[rows], self.moved[rows], self.ends[rows]
        while len(rows) > 2:  # a few rounds, in each every other one; columns are cut at last
            lengths = _norms(points[1:] - points[:-1])
            lengths[ends[:-1]] = np.inf
            both = lengths[:-1] + lengths[1:] < MERGE * self.radius
            merged = np.flatnonzero(both & moved[1:-1]) + 1
            if not merged.size:
                break
            keep = np.ones(len(rows), dtype=bool)
            keep[merged[every_other(merged)]] = False
            rows, points, moved, ends = rows[keep], points[keep], moved[keep], ends[keep]
        if len(rows) < len(self):
            self._take(rows)

    def _spaced(self) -> Indices:
        """Rows, less those of crowds of pushed ones: of these one stays in each stretch.

        Of a dense curve most go here at once, where merging two by two would take many rounds. No
        segment that this makes is longer than ``MERGE``.
        """
        lengths = self._lengths()[:-1]
        crowded = self.moved[:-1] & self.moved[1:] & (lengths < CROWDED * self.radius)
        place = np.floor(np.where(crowded, lengths, 0.0).cumsum() / (SPACED * self.radius))
        stays = np.ones(len(self), dtype=bool)
        # the last in each stretch, and the ends of each crowd
        stays[1:-1] = ~(crowded[1:] & crowded[:-1]) | (place[1:] != place[:-1])
        return np.flatnonzero(stays)

    # -- rows --------------------------------------------------------------------------------------

    def _lengths(self) -> Array:
        """Length of the segment from each row to the next; infinite where there is none."""
        lengths = np.full(len(self), np.inf)
        lengths[:-1] = _norms(self.points[1:] - self.points[:-1])
        lengths[self.ends] = np.inf
        return lengths

    def _touched(self) -> Mask:
        """Whether the segment from each row to the next has a moved end."""
        touched = self.moved.copy()
        touched[:-1] |= self.moved[1:]
        return touched & ~self.ends

    def _halve(self, segments: Indices) -> Indices:
        """Insert the middles of segments; return the rows of the new vertices (their t is NaN)."""
        counts = np.ones(len(self), dtype=np.intp)
        counts[segments] = 2
        middles = 0.5 * (self.points[segments] + self.points[segments + 1])
        places = segments + 1 + np.arange(len(segments))
        self._take(np.repeat(np.arange(len(self)), counts))
        self.points[places] = middles
        self.t[places], self.source[places], self.moved[places] = np.nan, -1, False
        return places

    def _take(self, rows: Indices) -> None:
        for name in ("points", "t", "source", "moved", "ends"):
            setattr(self, name, getattr(self, name)[rows])


def _norms(vectors: Array) -> Array:
    lengths: Array = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    return lengths


def _near_boxes(starts: Array, stops: Array, radius: float) -> Callable[[Array, Array], Mask]:
    """Return the test whether boxes come within ``radius`` of the boxes of the legs."""
    each = -(-len(starts) // LEG_BOXES)  # one box for several legs, if there are many
    groups = np.arange(0, len(starts), each)
    lows = np.minimum.reduceat(np.minimum(starts, stops), groups) - radius
    highs = np.maximum.reduceat(np.maximum(starts, stops), groups) + radius

    def hit(box_lows: Array, box_highs: Array) -> Mask:
        apart = np.any((box_lows[:, None] > highs) | (box_highs[:, None] < lows), axis=2)
        result: Mask = ~np.all(apart, axis=1)
        return result

    return hit


def _within(points: Array, reach: Array, starts: Array, stops: Array) -> Mask:
    """Whether points are within their ``reach`` of any of the legs start-stop; (m,)."""
    result = np.zeros(len(points), dtype=bool)
    if not len(points):
        return result
    far, each = (reach * reach)[:, None], max(1, TABLE // len(points))
    for k in range(0, len(starts), each):
        start = starts[k : k + each]
        leg = stops[k : k + each] - start
        square = np.einsum("ij,ij->i", leg, leg)
        # coordinate by coordinate: sums over a short last axis cost several times as much
        x, y = points[:, :1] - start[:, 0], points[:, 1:] - start[:, 1]
        along = (x * leg[:, 0] + y * leg[:, 1]) / np.where(square > 0, square, 1.0)
        along = np.minimum(np.maximum(along, 0.0), 1.0)
        x -= along * leg[:, 0]
        y -= along * leg[:, 1]
        result |= (x * x + y * y <= far).any(axis=1)
    return result
