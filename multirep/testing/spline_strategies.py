"""Hypothesis strategies for splines as plain arrays, on a dyadic grid.

Knots, coordinates and parameters are multiples of 1/64 and weights powers of two, so that they are
exact as floats, and interesting coincidences (multiple knots, parameters at knots, equal control
points) come up by themselves.
"""

from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

from multirep.splines.arrays import Array

__all__ = ["DyadicSpline", "dyadic_splines"]

_GRID = 64


class DyadicSpline(NamedTuple):
    """A spline on [0, 1]: knots, coefficients (homogeneous if rational) and degree."""

    knots: Array
    coefficients: Array
    degree: int
    rational: bool

    @property
    def points(self) -> Array:
        """The control points, ``(n, d)``."""
        return (
            self.coefficients[:, :-1] / self.weights[:, None]
            if self.rational
            else (self.coefficients)
        )

    @property
    def weights(self) -> Array:
        """The weights, ``(n,)``; ones for a polynomial spline."""
        if self.rational:
            return np.asarray(self.coefficients[:, -1])
        return np.ones(len(self.coefficients))


@st.composite
def dyadic_splines(
    draw: st.DrawFn,
    *,
    degrees: tuple[int, int] = (1, 5),
    rational: bool | None = False,
    max_inner: int = 6,
    max_multiplicity: int | None = None,
) -> DyadicSpline:
    """Draw a clamped spline on [0, 1] with inner knots of any multiplicity up to the degree.

    Parameters
    ----------
    draw : callable
        Hypothesis supplies it.
    degrees : (int, int), keyword-only
        Smallest and largest degree.
    rational : bool or None, keyword-only
        None draws both kinds.
    max_inner : int, keyword-only
        Largest number of distinct inner knots.
    max_multiplicity : int, keyword-only, optional
        Default the degree.
    """
    degree = draw(st.integers(*degrees))
    inner = draw(st.lists(st.integers(1, _GRID - 1), max_size=max_inner, unique=True))
    most = min(degree, degree if max_multiplicity is None else max_multiplicity)
    knots = [0.0] * (degree + 1)
    for knot in sorted(inner):
        knots += [knot / _GRID] * draw(st.integers(1, most))
    knots += [1.0] * (degree + 1)
    count = len(knots) - degree - 1
    dimension = draw(st.integers(1, 3))
    numbers = st.integers(-4 * _GRID, 4 * _GRID)
    grid = draw(
        st.lists(
            st.lists(numbers, min_size=dimension, max_size=dimension),
            min_size=count,
            max_size=count,
        )
    )
    points = np.array(grid, dtype=np.float64) / _GRID
    is_rational = draw(st.booleans()) if rational is None else rational
    if is_rational:
        exponents = draw(st.lists(st.integers(-3, 3), min_size=count, max_size=count))
        weights = 2.0 ** np.array(exponents, dtype=np.float64)[:, None]
        points = np.concatenate((points * weights, weights), axis=1)
    return DyadicSpline(np.array(knots), points, degree, is_rational)
