"""What knots, control points and weights must be, said in sentences that a user can act on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.errors import EditError, InvalidCurveError

#: Higher degrees are refused: basis functions of such degrees are no longer well conditioned.
LARGEST_DEGREE = 25


def validated(
    degree: int, knots: ArrayLike, points: ArrayLike, weights: ArrayLike | None
) -> tuple[int, Array, Array, Array | None]:
    """Return degree, knots, points and weights as arrays, or refuse them.

    Weights that are all 1 become None: the same curve, polynomial.

    Raises
    ------
    InvalidCurveError
        With what was found and what is allowed.
    """
    if isinstance(degree, bool) or not isinstance(degree, int | np.integer):
        raise InvalidCurveError(f"the degree must be a whole number, got {degree!r}")
    p = int(degree)
    if not 1 <= p <= LARGEST_DEGREE:
        raise InvalidCurveError(f"the degree must be between 1 and {LARGEST_DEGREE}, got {p}")
    u = _numbers(knots, "knots")
    rows = _numbers(points, "control points")
    if u.ndim != 1:
        raise InvalidCurveError(f"knots must be a flat list of numbers, got shape {u.shape}")
    if rows.ndim != 2 or rows.shape[1] < 1:
        raise InvalidCurveError(
            f"control points must have shape (n, d) with d >= 1, got {rows.shape}"
        )
    n = len(rows)
    if n < p + 1:
        raise InvalidCurveError(f"degree {p} needs {p + 1} control points or more, got {n}")
    if len(u) != n + p + 1:
        raise InvalidCurveError(
            f"{n} control points of degree {p} need {n + p + 1} knots, got {len(u)}"
        )
    check_knots(u, p)
    if weights is None:
        return p, u, rows, None
    w = _numbers(weights, "weights")
    if w.shape != (n,):
        raise InvalidCurveError(f"{n} control points need {n} weights, got shape {w.shape}")
    if not (w > 0).all():
        i = int(np.argmin(w > 0))
        raise InvalidCurveError(f"weights must be positive; weight {i} is {float(w[i])!r}")
    return p, u, rows, None if bool((w == 1.0).all()) else w


def check_knots(u: Array, p: int) -> None:
    """Refuse knots that are out of order, too multiple, or bound no domain."""
    if not (u[1:] >= u[:-1]).all():
        i = int(np.argmin(u[1:] >= u[:-1]))
        raise InvalidCurveError(
            f"knots must not decrease; knot {i + 1} is {float(u[i + 1])!r} after {float(u[i])!r}"
        )
    n = len(u) - p - 1
    start, stop = u[p], u[n]
    if not (start < u[p + 1] and u[n - 1] < stop):
        raise InvalidCurveError(
            f"the first and the last span of the domain [{float(start)!r}, {float(stop)!r}] "
            f"must not be empty: each end may be a knot at most {p + 1} times, "
            f"as the first or last ones"
        )
    if n > p + 1:
        inner = u[p + 1 : n]
        if len(inner) > p and bool((inner[p:] == inner[:-p]).any()):
            i = int(np.argmax(inner[p:] == inner[:-p]))
            times = int((inner == inner[i]).sum())
            raise InvalidCurveError(
                f"an interior knot may occur at most {p} times (the degree); "
                f"{float(inner[i])!r} occurs {times} times"
            )


def point_of(values: ArrayLike, dimension: int) -> Array:
    """Return one finite point of ``dimension`` coordinates, or refuse it."""
    array = np.asarray(values, dtype=np.float64)
    if array.shape != (dimension,) or not np.isfinite(array).all():
        raise EditError(f"expected a finite point of {dimension} coordinates, got {values!r}")
    return array


def rows_of(values: ArrayLike, dimension: int) -> Array:
    """Return finite points of ``dimension`` coordinates, (k, d), or refuse them."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != dimension or not np.isfinite(array).all():
        raise EditError(
            f"expected finite points of {dimension} coordinates each, got an array of shape "
            f"{array.shape}" + ("" if np.isfinite(array).all() else " with NaN or infinity")
        )
    return array


def weight_of(value: float) -> float:
    """Return a positive finite weight, or refuse it."""
    weight = float(value)
    if not (weight > 0 and np.isfinite(weight)):
        raise EditError(f"a weight must be positive and finite, got {value!r}")
    return weight


def index_of(index: int, count: int, what: str) -> int:
    """Return an index in 0 .. count - 1, or refuse it."""
    if not 0 <= index < count:
        raise EditError(f"there is no {what} {index}; there are {count}, numbered from 0")
    return int(index)


def _numbers(values: ArrayLike | Sequence[float], what: str) -> Array:
    try:
        array: Array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidCurveError(f"{what} must be numbers in rows of equal length") from None
    finite = np.isfinite(array)
    if not finite.all():
        where = tuple(int(i) for i in np.argwhere(~finite)[0])
        raise InvalidCurveError(
            f"{what} must be finite; number {list(where)} is {float(array[where])!r}"
        )
    return array
