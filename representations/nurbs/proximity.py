"""The nearest place of a NURBS: boxes discard most of the curve, certified samples find the rest.

The piece on a span lies in the convex hull of its p + 1 control points (weights are positive), so
in their box. Whole blocks of control points that are farther than a point already found are not
looked at; in the others a span costs a few comparisons.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvalidCurveError
from multirep.nearest import nearest_by_sampling
from multirep.representation import Nearest
from multirep.representations.nurbs.boxes import box_distances
from multirep.representations.nurbs.changes import merged
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representations.nurbs.value import NurbsValue


def nearest(curve: NurbsValue, point: Array) -> Nearest:
    """Find the place of ``curve`` nearest to ``point``; see `nearest_by_sampling`.

    Cost: one look at each block, and at each span of the blocks that may hold the answer.
    """
    if point.shape != (curve.dimension,) or not np.isfinite(point).all():
        raise InvalidCurveError(
            f"expected a finite point of {curve.dimension} coordinates, got {point!r}"
        )
    if not (curve.magnitude or point.any()):
        return Nearest(curve.domain.start, curve(curve.domain.start), 0.0)
    return nearest_by_sampling(curve, point, candidates=_candidates(curve, point))


def _candidates(curve: NurbsValue, point: Array) -> SpliceList:
    """Return stretches that hold the nearest place."""
    p = curve.degree
    counts = np.array([len(block) for block in curve.points.blocks])
    stops = counts.cumsum()
    # The spans that begin in a block read up to p control points of the blocks before it.
    distances = curve._boxes.distances(point)
    firsts = stops.searchsorted(np.maximum(stops - counts - p, 0), "right")
    least = np.array([distances[first : k + 1].min() for k, first in enumerate(firsts.tolist())])
    reached = np.inf
    found: list[tuple[Array, Array, Array]] = []
    for k in np.argsort(least, kind="stable").tolist():
        if least[k] > reached:
            break
        low, high = max(int(stops[k] - counts[k]), p), int(stops[k])
        if low >= high:
            continue
        rows = curve.points.window(low - p, high)
        knots = curve.knots.window(low, high + 1)
        bottom, top = rows[p:], rows[p:]
        for back in range(1, p + 1):
            bottom = np.minimum(bottom, rows[p - back : len(rows) - back])
            top = np.maximum(top, rows[p - back : len(rows) - back])
        away = np.where(knots[:-1] < knots[1:], box_distances(bottom, top, point), np.inf)
        best = int(away.argmin())
        if not np.isfinite(away[best]):
            continue
        there = curve(np.linspace(knots[best], knots[best + 1], 5))
        reached = min(reached, float(np.sqrt(((there - point) ** 2).sum(axis=1)).min()))
        found.append((away, knots[:-1], knots[1:]))
    away, starts, ends = (np.concatenate(column) for column in zip(*found, strict=True))
    near = np.flatnonzero(away <= reached * (1 + 1e-12))
    near = near[np.argsort(starts[near], kind="stable")]
    return merged(starts[near], ends[near], curve.domain)
