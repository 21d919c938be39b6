"""How a polyline takes over what another representation says (Grimm-Ayers 6.1).

Between its ends the new stretch follows the samples L; where it begins or ends inside T, it must
meet what stands outside, R(a), which may be off L(a): the end gap. R' - L is then a line from the
gap down to 0 along the first chord, piecewise linear everywhere, and its norm is convex on each
chord of L. So the certificate needs the samples only: the gap against the allowance of the first
chord, every other sample against those of its two chords.
"""

from __future__ import annotations

import math

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import ToleranceError
from multirep.representations.polyline.simplification import simplify
from multirep.sampled import SampledSplice, interpolate

#: Half an ulp, relative.
UNIT = 2.0**-53


@attrs.frozen(eq=False)
class Follower:
    """The vertices that follow a sampled splice, with the proved distance from it."""

    t: Array
    points: Array
    bound: float


def follow(
    sampled: SampledSplice, tolerance: float, start: Array | None, stop: Array | None
) -> Follower:
    """Choose vertices within the allowance of L on each chord, as few as it can find.

    Parameters
    ----------
    sampled : SampledSplice
    tolerance : float
    start, stop : (d,) array or None
        Where the curve must begin and end; None leaves it to L.

    Returns
    -------
    Follower
        Corners of the source (``breaks``) are among its vertices. Cost: linear in the samples.

    Raises
    ------
    ToleranceError
        When a given end is farther from L than the allowance there.
    """
    t = sampled.t
    targets = sampled.points + 0.0
    values = targets
    if start is not None or stop is not None:
        values = targets.copy()
        values[0] = values[0] if start is None else start
        values[-1] = values[-1] if stop is None else stop
    chords = sampled.allowance(tolerance)
    gap = 0.0
    if start is not None:
        gap = _gap(sampled, start, chords, tolerance, 0)
    if stop is not None:
        gap = max(gap, _gap(sampled, stop, chords, tolerance, -1))
    # evaluating the deviation rounds: at most 8 units of the largest coordinate in each of d
    # coordinates
    largest = max(float(values.max()), -float(values.min()))
    rounding = 8 * UNIT * largest * math.sqrt(values.shape[1])
    allowed = np.empty(len(t))
    allowed[1:-1] = np.minimum(chords[1:], chords[:-1]) - rounding
    allowed[0], allowed[-1] = chords[0], chords[-1]
    keep = np.isin(t, sampled.breaks) if sampled.breaks else np.zeros(len(t), dtype=bool)
    kept = simplify(t, values, targets, allowed, keep)
    kept = _distinct(kept, values)
    if len(kept) == len(t):
        return Follower(t, values, gap)
    rows = values[kept]
    off = interpolate(t[kept], rows, t[1:-1]) - targets[1:-1]
    worst = float(np.sqrt(np.einsum("ij,ij->i", off, off).max())) + rounding
    return Follower(t[kept], rows, max(gap, worst))


def _gap(sampled: SampledSplice, pinned: Array, chords: Array, tolerance: float, end: int) -> float:
    """Return the distance of a pinned end from L; ToleranceError beyond the allowance."""
    gap = math.dist(pinned.tolist(), sampled.points[end].tolist())
    allowed = float(chords[end])
    if gap > allowed:
        where = float(sampled.t[end])
        raise ToleranceError(
            f"the polyline stands {gap:.3g} from the samples at t = {where:g}, "
            f"where only {allowed:.3g} are allowed",
            tolerance=tolerance,
            reachable=tolerance + gap - allowed,
            where=where,
        )
    return gap


def _distinct(kept: Indices, values: Array) -> Indices:
    """Keep one more vertex where only two equal ones would be left."""
    if len(kept) > 2 or (values[kept[0]] != values[kept[-1]]).any():
        return kept
    far = int(np.abs(values - values[0]).max(axis=1).argmax())
    return kept if far in kept else np.insert(kept, 1, far)
