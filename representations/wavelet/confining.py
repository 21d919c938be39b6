"""Go over from one curve to another inside an interval, smoothly and changing nothing outside.

Both curves are written on the same knots; the control points inside the interval go over from the
one to the other with weights that rise from 0 to 1 over an apron at each end of the interval that
lies inside T. So the result is as smooth as its knots (C2), and the rule of fixed stretches holds:
only control points move whose support lies inside (facts 1e; Grimm-Ayers 6.3).
"""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array
from multirep.errors import EditError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import finest_level, parameters
from multirep.representations.wavelet.graded import Graded
from multirep.splices import SpliceList

__all__ = ["confined", "confined_to", "free_of", "inside", "mixed"]

#: Knots that an apron needs, about: fewer make the transition sudden, more stay behind for nothing.
_APRON_KNOTS = 4
#: Curves closer than this part of the largest coordinate are the same, written otherwise.
_ROUNDING = 32 * float(np.finfo(np.float64).eps)
#: What cannot be changed for want of room is refused if it is more than this part of it.
_SEEN = 1e-9
#: An apron takes at most this part of the interval, so that something is left between two.
LARGEST_APRON = 1 / 3


def free_of(frozen: SpliceList, wanted: Interval) -> SpliceList:
    """Return what of an interval is not frozen; all of it if nothing is.

    Then the edit is made as if nothing were frozen, for the kernel to refuse it: it knows who froze
    the stretch.
    """
    everything = SpliceList([wanted])
    return everything - frozen or everything


def confined_to(
    before: Graded,
    after: Graded,
    where: SpliceList,
    apron: float,
    frozen: SpliceList = SpliceList.EMPTY,
) -> Graded:
    """Return ``after`` on some stretches and ``before`` elsewhere; see :func:`confined`.

    Parameters
    ----------
    before, after : Graded
    where : SpliceList
        Where to change; see :func:`free_of`.
    apron : float
    frozen : SpliceList
        Where not a bit may change.

    Raises
    ------
    EditError
        When there is no stretch with room for a change.

    Examples
    --------
    >>> from multirep.representations.wavelet.graded import clamped
    >>> u = clamped(np.linspace(0, 1, 33))
    >>> flat = Graded.of(Interval(0, 1), u, np.zeros((35, 1)))
    >>> high = Graded.of(Interval(0, 1), u, np.ones((35, 1)))
    >>> half = confined_to(flat, high, SpliceList([(0.5, 1)]), apron=0.125)
    >>> half.evaluate(np.array([0.25, 0.5, 0.75, 1.0]))[:, 0]
    array([0., 0., 1., 1.])
    """
    if where == SpliceList([before.domain]):
        return after
    curve = before
    for stretch in where:
        beside = not frozen.contains(stretch)
        fixed = (
            beside and frozen.contains(stretch.start),
            beside and frozen.contains(stretch.stop),
        )
        curve = confined(curve, after, stretch, apron, fixed)
    if curve is before and any(
        _differ(before, after, part.start, part.stop, _SEEN) for part in where
    ):
        raise EditError(
            f"there is no room for a change on {where}: knots of a curve on {before.domain} cannot "
            f"be closer than 2**-{finest_level(before.domain)} of it, and those beside a frozen "
            "stretch stay"
        )
    return curve


def _differ(
    one: Graded, two: Graded, start: float, stop: float, allowed: float = _ROUNDING
) -> bool:
    """Whether two curves differ by more than a part of their size, as far as 65 places show."""
    t = np.linspace(start, stop, 65)
    return bool(np.abs(one.evaluate(t) - two.evaluate(t)).max() > allowed * one.magnitude)


def mixed(one: Graded, two: Graded, share: float) -> Graded:
    """Go from one curve to another by a share; what both have in common keeps its bits.

    Examples
    --------
    >>> from multirep.representations.wavelet.graded import clamped
    >>> flat = Graded.of(Interval(0, 1), clamped(np.array([0.0, 1])), np.zeros((4, 1)))
    >>> high = Graded.of(Interval(0, 1), clamped(np.array([0.0, 0.5, 1])), np.ones((5, 1)))
    >>> np.asarray(mixed(flat, high, 0.25).points)[:, 0]
    array([0.25, 0.25, 0.25, 0.25, 0.25])
    """
    low, high, other = one.u.difference(two.u)
    first, second = one.u.window(low, high), two.u.window(low, other)
    one = one.refined(np.setdiff1d(second, first))
    two = two.refined(np.setdiff1d(first, second))
    low, high, _ = one.points.difference(two.points)
    rows = one.points.window(low, high)
    rows = rows + share * (two.points.window(low, high) - rows)
    return one.replaced((4, 4), np.empty(0), (low, high), rows)


