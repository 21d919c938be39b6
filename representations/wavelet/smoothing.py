"""Smoothing to a level: everywhere, or on a stretch that goes over smoothly into what stays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs

from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.wavelet.confining import confined_to, free_of, inside, mixed
from multirep.representations.wavelet.dyadic import finest_level
from multirep.representations.wavelet.levels import at_level
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.edit import Edit
    from multirep.representations.wavelet.bspline import WaveletBSpline

__all__ = ["APRON_SPANS", "shown", "smoothed"]

#: Details fade out over so many spans of the level: over their longest wave, so that the
#: transition itself is no detail.
APRON_SPANS = 2


def smoothed(
    curve: WaveletBSpline,
    level: float,
    interval: Interval | None = None,
    frozen: SpliceList = SpliceList.EMPTY,
) -> Edit[WaveletBSpline]:
    """Take away the details above a level, everywhere or on a stretch.

    Parameters
    ----------
    curve : WaveletBSpline
    level : float
        What remains is :meth:`WaveletBSpline.at_level`; between two levels, the mix of what remains
        of either. From the finest level of the curve on nothing is taken away.
    interval : Interval, optional
        Where; default T. Over an apron of two spans of the level at each of its ends inside T, at
        most a third of it, the details go from full to none.
    frozen : SpliceList
        Where nothing may change: taken out of the interval, with aprons of its own.

    Returns
    -------
    Edit
        Only control points change whose support lies in the interval. (Where the curve is too
        coarse to go over within an apron, it is written with more knots there; the curve around is
        the same up to rounding, and the splices reach as far as the control points concerned.)

    Raises
    ------
    ParameterError
        When the interval leaves T.
    EditError
        For a negative level, or when there is no room for a change in the interval.

    Notes
    -----
    Costs what the stretch and 40 spans of the level on either side hold.

    Examples
    --------
    >>> import numpy as np
    >>> from multirep.representations import WaveletBSpline
    >>> rough = WaveletBSpline(np.random.default_rng(1).normal(size=(131, 2)))
    >>> edit = smoothed(rough, 3.5, Interval(0.25, 0.75))
    >>> print(edit.splices, edit.value.size < rough.size)
    [1/4,3/4] True
    """
    before, domain = curve._graded, curve.domain
    wanted = domain if interval is None else interval
    curve.parameters([wanted.start, wanted.stop])
    if not level >= 0:
        raise EditError(f"levels begin at 0, the base curve; got {level:g}")
    where = free_of(frozen, wanted)
    near = (0.0, 1.0)
    if where and where.hull != domain:
        near = _hull(curve, where.hull)
    coarse, share = int(level), level % 1.0
    if coarse >= before.level:
        return curve._edit(before)
    graded, *finer = (
        confined_to(before, at_level(before, j, near), where, APRON_SPANS * 2.0**-j, frozen)
        for j in range(coarse, coarse + 1 + (share > 0))
    )
    return curve._edit(mixed(graded, finer[0], share) if finer else graded)


def _hull(curve: WaveletBSpline, interval: Interval) -> tuple[float, float]:
    """Return the knots around an interval, as dyadic numbers."""
    first, last = inside(curve._graded, interval)
    u = curve._graded.u
    low, high = (u.window(k, k + 1)[0] for k in (max(first - 1, 3), min(last + 1, curve.size)))
    return float(low), float(high)


def shown(
    curve: WaveletBSpline,
    source: WaveletBSpline,
    level: float,
    frozen: SpliceList = SpliceList.EMPTY,
) -> Edit[WaveletBSpline]:
    """Make a curve the curve of a level of another, over its own domain.

    Parameters
    ----------
    curve, source : WaveletBSpline
        In the same number of coordinates.
    level : float
    frozen : SpliceList
        Where ``curve`` may not change; it goes over within aprons of a third of what is free.

    Returns
    -------
    Edit

    Raises
    ------
    EditError
        For a negative level, other numbers of coordinates, or when there is no room beside what is
        frozen.

    Examples
    --------
    >>> from multirep.representations import WaveletBSpline
    >>> rough = WaveletBSpline([[k, k % 3] for k in range(131)])
    >>> line = WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0]], domain=(0, 10))
    >>> shown(line, rough, 3.5).value
    WaveletBSpline(size=19, level=4, domain=[0, 10])
    """
    if curve.dimension != source.dimension:
        raise EditError(
            f"the curve has {curve.dimension} coordinates, that to be shown has {source.dimension}"
        )
    after = attrs.evolve(at_level(source._graded, level), domain=curve.domain)
    if after.level > finest_level(curve.domain):
        raise EditError(
            f"the curve to be shown is of level {after.level}, but knots on {curve.domain} cannot "
            f"be closer than those of level {finest_level(curve.domain)}"
        )
    where = free_of(frozen, curve.domain)
    return curve._edit(confined_to(curve._graded, after, where, 1.0, frozen))
