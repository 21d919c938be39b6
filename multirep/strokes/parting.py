"""Strokes over an outline whose ends meet: they may begin anywhere, and go on over that place."""

from __future__ import annotations

from itertools import pairwise

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.sampled import interpolate
from multirep.strokes.arc_length import arc_lengths, norms
from multirep.strokes.cleaning import Stroke
from multirep.strokes.places import STATIONS, nearest_lengths

#: A step of the nearest place back by more than this part of an outline goes over its ends.
ROUND = 0.5


def parted(points: Array, lengths: Array, stroke: Stroke, close: float) -> list[Stroke]:
    """Return a stroke, or what it is made of, so that none goes over the ends of an outline.

    Parameters
    ----------
    points, lengths : (n, d) and (n,) arrays
        The outline and the length up to each vertex.
    stroke : Stroke
        In its direction.
    close : float
        Ends that are closer than this part of the length meet.

    Returns
    -------
    list of Stroke
        The stroke itself if the outline is open or it does not go over its ends. A stroke whose own
        ends meet begins anew beside those of the outline; another one is cut there.

    Examples
    --------
    >>> from multirep.strokes import clean_stroke
    >>> square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    >>> other = clean_stroke([[1, 1], [0, 1], [0, 0], [1, 0], [1, 1]], straight=True)
    >>> parted(square, arc_lengths(square), other, 0.1)[0].points.tolist()
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]
    """
    s, ends = arc_lengths(stroke.points), points[[0, -1]]
    same = norms(stroke.points[[0, -1]] - ends) <= close * min(lengths[-1], s[-1])
    if same.all() or not _meet(ends, close * lengths[-1]):
        return [stroke]
    asked = np.linspace(0.0, s[-1], STATIONS)
    where, _ = nearest_lengths(points, lengths, interpolate(s, stroke.points, asked))
    over = np.flatnonzero(where[1:] - where[:-1] < -ROUND * lengths[-1])
    if not len(over):
        return [stroke]
    cuts = [_beside(stroke.points, s, ends.mean(axis=0), asked[k], asked[k + 1]) for k in over]
    if len(cuts) == 1 and _meet(stroke.points[[0, -1]], close * s[-1]):
        return [_chained(_cut(stroke, s, cuts[0], s[-1]), _cut(stroke, s, 0.0, cuts[0]))]
    marks = [0.0, *cuts, float(s[-1])]
    parts = [(a, b) for a, b in pairwise(marks) if b - a > close * s[-1]]
    return [_cut(stroke, s, a, b) for a, b in parts]


def _meet(ends: Array, close: float) -> bool:
    return float(norms(ends[1:] - ends[:1])[0]) <= close


def _beside(points: Array, s: Array, place: Array, low: float, high: float) -> float:
    """Return the length between two at which a stroke is nearest to a place."""
    first, last = s.searchsorted(low, "right"), s.searchsorted(high)
    t = np.concatenate([[low], s[first:last], [high]])
    where, _ = nearest_lengths(interpolate(s, points, t), t, place[None])
    return float(where[0])


def _cut(stroke: Stroke, s: Array, low: float, high: float) -> Stroke:
    """Return the part of a stroke between two lengths."""
    inner = np.flatnonzero((s > low) & (s < high))
    ends = interpolate(s, stroke.points, np.array([low, high]))
    points = np.concatenate([ends[:1], stroke.points[inner], ends[1:]])
    corners = np.flatnonzero(np.isin(inner, stroke.corners)) + 1
    return attrs.evolve(stroke, points=points, corners=corners)


def _chained(first: Stroke, second: Stroke) -> Stroke:
    """Return two strokes in one; they share a point, or are joined by a straight line."""
    shared = int((first.points[-1] == second.points[0]).all())
    return attrs.evolve(
        first,
        points=np.concatenate([first.points, second.points[shared:]]),
        corners=np.concatenate([first.corners, second.corners + len(first.points) - shared]),
    )
