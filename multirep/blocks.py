"""A persistent block array: replacing a window copies the blocks it touches and shares the rest.

Long arrays (vertices, knots, control points) live in block arrays, so that an edit, a snapshot and
the comparison of two versions cost what changed and not what there is.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from itertools import chain, pairwise
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.bitwise import common_ends
from multirep.errors import InvariantError
from multirep.runs import Run, blocks_of, ends_of, renewed, runs_of, shared_rows
from multirep.splines import compiled

if TYPE_CHECKING:
    from multirep.splines._core import Rope

#: Rows in a full block. An edit copies and keeps a block (1024 rows of two coordinates: 16 KiB):
#: more take more memory, fewer more time for what goes through all of them.
BLOCK_ROWS = 1024


class BlockArray(NDArrayOperatorsMixin):
    """An immutable float64 array, (n,) or (n, d), stored as a tuple of frozen blocks.

    It reads like a numpy array: indexing, ``len``, ``shape``, operators, ufuncs and ``np.asarray``
    work. An integer or a slice of step 1 touches only the blocks it needs; everything else
    materialises the whole array, O(n).

    Examples
    --------
    >>> a = BlockArray.of(np.arange(10_000.0))
    >>> b = a.replaced(3, 5, [0.5])
    >>> len(b), b[2:5]
    (9999, array([2. , 0.5, 5. ]))
    >>> b.difference(a)
    (3, 4, 5)
    """

    __slots__ = ("_ends", "_only", "_rope", "_rows", "_runs", "_tail")
    #: The block of an array of one block, for which everything below is a short cut.
    _only: Array | None
    #: Otherwise the blocks in runs, and where the runs end.
    _runs: tuple[Run, ...]
    _ends: tuple[int, ...]
    _rows: int
    _tail: tuple[int, ...]
    #: See :attr:`rope`.
    _rope: Rope | None

    def __init__(self, blocks: Iterable[Array], tail: tuple[int, ...]) -> None:
        blocks = tuple(blocks)
        if len(blocks) == 1:
            self._set(blocks[0], (), (), tail)
        else:
            runs = runs_of(blocks)
            self._set(None, runs, ends_of(runs), tail)

    def _set(
        self,
        only: Array | None,
        runs: tuple[Run, ...],
        ends: tuple[int, ...],
        tail: tuple[int, ...],
    ) -> Self:
        self._only, self._runs, self._ends, self._tail, self._rope = only, runs, ends, tail, None
        self._rows = len(only) if only is not None else ends[-1] if ends else 0
        return self

    @classmethod
    def of(cls, values: ArrayLike | BlockArray) -> BlockArray:
        """Make a block array of anything that numpy reads; a block array is returned as it is."""
        if isinstance(values, BlockArray):
            return values
        array = frozen_array(values)
        if 0 < len(array) <= BLOCK_ROWS:
            return _new(BlockArray)._set(array, (), (), array.shape[1:])
        return cls(_cut(array), array.shape[1:])

    # -- reading -----------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self._rows

    @property
    def shape(self) -> tuple[int, ...]:
        """(n,) or (n, d)."""
        return (len(self), *self._tail)

    @property
    def row_shape(self) -> tuple[int, ...]:
        """() or (d,)."""
        return self._tail

    @property
    def ndim(self) -> int:
        """1 or 2."""
        return 1 + len(self._tail)

    @property
    def size(self) -> int:
        """Number of numbers."""
        return int(np.prod(self.shape))

    @property
    def dtype(self) -> np.dtype[np.float64]:
        """Always float64."""
        return np.dtype(np.float64)

    @property
    def nbytes(self) -> int:
        """Bytes in all blocks, shared or not."""
        return 8 * self.size

    @property
    def blocks(self) -> tuple[Array, ...]:
        """The blocks themselves, read-only; shared blocks of two versions are the same objects.

        O(blocks) to list them all; :attr:`runs` are listed already.
        """
        return (self._only,) if self._only is not None else tuple(blocks_of(self._runs))

    @property
    def runs(self) -> tuple[Run, ...]:
        """The blocks in runs of neighbours; versions share whole runs too."""
        return self._runs if self._only is None else (Run((self._only,)),)

    @property
    def rope(self) -> Rope:
        """The rows as the core reads them, only with it and of one row or more; made once.

        O(blocks) nanoseconds, and some microseconds for each run that is new.
        """
        if self._rope is None:
            only = self._only
            parts = (only,) if only is not None else tuple([run.rope for run in self._runs])
            self._rope = compiled.core.rope(parts)
        return self._rope

    def window(self, start: int, stop: int) -> Array:
        """Rows start..stop-1, contiguous and read-only; no copy when they lie in one block.

        Parameters
        ----------
        start, stop : int
            0 <= start <= stop <= n; not checked.
        """
        if self._only is not None:
            return self._only[start:stop]
        if start == self._rows:
            return _EMPTY.reshape((0, *self._tail)) if self._tail else _EMPTY
        g = bisect_right(self._ends, start)
        run = self._runs[g]
        blocks, ends = run.blocks, run.ends
        first = self._ends[g] - run.rows
        low, high = start - first, stop - first
        k = bisect_right(ends, low)
        begin = ends[k] - len(blocks[k])
        if high <= ends[k]:
            return blocks[k][low - begin : high - begin]
        pieces = [blocks[k][low - begin :]]
        if high > run.rows:  # go on in the run that has the last row
            pieces += blocks[k + 1 :]
            last = bisect_left(self._ends, stop)
            pieces += blocks_of(self._runs[g + 1 : last])
            blocks, ends = self._runs[last].blocks, self._runs[last].ends
            k, high = -1, stop - self._ends[last - 1]
        end = bisect_left(ends, high)
        pieces += blocks[k + 1 : end]
        pieces.append(blocks[end][: high - (ends[end - 1] if end else 0)])
        joined = np.concatenate(pieces)
        joined.setflags(write=False)
        return joined

    def _place(self, row: int) -> tuple[int, int, Run, int]:
        """Where a row is: number of its run, first row of that, run, number of its block there."""
        g = bisect_right(self._ends, row)
        run = self._runs[g]
        first = self._ends[g] - run.rows
        return g, first, run, bisect_right(run.ends, row - first)

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice) and key.step in (None, 1):
            start, stop, _ = key.indices(self._rows)
            return self.window(start, max(start, stop))
        if isinstance(key, int | np.integer) and not isinstance(key, bool):
            index, n = int(key), self._rows
            if not -n <= index < n:
                raise IndexError(f"index {index} is out of bounds for {n} rows")
            index %= n
            if self._only is not None:
                return self._only[index]
            _, first, run, k = self._place(index)
            return run.blocks[k][index - first - run.ends[k]]
        return self.__array__()[key]

    def __iter__(self) -> Iterator[Any]:
        return chain.from_iterable(blocks_of(self.runs))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if self._only is not None and not copy:
            array = self._only
        elif self._rows:
            array = np.concatenate(self.blocks)
        else:
            array = np.empty(self.shape)
        return array if dtype is None else array.astype(dtype, copy=False)

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        flat = [np.asarray(x) if isinstance(x, BlockArray) else x for x in inputs]
        return getattr(ufunc, method)(*flat, **kwargs)

    def tolist(self) -> list[Any]:
        """Nested Python lists."""
        values: list[Any] = np.asarray(self).tolist()
        return values

    def min(self, axis: int | None = None) -> Any:
        """Smallest number, or along an axis."""
        return np.asarray(self).min(axis=axis)

    def max(self, axis: int | None = None) -> Any:
        """Largest number, or along an axis."""
        return np.asarray(self).max(axis=axis)

    def sum(self, axis: int | None = None) -> Any:
        """Sum, or sums along an axis."""
        return np.asarray(self).sum(axis=axis)

    def mean(self, axis: int | None = None) -> Any:
        """Mean, or means along an axis."""
        return np.asarray(self).mean(axis=axis)

    def copy(self) -> Array:
        """Return a writable flat copy."""
        return np.array(self)

    def searchsorted(self, value: float, side: str = "left") -> int:
        """Index that keeps a sorted (n,) array sorted, as numpy's; O(log n), no flat copy."""
        # the method of a block: np.searchsorted takes five times as long to reach it
        if self._only is not None:
            return int(self._only.searchsorted(value, side="right" if side == "right" else "left"))
        # the first run, and in it the first block, whose last value is not before `value`
        find = bisect_right if side == "right" else bisect_left
        g = find(self._runs, value, key=_last_of_run)
        if g == len(self._runs):
            return self._rows
        run = self._runs[g]
        k = find(run.blocks, value, key=_last)
        block = run.blocks[k]
        inside = int(block.searchsorted(value, side="right" if side == "right" else "left"))
        return self._ends[g] - run.rows + run.ends[k] - len(block) + inside

    # -- making new versions -----------------------------------------------------------------------

    def replaced(self, start: int, stop: int, rows: ArrayLike) -> BlockArray:
        """Return a version in which ``rows`` stand for rows start..stop-1; the counts may differ.

        Cost: O(len(rows) + BLOCK_ROWS), and lists of one run and of all runs; all untouched blocks
        and runs are shared.
        """
        new: Array = np.asarray(rows, dtype=np.float64)
        if new.shape[1:] != self._tail:
            raise InvariantError(f"rows of shape {new.shape[1:]} in an array of {self._tail}", rows)
        if not 0 <= start <= stop <= self._rows:
            raise IndexError(f"window {start}:{stop} does not fit into {self._rows} rows")
        only = self._only
        if only is not None and 0 < len(new) <= BLOCK_ROWS - self._rows:
            joined = np.concatenate((only[:start], new, only[stop:]))
            joined.setflags(write=False)
            return _new(BlockArray)._set(joined, (), (), self._tail)
        if not self._rows:
            return BlockArray(_cut(frozen_array(new)), self._tail)
        if only is None and len(new) == stop - start and new.size:
            g, first, run, k = self._place(start)
            if stop - first <= run.ends[k]:  # rows of one block are moved: the usual edit
                block = run.blocks[k].copy()
                begin = start - first - run.ends[k] + len(block)
                block[begin : begin + len(new)] = new
                block.setflags(write=False)
                runs = (*self._runs[:g], run.with_block(k, block), *self._runs[g + 1 :])
                return _new(BlockArray)._set(None, runs, self._ends, self._tail)
        runs = self.runs
        ends = self._ends if only is None else (self._rows,)
        low = min(bisect_right(ends, start), len(runs) - 1)
        high = min(bisect_left(ends, max(stop, start + 1)), len(runs) - 1) + 1
        first = ends[low] - runs[low].rows
        run = runs[low] if high == low + 1 else Run(tuple(blocks_of(runs[low:high])))
        blocks = _replaced(run, start - first, stop - first, new)
        runs = renewed(runs, low, high, blocks)
        if len(runs) == 1 and len(runs[0].blocks) == 1:
            return _new(BlockArray)._set(runs[0].blocks[0], (), (), self._tail)
        return _new(BlockArray)._set(None, runs, ends_of(runs), self._tail)

    def shared(self, other: BlockArray) -> tuple[int, int]:
        """Count the rows in blocks that both have at the head, and those at the tail.

        The blocks are the same objects; nothing is looked into. The two are counted each by itself
        and overlap when equal blocks repeat. O(runs, and blocks in the first that differ).
        """
        mine, theirs = self.runs, other.runs
        return shared_rows(mine, theirs, 1), shared_rows(mine, theirs, -1)

    def difference(self, other: BlockArray) -> tuple[int, int, int]:
        """Where two versions differ: ``(low, high, other_high)``.

        Rows before ``low`` are bitwise equal, and so are ``self[high:]`` and
        ``other[other_high:]``. Equal arrays give ``low == high == other_high``. Blocks that both
        share are not looked into: O(changed + runs).
        """
        n, m = self._rows, other._rows
        low = tail = 0
        one, two = self._only, other._only
        if self is other:
            return n, n, n
        if one is None or two is None:
            low, tail = self.shared(other)
            tail = min(tail, n - low, m - low)
            one, two = self.window(low, n - tail), other.window(low, m - tail)
        elif one is two:
            return n, n, n
        head, end = common_ends(one, two)
        return low + head, n - tail - end, m - tail - end

    def __repr__(self) -> str:
        return f"BlockArray(shape={self.shape}, blocks={sum(len(run.blocks) for run in self.runs)})"

    def __reduce__(self) -> tuple[object, ...]:
        return BlockArray.of, (np.asarray(self),)


