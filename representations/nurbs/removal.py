"""Knot removal with a proof: how far the curve moves, and refusal when that is too far.

Removing a knot asks one linear condition of the p - m + 1 control points that read all its m
copies (their combination that is the jump of a derivative must vanish). The smallest change that
meets it, in the largest norm, moves each of them by the same distance: |jump| over the sum of the
absolute coefficients. By the convex hull the curve moves no farther.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError, ToleranceError
from multirep.interval import Interval
from multirep.splices import SpliceList
from multirep.splines.rational import homogeneous

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

N = TypeVar("N", bound="Nurbs")

_EPS = float(np.finfo(np.float64).eps)


def knot_removed(curve: N, t: float, tolerance: float, times: int) -> Edit[N]:
    """Remove the knot at t ``times`` times, or refuse."""
    if not tolerance >= 0:
        raise EditError(f"the tolerance must be 0 or more, got {tolerance!r}")
    at = float(t)
    last = curve._knots.searchsorted(at, "right")
    have = last - curve._knots.searchsorted(at, "left")
    inside = curve.domain.start < at < curve.domain.stop
    if not (inside and have >= times):
        raise EditError(
            f"cannot remove {times} times the knot {at!r}: inside {curve.domain} it occurs "
            f"{have if inside else 0} times"
        )
    value, total = curve, 0.0
    touched = SpliceList.EMPTY
    for copies in range(have, have - times, -1):
        removed = _removed_once(value, last - 1, copies)
        if removed is None:
            raise ToleranceError(
                f"the knot {at!r} cannot be removed: a weight would not stay positive",
                tolerance=tolerance,
                where=at,
            )
        value, splice, moved = removed
        touched = touched | SpliceList([splice])
        total += moved
        last -= 1
    if total > tolerance:
        raise ToleranceError(
            f"removing the knot {at!r} {times} times can be proved to move the curve by no less "
            f"than {total:.3g}, more than the tolerance {tolerance:.3g}",
            tolerance=tolerance,
            reachable=total,
            where=at,
        )
    return Edit(value, touched, bound=total)


def _removed_once(curve: N, j: int, m: int) -> tuple[N, Interval, float] | None:
    """Remove one copy of the knot with last index j and multiplicity m; None: weights fail."""
    p, knots = curve.degree, curve._knots
    t = float(knots[j])
    # Row i of the old curve is (1 - alpha_i) x_(i-1) + alpha_i x_i of the new one, i = j-p .. j-m.
    local = np.delete(knots.window(j - p, j - m + p + 2), p)
    size = p - m + 1
    alpha = (t - local[:size]) / (local[p : p + size] - local[:size])
    points = curve._points.window(j - p - 1, j - m + 2)
    weights = None
    rows = points
    if curve._weights is not None:
        weights = curve._weights.window(j - p - 1, j - m + 2)
        if bool((weights == weights[0]).all()):
            weights = None
        else:
            rows = homogeneous(points, weights)
    old = rows[1:-1]
    rest = old.copy()
    rest[0] -= (1 - alpha[0]) * rows[0]
    rest[-1] -= alpha[-1] * rows[-1]
    steps = np.ones(size)
    steps[1:] = -alpha[:-1] / (1 - alpha[1:])
    condition = steps.cumprod()
    jump = condition @ rest
    change = -np.sign(condition)[:, None] * (jump / np.abs(condition).sum())
    matrix = np.diag(alpha) + np.diag(1 - alpha[1:], -1)
    solved = np.linalg.lstsq(matrix[:, :-1], rest + change, rcond=None)[0] if size > 1 else rest[:0]
    around = np.concatenate((rows[:1], solved, rows[-1:]))
    there = (1 - alpha)[:, None] * around[:-1] + alpha[:, None] * around[1:]
    unit = (4 * p + 16) * _EPS * float(np.abs(points).max()) * np.sqrt(curve.dimension)
    new_weights = None
    if weights is None:
        moved = float(np.sqrt(((there - old) ** 2).sum(axis=1)).max()) + unit
        if curve._weights is not None:
            new_weights = curve._weights.replaced(
                j - p, j - m + 1, np.full(len(solved), curve._weights[j - p])
            )
    else:
        if not (solved[:, -1] > 0).all() or not (there[:, -1] > 0).all():
            return None
        moved = _rational_movement(knots.window(j - p, j + p + 1), curve, j, old, there, m) + unit
        assert curve._weights is not None
        new_weights = curve._weights.replaced(j - p, j - m + 1, solved[:, -1])
        solved = solved[:, :-1] / solved[:, -1:]
    touched = Interval(float(knots[j - p]), float(knots[j - m + p + 1])).clipped(curve.domain)
    value = curve._with(
        knots=knots.replaced(j, j + 1, []),
        points=curve._points.replaced(j - p, j - m + 1, solved),
        weights=new_weights,
    )
    return value, touched, moved


def _rational_movement(local: Array, curve: Nurbs, j: int, old: Array, new: Array, m: int) -> float:
    """Bound the movement of a rational curve whose homogeneous rows j - p .. j - m change.

    ``R' - R = sum N_i ((A'_i - A_i) - R (w'_i - w_i)) / w'`` and R lies in the hull of the control
    points around, so the largest ``|(A'_i - A_i) - P_k (w'_i - w_i)|`` over the smallest w'.
    """
    p = curve.degree
    low, high = max(j - 2 * p, 0), min(j - m + p + 1, curve.size)
    hull = curve._points.window(low, high)
    weights = curve.weights.window(low, high)
    difference = new - old
    off = difference[:, None, :-1] - hull[None] * difference[:, None, -1:]
    smallest = min(float(weights.min()), float(new[:, -1].min()))
    return float(np.sqrt((off**2).sum(axis=2)).max()) / smallest
