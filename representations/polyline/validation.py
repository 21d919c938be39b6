"""What vertices must be, said in one place."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.blocks import BlockArray
from multirep.errors import EditError, InvalidCurveError
from multirep.runs import blocks_of

if TYPE_CHECKING:
    from multirep.representations.polyline.curve import Polyline

#: Largest |coordinate|: squares of differences, summed over coordinates, stay finite.
LARGEST = 1e150


def checked_points(points: ArrayLike) -> Array:
    """Return points as a new (n, d) array without negative zeros.

    Raises
    ------
    InvalidCurveError
        For NaN, infinity, a wrong shape, fewer than two points, or coordinates whose differences
        overflow.
    """
    try:
        rows: Array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidCurveError(
            "points must be numbers in an array of shape (n, d): one row a point"
        ) from None
    if rows.ndim != 2 or rows.shape[1] < 1:
        raise InvalidCurveError(
            f"points must have shape (n, d), one row a point; got shape {rows.shape}"
        )
    if len(rows) < 2:
        raise InvalidCurveError(f"a polyline needs two distinct points or more, got {len(rows)}")
    bad = ~np.isfinite(rows)
    if bad.any():
        i, k = np.argwhere(bad)[0].tolist()
        raise InvalidCurveError(
            f"points must be finite; point {i} is {rows[i].tolist()} (coordinate {k})"
        )
    if float(np.abs(rows).max()) > LARGEST:
        raise InvalidCurveError(f"coordinates must stay below {LARGEST:g}; lengths overflow beyond")
    return rows + 0.0  # -0.0 becomes 0.0: so evaluation at a vertex gives the vertex, bit by bit


def checked_parameters(t: ArrayLike, count: int) -> Array:
    """Return ``count`` strictly increasing parameters as a (n,) array; else InvalidCurveError."""
    try:
        values: Array = np.array(t, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidCurveError("parameters must be numbers in an array of shape (n,)") from None
    if values.shape != (count,):
        raise InvalidCurveError(
            f"expected {count} parameters, one a point; got shape {values.shape}"
        )
    if not np.isfinite(values).all():
        raise InvalidCurveError(
            f"parameters must be finite; t[{int((~np.isfinite(values)).argmax())}] is not"
        )
    falls = values[1:] <= values[:-1]
    if falls.any():
        i = int(falls.argmax())
        raise InvalidCurveError(
            f"parameters must increase strictly; t[{i}] = {values[i]!r} is followed by "
            f"{values[i + 1]!r}"
        )
    return values + 0.0


def checked_rows(rows: ArrayLike, dimension: int) -> Array:
    """Return new vertices of an edit as a (k, d) array; else EditError."""
    try:
        new: Array = np.asarray(rows, dtype=np.float64)
    except (TypeError, ValueError):
        raise EditError(f"a vertex needs {dimension} numbers, got {rows!r}") from None
    if new.ndim != 2:
        raise EditError(f"vertices must have shape (k, {dimension}), got {new.shape}")
    if new.shape[1] != dimension:
        raise EditError(f"a vertex of this curve has {dimension} coordinates, got {new.shape[1]}")
    if new.size and not float(np.abs(new).max()) <= LARGEST:
        raise EditError(
            f"a vertex must be finite, got {new[~np.isfinite(new).all(axis=1)].tolist()}"
        )
    return new + 0.0


def checked_row(point: ArrayLike, dimension: int) -> Array:
    """Return one new vertex of an edit as a (1, d) array; else EditError."""
    try:
        row: Array = np.asarray(point, dtype=np.float64)
    except (TypeError, ValueError):
        raise EditError(f"a vertex needs {dimension} numbers, got {point!r}") from None
    if row.ndim != 1:
        raise EditError(f"a vertex needs {dimension} numbers, got an array of shape {row.shape}")
    return checked_rows(row[None], dimension)


def checked_replacement(
    curve: Polyline, start: int, stop: int, t: ArrayLike, points: ArrayLike
) -> tuple[Array, Array, tuple[float, float]]:
    """Check what shall replace the vertices ``start`` .. ``stop`` - 1; else EditError.

    Returns
    -------
    (k,) array
        Parameters, between those of the vertices around; the ends of T stay where they are.
    (k, d) array
        Vertices.
    pair of float
        Where the curve changes: from the vertex before to the vertex after. Cost: O(k).
    """
    if not 0 <= start <= stop <= curve.size:
        raise EditError(
            f"vertices {start} to {stop} of a polyline with vertices 0 to {curve.size - 1}"
        )
    rows = checked_rows(points, curve.dimension)
    values: Array = np.asarray(t, dtype=np.float64)
    if values.shape != (len(rows),):
        raise EditError(f"{len(rows)} vertices need as many parameters, got shape {values.shape}")
    low, high = max(start - 1, 0), min(stop + 1, curve.size)
    around = np.concatenate([curve.t.window(low, start), values, curve.t.window(stop, high)])
    first, last = float(curve.t[low]), float(curve.t[high - 1])
    ends = len(around) > 1 and around[0] == first and around[-1] == last
    if not (ends and (around[1:] > around[:-1]).all()):
        raise EditError(
            "the parameters of the vertices must increase strictly from one end of the domain "
            f"{curve.domain} to the other"
        )
    return values, rows, (first, last)


def two_distinct(points: BlockArray) -> bool:
    """Whether not all points are the same one; looks at the ends first."""
    first = points[0]
    if (points[-1] != first).any():
        return True
    return any(bool((block != first).any()) for block in blocks_of(points.runs))
