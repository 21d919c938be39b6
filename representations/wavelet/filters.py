"""Filters of end-interpolating cubic B-spline wavelets: P and Q, applied as stencils.

Level j has the knots 0, 0, 0, 0, h, 2h, .., 1 - h, 1, 1, 1, 1 with h = 2**-j and so 2**j + 3
control points. A curve of level j is one of level j - 1 plus details, ``c(j) = P(j) c(j-1) + Q(j)
d(j-1)``, with 2**(j-1) details that are orthogonal to everything coarser (Finkelstein-Salesin 1994;
Stollnitz, DeRose, Salesin, A Primer, part 2).

The columns of Q are integers and make ``P^T G Q = 0`` exactly, where G is the Gram matrix; the
decimals printed in the primer are these, rounded. Here each column is scaled so that its wavelet
has the peak 1: a detail is then the displacement, in the units of the points, that it adds at the
peak of its wavelet, at every level alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np

from multirep.arrays import Array
from multirep.splines import compiled

__all__ = [
    "add_details",
    "column_table",
    "columns",
    "end_rows",
    "level_of",
    "point_count",
    "refine_uniform",
    "unit_scale",
]

#: A column that is shift invariant; column k of level j >= 4, 3 <= k <= 2**(j-1) - 4, starts at row
#: 2k - 3.
INTERIOR = (-1, 124, -1677, 7904, -18482, 24264, -18482, 7904, -1677, 124, -1)

#: The columns at the left end, by level (4 stands for all above): column k starts at row k. The
#: right end mirrors them.
END_COLUMNS: dict[int, tuple[tuple[int, ...], ...]] = {
    1: ((1, -2, 3, -2, 1),),
    2: ((1368, -2064, 1793, -1053, 691, -240),),
    3: (
        (1136914560, -1655323200, 1321223960, -633094403, 229000092, -46819570, 3456748, -27877),
        (-243649440, 666995430, -881412943, 956224942, -689203555, 300343998, -74736797, 13816670),
    ),
    4: (
        (1136914560, -1655323200, 1321223960, -633094403, 229000092, -46819570, 3456748, -27877),
        (
            -113407810560,
            310334449720,
            -409599117799,
            442436404716,
            -314778993806,
            131665074668,
            -27809640281,
            2055920496,
            -16580004,
        ),
        (
            1228360,
            -6643465,
            26584020,
            -59678354,
            77343956,
            -58651607,
            25047312,
            -5312796,
            392832,
            -3168,
        ),
    ),
}

#: Peaks of the absolute value of the wavelets of the integer columns, same order; INTERIOR_PEAK is
#: exact.
END_PEAKS: dict[int, tuple[float, ...]] = {
    1: (1.0,),
    2: (1368.0,),
    3: (1136914560.0, 377061975.7915352),
    4: (1136914560.0, 174938766957.2539, 31841460.37904473),
}
INTERIOR_PEAK = 30046 / 3

#: Their squared L2 norms when the fine knots are 1 apart.
END_NORMS: dict[int, tuple[float, ...]] = {
    1: (2 / 7,),
    2: (124785152 / 315,),
    3: (27256875217617114112 / 105, 6972626311777967104 / 35),
    4: (27256875217617114112 / 105, 4495390681774587444930112 / 105, 20535305233863616 / 15),
}
INTERIOR_NORM = 675221664 / 5

#: The first rows of a refined curve as combinations of the first control points, by the number of
#: coarse spans (3 stands for all above); the last rows mirror them.
_END_ROWS: dict[int, tuple[tuple[float, ...], ...]] = {
    1: ((1.0,), (1 / 2, 1 / 2), (0.0, 1 / 2, 1 / 2)),
    2: ((1.0,), (1 / 2, 1 / 2), (0.0, 3 / 4, 1 / 4), (0.0, 3 / 16, 10 / 16, 3 / 16)),
    3: ((1.0,), (1 / 2, 1 / 2), (0.0, 3 / 4, 1 / 4), (0.0, 3 / 16, 11 / 16, 2 / 16)),
}


def point_count(level: int) -> int:
    """Return the number of control points of a level: 2**level + 3.

    Examples
    --------
    >>> [point_count(level) for level in range(5)]
    [4, 5, 7, 11, 19]
    """
    return (1 << level) + 3


def level_of(count: int) -> int:
    """Level of a uniform curve with ``count`` control points.

    Raises
    ------
    ValueError
        When no level has that many.

    Examples
    --------
    >>> level_of(19)
    4
    """
    level = (count - 3).bit_length() - 1
    if level < 0 or point_count(level) != count:
        raise ValueError(
            f"a curve of one level has 2**level + 3 control points (4, 5, 7, 11, ...), got {count}"
        )
    return level


def refine_uniform(points: Array) -> Array:
    """Apply P: the same curve with every span halved.

    Parameters
    ----------
    points : (m + 3, d) array
        Control points of a curve of m equal spans, m >= 1; any m, not only powers of two.

    Returns
    -------
    (2 m + 3, d) array

    Notes
    -----
    Rows are (c[i-1] + c[i])/2 and (c[i-1] + 6 c[i] + c[i+1])/8 inside; O(m), no matrix.

    Examples
    --------
    >>> refine_uniform(np.array([[0.0], [0.0], [0.0], [8.0]]))[:, 0]
    array([0., 0., 0., 4., 8.])
    """
    coarse = len(points) - 3
    refined = np.empty((2 * coarse + 3, points.shape[1]))
    if compiled.active:
        compiled.core.refine_uniform(points, end_rows(coarse), refined)
        return refined
    if coarse > 2:
        refined[4:-4:2] = 0.5 * (points[2:-3] + points[3:-2])
        inner = points[3:-3]
        refined[5:-5:2] = 0.125 * (points[2:-4] + 6.0 * inner + points[4:-2])
    for row, weights in enumerate(end_rows(coarse)):
        # Mirrored first: with one or two spans the last of these rows is in the middle.
        refined[-1 - row] = weights @ points[:-5:-1]
        refined[row] = weights @ points[:4]
    return refined


def end_rows(spans: int) -> Array:
    """Return the first rows of P, (3 or 4, 4), for any number of spans; the last mirror them.

    Examples
    --------
    >>> end_rows(8)
    array([[1.    , 0.    , 0.    , 0.    ],
           [0.5   , 0.5   , 0.    , 0.    ],
           [0.    , 0.75  , 0.25  , 0.    ],
           [0.    , 0.1875, 0.6875, 0.125 ]])
    """
    return _padded_rows(min(spans, 3))


@cache
def _padded_rows(spans: int) -> Array:
    return _padded([np.array(row) for row in _END_ROWS[spans]], 4)


def _padded(rows: Sequence[Array], width: int) -> Array:
    """Stack rows, with zeros behind the shorter ones."""
    table = np.zeros((len(rows), width))
    for line, row in zip(table, rows, strict=True):
        line[: len(row)] = row
    table.setflags(write=False)
    return table


@cache
def columns(level: int) -> tuple[tuple[Array, ...], Array]:
    """Columns of Q for the step from ``level - 1`` to ``level``, scaled to peak 1.

    Parameters
    ----------
    level : int
        The finer level, at least 1.

    Returns
    -------
    ends : tuple of arrays
        The columns at the left end; column k starts at row k. The right end mirrors them.
    interior : (11,) array
        Every other column; column k starts at row 2k - 3.

    Examples
    --------
    >>> ends, interior = columns(1)
    >>> ends[0]
    array([ 1., -2.,  3., -2.,  1.])
    """
    kind = min(level, 4)
    ends = tuple(
        np.array(column, dtype=np.float64) / peak
        for column, peak in zip(END_COLUMNS[kind], END_PEAKS[kind], strict=True)
    )
    interior = np.array(INTERIOR, dtype=np.float64) / INTERIOR_PEAK
    for column in (*ends, interior):
        column.setflags(write=False)
    return ends, interior


@cache
def column_table(kind: int) -> Array:
    """Return the columns at the left end and the interior one below, padded to eleven entries.

    Parameters
    ----------
    kind : int
        The finer level; 4 for all above.

    Examples
    --------
    >>> [column_table(kind).shape for kind in (1, 2, 3, 4)]
    [(2, 11), (2, 11), (3, 11), (4, 11)]
    """
    ends, interior = columns(kind)
    return _padded([*ends, interior], len(INTERIOR))


def add_details(points: Array, details: Array, share: float = 1.0) -> None:
    """Add Q d, or a share of it, to the control points of the finer level, in place.

    Parameters
    ----------
    points : (2**j + 3, d) array
        Control points of level j >= 1, changed.
    details : (2**(j-1), d) array
        Details in units of their peak.
    share : float, optional
        A factor.

    Notes
    -----
    A loop over the at most 11 entries of a column, none over the details; O(2**j).

    Examples
    --------
    >>> points = np.zeros((5, 1))
    >>> add_details(points, np.array([[2.0]]))
    >>> points[:, 0]
    array([ 2., -4.,  6., -4.,  2.])
    """
    count = len(details)
    level = level_of(len(points))
    if compiled.active and points.flags.c_contiguous:
        compiled.core.add_details(details, column_table(min(level, 4)), share, points)
        return
    if share != 1.0:
        details = share * details
    ends, interior = columns(level)
    if count == 1:
        points += ends[0][:, None] * details
        return
    backwards = points[::-1]
    for k, column in enumerate(ends):
        points[k : k + len(column)] += column[:, None] * details[k]
        backwards[k : k + len(column)] += column[:, None] * details[-1 - k]
    first, stop = len(ends), count - len(ends)
    if first < stop:
        inner = details[first:stop]
        for row, entry in enumerate(interior, start=2 * first - 3):
            points[row : row + 2 * (stop - first) - 1 : 2] += entry * inner


def unit_scale(level: int) -> Array:
    """L2 norms on [0, 1] of the wavelets between ``level - 1`` and ``level``, peak 1.

    Multiply details by it to get the coefficients for wavelets of unit norm, as in the primer.

    Parameters
    ----------
    level : int
        The finer level, at least 1.

    Returns
    -------
    (2**(level - 1),) array

    Examples
    --------
    >>> round(float(unit_scale(1)[0]) ** 2 * 7, 12)
    1.0
    """
    kind, count = min(level, 4), 1 << (level - 1)
    norms = np.full(count, INTERIOR_NORM**0.5 / INTERIOR_PEAK)
    for k, (norm, peak) in enumerate(zip(END_NORMS[kind], END_PEAKS[kind], strict=True)):
        norms[k] = norms[-1 - k] = norm**0.5 / peak
    norms *= 0.5 ** (level / 2)
    return norms
