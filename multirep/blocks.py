"""A persistent block array: replacing a window copies the blocks it touches and shares the rest.

Long arrays (vertices, knots, control points) live in block arrays, so that an edit, a snapshot and
the comparison of two versions cost what changed and not what there is.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from itertools import accumulate, chain, pairwise
from typing import TYPE_CHECKING, Any, Self, TypeAlias

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.bitwise import common_ends
from multirep.errors import InvariantError
from multirep.runs import (
    Run,
    blocks_of,
    ends_of,
    place_of,
    renewed,
    runs_of,
    searched,
    shared_rows,
    with_block,
)
from multirep.splines import compiled

if TYPE_CHECKING:
    from multirep.splines._core import Rope

#: Rows in a full block. An edit copies and keeps a block (1024 rows of two coordinates: 16 KiB):
#: more take more memory, fewer more time for what goes through all of them.
BLOCK_ROWS = 1024

#: A block, its first row, the number of its run, and its number there.
Place: TypeAlias = tuple[Array, int, int, int]


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
    #: The blocks in runs, and where the runs end.
    _runs: tuple[Run, ...]
    _ends: tuple[int, ...]
    _rows: int
    #: The block of an array of one block: a short cut for much below.
    _only: Array | None
    _tail: tuple[int, ...]
    #: See :attr:`rope`.
    _rope: Rope | None

    def __init__(self, blocks: Iterable[Array], tail: tuple[int, ...]) -> None:
        runs = runs_of(tuple(blocks))
        self._set(runs, ends_of(runs), tail)

    def _set(self, runs: tuple[Run, ...], ends: tuple[int, ...], tail: tuple[int, ...]) -> Self:
        self._runs, self._ends, self._tail, self._rope = runs, ends, tail, None
        self._rows = ends[-1] if ends else 0
        self._only = runs[0][0] if len(runs) == 1 and len(runs[0]) == 1 else None
        return self

    @classmethod
    def of(cls, values: ArrayLike | BlockArray) -> BlockArray:
        """Make a block array of anything that numpy reads; a block array is returned as it is."""
        if isinstance(values, BlockArray):
            return values
        array = frozen_array(values)
        if 0 < 2 * len(array) < 3 * BLOCK_ROWS:
            return _new(BlockArray)._set((Run((array,)),), (len(array),), array.shape[1:])
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
        return tuple(blocks_of(self._runs))

    @property
    def runs(self) -> tuple[Run, ...]:
        """The blocks in runs of neighbours, tuples; versions share whole runs too."""
        return self._runs

    @property
    def ends(self) -> tuple[int, ...]:
        """The row after each run."""
        return self._ends

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
        if not self._rows:
            return np.empty((0, *self._tail))
        block, first, g, k = place_of(self._runs, self._ends, start)
        if stop - first <= len(block):
            return block[start - first : stop - first]
        pieces, missing = [block[start - first :]], stop - first - len(block)
        for block in chain(self._runs[g][k + 1 :], blocks_of(self._runs[g + 1 :])):
            pieces.append(block[:missing])
            missing -= len(block)
            if missing <= 0:
                break
        joined = np.concatenate(pieces)
        joined.setflags(write=False)
        return joined

    def __getitem__(self, key: Any) -> Any:
        if self._only is not None:
            return self._only[key]
        if isinstance(key, slice) and key.step in (None, 1):
            start, stop, _ = key.indices(self._rows)
            return self.window(start, max(start, stop))
        if isinstance(key, int | np.integer) and not isinstance(key, bool):
            index, n = int(key), self._rows
            if not -n <= index < n:
                raise IndexError(f"index {index} is out of bounds for {n} rows")
            block, first, _, _ = place_of(self._runs, self._ends, index % n)
            return block[index % n - first]
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
        if not self._rows:
            return 0
        return searched(self._runs, self._ends, value, side == "right")

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
        if not self._rows:
            return BlockArray(_cut(frozen_array(new)), self._tail)
        place = self.around(start, stop, len(new) - (stop - start))
        if place is not None:  # in one block: the usual edit
            block, first, _, _ = place
            return self.with_block(place, self._joined(block, start - first, stop - first, new))
        runs = self._runs
        low, high = (place_of(runs, self._ends, row)[2] for row in (start, max(stop - 1, start)))
        first = self._ends[low - 1] if low else 0
        blocks = _replaced([*blocks_of(runs[low : high + 1])], start - first, stop - first, new)
        runs, ends = renewed(runs, self._ends, low, high + 1, blocks)
        return _new(BlockArray)._set(runs, ends, self._tail)

    def around(self, start: int, stop: int, more: int) -> Place | None:
        """Return the block that has rows start .. stop - 1, with its place.

        None where they lie in several, or where the block would become too short or too long by
        ``more`` rows: then others have to change with it.
        """
        if self._only is not None:
            size = self._rows + more
            return (self._only, 0, 0, 0) if 0 < 2 * size < 3 * BLOCK_ROWS else None
        place = place_of(self._runs, self._ends, start)
        old = len(place[0])
        if stop - place[1] <= old and BLOCK_ROWS <= 4 * (old + more) < 6 * BLOCK_ROWS:
            return place
        return None

    def with_block(self, place: Place, block: Array) -> BlockArray:
        """Return a version with another block at a place that `around` has found; freezes it."""
        block.setflags(write=False)
        new = _new(BlockArray)  # not by `_set`: as many blocks as before
        new._runs, new._ends = with_block(self._runs, self._ends, place[2], place[3], block)
        new._rows, new._tail, new._rope = new._ends[-1], self._tail, None
        new._only = None if self._only is None else block
        return new

    def _joined(self, block: Array, start: int, stop: int, new: Array) -> Array:
        """Return a block in which new rows stand for rows start .. stop - 1."""
        if not compiled.active:
            return np.concatenate((block[:start], new, block[stop:]))
        made = np.empty((len(block) + len(new) - (stop - start), *self._tail))
        compiled.core.joined(block, start, stop, new, made)
        return made

    def shared(self, other: BlockArray) -> tuple[int, int]:
        """Count the rows in blocks that both have at the head, and those at the tail.

        The blocks are the same objects; nothing is looked into. The two are counted each by itself
        and overlap when equal blocks repeat. O(runs, and blocks in the first that differ).
        """
        mine, theirs = (self._runs, self._ends), other._runs
        return shared_rows(*mine, theirs, False), shared_rows(*mine, theirs, True)

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
        return f"BlockArray(shape={self.shape}, blocks={sum(map(len, self._runs))})"

    def __reduce__(self) -> tuple[object, ...]:
        return BlockArray.of, (np.asarray(self),)


_new = object.__new__


def _replaced(blocks: list[Array], start: int, stop: int, new: Array) -> list[Array]:
    """Return some neighbouring blocks in which new rows stand for rows start .. stop - 1."""
    ends = tuple(accumulate(map(len, blocks)))
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
