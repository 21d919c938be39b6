"""What makes one version of some block arrays of another, as few bytes.

Two neighbouring versions differ in a few rows. Blocks are shared whole, so that an old version
keeps a block for every row that changed; a patch keeps the rows (H. Baker, "Shallow binding makes
functional arrays fast", 1991: all versions but one are differences from a neighbour).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence

import numpy as np

from multirep.blocks import BLOCK_ROWS, BlockArray

__all__ = ["patch_of", "patched"]

#: Rows in a patch of one array at most: where versions differ in more, or far apart, whole blocks
#: that they share take less.
_MOST = BLOCK_ROWS
#: First row, rows of the base that go, rows that come.
_MARK = struct.Struct("=3q")


def patch_of(arrays: Sequence[BlockArray], base: Sequence[BlockArray]) -> bytes | None:
    """Return what makes ``arrays`` of ``base``, or None where that would be no small thing.

    Parameters
    ----------
    arrays, base : sequences of BlockArray
        As many of both, in the same order.

    Notes
    -----
    O(rows that differ); see `BlockArray.difference`. 24 bytes an array and 8 a number.

    Examples
    --------
    >>> a = BlockArray.of([1.0, 2.0, 3.0])
    >>> b = a.replaced(1, 2, [])
    >>> patch = patch_of([a], [b])
    >>> len(patch), np.asarray(patched([b], patch)[0])
    (32, array([1., 2., 3.]))
    """
    marks, parts = [], []
    for mine, theirs in zip(arrays, base, strict=True):
        low = high = other = 0
        if mine is not theirs:
            if mine.shape[1:] != theirs.shape[1:]:
                return None
            low, high, other = mine.difference(theirs)
            if high - low > _MOST:
                return None
        marks.append(_MARK.pack(low, other - low, high - low))
        parts.append(mine.window(low, high).tobytes())
    return b"".join(marks + parts)


def patched(base: Sequence[BlockArray], patch: bytes) -> tuple[BlockArray, ...]:
    """Return the arrays that gave ``patch`` beside ``base``, bit for bit.

    They share with ``base`` all blocks in which nothing differs, and arrays that are the same.
    O(rows in the patch), as for `BlockArray.replaced`.
    """
    return tuple(_patched(base, patch))


def _patched(base: Sequence[BlockArray], patch: bytes) -> Iterator[BlockArray]:
    at = _MARK.size * len(base)
    for k, array in enumerate(base):
        low, gone, come = _MARK.unpack_from(patch, _MARK.size * k)
        if gone or come:
            shape = (come, *array.shape[1:])
            rows = np.ndarray(shape, np.float64, patch, at)
            at += rows.nbytes
            array = array.replaced(low, low + gone, rows)
        yield array
