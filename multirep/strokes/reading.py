"""A stroke as it comes from a pen: checked, with repeated samples merged."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.errors import InvalidCurveError

#: Largest |coordinate|: squares of differences, summed over coordinates, stay finite.
LARGEST = 1e150


def read_stroke(points: ArrayLike, *, what: str = "the stroke") -> tuple[Array, int]:
    """Return the samples of a stroke without consecutive repeats, and how many those were.

    Parameters
    ----------
    points : (n, d) array_like
        The places of the pen in order; it may rest, go back and cross its own path.
    what : str, optional
        What the messages call it.

    Returns
    -------
    points : (m, d) array
        Two or more; neighbours differ.
    merged : int
        n - m.

    Raises
    ------
    InvalidCurveError
        For anything that is no array of numbers of shape (n, d), for NaN and infinity, and for
        fewer than two distinct samples. Says what was found.

    Examples
    --------
    >>> points, merged = read_stroke([[0, 0], [0, 0], [1, 2]])
    >>> points.tolist(), merged
    ([[0.0, 0.0], [1.0, 2.0]], 1)
    >>> read_stroke([[3, 4]])
    Traceback (most recent call last):
        ...
    multirep.errors.InvalidCurveError: the stroke has 1 sample; a curve needs two distinct ones
    """
    try:
        rows: Array = np.asarray(points, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidCurveError(
            f"{what} must be numbers in rows of equal length: one row a sample, as in "
            "[[x, y], [x, y]]"
        ) from None
    if rows.size == 0:
        raise InvalidCurveError(f"{what} has no samples; a curve needs two distinct ones")
    if rows.ndim != 2:
        raise InvalidCurveError(
            f"{what} must have shape (n, d), one row a sample; got shape {rows.shape}"
        )
    bad = ~np.isfinite(rows).all(axis=1)
    if bad.any():
        i = int(bad.argmax())
        raise InvalidCurveError(
            f"{what} must be finite; sample {i} of {len(rows)} is {rows[i].tolist()}, "
            f"{int(bad.sum())} in all are not"
        )
    if len(rows) == 1:
        raise InvalidCurveError(f"{what} has 1 sample; a curve needs two distinct ones")
    if float(np.abs(rows).max()) > LARGEST:
        raise InvalidCurveError(f"coordinates of {what} must stay below {LARGEST:g}")
    moves = (rows[1:] != rows[:-1]).any(axis=1)
    merged = len(moves) - int(np.count_nonzero(moves))
    if merged == len(moves):
        raise InvalidCurveError(
            f"{what} has no length: all its {len(rows)} samples are at {rows[0].tolist()}; "
            "a curve needs two distinct ones"
        )
    return rows[np.concatenate([[True], moves])] + 0.0, merged
