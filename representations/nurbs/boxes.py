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
    known : dict
        Block number (``id``) to its box, (2, d). The blocks themselves are kept alive by the
        points that the boxes belong to.
    order : (blocks,) tuple
        The boxes in the order of the blocks.
    magnitude : float
        Largest |coordinate|.
    """

    known: dict[int, Array]
    order: tuple[Array, ...]
    magnitude: float

    @classmethod
    def of(cls, points: BlockArray, known: dict[int, Array] | None = None) -> Boxes:
        """Measure all blocks, or those that are not known."""
        found = {}
        for block in points.blocks:
            box = None if known is None else known.get(id(block))
            if box is None:
                box = np.array([[c.min() for c in block.T], [c.max() for c in block.T]])
            found[id(block)] = box
        order = tuple(found[id(block)] for block in points.blocks)
        return cls(found, order, max(float(np.abs(box).max()) for box in order))

    def renewed(self, points: BlockArray) -> Boxes:
        """Return the boxes of the next version: only blocks that are new are measured."""
        return Boxes.of(points, self.known)

    def distances(self, point: Array) -> Array:
        """How far ``point`` is at least from the control points of each block."""
        boxes = np.stack(self.order)
        return box_distances(boxes[:, 0], boxes[:, 1], point)


def box_distances(low: Array, high: Array, point: Array) -> Array:
    """Distance of a point from boxes (k, d); 0 inside."""
    off = np.maximum(np.maximum(low - point, point - high), 0.0)
    return np.asarray(np.sqrt(np.einsum("kd,kd->k", off, off)))