def inside(curve: Graded, interval: Interval) -> tuple[int, int]:
    """Return the first and the last knot of a curve in an interval; the outermost at ends of T."""
    first, last = curve.span_at(interval.start, "left") + 1, curve.span_at(interval.stop)
    if interval.start <= curve.domain.start:
        first = 3
    if interval.stop >= curve.domain.stop:
        last = curve.size
    return first, last


def confined(
    before: Graded,
    after: Graded,
    interval: Interval,
    apron: float,
    fixed: tuple[bool, bool] = (False, False),
) -> Graded:
    """Return a curve that is ``before`` outside an interval and ``after`` in its middle.

    Parameters
    ----------
    before, after : Graded
        On the same T; ``after`` may be a part around the interval.
    interval : Interval
    apron : float
        Width of the transition at each end inside T, as a part of T; at most a third of the
        interval is used. Its weights are ``s**2 (3 - 2 s)`` in the distance s, at the mean of the
        three inner knots of each control point. An end where both curves are the same has none.
    fixed : pair of bool
        Whether not a bit may change beyond the start and the stop: two guarding knots stand inside,
        see :meth:`WaveletBSpline.held`.

    Returns
    -------
    Graded
        ``before`` itself if nothing changes inside. Control points whose support reaches out of
        the interval keep their bits, unless ``before`` is so coarse that knots had to be added on
        an apron: then those around are written anew, and the curve out there is the same up to
        rounding. Knots of ``before`` that the middle does not need are gone.

    Notes
    -----
    Linear in the knots of both inside the interval. New knots keep two knots of ``before`` off the
    ends, or control points beyond would change.
    """
    width, aprons = _aprons(before, after, interval, apron)
    curve = _with_room(before, after, interval, width, aprons, fixed)
    first, last = inside(curve, interval)
    if last - first < 1:
        return before
    ends = curve.u.window(first, last + 1)
    left, right = first > 3, last < curve.size
    low, high = ends[min(2 * left, len(ends) - 1)], ends[max(len(ends) - 1 - 2 * right, 0)]
    u = _strictly_inside(after, ends[0], ends[-1])
    missing = np.setdiff1d(u, ends, assume_unique=True)
    # Where `after` has knots too near to an end to be taken over, the change begins behind them.
    start = low if len(missing) and missing[0] <= low else ends[0]
    stop = high if len(missing) and missing[-1] >= high else ends[-1]
    if start >= stop:
        return before
    curve = curve.refined(missing[(missing > low) & (missing < high)])
    i = _index(curve, start, 3, left)
    j = _index(curve, stop, curve.size, right)
    common = curve.u.window(i, j + 1)
    p, q = (i if left else 0), (j - 3 if right else curve.size)
    if p >= q:
        return before
    wanted = _points_on(after, common, (left, right))
    unit = _unit(interval, curve.domain)
    weights = _weights(curve.u.window(p, q + 4), unit, width, aprons)
    old = curve.points.window(p, q)
    rows = np.where(weights == 1.0, wanted, old + weights * (wanted - old))
    if np.abs(rows - old).max() <= _ROUNDING * before.magnitude:
        return before
    curve = curve.replaced((4, 4), np.empty(0), (p, q), rows)
    full = np.flatnonzero(weights[:, 0] == 1.0)
    return _thinned(curve, after, p + full[0], p + full[-1] + 1) if len(full) else curve


def _aprons(
    before: Graded, after: Graded, interval: Interval, apron: float
) -> tuple[float, tuple[bool, bool]]:
    """Width of the aprons as a part of T, and at which ends there is one."""
    domain = before.domain
    width = min(apron, LARGEST_APRON * interval.length / domain.length)
    zones = (
        (interval.start, interval.start + width * domain.length),
        (interval.stop - width * domain.length, interval.stop),
    )
    inner = interval.start > domain.start, interval.stop < domain.stop
    left, right = (
        within and _differ(before, after, *zone) for within, zone in zip(inner, zones, strict=True)
    )
    return width, (left, right)


