"""The smallest change of control points that meets linear conditions (NURBS book 11.5.1).

A condition is a row: what a curve does at one parameter is a sum of p + 1 neighbouring control
points with known factors. Among all changes that meet the rows, (11.76) takes the one with the
smallest sum of squares.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from multirep.splines.arrays import Array, IntArray

__all__ = ["Factored", "LeastNorm", "factored", "least_norm"]

#: Up to so many rows a dense orthogonal factorisation is faster than a banded one.
_DENSE = 32
#: Rows closer to a combination of others than this are one: only rounding would tell them apart.
_DEPENDENT = 1e-8


class LeastNorm(NamedTuple):
    """What `least_norm` found.

    Parameters
    ----------
    change : (n, d) array
        Of the control points; 0 where they are held.
    quality : float
        Between 0 and 1: the smallest distance of a row (scaled to length 1 before the held columns
        are struck out) from the rows before it. Below 1e-3 or so the change is large and wild; 0
        means that the rows cannot be met.
    culprits : (k,) integer array
        The rows of which the worst one is nearly a combination, itself included.
    """

    change: Array
    quality: float
    culprits: IntArray


class Factored(NamedTuple):
    """A system that is solved for one right-hand side after the other; see `factored`.

    Parameters
    ----------
    columns : (m, q) integer array
        Which control points each row concerns.
    scaled : (m, q) array
        The rows, scaled to length 1, with the held columns struck out.
    lengths : (m,) array
        What they were scaled by.
    size : int
        Number n of control points.
    quality : float
    culprits : (k,) integer array
        As in `LeastNorm`.
    gram : array
        Up to 32 rows the transpose of B, more the lower diagonals of ``B B^T``.
    factor : array
        Its triangle, or its banded Cholesky factor.
    """

    columns: IntArray
    scaled: Array
    lengths: Array
    size: int
    quality: float
    culprits: IntArray
    gram: Array
    factor: Array

    def solve(self, wanted: Array) -> LeastNorm:
        """Return the shortest change for right-hand sides (m, d); nothing is factored for it."""
        if self.quality == 0.0:
            nothing = np.zeros((self.size, wanted.shape[1]))
            return LeastNorm(nothing, 0.0, self.culprits)
        right = wanted / self.lengths[:, None]
        solve = _solved_densely if len(right) <= _DENSE else _solved_in_bands
        factors = solve(self.gram, self.factor, right)
        change = np.zeros((self.size, wanted.shape[1]))
        for j in range(self.columns.shape[1]):
            np.add.at(change, self.columns[:, j], self.scaled[:, j, None] * factors)
        return LeastNorm(change, self.quality, self.culprits)


def factored(starts: IntArray, rows: Array, free: npt.NDArray[np.bool_]) -> Factored:
    """Prepare for `least_norm` with several right-hand sides.

    Parameters
    ----------
    starts, rows, free
        As for `least_norm`.

    Returns
    -------
    Factored

    Examples
    --------
    >>> import numpy as np
    >>> starts, rows = np.array([0, 1]), np.array([[0.5, 0.5], [0.5, 0.5]])
    >>> system = factored(starts, rows, np.array([True, True, False]))
    >>> system.solve(np.array([[1.0], [0.0]])).change.round(12) + 0.0
    array([[2.],
           [0.],
           [0.]])
    """
    lengths = np.sqrt(np.einsum("mq,mq->m", rows, rows))
    columns = starts[:, None] + np.arange(rows.shape[1])
    scaled = rows / lengths[:, None] * free[columns]
    if len(rows) <= _DENSE:
        found = _triangle(columns, scaled, int(free.sum()))
    else:
        found = _bands(starts, scaled)
    return Factored(columns, scaled, lengths, len(free), *found)


def least_norm(
    starts: IntArray, rows: Array, wanted: Array, free: npt.NDArray[np.bool_]
) -> LeastNorm:
    """Solve ``B change = wanted`` for the shortest change.

    Parameters
    ----------
    starts : (m,) integer array
        The first column of each row, non-decreasing.
    rows : (m, q) array
        The q entries of B from there on; no row is all zeros.
    wanted : (m, d) array
        Right-hand sides.
    free : (n,) boolean array
        Which control points may move.

    Returns
    -------
    LeastNorm
        With a quality of 0 the change is 0.

    Notes
    -----
    Up to 32 rows by a QR factorisation of the transpose; more by banded normal equations ``B B^T``
    with one step of refinement, linear in m. `factored` keeps the factorisation.

    Examples
    --------
    Example 11.1 of the NURBS book: one point of a cubic, all four control points free.

    >>> import numpy as np
    >>> from multirep.splines import basis_functions
    >>> knots = np.array([0, 0, 0, 0, 0.2, 0.4, 0.6, 0.8, 1, 1, 1, 1])
    >>> rows = basis_functions(knots, 3, [0.5], np.array([5]))
    >>> found = least_norm(np.array([2]), rows, np.array([[0.04, -0.08]]), np.ones(8, dtype=bool))
    >>> (rows @ found.change[2:6]).round(12)
    array([[ 0.04, -0.08]])
    """
    return factored(starts, rows, free).solve(wanted)


def _triangle(columns: IntArray, scaled: Array, most: int) -> tuple[float, IntArray, Array, Array]:
    """Quality, culprits, ``B^T`` and the triangle of ``B^T = Q R``."""
    count = len(scaled)
    low = int(columns[0, 0])
    matrix = np.zeros((int(columns[-1, -1]) + 1 - low, count))
    np.put_along_axis(matrix.T, columns - low, scaled, axis=1)
    triangle: Array = np.linalg.qr(matrix, mode="r")  # type: ignore[assignment]  # the stubs differ
    pivots = np.zeros(count)
    size = min(triangle.shape)
    pivots[:size] = np.abs(np.diagonal(triangle)[:size])
    quality = float(pivots.min())
    if quality < _DEPENDENT or count > most:
        quality = 0.0
    return quality, _combined(triangle, pivots), matrix, triangle


def _solved_densely(matrix: Array, triangle: Array, right: Array) -> Array:
    """Factors of the rows, from ``R^T R f = b``."""
    # Not dtrtrs: OpenBLAS starts threads for it, which takes milliseconds on a busy machine.
    from scipy.linalg.lapack import dpotrs

    factors, _ = dpotrs(triangle, right)
    # The products lose what the condition costs; one correction brings it back.
    missed = right - matrix.T @ (matrix @ factors)
    correction, _ = dpotrs(triangle, missed)
    total: Array = factors + correction
    return total


def _combined(triangle: Array, pivots: Array) -> IntArray:
    """Rows that combine to the first one that (nearly) depends on those before it."""
    row = int((pivots <= 2 * pivots.min()).argmax())
    before = min(row, len(triangle))
    shares, *_ = np.linalg.lstsq(triangle[:before, :before], triangle[:before, row], rcond=1e-12)
    return np.append(np.flatnonzero(np.abs(shares) > 1e-3), row)


def _bands(starts: IntArray, scaled: Array) -> tuple[float, IntArray, Array, Array]:
    """Quality, culprits, the banded Gram matrix of the rows and its Cholesky factor."""
    from scipy.linalg.lapack import dpbtrf

    count, width = scaled.shape
    ahead = starts.searchsorted(starts + width) - np.arange(count)
    gram = np.zeros((int(ahead.max()), count))
    padded = np.concatenate((scaled, np.zeros((count, width))), axis=1)
    for diagonal in range(len(gram)):
        shift = np.minimum(starts[diagonal:] - starts[: count - diagonal], width)
        places = shift[:, None] + np.arange(width)
        shifted = np.take_along_axis(padded[: count - diagonal], places, axis=1)
        gram[diagonal, : count - diagonal] = np.einsum("mq,mq->m", shifted, scaled[diagonal:])
    factor, info = dpbtrf(gram, lower=1)
    worst = info - 1 if info > 0 else int(factor[0].argmin())
    quality = 0.0 if info > 0 else float(factor[0][worst])
    if quality < _DEPENDENT:
        quality = 0.0
    return quality, _near(starts, width, worst), gram, factor


def _solved_in_bands(gram: Array, factor: Array, right: Array) -> Array:
    """Factors of the rows, with one step of refinement."""
    from scipy.linalg.lapack import dpbtrs

    factors, _ = dpbtrs(factor, right, lower=1)
    correction, _ = dpbtrs(factor, right - _times(gram, factors), lower=1)
    total: Array = factors + correction
    return total


def _near(starts: IntArray, width: int, row: int) -> IntArray:
    """Rows up to ``row`` that share a control point with it."""
    return np.flatnonzero(starts[: row + 1] > starts[row] - width)


def _times(gram: Array, factors: Array) -> Array:
    """Multiply the symmetric banded matrix, given by its lower diagonals."""
    product: Array = gram[0][:, None] * factors
    for diagonal in range(1, len(gram)):
        entries = gram[diagonal, :-diagonal, None]
        product[diagonal:] += entries * factors[:-diagonal]
        product[:-diagonal] += entries * factors[diagonal:]
    return product
