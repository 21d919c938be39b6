"""Which boxes of one list are near which of another, from coarse to fine.

Two hierarchies over neighbours in the lists, gone through together: pairs of boxes that are too far
apart are dropped with all that is in them, and so are boxes of the first list that are done with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import attrs
import numpy as np

from multirep.arrays import Array, Flags, Indices

#: So many neighbours go into one box of the next level.
FAN = 4
#: About so many pairs are worked on at a time; more cost memory, fewer cost calls.
TOGETHER = 2**15


@attrs.frozen(eq=False)
class Boxes:
    """Boxes, and boxes of FAN neighbours each, level by level, up to a single one.

    Parameters
    ----------
    lows, highs : lists of (k, d) arrays
        From fine to coarse.
    """

    lows: list[Array]
    highs: list[Array]

    @classmethod
    def of(cls, low: Array, high: Array) -> Boxes:
        """Build the levels over (n, d) boxes; O(n)."""
        lows, highs = [low], [high]
        while len(low) > 1:
            firsts = np.arange(0, len(low), FAN)
            low, high = np.minimum.reduceat(low, firsts), np.maximum.reduceat(high, firsts)
            lows.append(low)
            highs.append(high)
        return cls(lows, highs)

    @property
    def top(self) -> int:
        """The level of the single box."""
        return len(self.lows) - 1

    def at(self, level: int) -> tuple[Array, Array]:
        """Boxes of a level; above the top it is the single one."""
        level = min(level, self.top)
        return self.lows[level], self.highs[level]

    def count(self, level: int) -> int:
        """How many boxes a level has."""
        return len(self.at(level)[0])

    def middles(self, level: int, nodes: Indices) -> Indices:
        """One of the finest boxes in the middle of each box of a level."""
        size = FAN ** min(level, self.top)
        middles: Indices = np.minimum(nodes * size + size // 2, len(self.lows[0]) - 1)
        return middles


def near_pairs(
    ones: Boxes,
    others: Boxes,
    distance: float,
    done: Callable[[int, Indices, Indices], Flags],
    finished: Flags,
) -> Iterator[tuple[Indices, Indices]]:
    """Yield pairs of finest boxes that are no farther apart than a distance, and not done with.

    Parameters
    ----------
    ones, others : Boxes
    distance : float
    done : callable
        (level, boxes of ``ones``, boxes of ``others``) to whether that pair settles all that is in
        the first.
    finished : (n,) array of bool
        Which of the finest ``ones`` are settled: set here as ``done`` says, and by who asks.

    Yields
    ------
    (k,) indices into ``ones``, (k,) indices into ``others``
        Some thousands at a time.

    Notes
    -----
    O(n + m) for lists whose neighbours are close to each other, and what is yielded.
    """
    if not len(finished):
        return
    top = max(ones.top, others.top)
    settled = [np.zeros(ones.count(level), dtype=bool) for level in range(top + 1)]
    settled[0] = finished
    root = np.zeros(1, dtype=np.intp)
    waiting = [(top, root, root)]
    while waiting:
        level, of, by = waiting.pop()
        if len(of) > TOGETHER:
            half = len(of) // 2
            waiting += [(level, of[half:], by[half:]), (level, of[:half], by[:half])]
            continue
        keep = ~settled[level][of]
        of, by = of[keep], by[keep]
        keep = _near(ones.at(level), others.at(level), of, by, distance)
        of, by = of[keep], by[keep]
        hit = done(level, of, by)
        _settle(settled, level, np.unique(of[hit]))
        keep = ~settled[level][of]
        of, by = of[keep], by[keep]
        if not len(of):
            continue
        if level == 0:
            yield of, by
            continue
        of, by = _children(of, by, ones.count(level - 1), others.count(level - 1))
        waiting.append((level - 1, of, by))


def _near(
    ones: tuple[Array, Array], others: tuple[Array, Array], of: Indices, by: Indices, far: float
) -> Flags:
    """Whether two boxes are no farther apart than ``far``, pair by pair."""
    gap = np.maximum(ones[0][of] - others[1][by], others[0][by] - ones[1][of])
    np.maximum(gap, 0.0, out=gap)
    return np.asarray(np.einsum("md,md->m", gap, gap) <= far * far)


def _settle(settled: list[Flags], level: int, nodes: Indices) -> None:
    """Mark nodes of a level and all below them."""
    settled[level][nodes] = True
    while level > 0 and len(nodes):
        level -= 1
        nodes = _below(nodes, len(settled[level]))
        settled[level][nodes] = True


def _below(nodes: Indices, count: int) -> Indices:
    below = (nodes[:, None] * FAN + np.arange(FAN)).ravel()
    return below[below < count]


def _children(of: Indices, by: Indices, ones: int, others: int) -> tuple[Indices, Indices]:
    """All pairs of children; of a box above the top the only child is itself."""
    fan = np.arange(FAN)
    shape = len(of), FAN, FAN
    a = np.broadcast_to((of[:, None] * FAN + fan)[:, :, None], shape).ravel()
    b = np.broadcast_to((by[:, None] * FAN + fan)[:, None, :], shape).ravel()
    exist = (a < ones) & (b < others)
    return a[exist], b[exist]
