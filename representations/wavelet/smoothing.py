"""Smoothing to a level: everywhere, or on a stretch that goes over smoothly into what stays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.wavelet.confining import confined_to, inside
from multirep.representations.wavelet.levels import at_level
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.edit import Edit
    from multirep.representations.wavelet.bspline import WaveletBSpline

__all__ = ["APRON_SPANS", "smoothed"]

#: Details fade out over so many spans of the level: over about their longest wave, so that the
#: transition itself is no detail.
APRON_SPANS = 4


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
        What remains is :meth:`WaveletBSpline.at_level`. From the finest level of the curve on
        nothing is taken away.
    interval : Interval, optional
        Where; default T. Over an apron of four spans of the level at each of its ends inside T, at
        most a third of it, the details go from full to none.
    frozen : SpliceList
        Where nothing may change: taken out of the interval, with aprons of its own.

    Returns
    -------
    Edit
        Only control points change whose support lies in the interval.

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
    if not level >= 0:
        raise EditError(f"levels begin at 0, the base curve; got {level:g}")
    before, domain = curve._graded, curve.domain
    wanted = domain if interval is None else interval
    curve.parameters([wanted.start, wanted.stop])
    where = SpliceList([wanted]) - frozen
    if level >= before.level:
        return curve._edit(before)
    near = (0.0, 1.0)
    if where and where.hull != domain:
        near = _hull(curve, where.hull)
    after = at_level(before, level, near)
    if after is before:
        return curve._edit(before)
    return curve._edit(confined_to(before, after, where, APRON_SPANS * 2.0**-level))


def _hull(curve: WaveletBSpline, interval: Interval) -> tuple[float, float]:
    """Return the knots around an interval, as dyadic numbers."""
    first, last = inside(curve._graded, interval)
    u = curve._graded.u
    low, high = (u.window(k, k + 1)[0] for k in (max(first - 1, 3), min(last + 1, curve.size)))
    return float(low), float(high)
