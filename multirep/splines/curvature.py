"""The second derivative of a spline: values that certify, bounds that are proved."""

import numpy as np

from multirep.splines.arrays import Array
from multirep.splines.certificates import bernstein_bound
from multirep.splines.polar import bernstein

__all__ = ["second_derivative_bound", "second_derivative_coefficients"]


def second_derivative_coefficients(knots: Array, coefficients: Array, degree: int) -> Array:
    """Differentiate a spline twice.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing; any multiplicity.
    coefficients : (n, D) array
        Control points.
    degree : int
        Degree p, at least 2.

    Returns
    -------
    (n - 2, D) array
        The coefficients of S'' as a spline of degree p - 2 on ``knots[2:-2]``; 0 where a basis
        function has no support. For a cubic they are the values of S'' at the knots.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 0, 1, 1, 1, 1.0])
    >>> cube = np.array([[0.0], [0.0], [0.0], [1.0]])
    >>> second_derivative_coefficients(knots, cube, 3)[:, 0]
    array([0., 6.])
    """
    count = len(coefficients)
    for order in (1, 2):
        gaps = knots[degree + 1 : degree + 1 + count - order] - knots[order:count]
        scale = np.divide(degree + 1 - order, gaps, out=np.zeros_like(gaps), where=gaps > 0)
        coefficients = (coefficients[1:] - coefficients[:-1]) * scale[:, None]
    return coefficients


def second_derivative_bound(
    knots: Array, coefficients: Array, degree: int, *, splits: int = 1
) -> Array:
    """Bound the norm of the second derivative on every span.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing; any multiplicity.
    coefficients : (n, D) array
        Control points of a polynomial spline.
    degree : int
        Degree p of the spline.
    splits : int, keyword-only
        How often each span is halved for the bound; matters from degree 4 on only.

    Returns
    -------
    (n - degree,) array
        An upper bound on each span ``knots[p + i], knots[p + i + 1]``; 0 on empty ones. Exact up to
        degree 3. In the units of the points over the square of those of the parameter.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1.0])
    >>> points = np.array([[0.0], [0.0], [0.0], [0.0], [1.0]])
    >>> second_derivative_bound(knots, points, 3)
    array([ 0., 24.])
    """
    count = len(coefficients)
    bounds = np.zeros(count - degree)
    if degree < 2:
        return bounds
    second = second_derivative_coefficients(knots, coefficients, degree)
    filled = np.flatnonzero(knots[degree:count] < knots[degree + 1 : count + 1])
    spans = filled + degree
    pieces = bernstein(knots[2:-2], second, degree - 2, spans - 2, knots[spans], knots[spans + 1])
    bounds[filled] = bernstein_bound(pieces, splits=splits if degree > 3 else 0)
    return bounds
