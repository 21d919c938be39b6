"""Splice lists as boolean masks: the slow definition that the fast algebra is tested against.

A regular closed set with end points k/n is a set of the cells [k/n, (k+1)/n]. Union, intersection
and difference of such sets are the operations on masks, with nothing to think about at the ends.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from multirep.splices import SpliceList

#: (cells,) booleans: which cells of the grid belong to the set.
Mask: TypeAlias = npt.NDArray[np.bool_]


def mask_of(splices: SpliceList, cells: int) -> Mask:
    """Return the mask of a splice list in [0, 1] whose ends are multiples of 1/``cells``.

    A cell belongs to the set when its middle does.

    Examples
    --------
    >>> mask_of(SpliceList.parse("[0,1/4] [1/2,3/4]"), 4).tolist()
    [True, False, True, False]
    """
    middles = (np.arange(cells) + 0.5) / cells
    mask: Mask = np.zeros(cells, dtype=bool)
    for splice in splices:
        mask |= (splice.start < middles) & (middles < splice.stop)
    return mask


def splices_of(mask: Mask) -> SpliceList:
    """Return the canonical splice list of a mask, made cell by cell.

    Examples
    --------
    >>> splices_of(np.array([True, True, False, True]))
    SpliceList.parse('[0,1/2] [3/4,1]')
    """
    cells = len(mask)
    runs: list[list[float]] = []
    for k in range(cells):
        if mask[k] and k and mask[k - 1]:
            runs[-1][1] = (k + 1) / cells
        elif mask[k]:
            runs.append([k / cells, (k + 1) / cells])
    return SpliceList(runs)


def point_is_inside(mask: Mask, k: int) -> bool:
    """Whether the grid point k/cells lies in the closed set: whether a cell beside it does."""
    return bool(mask[max(k - 1, 0) : k + 1].any())
