"""B-splines word for word as they are defined: the slow truth that fast code is tested against.

No vectorisation and no cleverness. Numbers may be floats or `fractions.Fraction`; with fractions
every result is exact.

The recursion is Cox-de Boor with the second numerator ``u_(i+k) - u`` for order k (degree k - 1).
Bartels and Beatty (1989) print it as ``u - u_(i+k)``, which is negative where it must not be.
"""

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

__all__ = [
    "basis_function",
    "bernstein_value",
    "blossom_value",
    "curve_point",
    "exact",
    "rational_curve_point",
]

Number: TypeAlias = float | Fraction


def exact(values: Sequence[float]) -> list[Fraction]:
    """Turn floats into the fractions that they are.

    Examples
    --------
    >>> exact([0.25, 3.0])
    [Fraction(1, 4), Fraction(3, 1)]
    """
    return [Fraction(float(value)) for value in values]


def basis_function(knots: Sequence[Number], degree: int, index: int, t: Number) -> Number:
    """Evaluate one B-spline basis function by recursion over its degree.

    Parameters
    ----------
    knots : sequence of numbers
        Non-decreasing.
    degree : int
        Its degree.
    index : int
        Which one: its support is ``knots[index] .. knots[index + degree + 1]``.
    t : number
        Spans are closed on the left; the last nonempty span of the domain on the right too.

    Returns
    -------
    number

    Examples
    --------
    >>> basis_function([0, 1, 2, 3], 2, 0, 1.5)
    0.75
    """
    if degree == 0:
        low, high = knots[index], knots[index + 1]
        last = t == high == knots[-1]
        return 1 if low <= t < high or (low < high and last) else 0
    total: Number = 0
    rise = knots[index + degree] - knots[index]
    fall = knots[index + degree + 1] - knots[index + 1]
    if rise:
        total += (t - knots[index]) / rise * basis_function(knots, degree - 1, index, t)
    if fall:
        share = (knots[index + degree + 1] - t) / fall
        total += share * basis_function(knots, degree - 1, index + 1, t)
    return total


def curve_point(
    knots: Sequence[Number], points: Sequence[Sequence[Number]], degree: int, t: Number
) -> list[Number]:
    """Sum all control points times their basis functions.

    Examples
    --------
    >>> curve_point([0, 0, 1, 1], [[0, 0], [2, 4]], 1, 0.5)
    [1.0, 2.0]
    """
    values = [basis_function(knots, degree, i, t) for i in range(len(points))]
    return [
        sum((value * point[axis] for value, point in zip(values, points, strict=True)), start=0)
        for axis in range(len(points[0]))
    ]


def rational_curve_point(
    knots: Sequence[Number],
    points: Sequence[Sequence[Number]],
    weights: Sequence[Number],
    degree: int,
    t: Number,
) -> list[Number]:
    """Sum all control points times their weighted basis functions, over the sum of these.

    Examples
    --------
    >>> rational_curve_point([0, 0, 1, 1], [[0], [2]], [1, 3], 1, 0.5)
    [1.5]
    """
    values = [weight * basis_function(knots, degree, i, t) for i, weight in enumerate(weights)]
    total = sum(values, start=0)
    return [
        sum((value * point[axis] for value, point in zip(values, points, strict=True)), start=0)
        / total
        for axis in range(len(points[0]))
    ]


def blossom_value(
    knots: Sequence[Number],
    points: Sequence[Sequence[Number]],
    degree: int,
    span: int,
    arguments: Sequence[Number],
) -> list[Number]:
    """Evaluate the polar form of the polynomial piece of a span by recursion over its arguments.

    Parameters
    ----------
    knots, points, degree
        The spline.
    span : int
        ``knots[span] < knots[span + 1]``.
    arguments : sequence of ``degree`` numbers
        In any order.

    Examples
    --------
    >>> blossom_value([0, 0, 0, 1, 1, 1], [[0], [0], [1]], 2, 2, [0.5, 0.25])
    [0.125]
    """

    def value(index: int, step: int) -> list[Number]:
        if step == 0:
            return list(points[index])
        low, high = knots[index], knots[index + degree + 1 - step]
        share = (arguments[step - 1] - low) / (high - low)
        before, after = value(index - 1, step - 1), value(index, step - 1)
        return [(1 - share) * a + share * b for a, b in zip(before, after, strict=True)]

    return value(span, degree)


def bernstein_value(coefficients: Sequence[Number], t: Number) -> Number:
    """Evaluate a polynomial in Bernstein form on [0, 1] by its definition.

    Examples
    --------
    >>> bernstein_value([0, 0, 1], 0.5)
    0.25
    """
    degree = len(coefficients) - 1
    total: Number = 0
    binomial = 1
    for i, coefficient in enumerate(coefficients):
        total += coefficient * (binomial * t**i * (1 - t) ** (degree - i))
        binomial = binomial * (degree - i) // (i + 1)
    return total
