"""The nearest place on any curve, from certified samples alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from multirep.arrays import Array
from multirep.errors import InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.representation import Nearest, Representation

#: First tolerance, relative to the size of the curve: coarse enough to be cheap, fine enough to
#: discard most of it.
FIRST_TOLERANCE = 1e-2
#: Each round tightens the tolerance by this factor; sampling counts grow with its root.
TIGHTENING = 1 / 64
#: The answer is within this part of the curve's size of the true distance (or as near as rounding
#: lets it).
ACCURACY = 1e-10


def nearest_by_sampling(
    curve: Representation, point: Array, *, candidates: SpliceList | None = None
) -> Nearest:
    """Find the place of ``curve`` nearest to ``point``.

    Samples with a certified bound s, discards the chords that are farther than the nearest one by
    more than 2 s, samples the rest more finely, and so on. Cost: one coarse sampling of the curve,
    then only near the answer.

    Parameters
    ----------
    curve : Representation
    point : (d,) array
    candidates : SpliceList, optional
        Where the nearest place is known to be. Default: anywhere in T.

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
    from multirep.representation import Nearest

    if point.shape != (curve.dimension,) or not np.isfinite(point).all():
        raise InvalidCurveError(
            f"expected a finite point of {curve.dimension} coordinates, got {point!r}"
        )
    size = max(curve.magnitude, float(np.abs(point).max()), np.finfo(float).tiny)
    tolerance = FIRST_TOLERANCE * size
    if candidates is None:
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