def _with_room(
    curve: Graded,
    after: Graded,
    interval: Interval,
    width: float,
    aprons: tuple[bool, bool],
    fixed: tuple[bool, bool],
) -> Graded:
    """Add knots where there are too few: on aprons, and for what is new beside other ends.

    The outermost two knots inside the interval stay behind what is new, see :func:`confined`; so
    knots of ``after`` among them have to be inserted first.
    """
    domain = curve.domain
    step = 2.0 ** math.floor(math.log2(width / _APRON_KNOTS))
    start, stop = _unit(interval, domain)
    first, last = inside(curve, interval)
    found = []
    for left, low, high in ((True, start, start + width), (False, stop - width, stop)):
        outer = curve.u.window(first, first + 3) if left else curve.u.window(last - 2, last + 1)
        near, far = (low, min(outer[-1], stop)) if left else (max(outer[0], start), high)
        new = _strictly_inside(after, np.nextafter(near, -1.0), np.nextafter(far, 2.0))
        if aprons[not left]:
            knots = np.concatenate(([low], _strictly_inside(curve, low, high), [high]))
            enough = (knots[1:] - knots[:-1]).max() <= 2.0 * step
            if enough and np.isin(new, outer).all():
                continue
            multiples = range(math.ceil(low / step), math.floor(high / step) + 1)
            new = np.array(multiples, dtype=np.float64) * step
        if fixed[not left]:
            new = new[new > outer[-1]] if left else new[new < outer[0]]
        found.append(new)
    added: Array = np.unique(np.concatenate([np.empty(0), *found]))
    added = added[(added > 0.0) & (added < 1.0)]
    t = parameters(added, domain)
    added = added[(t >= interval.start) & (t <= interval.stop)]
    closest = min(np.diff(added).min(initial=1.0), step)
    return curve if closest < 2.0 ** -finest_level(domain) else curve.refined(added)


def _unit(interval: Interval, domain: Interval) -> tuple[float, float]:
    """Return the ends of an interval as parts of T."""
    start, stop = ((t - domain.start) / domain.length for t in interval)
    return start, stop


def _strictly_inside(curve: Graded, low: float, high: float) -> Array:
    u: Array = curve.u.window(curve.u.searchsorted(low, "right"), curve.u.searchsorted(high))
    return u


def _index(curve: Graded, u: float, end: int, inner: bool) -> int:
    """Index of a knot inside T; ``end`` at the ends of T."""
    return curve.u.searchsorted(u) if inner else end


def _points_on(curve: Graded, breaks: Array, inner: tuple[bool, bool]) -> Array:
    """Control points of a curve on finer knots, those with support between the first and the last.

    Parameters
    ----------
    curve : Graded
    breaks : (m + 1,) array
        Its own knots in between are among them.
    inner : pair of bool
        Whether supports begin at the first and end at the last of them; else all from the start, or
        up to the end, of T are meant.
    """
    left, right = inner
    curve = curve.refined(breaks[(breaks > 0.0) & (breaks < 1.0)])
    p = curve.u.searchsorted(breaks[0], "right") - 1 if left else 0
    q = curve.u.searchsorted(breaks[-1]) - 3 if right else curve.size
    points: Array = curve.points.window(p, q)
    return points


def _weights(
    knots: Array, ends: tuple[float, float], width: float, aprons: tuple[bool, bool]
) -> Array:
    """Weights (m, 1) of the m control points on m + 4 knots inside an interval."""
    places = (knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3.0
    weights = np.ones(len(places))
    for present, distance in zip(aprons, (places - ends[0], ends[1] - places), strict=True):
        if present:
            s = np.minimum(distance / width, 1.0)
            weights *= s * s * (3.0 - 2.0 * s)
    return weights[:, None]


def _thinned(curve: Graded, after: Graded, p: int, q: int) -> Graded:
    """Drop knots that ``after`` does not have where control points p..q-1 are those of ``after``.

    Three knots at each end of that stretch stay, so that the control points which reach over it
    do.
    """
    if q - p < 12:
        return curve
    u = curve.u.window(p + 3, q + 1)
    middle = _strictly_inside(after, u[3], u[-4])
    if len(middle) >= len(u) - 8:
        return curve
    breaks = np.concatenate((u[:4], middle, u[-4:]))
    rows = _points_on(after, breaks, (True, True))
    return curve.replaced((p + 4, q), breaks[1:-1], (p + 3, q - 3), rows)
