"""Knot insertion: the same curve on more knots, all at once."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple, NoReturn, TypeVar

import numpy as np

from multirep.arrays import Array, ArrayLike, Indices
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.nurbs.changes import merged
from multirep.representations.nurbs.evaluation import homogeneous
from multirep.splices import SpliceList
from multirep.splines.polar import blossom_rows, unmatched_rows

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")

#: Windows with no more than so many control points between them are one: a window costs some
#: microseconds, a row a tenth of one.
BRIDGED = 32


class Run(NamedTuple):
    """A window of control points, low .. high - 1, and how many knots are inserted in it."""

    low: int
    high: int
    added: int


def times_of(times: int) -> int:
    """Return how often, a whole number from 1, or refuse it."""
    if isinstance(times, bool) or not isinstance(times, int | np.integer) or times < 1:
        raise EditError(f"times must be a whole number of 1 or more, got {times!r}")
    return int(times)


def knot_inserted(curve: N, t: float, times: int) -> Edit[N]:
    """Insert one knot, once or several times; flat in n."""
    if times_of(times) > 1:
        return knots_inserted(curve, [t] * times)
    t = float(t)
    if not curve.domain.start < t < curve.domain.stop:
        _refuse_outside(curve.domain, t)
    return _one_inserted(curve, t)


def knots_inserted(curve: N, knots: ArrayLike) -> Edit[N]:
    """Insert knots, each strictly inside T; cost: what changes, whatever lies between them.

    Control points whose p inner knots stay are copied; each other one is the blossom, at its new
    inner knots, of the old piece in the middle of its support (Boehm's and the Oslo algorithm are
    orders in which to compute that). All are computed at once, from the windows around the new
    knots laid end to end.
    """
    new = np.sort(np.asarray(knots, dtype=np.float64).ravel())
    if not len(new):
        return Edit(curve, SpliceList.EMPTY)
    p, domain = curve.degree, curve.domain
    inside = (new > domain.start) & (new < domain.stop)
    if not inside.all():
        _refuse_outside(domain, float(new[~inside][0]))
    runs = _runs(curve, new)
    old = np.concatenate([curve._knots.window(low, high + p + 1) for low, high, _ in runs])
    union = np.concatenate((old, new))
    union.sort()
    _refuse_full(p, old, union, new)
    points = _end_to_end(curve._points, runs, np.zeros((p + 1, curve.dimension)))
    weights = None
    if curve._weights is not None:
        weights = _end_to_end(curve._weights, runs, np.ones(p + 1))
    rows, bottoms, changed = refined(old, points, weights, p, union)
    spans = list(_results(runs, p))
    splices = SpliceList.EMPTY
    for start, stop in spans:
        at = changed[changed.searchsorted(start) : changed.searchsorted(stop)]
        splices |= merged(union[at], union[at + p + 1], domain)
    value = curve._with(
        knots=_put(curve._knots, runs, union, [(i, j + p + 1) for i, j in spans], p + 1),
        points=_put(curve._points, runs, rows, spans),
        weights=None if bottoms is None else _put(curve.weights, runs, bottoms, spans),
    )
    return Edit(value, splices)


def _results(runs: list[Run], degree: int) -> Iterator[tuple[int, int]]:
    """Where the rows of each window stand among those of all."""
    start = 0
    for low, high, added in runs:
        yield start, start + high - low + added
        start += high - low + added + degree + 1


def _put(
    array: BlockArray,
    runs: list[Run],
    rows: Array,
    places: list[tuple[int, int]],
    more: int = 0,
) -> BlockArray:
    """Put ``rows[i:j]`` in the place of each window, one replacement for windows that are near.

    Goes from the last window to the first: so the rows before stay where they are.
    """
    pieces: list[Array] = []
    end = begin = runs[-1][1] + more
    for (low, high, _), (i, j) in zip(reversed(runs), reversed(places), strict=True):
        high += more
        if begin - high > BLOCK_ROWS:
            array = array.replaced(begin, end, np.concatenate(pieces[::-1]))
            pieces, end = [], high
        else:
            pieces.append(array.window(high, begin))
        pieces.append(rows[i:j])
        begin = low
    return array.replaced(begin, end, np.concatenate(pieces[::-1]))


def _runs(curve: N, new: Array) -> list[Run]:
    """Cut the control points into windows around new knots that are far apart.

    Windows do not share a knot, and reach p control points beyond those that change.
    """
    p, count, find = curve.degree, curve.size, curve._knots.searchsorted

    def around(first: float, last: float, added: int) -> Run:
        # A knot is there p times at most: the span on its left begins p knots before.
        low, high = find(first, "right") - 1 - 3 * p, find(last, "right") + p
        return Run(max(low, 0), min(high, count), added)

    whole = around(float(new[0]), float(new[-1]), len(new))
    if whole.high - whole.low <= BRIDGED * len(new):
        return [whole]
    runs: list[Run] = []
    for t in new.tolist():
        run = around(t, t, 1)
        if runs and run.low <= runs[-1].high + p + BRIDGED:
            runs[-1] = Run(runs[-1].low, run.high, runs[-1].added + 1)
        else:
            runs.append(run)
    return runs


def _end_to_end(rows: BlockArray, runs: list[Run], gap: Array) -> Array:
    """Join windows with rows between them that no piece reads which matters."""
    parts = [part for low, high, _ in runs for part in (rows.window(low, high), gap)]
    return np.concatenate(parts[:-1])


def _one_inserted(curve: N, t: float) -> Edit[N]:
    """Insert one knot by Boehm's algorithm: at most p control points change.

    Plain floats: for so few numbers they are faster than arrays.
    """
    p, count = curve.degree, curve.size
    k = min(max(curve._knots.searchsorted(t, "right") - 1, p), count - 1)
    low = k - p
    u = curve._knots.window(low, k + p + 1).tolist()
    times = u.count(t)
    if times >= p:
        _refuse_full(p, np.array(u), np.array(sorted([*u, t])), np.array([t]))
    points, weights = curve._points.window(low, k + 1), None
    rows = points.tolist()
    if curve._weights is not None:
        weights = curve._weights.window(low, k + 1).tolist()
        if weights.count(weights[0]) < p + 1:
            rows = [[*(w * x for x in row), w] for row, w in zip(rows, weights, strict=True)]
    made = []
    for i in range(1, p - times + 1):  # row i: between old rows i - 1 and i
        share = (t - u[i]) / (u[i + p] - u[i])
        rest = 1.0 - share
        made.append([rest * a + share * b for a, b in zip(rows[i - 1], rows[i], strict=True)])
    start, stop = low + 1, k - times  # the old rows that the new ones stand for
    new_weights = curve._weights
    if weights is not None and new_weights is not None:
        bottoms = [weights[0]] * len(made)
        if len(rows[0]) > curve.dimension:
            bottoms = [row[-1] for row in made]
            made = [[x / row[-1] for x in row[:-1]] for row in made]
        new_weights = new_weights.replaced(start, stop, bottoms)
    value = curve._with(
        knots=curve._knots.replaced(k + 1, k + 1, [t]),
        points=curve._points.replaced(start, stop, made),
        weights=new_weights,
    )
    reach = [(max(u[1], curve.domain.start), min(u[2 * p - times], curve.domain.stop))]
    return Edit(value, SpliceList(reach))


def _refuse_outside(domain: Interval, wrong: float) -> NoReturn:
    raise EditError(f"a knot can be inserted inside {domain} only, not at {wrong!r}")


def _refuse_full(degree: int, old: Array, union: Array, new: Array) -> None:
    """Raise EditError where a new knot would be there more than p times."""
    have = union.searchsorted(new, "right") - union.searchsorted(new)
    if int(have.max()) > degree:
        wrong = float(new[have > degree][0])
        times = int((old == wrong).sum())
        raise EditError(
            f"{wrong!r} is a knot {times} times already; a curve of degree {degree} "
            f"stays in one piece up to {degree} times"
        )


def refined(
    old: Array, points: Array, weights: Array | None, degree: int, new: Array
) -> tuple[Array, Array | None, Indices]:
    """Express a window on more knots: Euclidean points, weights, and which rows are new.

    The others are copied, bit by bit. Equal weights stay equal to the last bit.
    """
    changed, source = unmatched_rows(old, new, degree)
    rows = points.take(source, axis=0, mode="clip")
    if weights is None or bool((weights == weights[0]).all()):
        rows[changed] = blossom_rows(old, points, degree, new, changed)
        return rows, None if weights is None else np.full(len(rows), weights[0]), changed
    made = blossom_rows(old, homogeneous(points, weights), degree, new, changed)
    rows[changed] = made[:, :-1] / made[:, -1:]
    bottoms = weights.take(source, mode="clip")
    bottoms[changed] = made[:, -1]
    return rows, bottoms, changed
