"""The nearest place on a polyline, exact, without looking at leaves that are too far away."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.nearest import distance_to_chords
from multirep.representations.polyline.boxes import LEAF, BlockBoxes


def nearest_place(t: BlockArray, points: BlockArray, boxes: BlockBoxes, point: Array) -> float:
    """Return the parameter of the place nearest to ``point``, (d,).

    Blocks are visited in the order of the distance of their boxes, until that exceeds the best
    found; in a block, the nearest leaf first, then all that could be nearer still. Of several
    equally near places, any. Cost: O(blocks), and O(leaves) of the few blocks that are near.
    """
    distances = _to_boxes(*boxes.linked, point)
    best, place = np.inf, float(t[0])
    for block in distances.argsort(kind="stable").tolist():
        if distances[block] > best:
            break
        base = int(boxes.starts[block])
        stop = min(base + len(boxes.blocks[block]) + 1, len(t))
        near = _to_boxes(*boxes.leaf_boxes(block), point)
        first = int(near.argmin())
        for leaves in (np.array([first]), np.flatnonzero(near < best)):
            rows = (base + LEAF * leaves[:, None] + np.arange(LEAF)).reshape(-1)
            rows = rows[rows < stop - 1] - base
            if not rows.size:
                continue
            vertices = points.window(base, stop)
            u, distance = distance_to_chords(vertices[rows], vertices[rows + 1], point)
            k = int(distance.argmin())
            if distance[k] < best:
                best = float(distance[k])
                low, high = (float(x) for x in t.window(base + rows[k], base + rows[k] + 2))
                place = min(max(low + float(u[k]) * (high - low), low), high)
                near[first] = np.inf  # done; its best is known
    return place


def _to_boxes(lows: Array, highs: Array, point: Array) -> Array:
    """Distances from a point to boxes, (k,); 0 inside."""
    outside = np.maximum(np.maximum(lows - point, point - highs), 0.0)
    result: Array = np.sqrt(np.einsum("ij,ij->i", outside, outside))
    return result
