"""A persistent block array: replacing a window copies the blocks it touches and shares the rest.

Long arrays (vertices, knots, control points) live in block arrays, so that an edit, a snapshot and
the comparison of two versions cost what changed and not what there is.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate, islice, pairwise
from operator import is_
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from numpy.lib.mixins import NDArrayOperatorsMixin

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.errors import InvariantError
from multirep.splines import compiled

#: Rows in a full block. An edit copies and keeps a block (1024 rows of two coordinates: 16 KiB) and
#: the list of all (16 bytes a block). Measured in KiB a version at 10^5 and 10^6 rows: 11 and 39
#: with 512 rows, 18 and 32 with 1024, 66 and 68 with 4096; the times hardly differ.
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

    __slots__ = ("_blocks", "_ends", "_tail")
    _blocks: tuple[Array, ...]
    _ends: tuple[int, ...]
    _tail: tuple[int, ...]

    def __init__(self, blocks: Iterable[Array], tail: tuple[int, ...]) -> None:
        self._blocks = tuple(blocks)
        self._tail = tail
        self._ends = tuple(accumulate(map(len, self._blocks)))

    @classmethod
    def _of(cls, blocks: tuple[Array, ...], ends: tuple[int, ...], tail: tuple[int, ...]) -> Self:
        new = cls.__new__(cls)
        new._blocks, new._ends, new._tail = blocks, ends, tail
        return new

    @classmethod
    def of(cls, values: ArrayLike | BlockArray) -> BlockArray:
        """Make a block array of anything that numpy reads; a block array is returned as it is."""
        if isinstance(values, BlockArray):
            return values
        array = frozen_array(values)
        return cls(_cut(array), array.shape[1:])

    # -- reading -----------------------------------------------------------------------------------

    def __len__(self) -> int:
        return self._ends[-1] if self._ends else 0

    @property
    def shape(self) -> tuple[int, ...]:
        """(n,) or (n, d)."""
        return (len(self), *self._tail)

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
        return sum(block.nbytes for block in self._blocks)

    @property
    def blocks(self) -> tuple[Array, ...]:
        """The blocks themselves, read-only; shared blocks of two versions are the same objects."""
        return self._blocks

    def window(self, start: int, stop: int) -> Array:
        """Rows start..stop-1, contiguous and read-only; no copy when they lie in one block.

        Parameters
        ----------
        start, stop : int
            0 <= start <= stop <= n; not checked.
        """
        blocks, ends = self._blocks, self._ends
        if ends and stop <= ends[0]:
            return blocks[0][start:stop]
        k = bisect_right(ends, start)
        if k == len(blocks):
            return _EMPTY.reshape((0, *self._tail)) if self._tail else _EMPTY
        first = ends[k] - blocks[k].shape[0]
        if stop <= ends[k]:
            return blocks[k][start - first : stop - first]
        last = bisect_left(ends, stop)
        pieces = [blocks[k][start - first :], *blocks[k + 1 : last]]
        pieces.append(blocks[last][: stop - ends[last - 1]])
        joined = np.concatenate(pieces)
        joined.setflags(write=False)
        return joined

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, slice) and key.step in (None, 1):
            start, stop, _ = key.indices(len(self))
            return self.window(start, max(start, stop))
        if isinstance(key, int | np.integer) and not isinstance(key, bool):
            index = int(key)
            n = len(self)
            if not -n <= index < n:
                raise IndexError(f"index {index} is out of bounds for {n} rows")
            index %= n
            k = bisect_right(self._ends, index)
            return self._blocks[k][index - self._ends[k]]
        return self.__array__()[key]

    def __iter__(self) -> Iterator[Any]:
        for block in self._blocks:
            yield from block

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        if len(self._blocks) == 1 and not copy:
            array = self._blocks[0]
        elif self._blocks:
            array = np.concatenate(self._blocks)
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
        blocks = self._blocks
        if len(blocks) == 1:
            return int(blocks[0].searchsorted(value, side="right" if side == "right" else "left"))
        low, high = 0, len(blocks)
        while low < high:  # the first block whose last value is not before `value`
            middle = (low + high) // 2
            last = blocks[middle][-1]
            if last < value or (side == "right" and last == value):
                low = middle + 1
            else:
                high = middle
        if low == len(blocks):
            return len(self)
        before = self._ends[low] - len(blocks[low])
        # the method: np.searchsorted takes five times as long to reach it
        inside = int(blocks[low].searchsorted(value, side="right" if side == "right" else "left"))
        return before + inside

    # -- making new versions -----------------------------------------------------------------------

    def replaced(self, start: int, stop: int, rows: ArrayLike) -> BlockArray:
        """Return a version in which ``rows`` stand for rows start..stop-1; the counts may differ.

        Cost: O(len(rows) + BLOCK_ROWS + number of blocks); all untouched blocks are shared.
        """
        new: Array = np.asarray(rows, dtype=np.float64)
        if new.shape[1:] != self._tail:
            raise InvariantError(f"rows of shape {new.shape[1:]} in an array of {self._tail}", rows)
        if not 0 <= start <= stop <= len(self):
            raise IndexError(f"window {start}:{stop} does not fit into {len(self)} rows")
        blocks, ends = self._blocks, self._ends
        if not blocks:
            return BlockArray(_cut(frozen_array(new)), self._tail)
        if len(blocks) == 1 and 0 < len(new) <= BLOCK_ROWS - ends[0]:
            joined = np.concatenate((blocks[0][:start], new, blocks[0][stop:]))
            joined.setflags(write=False)
            return BlockArray._of((joined,), (len(joined),), self._tail)
        first = min(bisect_right(ends, start), len(blocks) - 1)
        last = min(bisect_left(ends, max(stop, start + 1)), len(blocks) - 1)
        before = ends[first - 1] if first else 0
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
                before = ends[first - 1] if first else 0
        middle = np.concatenate(pieces)
        middle.setflags(write=False)
        cut = _cut(middle)
        shift = before + len(middle) - ends[last]
        marks = [before + count for count in accumulate(map(len, cut))]
        after = ends[last + 1 :]
        new_ends = (*ends[:first], *marks, *(map(shift.__add__, after) if shift else after))
        return BlockArray._of((*blocks[:first], *cut, *blocks[last + 1 :]), new_ends, self._tail)

    def difference(self, other: BlockArray) -> tuple[int, int, int]:
        """Where two versions differ: ``(low, high, other_high)``.

        Rows before ``low`` are bitwise equal, and so are ``self[high:]`` and
        ``other[other_high:]``. Equal arrays give ``low == high == other_high``. Blocks that both
        share are not looked into: O(changed + blocks).
        """
        mine, theirs = self._blocks, other._blocks
        if len(mine) == len(theirs) == 1 and mine[0] is not theirs[0]:
            head, end = _common(mine[0], theirs[0])
            return head, len(mine[0]) - end, len(theirs[0]) - end
        i, j = shared_ends(mine, theirs)
        low = self._ends[i - 1] if i else 0
        tail = len(self) - (self._ends[len(mine) - j - 1] if len(mine) > j else 0)
        a = self.window(low, len(self) - tail)
        b = other.window(low, len(other) - tail)
        head, end = _common(a, b)
        return low + head, low + len(a) - end, low + len(b) - end

    def __repr__(self) -> str:
        return f"BlockArray(shape={self.shape}, blocks={len(self._blocks)})"

    def __reduce__(self) -> tuple[object, ...]:
        return BlockArray.of, (np.asarray(self),)


_EMPTY = np.empty(0)
_EMPTY.setflags(write=False)


def shared_ends(one: Sequence[object], other: Sequence[object]) -> tuple[int, int]:
    """Count what two sequences share, object for object, at the head and, behind it, at the tail.

    Examples
    --------
    >>> shared_ends("abcd", "abbcd")
    (2, 2)
    """
    limit = min(len(one), len(other))
    head = _shared(one, other, limit)
    return head, _shared(reversed(one), reversed(other), limit - head)


def _shared(one: Iterable[object], other: Iterable[object], limit: int) -> int:
    same = (*islice(map(is_, one, other), limit), False)  # 20 ns a block: no Python loop
    return same.index(False)


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


def _common(a: Array, b: Array) -> tuple[int, int]:
    """Lengths of the common bitwise prefix, and of the common suffix of what follows it.

    -0.0 and 0.0 differ. The comparison is flat: a reduction along short rows is ten times slower.
    """
    if compiled.active:
        return compiled.core.common(a, b)
    n = min(len(a), len(b))
    if n == 0:
        return 0, 0
    width = a.size // len(a)
    bits_a, bits_b = _bits(a), _bits(b)
    differs = bits_a[: n * width] != bits_b[: n * width]
    first = int(differs.argmax())
    if not differs[first]:
        return n, 0
    head = first // width
    rest = (n - head) * width
    if len(a) == len(b):
        differs = differs[head * width :]
    else:
        differs = bits_a[bits_a.size - rest :] != bits_b[bits_b.size - rest :]
    last = int(differs[::-1].argmax())
    return head, (last // width if differs[-1 - last] else n - head)


def _bits(rows: Array) -> npt.NDArray[np.int64]:
    bits: npt.NDArray[np.int64] = np.ascontiguousarray(rows).reshape(-1).view(np.int64)
    return bits
