"""Spans and B-spline basis functions, vectorised over parameters.

The recursion is Cox-de Boor with the second numerator ``u_(i+k) - u``; Bartels and Beatty (1989)
print it the other way round. `multirep.testing.reference` holds the recursion word for word.
"""

from typing import Literal

import numpy as np
import numpy.typing as npt

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray

__all__ = ["basis_functions", "find_spans"]


def find_spans(
    knots: Array,
    degree: int,
    t: npt.ArrayLike,
    *,
    side: Literal["left", "right"] = "right",
) -> IntArray:
    """Find the knot span that each parameter lies in.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing; the domain is ``[knots[degree], knots[n]]``.
    degree : int
        Degree of the spline.
    t : array_like (m,)
        Parameters, in any order. Those outside the domain get its first or last span.
    side : {"right", "left"}, keyword-only
        At a knot, whether the span to its right or to its left is meant.

    Returns
    -------
    (m,) integer array
        ``k`` with ``knots[k] <= t < knots[k + 1]`` (left: ``knots[k] < t <= knots[k + 1]``). The
        span is never empty, at the ends of the domain neither.

    Notes
    -----
    Costs two logarithmic searches for each parameter and none over the knots.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 0.5, 1, 1, 1.0])
    >>> find_spans(knots, 2, [0.0, 0.5, 1.0])
    array([2, 3, 3])
    >>> find_spans(knots, 2, [0.0, 0.5, 1.0], side="left")
    array([2, 2, 3])
    """
    if compiled.active and side == "right":
        t = np.asarray(t, dtype=np.float64)
        found = np.empty(t.shape, dtype=np.intp)
        compiled.core.find_spans(knots, degree, t, found)
        return found
    last = len(knots) - degree - 1
    low = knots.searchsorted(knots[degree], "right") - 1
    high = knots.searchsorted(knots[last], "left") - 1
    spans = knots.searchsorted(np.asarray(t, dtype=np.float64), side) - 1
    return np.asarray(np.minimum(np.maximum(spans, low), high))


def basis_functions(
    knots: Array,
    degree: int,
    t: npt.ArrayLike,
    spans: IntArray,
    *,
    order: int = 0,
) -> Array:
    """Evaluate the basis functions that do not vanish, or a derivative of them.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing.
    degree : int
        Degree p of the spline.
    t : array_like (m,)
        Parameters.
    spans : (m,) integer array
        The span of each, as `find_spans` gives it. A parameter outside its span is allowed: the
        polynomial piece of the span is continued.
    order : int, keyword-only
        Order of the derivative, 0 for the values.

    Returns
    -------
    (m, p + 1) array
        Row r holds ``N_(k-p) .. N_k`` at ``t[r]`` for ``k = spans[r]``. Rows of values sum to 1.

    Notes
    -----
    Cox-de Boor from degree 0 upwards; each of the last ``order`` steps differentiates instead of
    blending. Non-negative terms only (for values inside their span), so every entry is exact to a
    few units in its last place.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> basis_functions(knots, 2, [0.5], np.array([2]))
    array([[0.25, 0.5 , 0.25]])
    >>> basis_functions(knots, 2, [0.5], np.array([2]), order=1)
    array([[-1.,  0.,  1.]])
    """
    t = np.asarray(t, dtype=np.float64)
    if order > degree:
        return np.zeros((len(t), degree + 1))
    if compiled.active and not order:
        rows = np.empty((len(t), degree + 1))
        compiled.core.basis_functions(knots, degree, t, spans, rows)
        return rows
    # Row j of `local` is knot k - p + 1 + j: the 2p knots that the span's functions depend on.
    local = knots.take(np.arange(1 - degree, degree + 1)[:, None] + spans)
    left = t - local[:degree]
    right = local[degree:] - t
    values = np.ones((1, len(t)))
    for step in range(1, degree + 1):
        low, high = left[degree - step :], right[:step]
        width = local[degree : degree + step] - local[degree - step : degree]
        if step > degree - order:
            share = step * values / width
            values = np.empty((step + 1, len(t)))
            values[0] = 0.0
            values[1:] = share
            values[:-1] -= share
        else:
            share = values / width
            values = np.empty((step + 1, len(t)))
            values[0] = 0.0
            np.multiply(low, share, out=values[1:])
            share *= high
            values[:-1] += share
    return values.T