_new = object.__new__
_EMPTY = np.empty(0)
_EMPTY.setflags(write=False)


def _last(block: Array) -> Any:
    return block[-1]


def _last_of_run(run: Run) -> Any:
    return run.blocks[-1][-1]


def _replaced(run: Run, start: int, stop: int, new: Array) -> list[Array]:
    """Return the blocks of a run in which new rows stand for some."""
    blocks, ends = run.blocks, run.ends
    first = min(bisect_right(ends, start), len(blocks) - 1)
    last = min(bisect_left(ends, max(stop, start + 1)), len(blocks) - 1)
    before = ends[first] - len(blocks[first])
    head, tail = blocks[first][: start - before], blocks[last][stop - ends[last] :]
    pieces = [head, new, tail if stop < ends[last] else tail[:0]]
    if len(blocks) > 1 and start - before + len(new) + ends[last] - stop < BLOCK_ROWS // 4:
        # take a neighbour in: many small edits must not leave crumbs
        if last + 1 < len(blocks):
            last += 1
            pieces.append(blocks[last])
        elif first > 0:
            first -= 1
            pieces.insert(0, blocks[first])
    middle = np.concatenate(pieces)
    middle.setflags(write=False)
    return [*blocks[:first], *_cut(middle), *blocks[last + 1 :]]


def _cut(array: Array) -> list[Array]:
    """Cut a frozen array into blocks between half and one and a half times BLOCK_ROWS."""
    n = array.shape[0]
    count = max(1, round(n / BLOCK_ROWS))
    if count == 1:
        return [array] if n else []
    marks = [n * k // count for k in range(count + 1)]
    blocks = []
    for start, stop in pairwise(marks):
        block = array[start:stop].copy()  # own memory: a view would keep the whole old array alive
        block.setflags(write=False)
        blocks.append(block)
    return blocks
