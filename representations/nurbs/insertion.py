"""Knot insertion: the same curve on more knots, all at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn, TypeAlias, TypeVar

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.nurbs.boehm import Refined, inserted, one_inserted
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")

#: A curve with no more control points is one window: all of it would be copied anyhow.
SHORT = BLOCK_ROWS
#: Windows with no more control points between them are one: that costs less than another window.
BRIDGED = BLOCK_ROWS

#: A window of control points, low .. high - 1, and the knots that are inserted in it, in order.
Run: TypeAlias = tuple[int, int, Array]


def times_of(times: int) -> int:
    """Return how often, a whole number from 1, or refuse it."""
    if isinstance(times, bool) or not isinstance(times, int | np.integer) or times < 1:
        raise EditError(f"times must be a whole number of 1 or more, got {times!r}")
    return int(times)


def knot_inserted(curve: N, t: float, times: int) -> Edit[N]:
    """Insert one knot, once or several times; flat in n."""
    if times_of(times) > 1:
        return knots_inserted(curve, [t] * min(times, curve.degree + 1))  # more are refused, too
    return _one_inserted(curve, float(t))


def _one_inserted(curve: N, t: float) -> Edit[N]:
    domain = curve.domain
    if not domain.start < t < domain.stop:
        _refuse_outside(domain, t)
    edit = _inserted_in_blocks(curve, t)
    return edit or _inserted_in_windows(curve, [(*_around(curve, t, t), np.array([t]))])


def knots_inserted(curve: N, knots: ArrayLike) -> Edit[N]:
    """Insert knots, each strictly inside T; cost: what changes, whatever lies between them."""
    new: Array = np.asarray(knots, dtype=np.float64)
    if new.size == 1:
        return _one_inserted(curve, new.item())
    if not new.size:
        return Edit(curve, SpliceList.EMPTY)
    new, domain = np.sort(new, axis=None), curve.domain
    inside = (new > domain.start) & (new < domain.stop)
    if not inside.all():
        _refuse_outside(domain, float(new[~inside][0]))
    if len(curve._points) <= SHORT:
        return _inserted_in_whole(curve, new)
    return _inserted_in_windows(curve, _runs(curve, new))


def _inserted_in_blocks(curve: N, t: float) -> Edit[N] | None:
    """Insert one knot where all that takes part lies in one block of each array: the usual case.

    None where it does not, or where the knot is there p times already.
    """
    p, knots, points, weights = curve.degree, curve._knots, curve._points, curve._weights
    at = knots.searchsorted(t, "right")
    last = at - 1  # of the control points that act there
    # of each array a block, its first row, and where it is
    k, i = knots.around(at - p, at + p, 1), points.around(last - p, at, 1)
    j = None if weights is None else weights.around(last - p, at, 1)
    if k is None or i is None or (j is None and weights is not None):
        return None
    heavy, heaviest = (None, 0) if j is None else (j[0], last - j[1])
    found = one_inserted(p, t, curve.domain, k[0], at - k[1], i[0], last - i[1], heavy, heaviest)
    if found is None:
        return None
    union, rows, bottoms, splices = found
    if weights is not None and j is not None and bottoms is not None:
        weights = weights.with_block(j, bottoms)
    value = curve._with(
        knots=knots.with_block(k, union), points=points.with_block(i, rows), weights=weights
    )
    return Edit(value, splices)


def _inserted_in_whole(curve: N, new: Array) -> Edit[N]:
    found = _refined(curve, 0, len(curve._points), new)
    value = curve._with(
        knots=_frozen(found.knots),
        points=_frozen(found.points),
        weights=None if found.weights is None else _frozen(found.weights),
    )
    return Edit(value, found.splices)


def _inserted_in_windows(curve: N, runs: list[Run]) -> Edit[N]:
    knots, points, weights = curve._knots, curve._points, curve._weights
    splices, shift = SpliceList.EMPTY, 0
    for low, high, new in runs:
        found = _refined(curve, low, high, new)
        start, stop = low + shift, high + shift
        knots = knots.replaced(start, stop + curve.degree + 1, found.knots)
        points = points.replaced(start, stop, found.points)
        if weights is not None and found.weights is not None:
            weights = weights.replaced(start, stop, found.weights)
        splices |= found.splices
        shift += len(new)
    return Edit(curve._with(knots=knots, points=points, weights=weights), splices)


def _refined(curve: Nurbs, low: int, high: int, new: Array) -> Refined:
    """Insert knots in a window, or refuse them."""
    p, weights = curve.degree, curve._weights
    knots, points = curve._knots.window(low, high + p + 1), curve._points.window(low, high)
    found = inserted(knots, points, None if weights is None else weights.window(low, high), p, new)
    return _refuse_full(p, knots, new) if found is None else found


def _frozen(rows: Array) -> BlockArray:
    rows.setflags(write=False)
    return BlockArray.of(rows)


def _around(curve: Nurbs, first: float, last: float) -> tuple[int, int]:
    """Return the window around new knots: it reaches p control points beyond those that change."""
    p, find = curve.degree, curve._knots.searchsorted
    # A knot is there p times at most: the span on its left begins p knots before.
    low = find(first, "right")
    high = low if first == last else find(last, "right")
    return max(low - 1 - 3 * p, 0), min(high + p, len(curve._points))


def _runs(curve: Nurbs, new: Array) -> list[Run]:
    """Cut the control points into windows around new knots that are far apart."""
    low, high = _around(curve, float(new[0]), float(new[-1]))
    if high - low <= BRIDGED * len(new):
        return [(low, high, new)]
    runs: list[Run] = []
    first = 0
    for i, t in enumerate(new.tolist()):
        low, high = _around(curve, t, t)
        if runs and low <= runs[-1][1] + curve.degree + BRIDGED:
            low = runs.pop()[0]
        else:
            first = i
        runs.append((low, high, new[first : i + 1]))
    return runs


def _refuse_outside(domain: Interval, wrong: float) -> NoReturn:
    raise EditError(f"a knot can be inserted inside {domain} only, not at {wrong!r}")


def _refuse_full(degree: int, old: Array, new: Array) -> NoReturn:
    """Raise EditError for the first new knot that would be there more than p times."""
    have, wanted = (x.searchsorted(new, "right") - x.searchsorted(new) for x in (old, new))
    first = int((have + wanted > degree).argmax())
    raise EditError(
        f"{float(new[first])!r} is a knot {have[first]} times already; a curve of degree {degree} "
        f"stays in one piece up to {degree} times"
    )
