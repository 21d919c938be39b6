"""The nearest place on any curve, from certified samples alone or in a tree of capsules."""

from __future__ import annotations

from collections.abc import Callable
from math import dist, isfinite

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.capsules import ACCURACY, Tree
from multirep.errors import InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.nearest_tree import nearest_parameter, nearest_parameters
from multirep.representation import Nearest, Representation
from multirep.splices import SpliceList

#: First tolerance, relative to the size of the curve: coarse enough to be cheap, fine enough to
#: discard most of it.
FIRST_TOLERANCE = 1e-2
#: Each round tightens the tolerance by this factor; sampling counts grow with its root.
TIGHTENING = 1 / 64


def nearest_in_tree(curve: Representation, tree: Callable[[], Tree], point: ArrayLike) -> Nearest:
    """Find the place nearest to a point, or those of many, in a tree of capsules.

    Parameters
    ----------
    curve : Representation
    tree : callable
        Returns the tree of the curve.
    point : (d,) or (m, d) array_like

    Returns
    -------
    Nearest
        As `Representation.nearest` promises.

    Raises
    ------
    InvalidCurveError
        When a point is not finite or has another dimension.
    """
    points = _checked(curve, point)
    if points.ndim == 1:
        t = nearest_parameter(tree(), points)
        there = curve(t)
        return Nearest(t, there, dist(there.tolist(), points.tolist()))
    many = nearest_parameters(tree(), points)
    places = curve(many)
    return Nearest(many, places, np.linalg.norm(places - points, axis=1))


def many_nearest(curve: Representation, points: Array) -> Nearest:
    """Ask for the nearest place to each of (m, d) points, one by one."""
    found = [curve.nearest(point) for point in _checked(curve, points)]
    return Nearest(
        np.array([place.t for place in found]),
        np.array([place.point for place in found]).reshape(len(found), curve.dimension),
        np.array([place.distance for place in found]),
    )


def _checked(curve: Representation, point: ArrayLike) -> Array:
    points: Array = np.asarray(point, dtype=np.float64)
    right = points.ndim in (1, 2) and points.shape[-1] == curve.dimension
    # of a few numbers faster one by one
    finite = all(map(isfinite, points.tolist())) if points.ndim == 1 else np.isfinite(points).all()
    if not (right and finite):
        raise InvalidCurveError(
            f"expected a finite point of {curve.dimension} coordinates, got {point!r}"
        )
    return points


def nearest_by_sampling(curve: Representation, point: Array) -> Nearest:
    """Find the place of ``curve`` nearest to ``point``.

    Samples with a certified bound s, discards the chords that are farther than the nearest one by
    more than 2 s, samples the rest more finely, and so on. Cost: one coarse sampling of the curve,
    then only near the answer.

    Parameters
    ----------
    curve : Representation
    point : (d,) array

    Returns
    -------
    Nearest
        Its distance exceeds the true one by at most 1e-10 of the curve's size, or by what the
        finest samples that the curve can certify leave open.

    Raises
    ------
    InvalidCurveError
        When the point is not a finite point of the curve's dimension.
    """
    _checked(curve, point)
    size = max(curve.magnitude, float(np.abs(point).max()), np.finfo(float).tiny)
    tolerance = FIRST_TOLERANCE * size
    candidates = SpliceList([curve.domain])
    found_t: float | None = None
    while True:
        starts, stops, distances, bound = [], [], [], 0.0
        best, best_t = np.inf, curve.domain.start
        for splice in candidates:
            try:
                sampled = curve.sample(splice, tolerance=tolerance)
            except ToleranceError:
                if found_t is None:
                    raise
                # Rounding (of widely different weights, say) allows no finer look.
                there = curve(found_t)
                return Nearest(found_t, there, float(np.linalg.norm(there - point)))
            u, d = distance_to_chords(sampled.points[:-1], sampled.points[1:], point)
            k = int(d.argmin())
            if d[k] < best:
                best = float(d[k])
                best_t = float(sampled.t[k] + u[k] * (sampled.t[k + 1] - sampled.t[k]))
            starts.append(sampled.t[:-1])
            stops.append(sampled.t[1:])
            distances.append(d)
            bound = max(bound, sampled.bound)
        found_t = best_t
        if bound <= ACCURACY * size or tolerance <= ACCURACY * size:
            break
        near = np.concatenate(distances) <= best + 2 * bound
        ends = zip(np.concatenate(starts)[near], np.concatenate(stops)[near], strict=True)
        candidates = SpliceList(Interval(float(a), float(b)) for a, b in ends)
        tolerance *= TIGHTENING
    found = curve(best_t)
    return Nearest(best_t, found, float(np.linalg.norm(found - point)))


def distance_to_chords(starts: Array, stops: Array, point: Array) -> tuple[Array, Array]:
    """Nearest places of chords: (u, distance), both (m,), with u in [0, 1] along each chord."""
    chord = stops - starts
    length = np.einsum("ij,ij->i", chord, chord)
    along = np.einsum("ij,ij->i", point - starts, chord)
    u: Array = np.clip(
        np.divide(along, length, out=np.zeros_like(along), where=length > 0), 0.0, 1.0
    )
    distance: Array = np.linalg.norm(starts + u[:, None] * chord - point, axis=1)
    return u, distance
