"""Where two polylines may differ, found without looking into the blocks that they share."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from multirep.arrays import Array
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.runs import Run
from multirep.splices import SpliceList
from multirep.splines import compiled

#: Rows between the first and the last difference that are simply compared, shared blocks or not.
NARROW = 4 * BLOCK_ROWS


def changed_stretches(
    t: BlockArray, points: BlockArray, other_t: BlockArray, other_points: BlockArray
) -> SpliceList:
    """Return the stretches on which two polylines over the same T may differ.

    A segment is common when both polylines have it, end for end and bit for bit. Cost: O(rows in
    blocks that are not shared, and number of blocks).

    Examples
    --------
    >>> t, points = BlockArray.of(np.arange(9.0)), BlockArray.of(np.zeros((9, 2)))
    >>> moved = points.replaced(2, 3, [[0, 1]]).replaced(6, 7, [[0, 1]])
    >>> print(changed_stretches(t, points, t, moved))
    [1,3] [5,7]
    """
    if t is other_t and points is other_points:
        return SpliceList.EMPTY
    stretches: list[tuple[float, float]] = []
    for start, stop, other_start, other_stop in _unshared(t, points, other_t, other_points):
        # one common row on either side ends the stretches
        low, high = max(start - 1, 0), min(stop + 1, len(t))
        other_low, other_high = max(other_start - 1, 0), min(other_stop + 1, len(other_t))
        stretches += _between_common(
            t.window(low, high),
            points.window(low, high),
            other_t.window(other_low, other_high),
            other_points.window(other_low, other_high),
        )
    return SpliceList(stretches)


def _between_common(
    t: Array, points: Array, other_t: Array, other_points: Array
) -> list[tuple[float, float]]:
    """Stretches between common vertices that are not one segment in both; plain arrays.

    The rows at either end bound the stretches, whether or not they are common: at an end of T
    nothing lies beyond.
    """
    if compiled.active:
        return compiled.core.between_common(t, points, other_t, other_points)
    position = np.minimum(other_t.searchsorted(t), len(other_t) - 1)
    same = (other_t[position] == t) & (other_points[position] == points).all(axis=1)
    mine = np.flatnonzero(same)
    theirs = position[mine]
    marks = np.concatenate([t[:1], t[mine], t[-1:]])
    broken = np.empty(len(mine) + 1, dtype=bool)
    broken[1:-1] = (mine[1:] - mine[:-1] > 1) | (theirs[1:] - theirs[:-1] > 1)
    broken[0] = not (len(mine) and mine[0] == theirs[0] == 0)
    broken[-1] = not (len(mine) and mine[-1] == len(t) - 1 and theirs[-1] == len(other_t) - 1)
    k = np.flatnonzero(broken)
    return list(zip(marks[k].tolist(), marks[k + 1].tolist(), strict=True))


def _unshared(
    t: BlockArray, points: BlockArray, other_t: BlockArray, other_points: BlockArray
) -> Iterator[tuple[int, int, int, int]]:
    """Windows (start, stop, other start, other stop) that hold all rows which are not common."""
    low, tail = len(t), min(len(t), len(other_t))
    for mine, theirs in ((t, other_t), (points, other_points)):
        first, high, other_high = mine.difference(theirs)
        if not first == high == other_high:
            low, tail = min(low, first), min(tail, len(t) - high)
    tail = min(tail, len(t) - low, len(other_t) - low)
    high, other_high = len(t) - tail, len(other_t) - tail
    if max(high, other_high) - low <= NARROW:
        if max(high, other_high) > low:
            yield low, high, low, other_high
        return
    row, other_row = low, low
    for start, stop, shift in _both(_shared(t, other_t), _shared(points, other_points)):
        first, last = max(start, row), min(stop, high, other_high - shift)
        if first < last:
            if first > row or first + shift > other_row:
                yield row, first, other_row, first + shift
            row, other_row = last, last + shift
    if row < high or other_row < other_high:
        yield row, high, other_row, other_high


def _shared(a: BlockArray, b: BlockArray) -> list[tuple[int, int, int]]:
    """Return runs of rows in blocks that both hold: (start, stop, shift to b), in order."""
    if a is b:
        return [(0, len(a), 0)]
    common = {id(run) for run in a.runs} & {id(run) for run in b.runs}
    where: dict[int, int] = {}
    row = 0
    for piece, rows in _pieces(b, common):
        where[id(piece)] = row
        row += rows
    runs: list[tuple[int, int, int]] = []
    row = 0
    for piece, rows in _pieces(a, common):
        stop = row + rows
        other = where.get(id(piece))
        if other is not None:
            if runs and runs[-1][1:] == (row, other - row):
                runs[-1] = (runs[-1][0], stop, other - row)
            else:
                runs.append((row, stop, other - row))
        row = stop
    return runs


def _pieces(array: BlockArray, common: set[int]) -> Iterator[tuple[Run | Array, int]]:
    """Yield runs that both have as they are, of the others the blocks; and the rows of each."""
    start = 0
    for run, stop in zip(array.runs, array.ends, strict=True):
        if id(run) in common:
            yield run, stop - start
        else:
            yield from zip(run, map(len, run), strict=True)
        start = stop


def _both(
    one: list[tuple[int, int, int]], two: list[tuple[int, int, int]]
) -> list[tuple[int, int, int]]:
    """Return runs that lie in both lists with the same shift."""
    runs: list[tuple[int, int, int]] = []
    i = j = 0
    while i < len(one) and j < len(two):
        start, stop = max(one[i][0], two[j][0]), min(one[i][1], two[j][1])
        if start < stop and one[i][2] == two[j][2]:
            runs.append((start, stop, one[i][2]))
        if one[i][1] <= two[j][1]:
            i += 1
        else:
            j += 1
    return runs
