"""Analysis: from control points to a coarser level and its details, by banded solves.

With the columns of P and Q interleaved by their position along the curve, the square matrix [P | Q]
is banded (five diagonals on either side), so one step costs O(n) with an LU factor that is kept for
each level, or for all. The scheme is exact for cubic end-interpolating wavelets, which have no
finite analysis filters (Finkelstein-Salesin 1994, section 3.2).
"""

from __future__ import annotations

from functools import cache

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvariantError
from multirep.representations.wavelet.elimination import eliminated
from multirep.representations.wavelet.filters import (
    add_details,
    level_of,
    point_count,
    refine_uniform,
)
from multirep.splines import compiled
from multirep.splines.arrays import IntArray

__all__ = ["MAX_LEVEL", "analyse"]

#: The finest level that is analysed: a million spans, some 50 ms with all coarser levels; each
#: level more doubles time and memory.
MAX_LEVEL = 20
#: Diagonals of [P | Q] on either side.
BANDS = 5
#: In numpy filters are faster than the stored factor from this level on.
ELIMINATED = 13
#: The compiled core has the factors of this level serve all above.
REPEATED = 8
#: From this row on, down to the ends of the curve, two rows of the factors take turns: the ends no
#: longer matter, to the last bit.
_TURNS = 128


def analyse(points: Array) -> tuple[Array, Array]:
    """Split the control points of level j into those of level j - 1 and the details.

    Parameters
    ----------
    points : (2**j + 3, d) array
        Control points of level j, 1 <= j <= 20. Subtract a point near the curve first: the error of
        a detail is relative to the largest coordinate.

    Returns
    -------
    coarse : (2**(j-1) + 3, d) array
        Control points of the best approximation in the L2 norm from level j - 1.
    details : (2**(j-1), d) array
        In units of the peaks of the wavelets.

    Notes
    -----
    O(n). In the compiled core by the triangular factors of [P | Q], whose rows repeat away from the
    ends, so that those of level 8 serve all above; otherwise by LAPACK gbtrs, with a factor that is
    made once for each level, and on high levels by `multirep.representations.wavelet.elimination`,
    which needs none. The condition number of [P | Q] is below 12 at every level.

    Examples
    --------
    >>> points = np.array([[0.0], [2.0], [1.0], [2.0], [0.0]])
    >>> coarse, details = analyse(points)
    >>> add_details(rebuilt := refine_uniform(coarse), details)
    >>> bool(np.allclose(rebuilt, points, rtol=0, atol=1e-14))
    True
    """
    level = level_of(len(points))
    if not 1 <= level <= MAX_LEVEL:
        raise ValueError(f"analysis is offered for levels 1 to {MAX_LEVEL}, got {level}")
    if compiled.active:
        spans = len(points) // 2 - 1
        details = np.empty((spans, points.shape[1]))
        coarse = np.empty((spans + 3, points.shape[1]))
        rows = _triangles(min(level, REPEATED))
        compiled.core.analyse(points, rows, min(_TURNS, len(rows) - 2), coarse, details)
        return coarse, details
    if level >= ELIMINATED:
        return eliminated(points)
    from scipy.linalg.lapack import dgbtrs

    factor, pivots, bands = _factor(level)
    solution, _ = dgbtrs(factor, bands, bands, points, pivots)
    coarse = np.concatenate((solution[:1], solution[1:-1:2], solution[-1:]))
    return coarse, solution[2:-2:2].copy()


@cache
def _factor(level: int) -> tuple[Array, IntArray, int]:
    """LU factor of the interleaved [P | Q] from ``level - 1`` to ``level``, pivots, bandwidth."""
    from scipy.linalg.lapack import dgbtrf

    matrix, bands = _interleaved(level)
    factor, pivots, info = dgbtrf(matrix, bands, bands, overwrite_ab=1)
    if info:
        raise InvariantError(f"[P | Q] of level {level} is singular", info)
    for array in (factor, pivots):
        array.setflags(write=False)
    return factor, pivots, bands


@cache
def _triangles(level: int) -> Array:
    """Rows (n, 11) of the factors L and U without pivots, which [P | Q] can do without.

    No entry grows beyond 5.5. Five of L, the inverse of the pivot, five of U.
    """
    matrix, bands = _interleaved(level)
    count = matrix.shape[1]
    # Entry (i, j) stands in column j, in this row less j plus i.
    middle = 2 * bands
    below = slice(middle + 1, None)
    for k in range(count):
        matrix[below, k] /= matrix[middle, k]
        for j in range(1, min(bands, count - 1 - k) + 1):
            down = slice(middle + 1 - j, middle + 1 - j + bands)
            matrix[down, k + j] -= matrix[below, k] * matrix[middle - j, k + j]
    rows = np.zeros((count, 2 * BANDS + 1))
    for offset in range(-bands, bands + 1):
        first, stop = max(0, -offset), count - max(0, offset)
        columns = slice(first + offset, stop + offset)
        rows[first:stop, BANDS + offset] = matrix[middle - offset, columns]
    rows[:, BANDS] = 1.0 / rows[:, BANDS]
    rows.setflags(write=False)
    return rows


def _interleaved(level: int) -> tuple[Array, int]:
    """Return [P | Q] from ``level - 1`` to ``level`` in band storage, and its bands on a side."""
    count = point_count(level)
    bands = min(BANDS, count - 1)
    matrix = np.zeros((3 * bands + 1, count))
    coarse = point_count(level - 1)
    places = np.maximum(2 * np.arange(coarse) - 1, 0)
    places[-1] = count - 1
    # Columns three apart have no row in common (details: six apart), so a few probes show them all.
    colours = np.arange(coarse) % 3
    _fill(matrix, bands, places, refine_uniform(np.eye(3)[colours]), colours)
    colours = np.arange(coarse - 3) % 6
    probes = np.zeros((count, 6))
    add_details(probes, np.eye(6)[colours])
    _fill(matrix, bands, 2 * np.arange(coarse - 3) + 2, probes, colours)
    return matrix, bands


def _fill(matrix: Array, bands: int, places: IntArray, probes: Array, colours: IntArray) -> None:
    """Write the columns that stand at ``places`` into the band matrix, read off the probes."""
    count = len(probes)
    for offset in range(-bands, bands + 1):
        rows = places + offset
        inside = (rows >= 0) & (rows < count)
        # A probe also shows the neighbours of its own colour: P is 5 rows wide, Q 11.
        width = 2 if probes.shape[1] == 3 else 5
        if abs(offset) <= width:
            matrix[2 * bands + offset, places[inside]] = probes[rows[inside], colours[inside]]
