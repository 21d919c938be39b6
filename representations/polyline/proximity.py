"""The nearest place on a polyline, exact, without looking at blocks that are too far away."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.nearest import distance_to_chords
from multirep.representations.polyline.boxes import BlockBoxes


def nearest_place(t: BlockArray, points: BlockArray, boxes: BlockBoxes, point: Array) -> float:
    """Return the parameter of the place nearest to ``point``, (d,).

    Blocks are visited in the order of the distance of their boxes, until that exceeds the best
    found. Of several equally near places, any. Cost: O(blocks), and O(rows) of the few blocks that
    are near.
    """
    lows, highs = boxes.with_links()
    outside = np.maximum(np.maximum(lows - point, point - highs), 0.0)
    distances = np.sqrt(np.einsum("ij,ij->i", outside, outside))
    ends = np.cumsum([len(block) for block in boxes.blocks])
    best, place = np.inf, float(t[0])
    for block in distances.argsort(kind="stable").tolist():
        if distances[block] > best:
            break
        start = int(ends[block]) - len(boxes.blocks[block])
        stop = min(int(ends[block]) + 1, len(t))
        if stop - start < 2:
            continue  # the last block holds one vertex, which ends the link of the one before
        rows, window = points.window(start, stop), t.window(start, stop)
        u, distance = distance_to_chords(rows[:-1], rows[1:], point)
        k = int(distance.argmin())
        if distance[k] < best:
            best = float(distance[k])
            place = float(window[k] + u[k] * (window[k + 1] - window[k]))
            place = min(max(place, float(window[k])), float(window[k + 1]))
    return place
