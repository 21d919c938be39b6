"""Runs of neighbouring blocks: the upper level of a block array, and what two sequences share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate, chain, islice, pairwise, takewhile
from operator import is_
from typing import TYPE_CHECKING

from multirep.arrays import Array
from multirep.splines import compiled

if TYPE_CHECKING:
    from multirep.splines._core import Rope

#: Blocks in a full run. An edit copies the list of one run and the list of all: at 10**6 rows in
#: blocks of 1024, both are about this long.
RUN_BLOCKS = 32


class Run:
    """Some neighbouring blocks of an array, none empty, and where they end, from the first row.

    Examples
    --------
    >>> import numpy as np
    >>> run = Run((np.zeros(3), np.zeros(4)))
    >>> run.ends, run.rows
    ((3, 7), 7)
    """

    __slots__ = ("_rope", "blocks", "ends", "rows")
    blocks: tuple[Array, ...]
    ends: tuple[int, ...]
    rows: int
    _rope: Rope | None

    def __init__(self, blocks: tuple[Array, ...], ends: tuple[int, ...] = ()) -> None:
        self.blocks = blocks
        self.ends = ends or tuple(accumulate(map(len, blocks)))
        self.rows = self.ends[-1]
        self._rope = None

    @property
    def rope(self) -> Rope:
        """The blocks as the core reads them, only with it; made when first asked for."""
        if self._rope is None:
            self._rope = compiled.core.rope(self.blocks)
        return self._rope

    def with_block(self, k: int, block: Array) -> Run:
        """Return the run with another block of the same length in the place of block ``k``."""
        return Run((*self.blocks[:k], block, *self.blocks[k + 1 :]), self.ends)

    def __len__(self) -> int:
        return self.rows


def runs_of(blocks: Sequence[Array]) -> tuple[Run, ...]:
    """Cut blocks into runs between half and one and a half times as many as a full one."""
    count = round(len(blocks) / RUN_BLOCKS)
    if count <= 1:
        return (Run(tuple(blocks)),) if blocks else ()
    marks = [len(blocks) * k // count for k in range(count + 1)]
    return tuple(Run(tuple(blocks[i:j])) for i, j in pairwise(marks))


def ends_of(runs: tuple[Run, ...]) -> tuple[int, ...]:
    """Return where runs end, from the first row."""
    return tuple(accumulate([run.rows for run in runs]))


def renewed(runs: tuple[Run, ...], low: int, high: int, blocks: Sequence[Array]) -> tuple[Run, ...]:
    """Put some blocks in the place of runs low .. high - 1, and leave no run too short."""
    if len(blocks) < RUN_BLOCKS // 4:
        if high < len(runs):
            blocks = (*blocks, *runs[high].blocks)
            high += 1
        elif low:
            low -= 1
            blocks = (*runs[low].blocks, *blocks)
    return (*runs[:low], *runs_of(blocks), *runs[high:])


def blocks_of(runs: Iterable[Run]) -> Iterator[Array]:
    """Yield the blocks of some runs."""
    return chain.from_iterable(run.blocks for run in runs)


def shared_ends(one: Sequence[object], other: Sequence[object]) -> tuple[int, int]:
    """Count what two sequences share, object for object, at the head and, behind it, at the tail.

    Looks no farther than the first difference from either end.

    Examples
    --------
    >>> shared_ends("abcd", "abbcd")
    (2, 2)
    """
    head = shared_head(one, other)
    limit = min(len(one), len(other)) - head
    return head, shared_head(islice(reversed(one), limit), reversed(other))


def shared_head(one: Iterable[object], other: Iterable[object]) -> int:
    """Count the objects from the beginning that are the same, up to the first that is not."""
    return len(list(takewhile(bool, map(is_, one, other))))  # 25 ns each: no Python loop


def shared_rows(one: Sequence[Run], other: Sequence[Run], step: int) -> int:
    """Count the rows in blocks that runs share from the beginning, or from the end (step = -1).

    O(shared runs, and blocks in the first two that are not the same run).
    """
    one, other = one[::step], other[::step]
    limit = min(len(one), len(other))
    whole = shared_head(one, other) if limit and one[0] is other[0] else 0
    rows = sum([run.rows for run in one[:whole]]) if whole else 0
    if whole == limit:
        return rows
    mine, theirs = one[whole].blocks[::step], other[whole].blocks[::step]
    count = shared_head(mine, theirs)
    if count == min(len(mine), len(theirs)):  # cut into runs in other places: go on in the next
        mine, theirs = (
            tuple(block for run in runs[whole:] for block in run.blocks[::step])
            for runs in (one, other)
        )
        count = shared_head(mine, theirs)
    return rows + sum(map(len, mine[:count]))
