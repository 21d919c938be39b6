"""Runs of neighbouring blocks: the upper level of a block array, and what two sequences share."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import accumulate, chain, islice, pairwise, takewhile
from operator import is_
from typing import TYPE_CHECKING, Any

from multirep.arrays import Array
from multirep.splines import compiled

if TYPE_CHECKING:
    from multirep.splines._core import Rope

#: Blocks in a full run. An edit copies the list of one run and the list of all: at 10**6 rows in
#: blocks of 1024, both are about this long.
RUN_BLOCKS = 32


class Run(tuple[Array, ...]):
    """Some neighbouring blocks of an array, none empty: a tuple that can keep their rope."""

    @cached_property
    def rope(self) -> Rope:
        """The blocks as the core reads them, only with it; made when first asked for."""
        return compiled.core.rope(tuple(self))  # the rope keeps what it is of: not this run


def runs_of(blocks: Sequence[Array]) -> tuple[Run, ...]:
    """Cut blocks into runs between half and one and a half times as many as a full one."""
    count = round(len(blocks) / RUN_BLOCKS)
    if count <= 1:
        return (Run(blocks),) if blocks else ()
    marks = [len(blocks) * k // count for k in range(count + 1)]
    return tuple(Run(blocks[i:j]) for i, j in pairwise(marks))


def rows_of(blocks: Iterable[Array]) -> int:
    """Return how many rows some blocks have."""
    return sum(map(len, blocks))


def ends_of(runs: tuple[Run, ...]) -> tuple[int, ...]:
    """Return where runs end, from the first row."""
    return tuple(accumulate(map(rows_of, runs)))


def renewed(
    runs: tuple[Run, ...], ends: tuple[int, ...], low: int, high: int, blocks: Sequence[Array]
) -> tuple[tuple[Run, ...], tuple[int, ...]]:
    """Return runs, none too short, with some blocks instead of runs low .. high - 1; their ends.

    Cost: O(blocks that are given, and runs).
    """
    if len(blocks) < RUN_BLOCKS // 4:
        if high < len(runs):
            blocks = (*blocks, *runs[high])
            high += 1
        elif low:
            low -= 1
            blocks = (*runs[low], *blocks)
    made = runs_of(blocks)
    marks = [*accumulate(map(rows_of, made), initial=ends[low - 1] if low else 0)]
    more = marks[-1] - ends[high - 1]
    after = [end + more for end in ends[high:]]
    return (*runs[:low], *made, *runs[high:]), (*ends[:low], *marks[1:], *after)


def blocks_of(runs: Iterable[Run]) -> Iterator[Array]:
    """Yield the blocks of some runs."""
    return chain.from_iterable(runs)


def place_of(runs: tuple[Run, ...], ends: tuple[int, ...], row: int) -> tuple[Array, int, int, int]:
    """Return the block that has a row, its first row, the number of its run, and its number there.

    The row after the last belongs to the last block.
    """
    if compiled.active:
        return compiled.core.place(runs, ends, row)
    g = min(bisect_right(ends, row), len(runs) - 1)
    run, first = runs[g], ends[g - 1] if g else 0
    firsts = [*accumulate(map(len, run[:-1]), initial=first)]
    k = bisect_right(firsts, row) - 1
    return run[k], firsts[k], g, k


def searched(runs: tuple[Run, ...], ends: tuple[int, ...], value: float, right: bool) -> int:
    """Return the row before which a value belongs among ascending ones; right: behind equals."""
    if compiled.active:
        return compiled.core.searched(runs, ends, value, right)
    # the first run, and in it the first block, whose last value is not before the value
    find = bisect_right if right else bisect_left
    g = find(runs, value, 0, len(runs) - 1, key=_last_of_run)
    run = runs[g]
    k = find(run, value, 0, len(run) - 1, key=_last)
    inside = int(run[k].searchsorted(value, "right" if right else "left"))
    return (ends[g - 1] if g else 0) + rows_of(run[:k]) + inside


def _last(block: Array) -> Any:
    return block[-1]


def _last_of_run(run: Run) -> Any:
    return run[-1][-1]


def with_block(
    runs: tuple[Run, ...], ends: tuple[int, ...], g: int, k: int, block: Array
) -> tuple[tuple[Run, ...], tuple[int, ...]]:
    """Return runs with another block in the place of block k of run g, and where they end."""
    if compiled.active:
        return compiled.core.with_block(runs, ends, g, k, block)
    run, more = runs[g], len(block) - len(runs[g][k])
    if more:
        ends = (*ends[:g], *[end + more for end in ends[g:]])
    return (*runs[:g], Run((*run[:k], block, *run[k + 1 :])), *runs[g + 1 :]), ends


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


def shared_rows(
    runs: tuple[Run, ...], ends: tuple[int, ...], others: tuple[Run, ...], from_end: bool
) -> int:
    """Count the rows in blocks that runs share from the beginning, or from the end.

    O(shared runs, and blocks in the first two that are not the same run).
    """
    if compiled.active:
        return compiled.core.shared_rows(runs, ends, others, from_end)
    step = -1 if from_end else 1
    one, other = runs[::step], others[::step]
    whole = shared_head(one, other)
    marks = (0, *ends)
    rows = marks[-1] - marks[-1 - whole] if from_end else marks[whole]
    mine, theirs = one[whole : whole + 1], other[whole : whole + 1]
    blocks = [block for run in mine for block in run[::step]]
    other_blocks = [block for run in theirs for block in run[::step]]
    count = shared_head(blocks, other_blocks)
    if count == min(len(blocks), len(other_blocks)):  # cut in other places: go on in the next
        blocks = [block for run in one[whole:] for block in run[::step]]
        other_blocks = [block for run in other[whole:] for block in run[::step]]
        count = shared_head(blocks, other_blocks)
    return rows + sum(map(len, blocks[:count]))
