"""What makes one version of some block arrays of another, as few bytes.

Two neighbouring versions differ in a few rows. Blocks are shared whole, so that an old version
keeps a block for every row that changed; a patch keeps the rows (H. Baker, "Shallow binding makes
functional arrays fast", 1991: all versions but one are differences from a neighbour).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from multirep.blocks import BLOCK_ROWS, BlockArray

__all__ = ["patch_of", "patched", "replacement"]

#: Rows in a patch of one array at most: where versions differ in more, or far apart, whole blocks
#: that they share take less.
_MOST = BLOCK_ROWS
#: First row, rows of the base that go, rows that come: of each array, as 32-bit numbers.
_MARK = struct.Struct("=3I")
#: So many rows can be counted so.
_LONGEST = 2**32
_SAME = _MARK.pack(0, 0, 0)


def patch_of(arrays: Sequence[BlockArray], base: Sequence[BlockArray]) -> bytes | None:
    """Return what makes ``arrays`` of ``base``, or None where that would be no small thing.

    Parameters
    ----------
    arrays, base : sequences of BlockArray
        As many of both, in the same order.

    Notes
    -----
    O(rows that differ); see `BlockArray.difference`. 12 bytes an array and 8 a number.

    Examples
    --------
    >>> a = BlockArray.of([1.0, 2.0, 3.0])
    >>> b = a.replaced(1, 2, [])
    >>> patch = patch_of([a], [b])
    >>> [made], back = patched([b], patch)
    >>> len(patch), len(back), np.asarray(made)
    (20, 12, array([1., 2., 3.]))
    >>> [made], _ = patched([made], back)
    >>> np.asarray(made)
    array([1., 3.])
    """
    marks, parts = [], []
    for mine, theirs in zip(arrays, base, strict=True):
        if mine is theirs:
            marks.append(_SAME)
        else:
            if mine.row_shape != theirs.row_shape:
                return None
            low, high, other = mine.difference(theirs)
            if high - low > _MOST or other >= _LONGEST:
                return None
            marks.append(_MARK.pack(low, other - low, high - low))
            if low < high:
                parts.append(mine.window(low, high).tobytes())
    return b"".join(marks + parts)


def patched(
    base: Sequence[BlockArray], patch: bytes
) -> tuple[tuple[BlockArray, ...], bytes | None]:
    """Return the arrays that gave ``patch`` beside ``base``, bit for bit, and the patch back.

    They share with ``base`` all blocks in which nothing differs, and arrays that are the same.
    There is no patch back where that would be no small thing. O(rows in both patches), as for
    `BlockArray.replaced`.
    """
    made, marks, parts = [], [], []
    at, most = _MARK.size * len(base), 0
    for array, (low, gone, come) in zip(base, _MARK.iter_unpack(patch[:at]), strict=True):
        marks.append(_MARK.pack(low, come, gone))
        if gone or come:
            rows = np.ndarray((come, *array.row_shape), np.float64, patch, at)
            at += rows.nbytes
            if 0 < gone <= _MOST:
                parts.append(array.window(low, low + gone).tobytes())
            most = max(most, gone)
            array = array.replaced(low, low + gone, rows)
        made.append(array)
    return tuple(made), b"".join(marks + parts) if most <= _MOST else None


def replacement(patch: bytes) -> tuple[int, int, int]:
    """Return what a patch does to the first array: ``(low, gone, come)``.

    Rows low .. low + gone - 1 of the base go, rows low .. low + come - 1 of the other come.
    """
    low, gone, come = _MARK.unpack_from(patch)
    return low, gone, come
