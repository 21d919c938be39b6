"""Boxes around the blocks of control points: how large the curve is, and where it is not."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.blocks import BlockArray


@attrs.frozen(eq=False)
class Boxes:
    """The smallest and largest coordinates of each block.

    Parameters
    ----------
    blocks : tuple of (rows, d) arrays
        What was measured.
    boxes : tuple of (2, d) arrays
        Of each block.
    sizes : tuple of float
        Largest |coordinate| in each block.
    """

    blocks: tuple[Array, ...]
    boxes: tuple[Array, ...]
    sizes: tuple[float, ...]

    @classmethod
    def of(cls, points: BlockArray) -> Boxes:
        """Measure all blocks."""
        boxes = tuple(map(_measured, points.blocks))
        return cls(points.blocks, boxes, tuple(map(_size, boxes)))

    def renewed(self, points: BlockArray) -> Boxes:
        """Return the boxes of the next version: only blocks that are new are measured."""
        old, new = self.blocks, points.blocks
        if new is old:
            return self
        most = min(len(old), len(new))
        head = 0
        while head < most and old[head] is new[head]:
            head += 1
        tail = 0
        while tail < most - head and old[-1 - tail] is new[-1 - tail]:
            tail += 1
        fresh = tuple(map(_measured, new[head : len(new) - tail]))
        keep = len(old) - tail
        return Boxes(
            new,
            (*self.boxes[:head], *fresh, *self.boxes[keep:]),
            (*self.sizes[:head], *map(_size, fresh), *self.sizes[keep:]),
        )

    @property
    def magnitude(self) -> float:
        """Largest |coordinate|."""
        return max(self.sizes)

    def distances(self, point: Array) -> Array:
        """How far ``point`` is at least from the control points of each block."""
        boxes = np.stack(self.boxes)
        return box_distances(boxes[:, 0], boxes[:, 1], point)


def _measured(block: Array) -> Array:
    return np.array([[c.min() for c in block.T], [c.max() for c in block.T]])


def _size(box: Array) -> float:
    return float(np.abs(box).max())


def box_distances(low: Array, high: Array, point: Array) -> Array:
    """Distance of a point from boxes (k, d); 0 inside."""
    off = np.maximum(np.maximum(low - point, point - high), 0.0)
    return np.asarray(np.sqrt(np.einsum("kd,kd->k", off, off)))
