"""The nearest places of a polyline: in the tree of capsules that are its segments."""

from __future__ import annotations

from functools import partial

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.capsules import Known, Leaf, Pieces, Tree, capsule_around, capsules


def tree(known: Known, t: BlockArray, points: BlockArray) -> Tree:
    """Return the tree of a polyline; O(n) for the first version that is asked, then O(changes).

    Parameters
    ----------
    known : Known
        What the versions share; brought up to date.
    t, points : BlockArray
        (n,) and (n, d).
    """
    if known.is_of((t, points)):
        return known.tree

    def build(first: int, stop: int) -> Leaf:
        at = t.window(first, stop + 1)
        columns = points.window(first, stop + 1).T
        whole = capsule_around(columns, columns[:, 0], columns[:, -1])
        return Leaf(stop - first, whole, partial(_pieces, at, columns))

    if known.arrays:
        # Segment i joins vertices i and i + 1.
        ranges = [
            (low - 1, high)
            for low, high, other in map(BlockArray.difference, known.arrays, (t, points))
            if not low == high == other
        ]
        first = max(min((low for low, _ in ranges), default=len(t)), 0)
        stop = min(max((high for _, high in ranges), default=0), len(known.arrays[0]) - 1)
        made = known.tree.renewed(build, first, stop, len(t) - len(known.arrays[0]))
    else:
        made = Tree.of(build, len(t) - 1)
    known.learn((t, points), made)
    return made


def _pieces(t: Array, columns: Array) -> Pieces:
    return Pieces(t[:-1], t[1:], capsules(columns[:, :-1], columns[:, 1:], 0.0))
