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

from multirep.arrays import Array
from multirep.errors import ToleranceError
from multirep.representations.polyline.simplification import deviation, simplify
from multirep.sampled import SampledSplice

_NOTHING = np.empty(0, dtype=np.intp)


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
    corners = np.isin(t, sampled.breaks).nonzero()[0] if sampled.breaks else _NOTHING
    kept, off = simplify(t, values, targets, chords, corners)
    if len(kept) == 2 < len(t) and bool((values[0] == values[-1]).all()):
        # one more vertex where only two equal ones would be left
        far = int(np.abs(values - values[0]).max(axis=1).argmax())
        kept = np.unique(np.append(kept, far))
        off = deviation(t, values, targets, kept)
    if len(kept) == len(t):
        return Follower(t, values, gap)
    return Follower(t[kept], values[kept], max(gap, off))


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
