"""Wavelets by definition: P, G and Q as explicit matrices of exact fractions.

Slow, and independent of the fast code: P comes from polar forms, G from exact integrals of products
of polynomial pieces, and a column of Q from what defines it: the vector, unique up to its length,
that vanishes outside a given window of rows and is orthogonal to every coarse function.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from itertools import pairwise

import numpy as np

from multirep.arrays import Array

Matrix = list[list[Fraction]]
Polynomial = list[Fraction]


def knots(level: int) -> list[Fraction]:
    """Knots of a level on [0, 2**level], one apart, fourfold at the ends.

    Examples
    --------
    >>> list(map(int, knots(1)))
    [0, 0, 0, 0, 1, 2, 2, 2, 2]
    """
    last = 1 << level
    return [Fraction(k) for k in [0, 0, 0, *range(last + 1), last, last, last]]


def pieces(knot_vector: list[Fraction], index: int) -> dict[Fraction, Polynomial]:
    """Write cubic B-spline ``index`` as polynomials in t, by the start of their spans."""

    def basis(i: int, degree: int, start: Fraction) -> Polynomial:
        if degree == 0:
            return [Fraction(int(knot_vector[i] == start and knot_vector[i + 1] > start))]
        total = [Fraction(0)] * (degree + 1)
        for j, low, sign in ((i, knot_vector[i], 1), (i + 1, knot_vector[i + degree + 1], -1)):
            width = knot_vector[j + degree] - knot_vector[j]
            if width:
                for power, value in enumerate(basis(j, degree - 1, start)):
                    total[power + 1] += sign * value / width
                    total[power] -= sign * low * value / width
        return total

    starts = sorted({a for a, b in pairwise(knot_vector[index : index + 5]) if a < b})
    return {start: basis(index, 3, start) for start in starts}


@cache
def refinement_matrix(level: int) -> Matrix:
    """P from ``level - 1`` to ``level``: rows are polar forms at the inner knots of fine points.

    Examples
    --------
    >>> [str(entry) for entry in refinement_matrix(1)[1]]
    ['1/2', '1/2', '0', '0']
    """
    coarse = [2 * knot for knot in knots(level - 1)]
    fine = knots(level)
    count = (1 << level - 1) + 3
    matrix = []
    for row in range((1 << level) + 3):
        inner = fine[row + 1 : row + 4]
        last = len(coarse) - 5
        span = max(k for k in range(3, last + 1) if coarse[k] <= min(inner[1], coarse[last]))
        local = [[Fraction(int(i == span - 3 + j)) for i in range(count)] for j in range(4)]
        for step, argument in enumerate(inner):
            for j in range(3 - step):
                low, high = coarse[span - 2 + step + j], coarse[span + 1 + j]
                share = (argument - low) / (high - low)
                local[j] = [
                    (1 - share) * a + share * b for a, b in zip(local[j], local[j + 1], strict=True)
                ]
        matrix.append(local[0])
    return matrix


@cache
def gram_matrix(level: int) -> Matrix:
    """Integrals of products of the functions of a level, fine knots one apart.

    Examples
    --------
    >>> str(gram_matrix(1)[0][0])
    '1/7'
    """
    fine = knots(level)
    count = (1 << level) + 3
    functions = [pieces(fine, index) for index in range(count)]
    matrix = [[Fraction(0)] * count for _ in range(count)]
    for i in range(count):
        for j in range(i, min(i + 4, count)):
            for start in functions[i].keys() & functions[j].keys():
                for m, a in enumerate(functions[i][start]):
                    for n, b in enumerate(functions[j][start]):
                        power = m + n + 1
                        width = (start + 1) ** power - start**power
                        matrix[i][j] += a * b * width / power
            matrix[j][i] = matrix[i][j]
    return matrix


@cache
def wavelet_matrix(level: int) -> Matrix:
    """Q from ``level - 1`` to ``level``: columns of coprime integers, signed as in the primer.

    Column k of m = 2**(level-1) vanishes outside rows max(k, 2k - 3) .. min(k + m + 3, 2k + 7), the
    smallest windows that leave room for exactly one.

    Examples
    --------
    >>> [int(row[0]) for row in wavelet_matrix(1)]
    [1, -2, 3, -2, 1]
    """
    rows, count = (1 << level) + 3, 1 << level - 1
    p, g = refinement_matrix(level), gram_matrix(level)
    coarse = range(count + 3)
    conditions = [
        [sum((p[r][i] * g[r][s] for r in range(rows)), Fraction(0)) for s in range(rows)]
        for i in coarse
    ]
    matrix = [[Fraction(0)] * count for _ in range(rows)]
    for k in range(count):
        first, stop = max(k, 2 * k - 3), min(k + count + 4, 2 * k + 8)
        vector = _null_vector([row[first:stop] for row in conditions])
        scale = np.lcm.reduce([entry.denominator for entry in vector], dtype=object)
        integers = [int(entry * scale) for entry in vector]
        common = int(np.gcd.reduce(np.array(integers, dtype=object)))
        # In the primer the entry in the middle of the window decides: it is the main lobe.
        mirrored = 2 * k >= count
        lead = integers[-1] if mirrored else integers[0]
        place = min(k, count - 1 - k)
        wanted = 1 if place == 0 or (place == 2 and level >= 4) else -1
        sign = wanted * (1 if lead > 0 else -1)
        for offset, entry in enumerate(integers):
            matrix[first + offset][k] = Fraction(sign * entry, common)
    return matrix


def _null_vector(matrix: Matrix) -> list[Fraction]:
    """Find the vector that ``matrix`` maps to zero, by Gauss-Jordan in fractions."""
    rows = [list(row) for row in matrix]
    columns = len(rows[0])
    pivots: list[int] = []
    for column in range(columns):
        done = len(pivots)
        pivot = next((r for r in range(done, len(rows)) if rows[r][column]), None)
        if pivot is None:
            continue
        rows[done], rows[pivot] = rows[pivot], rows[done]
        rows[done] = [entry / rows[done][column] for entry in rows[done]]
        for r in range(len(rows)):
            if r != done and rows[r][column]:
                factor = rows[r][column]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[done], strict=True)]
        pivots.append(column)
    free = [column for column in range(columns) if column not in pivots]
    if len(free) != 1:
        raise ValueError(f"expected one solution up to its length, found {len(free)} free unknowns")
    vector = [Fraction(0)] * columns
    vector[free[0]] = Fraction(1)
    for row, column in enumerate(pivots):
        vector[column] = -rows[row][free[0]]
    return vector


def floats(matrix: Matrix) -> Array:
    """Round a matrix of fractions to float64."""
    return np.array([[float(entry) for entry in row] for row in matrix])


def decompose(points: Array) -> tuple[Array, Array]:
    """Analyse one step by a dense solve: coarse points, and details for the integer columns.

    Examples
    --------
    >>> coarse, details = decompose(np.array([[1.0], [-2.0], [3.0], [-2.0], [1.0]]))
    >>> bool(abs(coarse).max() < 1e-14), round(float(details[0, 0]), 12)
    (True, 1.0)
    """
    level = (len(points) - 3).bit_length() - 1
    p, q = floats(refinement_matrix(level)), floats(wavelet_matrix(level))
    scale = np.abs(q).max(axis=0)
    solution = np.linalg.solve(np.concatenate((p, q / scale), axis=1), points)
    rows: Array = np.asarray(solution, dtype=np.float64)
    coarse = p.shape[1]
    return rows[:coarse], rows[coarse:] / scale[:, None]
