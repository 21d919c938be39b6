"""Where a spline has a corner: knots of full multiplicity at which the tangent really jumps."""

import numpy as np

from multirep.splines.arrays import Array
from multirep.splines.basis import find_spans

__all__ = ["corner_parameters"]


def corner_parameters(
    knots: Array,
    coefficients: Array,
    degree: int,
    start: float,
    stop: float,
    *,
    rational: bool = False,
) -> Array:
    """Find the parameters at which the derivative of a spline jumps.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing.
    coefficients : (n, d) array, or (n, d + 1) if rational
        Control points; of a rational spline homogeneous ones with the weight last.
    degree : int
        Degree p of the spline, at least 1.
    start, stop : float
        The interval; corners strictly inside are wanted.
    rational : bool, keyword-only
        Whether the last coordinate of the coefficients is a weight.

    Returns
    -------
    (c,) array
        Increasing knots of multiplicity p or more where the derivatives from both sides differ by
        more than the rounding of their control points explains.

    Notes
    -----
    At a knot of multiplicity p the curve passes through a control point P with neighbours A and B,
    and the derivatives are p (P - A) / h and p (B - P) / k with h, k the spans' lengths. What
    rounding explains is 16 units in the last place of the largest of the three coordinates (times
    the ratio of the weights), over the shorter of h and k: where a smooth curve was given a knot p
    times, no corner is reported.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0.25, 0.5, 1, 1])
    >>> zigzag = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [4.0, 0.0]])
    >>> corner_parameters(knots, zigzag, 1, 0.0, 1.0)
    array([0.5])
    """
    low = int(knots.searchsorted(start, "right"))
    high = int(knots.searchsorted(stop, "left"))
    inner = knots[low:high]
    full = inner[: max(len(inner) - degree + 1, 0)]
    full = full[full == inner[degree - 1 :]]
    if not len(full):
        return np.empty(0)
    if len(full) > 1:
        full = full[np.concatenate(([True], full[1:] > full[:-1]))]
    after = find_spans(knots, degree, full)
    before = find_spans(knots, degree, full, side="left")
    # The first control point of the piece after, the last of the piece before: both at the knot.
    first, last = after - degree, before
    rows = coefficients.take(np.stack([last - 1, last, first, first + 1]), axis=0)
    ahead, behind = knots[after + 1] - full, full - knots[before]
    points = rows
    slower, faster, steepest = (np.ones(1) for _ in range(3))
    if rational:
        weights = rows[..., -1:]
        points = rows[..., :-1] / weights
        slower, faster = weights[0] / weights[1], weights[3] / weights[2]
        steepest = np.maximum(np.maximum(slower, faster), 1.0)[:, 0]
    left = (points[1] - points[0]) * slower / behind[:, None]
    right = (points[3] - points[2]) * faster / ahead[:, None]
    jump = np.abs(right - left).max(axis=1)
    noise = 16 * np.finfo(np.float64).eps * steepest * np.abs(points).max(axis=(0, 2))
    return np.asarray(full[jump * np.minimum(ahead, behind) > noise])
