"""Knot insertion in a window: the control points of the same curve on more knots.

A control point belongs to its p inner knots: it is the polar form there. Those whose inner knots
stay are copied, bit by bit. One that reads a single new knot lies between two old neighbours
(Boehm's algorithm), any other one is the polar form of an old piece near the middle of its support
(as in the Oslo algorithm). Where the weights that take part are equal, they stay equal to the last
bit, and the points are those of the polynomial curve.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from multirep.arrays import Array
from multirep.interval import Interval
from multirep.representations.nurbs.changes import merged
from multirep.splices import SpliceList
from multirep.splines import compiled
from multirep.splines.polar import blossom, inner_knots
from multirep.splines.rational import homogeneous


#: A block of an array, and a row in it.
Part: TypeAlias = tuple[Array, int]


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
        if len(new) == 1:
            return _inserted_alone(knots, points, weights, degree, float(new[0]))
        return _many_inserted(knots, points, weights, degree, new)
    (n, d), m = points.shape, len(new)
    union, rows = np.empty(len(knots) + m), np.empty((n + m, d))
    bottoms = None if weights is None else np.empty(n + m)
    ends = compiled.core.insert_knots(knots, points, weights, degree, new, union, rows, bottoms)
    if ends is None:
        return None
    return Refined(union, rows, bottoms, SpliceList.unchecked(tuple(ends[0]), tuple(ends[1])))


def one_inserted(
    knots: Part, points: Part, weights: Part | None, degree: int, t: float
) -> tuple[Array, Array, Array | None, float, float] | None:
    """Insert one knot in blocks, each of which has all that takes part.

    Parameters
    ----------
    knots : block and row
        The row before which the new knot belongs, behind equal ones; p knots on either side.
    points, weights : blocks and rows
        The row of the last control point that acts there; p before it.
    degree : int
    t : float
        Strictly inside the domain.

    Returns
    -------
    knots, points, weights, start, stop or None
        New blocks, to be frozen, and from which knot to which control points act that are no old
        ones, perhaps beyond the domain. None where the knot is there p times already.

    Examples
    --------
    >>> knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.array([[0.0], [0.0], [1.0]])
    >>> _, points, _, start, stop = one_inserted((knots, 3), (points, 2), None, 2, 0.5)
    >>> points[:, 0], start, stop
    (array([0. , 0. , 0.5, 1. ]), 0.0, 1.0)
    """
    if not compiled.active:
        return _one_inserted(knots, points, weights, degree, t)
    (u, at), (rows, last) = knots, points
    union, made = np.empty(len(u) + 1), np.empty((len(rows) + 1, rows.shape[1]))
    w, heaviest, bottoms = None, 0, None
    if weights is not None:
        w, heaviest = weights
        bottoms = np.empty(len(w) + 1)
    ends = compiled.core.insert_knot(
        u, at, rows, last, w, heaviest, degree, t, union, made, bottoms
    )
    return None if ends is None else (union, made, bottoms, *ends)


def _inserted_alone(
    knots: Array, points: Array, weights: Array | None, p: int, t: float
) -> Refined | None:
    at = int(knots.searchsorted(t, "right"))
    heavy = None if weights is None else (weights, at - 1)
    found = _one_inserted((knots, at), (points, at - 1), heavy, p, t)
    if found is None:
        return None
    union, rows, bottoms, start, stop = found
    ends = max(start, knots[p]), min(stop, knots[len(points)])
    return Refined(union, rows, bottoms, SpliceList([ends]))


def _one_inserted(
    knots: Part, points: Part, weights: Part | None, p: int, t: float
) -> tuple[Array, Array, Array | None, float, float] | None:
    """Insert one knot with plain floats: for so few numbers they are faster than arrays."""
    (union, at), (rows, last) = knots, points
    u = union[at - p : at + p].tolist()
    times = u.count(t)
    if times >= p:
        return None
    old = rows[last - p : last + 1].tolist()
    w = [1.0] * (p + 1)
    if weights is not None:
        bottoms, heaviest = weights
        w = bottoms[heaviest - p : heaviest + 1].tolist()
    made, below = [], []
    for i in range(1, p - times + 1):
        share = (t - u[i - 1]) / (u[i - 1 + p] - u[i - 1])
        rest = 1.0 - share
        pairs = zip(old[i - 1], old[i], strict=True)
        if w[i - 1] == w[i]:
            below.append(w[i])
            made.append([rest * a + share * b for a, b in pairs])
        else:
            below.append(rest * w[i - 1] + share * w[i])
            made.append(
                [(rest * (w[i - 1] * a) + share * (w[i] * b)) / below[-1] for a, b in pairs]
            )
    # the old rows that the new ones stand for
    return (
        np.concatenate((union[:at], [t], union[at:])),
        np.concatenate((rows[: last - p + 1], made, rows[last - times :])),
        None
        if weights is None
        else np.concatenate((bottoms[: heaviest - p + 1], below, bottoms[heaviest - times :])),
        u[0],
        u[2 * p - 1 - times],
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
