"""Which control points may move beside a frozen stretch, and which had better not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from multirep.arrays import Flags
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.curve import Nurbs

#: Knots are not inserted closer than this part of T.
CLOSEST = 1e-7


def acts_on(curve: Nurbs, first: int, count: int, splices: SpliceList) -> Flags:
    """Say which of the control points first, first + 1, .. act on the interior of some splices.

    Parameters
    ----------
    curve : Nurbs
    first, count : int
        A window of control points.
    splices : SpliceList

    Returns
    -------
    (count,) array of bool

    Examples
    --------
    >>> from multirep.representations.nurbs import Nurbs
    >>> line = Nurbs(degree=1, knots=[0, 0, 1, 2, 3, 3], points=[[0], [1], [2], [3]])
    >>> acts_on(line, 0, 4, SpliceList([(0, 1)])).tolist()
    [True, True, False, False]
    """
    p = curve.degree
    acting = np.zeros(count, dtype=bool)
    if splices:
        knots = curve.knots.window(first, first + count + p + 1)
        for start, stop in splices:
            acting |= (knots[:count] < stop) & (knots[p + 1 :] > start)
    return acting


def bends_at(curve: Nurbs, first: int, count: int, frozen: SpliceList) -> Flags:
    """Say which control points carry the derivatives with which the curve leaves a frozen stretch.

    Beside the p-fold knot of a border those are the next p - 1: moving one of them bends the curve
    at the border, though it tears nothing. Shapes and result as for :func:`acts_on`.
    """
    p = curve.degree
    bending = np.zeros(count, dtype=bool)
    if frozen and p > 1:
        knots = curve.knots.window(first, first + count + p + 1)
        for start, stop in frozen:
            bending |= knots[1 : count + 1] == stop
            bending |= knots[p : count + p] == start
    return bending


def halfway_knots(curve: Nurbs, places: list[float], frozen: SpliceList) -> list[float]:
    """Return knots half way between some parameters and their neighbours, knots or not.

    For a change that finds too few control points: after insertion the spans there are half as
    long. None lies in a frozen stretch, and none closer than 1e-7 of T to what it divides.
    """
    shortest = CLOSEST * curve.domain.length
    t = np.unique(places)
    low, high = curve.span(float(t[0]), "left"), curve.span(float(t[-1])) + 1
    marks = np.union1d(curve.knots.window(low, high + 1), t)
    beside = np.isin(marks, t)
    chosen = (beside[1:] | beside[:-1]) & (np.diff(marks) > 2 * shortest)
    middles = 0.5 * (marks[1:] + marks[:-1])[chosen]
    return [m for m in middles.tolist() if not frozen.contains(m)]
