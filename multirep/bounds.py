"""Certified bounds, for whoever has to prove how far a curve is from a polyline.

Everything here bounds a distance at equal parameter, ``||S(t) - L(t)||`` for every t in an
interval, from finitely many numbers and never from looking at more points:

* a piecewise polynomial or rational in B-spline form: `spline_chord_deviation`, one call;
* any polynomial or rational: write the difference in Bernstein form and take `bernstein_bound` or
  `rational_bernstein_bound`;
* anything else: bound the second derivative and use `chord_deviation` (or `sagitta`, when the
  polyline's vertices lie on the curve); `sample_curve` samples such a curve from the same bound.

Examples
--------
A helix of radius 2, sampled to within 1e-3: its second derivative has norm 2 everywhere.

>>> import numpy as np
>>> def helix(t):
...     return np.stack([2 * np.cos(t), 2 * np.sin(t), t], axis=1)
>>> t, points, bounds = sample_curve(
...     helix, lambda starts, stops: np.full(len(starts), 2.0), 0.0, 6.0, tolerance=1e-3
... )
>>> len(t), bool(bounds.max() <= 1e-3)
(97, True)
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from multirep.arrays import Array
from multirep.splines.certificates import bernstein_bound, rational_bernstein_bound
from multirep.splines.curvature import second_derivative_bound
from multirep.splines.deviation import spline_chord_deviation

__all__ = [
    "bernstein_bound",
    "chord_deviation",
    "rational_bernstein_bound",
    "sagitta",
    "sample_curve",
    "second_derivative_bound",
    "spline_chord_deviation",
]

_EPS = float(np.finfo(np.float64).eps)


def sagitta(length: npt.ArrayLike, second_derivative: npt.ArrayLike) -> Array:
    """Bound how far a curve leaves the chord between two of its points.

    Parameters
    ----------
    length : array_like
        Length h of the chord's parameter interval.
    second_derivative : array_like
        An upper bound of ``||S''||`` there. S' must be continuous in the interval.

    Returns
    -------
    array
        ``h**2 / 8 max ||S''||``; sharp for a parabola.

    Examples
    --------
    >>> float(sagitta(0.5, 2.0))
    0.0625
    """
    length = np.asarray(length, dtype=np.float64)
    return np.asarray(length * length * np.asarray(second_derivative, dtype=np.float64) / 8)


def chord_deviation(
    t: Array, points: Array, curve_points: Array, second_derivative: npt.ArrayLike
) -> Array:
    """Bound the deviation of a curve from a polyline whose vertices need not lie on it.

    Parameters
    ----------
    t : (m + 1,) array
        Strictly increasing parameters of the polyline; every corner of the curve among them.
    points : (m + 1, d) array
        The polyline's vertices.
    curve_points : (m + 1, d) array
        The curve at the same parameters.
    second_derivative : (m,) array_like
        An upper bound of ``||S''||`` on each chord's interval.

    Returns
    -------
    (m,) array
        The larger deviation of the two vertices plus the sagitta, plus eight units in the last
        place of the largest coordinate for rounding.

    Notes
    -----
    The difference of the curve and its own chord is at most the sagitta; the difference of that
    chord and the polyline's is linear, so largest at an end.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.array([0.0, 0.5, 1.0])
    >>> chord_deviation(t, (t**2 + 0.1)[:, None], (t**2)[:, None], 2.0).round(6)
    array([0.1625, 0.1625])
    """
    ends = np.linalg.norm(curve_points - points, axis=1)
    largest = max(float(np.abs(points).max()), float(np.abs(curve_points).max()))
    slack = 8 * _EPS * np.sqrt(points.shape[1]) * largest
    return np.asarray(
        np.maximum(ends[:-1], ends[1:]) + sagitta(np.diff(t), second_derivative) + slack
    )


def sample_curve(
    curve: Callable[[Array], Array],
    second_derivative: Callable[[Array, Array], npt.ArrayLike],
    start: float,
    stop: float,
    *,
    tolerance: float,
    corners: npt.ArrayLike = (),
) -> tuple[Array, Array, Array]:
    """Sample any curve of which the second derivative can be bounded.

    Parameters
    ----------
    curve : callable
        ``(m,)`` parameters to ``(m, d)`` points.
    second_derivative : callable
        ``(m,)`` starts and ``(m,)`` stops of intervals to ``(m,)`` upper bounds of ``||S''||`` on
        them. Bounds of short intervals should approach the true maximum.
    start, stop : float
        The interval, ``start < stop``.
    tolerance : float, keyword-only
        What no chord may deviate by.
    corners : array_like (c,), keyword-only, optional
        Where S' is not continuous: these become samples. Increasing, strictly inside.

    Returns
    -------
    t : (m + 1,) array
        From start to stop.
    points : (m + 1, d) array
        The curve there.
    chord_bounds : (m,) array
        `chord_deviation` of each chord, at most the tolerance.

    Raises
    ------
    ValueError
        If the tolerance is below what rounding allows.

    Notes
    -----
    Repeatedly cuts every chord that is above the tolerance into equal parts, as many as its own
    bound asks for. Where the bound is constant the count is optimal but for rounding up; where it
    varies within the first chords, up to half as many again.

    Examples
    --------
    >>> import numpy as np
    >>> t, points, bounds = sample_curve(
    ...     lambda t: t[:, None] ** 2, lambda a, b: 2.0, 0.0, 1.0, tolerance=1 / 60
    ... )
    >>> t
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """
    t = np.concatenate(([start], np.asarray(corners, dtype=np.float64), [stop]))
    while True:
        points = curve(t)
        largest = float(np.abs(points).max())
        slack = 8 * _EPS * np.sqrt(points.shape[1]) * largest
        bounds = chord_deviation(t, points, points, second_derivative(t[:-1], t[1:]))
        if bool((bounds <= tolerance).all()):
            return t, points, bounds
        room = tolerance - slack
        parts = np.ones(len(bounds), dtype=np.intp)
        above = bounds > tolerance
        # At most 16 at a time: shorter intervals have better bounds.
        with np.errstate(divide="ignore"):
            wanted = np.sqrt((bounds[above] - slack) / max(room, 0.0))
        parts[above] = np.clip(np.ceil(wanted), 2, 16)
        ends = parts.cumsum()
        fractions = (np.arange(ends[-1]) - (ends - parts).repeat(parts)) / parts.repeat(parts)
        finer = t[:-1].repeat(parts) + fractions * np.diff(t).repeat(parts)
        finer = np.append(finer, stop)
        if room <= 0 or not bool((finer[1:] > finer[:-1]).all()):
            raise ValueError(
                f"a tolerance of {tolerance:.3g} is out of reach: rounding of coordinates up to "
                f"{largest:.3g} alone may cost {slack:.3g}"
            )
        t = finer
