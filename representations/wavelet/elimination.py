"""Analysis of long curves in linear time without stored factors: coarse points are eliminated.

Five neighbouring rows of P are combined to nothing by (1, -4, 6, -4, 1), so the same combinations
of the fine control points depend on the details alone: ``A c = A Q d``. That matrix has three
diagonals on either side, and all its rows away from the ends are the same. The rows of its
triangular factors become the same within rounding after some fifty rows; from there to the other
end they are recursive filters. What is left after the details, ``c - Q d = P x``, gives x by a
stencil: ``x = 2 v - (e + e') / 2`` of a row v at a knot and the rows e, e' beside it.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from multirep.arrays import Array
from multirep.representations.wavelet.filters import (
    add_details,
    columns,
    point_count,
    refine_uniform,
)

__all__ = ["SHORTEST", "eliminated"]

#: The lowest level with a stretch in the middle where nothing of the ends is left.
SHORTEST = 8
#: Rows at the start and at the end of the factors that are kept as they are.
_HEAD, _TAIL = 72, 16


class _Factors(NamedTuple):
    """A, and the triangular factors of A Q: inverses at the ends, filters in between."""

    first: Array
    """The combinations for the first two details, (2, 5); those for the last two mirror them."""
    head: tuple[Array, Array]
    """Inverses of the first rows of L and of U."""
    tail: tuple[Array, Array]
    """Inverses of the last rows of L and of U."""
    before: Array
    """What the last rows of L read before them, (_TAIL, 3)."""
    after: Array
    """What the first rows of U read behind them, (_HEAD, 3)."""
    down: Array
    """A row of L away from the ends, from the diagonal to the left, (4,)."""
    up: Array
    """A row of U away from the ends, from the diagonal to the right, (4,)."""


def eliminated(points: Array) -> tuple[Array, Array]:
    """Split control points of a level from `SHORTEST` on, as `analyse` does; O(n)."""
    factors = _factors()
    even, odd = np.ascontiguousarray(points[0::2].T), np.ascontiguousarray(points[1::2].T)
    right = np.array([np.convolve(row, [1.0, 6.0, 1.0], "valid") for row in even])
    right -= [np.convolve(row, [4.0, 4.0], "valid") for row in odd]
    for k, taps in enumerate(factors.first):
        right[:, k] = taps @ points[2 * k : 2 * k + 5]
        right[:, -1 - k] = taps @ points[::-1][2 * k : 2 * k + 5]
    details = _solved(factors, right)
    _subtract(even, odd, details)
    coarse = np.empty((len(even), details.shape[1] + 3))
    for x, e, v in zip(coarse, even, odd, strict=True):
        np.multiply(v[2:-2], 2.0, out=x[3:-3])
        x[3:-3] -= np.convolve(e[2:-2], [0.5, 0.5], "valid")
    for way in (slice(None), slice(None, None, -1)):
        x, e, v = coarse[:, way], even[:, way], odd[:, way]
        x[:, 0] = e[:, 0]
        x[:, 1] = 2.0 * v[:, 0] - e[:, 0]
        x[:, 2] = (16.0 * v[:, 1] - 3.0 * x[:, 1] - 2.0 * x[:, 3]) / 11.0
    return np.ascontiguousarray(coarse.T), np.ascontiguousarray(details.T)


def _solved(factors: _Factors, right: Array) -> Array:
    """Solve A Q d = right, (dimension, n): down by L, up by U."""
    from scipy.signal import lfilter

    count = right.shape[1]
    y = np.empty_like(right)
    y[:, :_HEAD] = right[:, :_HEAD] @ factors.head[0].T
    stop = count - _TAIL
    start = _state(factors.down, y[:, _HEAD - 3 : _HEAD][:, ::-1])
    y[:, _HEAD:stop] = lfilter([1.0], factors.down, right[:, _HEAD:stop], zi=start)[0]
    ends = right[:, stop:] - y[:, stop - 3 : stop] @ factors.before.T
    y[:, stop:] = ends @ factors.tail[0].T
    solved = np.empty_like(right)
    solved[:, stop:] = y[:, stop:] @ factors.tail[1].T
    gain, up = 1.0 / factors.up[0], factors.up / factors.up[0]
    start = _state(up, solved[:, stop : stop + 3])
    backwards = lfilter([gain], up, y[:, _HEAD:stop][:, ::-1], zi=start)[0]
    solved[:, _HEAD:stop] = backwards[:, ::-1]
    ends = y[:, :_HEAD] - solved[:, _HEAD : _HEAD + 3] @ factors.after.T
    solved[:, :_HEAD] = ends @ factors.head[1].T
    return solved


def _state(taps: Array, last: Array) -> Array:
    """State of the filter 1 / taps after the outputs ``last``, (dimension, 3), the latest first."""
    shifted = np.array([taps[1:], [*taps[2:], 0.0], [taps[3], 0.0, 0.0]])
    return np.asarray(-last @ shifted.T)


def _subtract(even: Array, odd: Array, details: Array) -> None:
    """Subtract Q d from the even and the odd rows, (dimension, n + 2) and (dimension, n + 1)."""
    ends, interior = columns(SHORTEST)
    first, stop = len(ends), details.shape[1] - len(ends)
    # Column k begins at row 2 k - 3, an odd one.
    width = stop - first
    for e, v, d in zip(even, odd, details[:, first:stop], strict=True):
        e[first - 1 : first + 3 + width] -= np.convolve(d, interior[1::2])
        v[first - 2 : first + 3 + width] -= np.convolve(d, interior[0::2])
    for k, column in enumerate(ends):
        for way in (slice(None), slice(None, None, -1)):
            e, v, d = even[:, way], odd[:, way], details[:, way][:, k, None]
            here, there = column[k % 2 :: 2], column[1 - k % 2 :: 2]
            low = (k + 1) // 2
            e[:, low : low + len(here)] -= d * here
            low = k // 2
            v[:, low : low + len(there)] -= d * there


@cache
def _factors() -> _Factors:
    count = (point_count(SHORTEST) - 3) // 2
    refined = refine_uniform(np.eye(count + 3))
    combine = np.zeros((count, len(refined)))
    for k in range(count):
        combine[k, 2 * k : 2 * k + 5] = 1.0, -4.0, 6.0, -4.0, 1.0
    first = np.empty((2, 5))
    for k in range(2):
        rows = refined[2 * k : 2 * k + 5, k : k + 5]
        taps = np.linalg.svd(rows.T)[2][-1]
        first[k] = 6.0 * taps / taps[2]
        combine[k, 2 * k : 2 * k + 5] = first[k]
        combine[-1 - k, ::-1][2 * k : 2 * k + 5] = first[k]
    details = np.zeros((len(refined), count))
    add_details(details, np.eye(count))
    upper: Array = combine @ details
    lower: Array = np.eye(count)
    for k in range(count):  # without pivots: far from them, all leading minors are positive
        below = slice(k + 1, min(k + 4, count))
        lower[below, k] = upper[below, k] / upper[k, k]
        upper[below] -= lower[below, k, None] * upper[k]
    row, stop = _HEAD, count - _TAIL

    def inverses(part: slice) -> tuple[Array, Array]:
        one: Array = np.asarray(np.linalg.inv(lower[part, part]), dtype=np.float64)
        two: Array = np.asarray(np.linalg.inv(upper[part, part]), dtype=np.float64)
        return one, two

    return _Factors(
        first,
        inverses(slice(row)),
        inverses(slice(stop, None)),
        lower[stop:, stop - 3 : stop].copy(),
        upper[:row, row : row + 3].copy(),
        lower[row, row - 3 : row + 1][::-1].copy(),
        upper[row, row : row + 4].copy(),
    )
