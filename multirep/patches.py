"""What makes one version of some block arrays of another, and back, as few bytes.

Two neighbouring versions differ in a few rows. Blocks are shared whole, so that an old version
keeps a block for every row that changed; a patch keeps the rows of both (H. Baker, "Shallow binding
makes functional arrays fast", 1991: all versions but one are differences from a neighbour).
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np

from multirep.blocks import BLOCK_ROWS, BlockArray

__all__ = ["patch_of", "patched", "replaced_rows"]

#: Rows in a patch of one array at most: where versions differ in more, or far apart, whole blocks
#: that they share take less.
_MOST = BLOCK_ROWS
#: First row, rows of the base that go, rows that come: of each array, as 32-bit numbers.
_MARK = struct.Struct("=3I")
#: So many rows can be counted so.
_LONGEST = 2**32
_SAME = _MARK.pack(0, 0, 0)


def patch_of(arrays: Sequence[BlockArray], base: Sequence[BlockArray]) -> bytes | None:
    """Return what makes ``arrays`` of ``base`` and back; None where that would be no small thing.

    Parameters
    ----------
    arrays, base : sequences of BlockArray
        As many of both, in the same order.

    Notes
    -----
    O(rows that differ); see `BlockArray.difference`. 12 bytes an array and 8 a number, of both.

    Examples
    --------
    >>> a = BlockArray.of([1.0, 2.0, 3.0])
    >>> b = a.replaced(1, 2, [])
    >>> patch = patch_of([a], [b])
    >>> len(patch), np.asarray(patched([b], patch)[0])
    (20, array([1., 2., 3.]))
    >>> np.asarray(patched([a], patch, back=True)[0])
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
            if max(high, other) - low > _MOST or other >= _LONGEST:
                return None
            marks.append(_MARK.pack(low, other - low, high - low))
            if low < other:
                parts.append(theirs.window(low, other).tobytes())
            if low < high:
                parts.append(mine.window(low, high).tobytes())
    return b"".join(marks + parts)


def patched(
    base: Sequence[BlockArray], patch: bytes, *, back: bool = False
) -> tuple[BlockArray, ...]:
    """Return the arrays that gave ``patch`` beside ``base``, bit for bit.

    Or, going back, those beside which ``base`` gave it. They share with ``base`` all blocks in
    which nothing differs, and arrays that are the same. O(rows in the patch), as for
    `BlockArray.replaced`.
    """
    made = []
    at = _MARK.size * len(base)
    for array, (low, gone, come) in zip(base, _MARK.iter_unpack(patch[:at]), strict=True):
        if gone or come:
            both = np.ndarray((gone + come, *array.row_shape), np.float64, patch, at)
            at += both.nbytes
            if back:
                array = array.replaced(low, low + come, both[:gone])
            else:
                array = array.replaced(low, low + gone, both[gone:])
        made.append(array)
    return tuple(made)


def replaced_rows(patch: bytes, *, back: bool = False) -> tuple[int, int, int]:
    """Return what a patch does to the first array: ``(low, high, other_high)``.

    Rows low .. high - 1 go, and low .. other_high - 1 of the other come.
    """
    low, gone, come = _MARK.unpack_from(patch)
    return (low, low + come, low + gone) if back else (low, low + gone, low + come)
