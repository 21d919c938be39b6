"""The character of one curve on another: details of some levels copied (Grimm-Ayers 2.2.4)."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.representations.wavelet import details
from multirep.representations.wavelet.confining import confined_to, free_of
from multirep.representations.wavelet.filters import add_details, refine_uniform
from multirep.representations.wavelet.frames import frames
from multirep.representations.wavelet.graded import Graded
from multirep.representations.wavelet.pyramid import Pyramid
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.edit import Edit
    from multirep.representations.wavelet.bspline import WaveletBSpline

__all__ = ["Frame", "detailed"]

Frame: TypeAlias = Literal["curve", "axes"]

#: Details smaller than this part of the largest coordinate are what rounding makes of none: knots
#: for them would be wasted. (Analysis errs by 12 units in the last place, its condition, at most.)
_ROUNDING = 32 * float(np.finfo(np.float64).eps)
#: Runs of changed control points with fewer unchanged ones between them are changed together: a run
#: costs about 0.2 ms.
_GAP = 16
#: Before a frozen stretch the change fades out over so many spans of the coarsest copied level.
_APRON_SPANS = 4


def detailed(
    curve: WaveletBSpline,
    source: WaveletBSpline,
    levels: Collection[int],
    frame: Frame = "curve",
    frozen: SpliceList = SpliceList.EMPTY,
) -> Edit[WaveletBSpline]:
    """Replace the details of some levels by those of another curve.

    Parameters
    ----------
    curve, source : WaveletBSpline
        In the same number of coordinates. Details correspond by their place as a part of T.
    levels : collection of int
        Detail level l leads from level l to l + 1. A source without details there takes those of
        the curve away.
    frame : "curve" or "axes"
        Whether copied details keep their direction relative to the curve, see
        `multirep.representations.wavelet.frames`, or to the axes of coordinates.
    frozen : SpliceList
        Where nothing may change; before it the change fades out over four spans of the lowest
        level, or a third of what is free.

    Returns
    -------
    Edit
        Details of other levels keep their coefficients. Copying a curve's own details changes
        nothing.

    Raises
    ------
    EditError
        For no level, levels outside 0 to 15, other numbers of coordinates, frames that do not
        exist, or when there is no room for a change beside what is frozen.

    Notes
    -----
    Linear in both curves and 2**level. Deeper parts of graded curves stay as they are: their
    details up to level 15 are those of the best approximation, as the pyramid says.

    Examples
    --------
    >>> from multirep.representations import WaveletBSpline
    >>> line = WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0]])
    >>> bump = line.add_detail(1, 0, [0.0, 0.5]).value
    >>> turned = WaveletBSpline([[0, 0], [0, 1], [0, 2], [0, 3]])
    >>> detailed(turned, bump, [1]).value.pyramid().details[1][0].round(12)
    array([-0.5,  0. ])
    """
    low, high = min(levels, default=-1), max(levels, default=-1)
    finest = details.FINEST_ANALYSED - 1
    if not 0 <= low <= high <= finest:
        raise EditError(
            f"copy details of one level or more between 0 and {finest}, got {sorted(levels)}; "
            f"level l has 2**l details all over T, and beyond {finest} that is too many"
        )
    if frame not in ("curve", "axes"):
        raise EditError(f"the frame must be 'curve' or 'axes', got {frame!r}")
    if curve.dimension != source.dimension:
        raise EditError(
            f"the curve has {curve.dimension} coordinates, that with the details has "
            f"{source.dimension}"
        )
    before = curve._graded
    nothing = _ROUNDING * max(curve.magnitude, source.magnitude)
    change = _change(
        curve.pyramid(high + 1), source.pyramid(high + 1), set(levels), low, frame, nothing
    )
    after = _plus(before, high + 1, change)
    if after is before or not frozen:
        return curve._edit(after)
    where = free_of(frozen, curve.domain)
    return curve._edit(confined_to(before, after, where, _APRON_SPANS * 2.0**-low, frozen))


def _change(
    mine: Pyramid, theirs: Pyramid, levels: set[int], low: int, frame: Frame, nothing: float
) -> Array:
    """Change of the control points of the level of the pyramids, (2**level + 3, d)."""
    coarse, pattern = (_relative(pyramid, low) for pyramid in (mine, theirs))
    change = np.zeros_like(coarse)
    own = other = None
    for level in range(low, mine.level):
        wanted = theirs.details[level]
        if frame == "curve":
            own, other = frames(coarse + change, own), frames(pattern, other)
            wanted = np.einsum("mij,mkj,mk->mi", own, other, wanted)
        added = wanted - mine.details[level] if level in levels else np.zeros_like(wanted)
        added[np.abs(added).max(axis=1) <= nothing] = 0.0
        coarse, pattern, change = (refine_uniform(p) for p in (coarse, pattern, change))
        add_details(coarse, mine.details[level])
        add_details(pattern, theirs.details[level])
        add_details(change, added)
    return change


def _relative(pyramid: Pyramid, level: int) -> Array:
    """Control points of a level about the centre."""
    points: Array = pyramid.control_points(level) - pyramid.centre
    return points


def _plus(curve: Graded, level: int, change: Array) -> Graded:
    """Add to the control points of a level; where nothing changes no knots are inserted."""
    changed = np.flatnonzero((change != 0.0).any(axis=1))
    if not len(changed):
        return curve
    apart = np.flatnonzero(changed[1:] - changed[:-1] > _GAP) + 1
    starts, stops = changed[np.append(0, apart)], changed[np.append(apart - 1, len(changed) - 1)]
    for start, stop in zip(starts.tolist(), stops.tolist(), strict=True):
        curve = details.plus(curve, level, start, change[start : stop + 1])
    return curve
