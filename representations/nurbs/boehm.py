"""Knot insertion in a window: the control points of the same curve on more knots.

A control point belongs to its p inner knots: it is the polar form there. Those whose inner knots
stay are copied, bit by bit. One that reads a single new knot lies between two old neighbours
(Boehm's algorithm), any other one is the polar form of an old piece near the middle of its support
(as in the Oslo algorithm). Where the weights that take part are equal, they stay equal to the last
bit, and the points are those of the polynomial curve.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representations.nurbs.changes import merged
from multirep.splices import SpliceList
from multirep.splines import compiled
from multirep.splines.polar import blossom, inner_knots
from multirep.splines.rational import homogeneous


class Refined(NamedTuple):
    """A window on more knots.

    Parameters
    ----------
    knots : (n + m + p + 1,) array
    points : (n + m, d) array
    weights : (n + m,) array or None
    splices : SpliceList
        Where control points act that are no old ones, inside the domain.
    """

    knots: Array
    points: Array
    weights: Array | None
    splices: SpliceList


def inserted(
    knots: Array, points: Array, weights: Array | None, degree: int, new: Array
) -> Refined | None:
    """Insert knots, all at once.

    Parameters
    ----------
    knots, points, weights : (n + p + 1,), (n, d), (n,) arrays or None
        A window that reaches p control points beyond those that change, or to the ends.
    degree : int
    new : (m,) array
        In order, strictly inside the domain of the curve; repeated as often as wanted.

    Returns
    -------
    Refined or None
        None where a knot would be there more than p times.

    Examples
    --------
    >>> knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.array([[0.0], [0.0], [1.0]])
    >>> found = inserted(knots, points, None, 2, np.array([0.5]))
    >>> found.points[:, 0], str(found.splices)
    (array([0. , 0. , 0.5, 1. ]), '[0,1]')
    """
    if not compiled.active:
        return _many_inserted(knots, points, weights, degree, new)
    (n, d), m = points.shape, len(new)
    union, rows = np.empty(len(knots) + m), np.empty((n + m, d))
    bottoms = None if weights is None else np.empty(n + m)
    ends = compiled.core.insert_knots(knots, points, weights, degree, new, union, rows, bottoms)
    if ends is None:
        return None
    return Refined(union, rows, bottoms, SpliceList.unchecked(tuple(ends[0]), tuple(ends[1])))


def one_inserted(
    degree: int,
    t: float,
    within: Interval,
    knots: Array,
    at: int,
    points: Array,
    last: int,
    weights: Array | None = None,
    heaviest: int = 0,
) -> tuple[Array, Array, Array | None, SpliceList] | None:
    """Insert one knot in blocks, each of which has all that takes part.

    Parameters
    ----------
    degree : int
    t : float
        Strictly inside the domain.
    within : Interval
        The domain.
    knots, at : (k,) array, int
        The row before which the new knot belongs, behind equal ones; p knots on either side.
    points, last : (n, d) array, int
        The row of the last control point that acts there; p before it.
    weights, heaviest : (m,) array, int, optional
        The same for the weights.

    Returns
    -------
    knots, points, weights, splices or None
        New blocks, to be frozen, and where control points act that are no old ones. None where the
        knot is there p times already.

    Examples
    --------
    >>> knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.array([[0.0], [0.0], [1.0]])
    >>> _, points, _, splices = one_inserted(2, 0.5, Interval(0, 1), knots, 3, points, 2)
    >>> points[:, 0], str(splices)
    (array([0. , 0. , 0.5, 1. ]), '[0,1]')
    """
    if not compiled.active:
        return _one_inserted(degree, t, within, knots, at, points, last, weights, heaviest)
    union, made = np.empty(len(knots) + 1), np.empty((len(points) + 1, points.shape[1]))
    bottoms = None if weights is None else np.empty(len(weights) + 1)
    ends = compiled.core.insert_knot(
        degree,
        t,
        within.start,
        within.stop,
        knots,
        at,
        points,
        last,
        weights,
        heaviest,
        union,
        made,
        bottoms,
    )
    if ends is None:
        return None
    start, stop = ends
    return union, made, bottoms, SpliceList.unchecked((start,), (stop,))


def _one_inserted(
    p: int,
    t: float,
    within: Interval,
    knots: Array,
    at: int,
    points: Array,
    last: int,
    weights: Array | None,
    heaviest: int,
) -> tuple[Array, Array, Array | None, SpliceList] | None:
    """Insert one knot with plain floats: for so few numbers they are faster than arrays."""
    u = knots[at - p : at + p].tolist()
    times = u.count(t)
    if times >= p:
        return None
    rows = points[last - p : last + 1].tolist()
    w = [1.0] * (p + 1) if weights is None else weights[heaviest - p : heaviest + 1].tolist()
    made, below = [], []
    for i in range(1, p - times + 1):
        share = (t - u[i - 1]) / (u[i - 1 + p] - u[i - 1])
        rest = 1.0 - share
        pairs = zip(rows[i - 1], rows[i], strict=True)
        if w[i - 1] == w[i]:
            below.append(w[i])
            made.append([rest * a + share * b for a, b in pairs])
        else:
            below.append(rest * w[i - 1] + share * w[i])
            made.append(
                [(rest * (w[i - 1] * a) + share * (w[i] * b)) / below[-1] for a, b in pairs]
            )

    def renewed(old: Array, new: list[Any], stop: int) -> Array:
        return np.concatenate((old[: stop - p + 1], new, old[stop - times :]))

    return (
        np.concatenate((knots[:at], [t], knots[at:])),
        renewed(points, made, last),
        None if weights is None else renewed(weights, below, heaviest),
        SpliceList([(max(u[0], within.start), min(u[2 * p - 1 - times], within.stop))]),
    )


def _many_inserted(
    knots: Array, points: Array, weights: Array | None, p: int, new: Array
) -> Refined | None:
    n, m = len(points), len(new)
    at = knots.searchsorted(new, "right")
    times = at - knots.searchsorted(new)
    places, union = at + np.arange(m), np.insert(knots, at, new)
    if bool((union[places - p] == new).any()):
        return None
    # New are the rows, from place - p on, that read a new knot and as many others of its value as
    # there were; behind them, rows stand one place later.
    stops = places - times
    before = np.arange(-p, 0)
    changed = np.unique((places[:, None] + before)[before < -times[:, None]])
    marks = np.concatenate(([0], stops, [n + m]))
    source = np.arange(n + m) - np.arange(m + 1).repeat(marks[1:] - marks[:-1])
    # Those that read one new knot lie between two old ones.
    first = stops.searchsorted(changed, "right")
    single = places.searchsorted(changed + p, "right") - first == 1
    first, several = first[single], changed[~single]
    right = changed[single] - first
    left = right - 1
    share = ((new[first] - knots[right]) / (knots[right + p] - knots[right]))[:, None]
    spans, arguments = inner_knots(knots, p, union, several)

    def mapped(coefficients: Array) -> Array:
        found = np.empty((len(changed), coefficients.shape[1]))
        found[single] = (1.0 - share) * coefficients[left] + share * coefficients[right]
        found[~single] = blossom(knots, coefficients, p, spans, arguments)
        return found

    made = mapped(points)
    bottoms = None
    if weights is not None:
        local = weights.take(spans[:, None] + np.arange(-p, 1))
        even, level = np.empty(len(changed), dtype=bool), np.empty(len(changed))
        even[single], level[single] = weights[left] == weights[right], weights[left]
        even[~single], level[~single] = (local == local[:, :1]).all(axis=1), local[:, 0]
        rational = mapped(homogeneous(points, weights))
        made = np.where(even[:, None], made, rational[:, :-1] / rational[:, -1:])
        bottoms = weights.take(source, mode="clip")
        bottoms[changed] = np.where(even, level, rational[:, -1])
    rows = points.take(source, axis=0, mode="clip")
    rows[changed] = made
    domain = Interval(float(knots[p]), float(knots[n]))
    return Refined(union, rows, bottoms, merged(union[changed], union[changed + p + 1], domain))
