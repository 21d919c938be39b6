"""What is known of each block of an array and of each run, taken over from version to version."""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain, islice
from typing import Generic, Self, TypeVar

import attrs

from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.runs import Run, blocks_of, shared_ends

__all__ = ["Summaries"]

#: Of a block, of a run.
B = TypeVar("B")
R = TypeVar("R")


@attrs.frozen(eq=False)
class Summaries(Generic[B, R]):
    """Summaries of the blocks of an array, and of its runs made of them.

    ``Summaries()`` are those of nothing; :meth:`renewed` makes those of another version.

    Parameters
    ----------
    runs : tuple of Run
        What was summarized.
    ends : tuple of int
        The row after each run.
    blocks : tuple of tuples
        The summaries of the blocks of each run.
    wholes : tuple
        The summary of each run.

    Examples
    --------
    >>> import numpy as np
    >>> array = BlockArray.of(np.arange(10_000.0))
    >>> def renewed(largest, array):
    ...     return largest.renewed(array, lambda block: float(block.max()), max)
    >>> largest = renewed(Summaries[float, float](), array)
    >>> renewed(largest, array.replaced(3, 4, [2e4])).wholes
    (20000.0,)
    """

    runs: tuple[Run, ...] = ()
    ends: tuple[int, ...] = ()
    blocks: tuple[tuple[B, ...], ...] = ()
    wholes: tuple[R, ...] = ()

    def renewed(
        self,
        array: BlockArray,
        of_block: Callable[[Array], B],
        of_run: Callable[[tuple[B, ...]], R],
    ) -> Self:
        """Summarize another version; O(rows in blocks that are not shared, and runs)."""
        old, new = self.runs, array.runs
        if len(new) == 1 and len(new[0]) == 1:  # most arrays have one block: a short cut
            [block] = new[0]
            if len(old) == 1 and len(old[0]) == 1 and old[0][0] is block:
                return self
            one = (of_block(block),)
            return type(self)(new, array.ends, (one,), (of_run(one),))
        head, tail = shared_ends(old, new)
        if head == len(old) == len(new):
            return self
        low, high, stop = head, len(old) - tail, len(new) - tail
        mine = tuple(blocks_of(old[low:high]))
        known = tuple(chain.from_iterable(self.blocks[low:high]))
        theirs = tuple(blocks_of(new[low:stop]))
        first, last = shared_ends(mine, theirs)
        fresh = map(of_block, theirs[first : len(theirs) - last])
        each = iter((*known[:first], *fresh, *known[len(known) - last :]))
        parts = [tuple(islice(each, len(run))) for run in new[low:stop]]
        return type(self)(
            new,
            array.ends,
            (*self.blocks[:low], *parts, *self.blocks[high:]),
            (*self.wholes[:low], *map(of_run, parts), *self.wholes[high:]),
        )
