"""Fading an edit out before a frozen border (Grimm-Ayers 5.2, without the jump).

An edit whose support reaches into a frozen stretch becomes ``old + w (new - old)`` on what is
free: the weight w is 0 with a zero derivative at the border and 1 beyond an apron on the free
side, so the curve leaves the frozen stretch in its old direction: exactly where the representation
can follow the blend exactly, else as far as its tolerance says anything of directions.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from multirep.aim import Aim
from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError, PluginError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, chord_bounds, interpolate
from multirep.splices import SpliceList

#: Width of the apron in terms of the free part of the change that borders on ice. Larger fades
#: more gently but leaves less of the edit; with two borders it must stay below 1/2.
APRON = 1 / 3
#: Free parts shorter than this part of T are dropped: nothing of the edit would be seen there, and
#: parameters that close leave no room for controls.
SHORTEST = 1e-9
#: Of the tolerance of a blend, what its three samplings (old, new, weight) may use each.
SAMPLING = 1 / 8


def blended(
    before: Representation,
    edit: Edit[Representation],
    frozen: SpliceList,
    *,
    tolerance: float,
    aims: Iterable[Aim] = (),
) -> Edit[Representation] | None:
    """Return the edit faded out before the frozen stretches that it reaches into.

    Parameters
    ----------
    before : Representation
    edit : Edit
        Of ``before``; nothing is done when it keeps off ``frozen``.
    frozen : SpliceList
    tolerance : float
        Certified distance of the result from the blend.
    aims : iterable of Aim
        Where the edit must come out in full: the apron ends before.

    Returns
    -------
    Edit or None
        None when nothing of the edit is left.

    Raises
    ------
    ToleranceError
        When the representation cannot follow the blend.

    Notes
    -----
    ``w = s**2 (3 - 2 s)`` in s, the distance from the border over that of the apron; with two
    borders the product of both. The samples of the blend are certified like any: between two
    neighbouring parameters old and new are within their own certificates of their chords, and the
    product of w with a linear difference D has a second derivative of at most
    ``|w''| |D| + 2 |w'| |D'|``.
    """
    if not edit.splices.intersects(frozen):
        return edit
    shortest = SHORTEST * before.domain.length
    free = [piece for piece in edit.splices - frozen if piece.length > shortest]
    if not free:
        return None
    places = [aim.t for aim in aims]
    value, splices, bound = before, SpliceList.EMPTY, 0.0
    for piece in free:
        aprons = _aprons(piece, frozen, places)
        sampled = _sampled_blend(before, edit.value, piece, aprons, tolerance)
        step = value.splice(sampled, tolerance=tolerance * (1 - 3 * SAMPLING))
        value, splices = step.value, splices | step.splices
        bound = max(bound, step.bound + sampled.bound)
    if splices.intersects(frozen):
        raise PluginError(
            f"{before.name!r} changed {splices & frozen}, which is frozen", before.name
        )
    if not splices:
        raise EditError("nothing of the edit is left beside the frozen stretch")
    return Edit(value, splices, bound)


def _aprons(
    piece: Interval, frozen: SpliceList, places: list[float]
) -> tuple[float | None, float | None]:
    """Return the widths of the aprons at both ends; None at an end that is not frozen."""
    inside = [t for t in places if piece.start < t < piece.stop]
    width = APRON * piece.length
    left = min([width, *(t - piece.start for t in inside)])
    right = min([width, *(piece.stop - t for t in inside)])
    return (
        left if frozen.contains(piece.start) else None,
        right if frozen.contains(piece.stop) else None,
    )


def _sampled_blend(
    before: Representation,
    after: Representation,
    piece: Interval,
    aprons: tuple[float | None, float | None],
    tolerance: float,
) -> SampledSplice:
    share = SAMPLING * tolerance
    old = before.sample(piece, tolerance=share)
    new = after.sample(piece, tolerance=share)
    ends = [
        end + sign * width
        for end, sign, width in zip(piece, (1, -1), aprons, strict=True)
        if width is not None
    ]
    t = np.union1d(np.union1d(old.t, new.t), [end for end in ends if piece.contains(end)])
    t = _finer(t, _difference(old, new, t), piece, aprons, share)
    difference = _difference(old, new, t)
    weight = _weight(t, piece, aprons)
    points = interpolate(old.t, old.points, t) + weight[:, None] * difference
    bounds = np.maximum(_at(old, t), _at(new, t)) + _curvature(t, difference, piece, aprons)
    breaks = set(old.breaks) | set(new.breaks)
    return SampledSplice(
        t,
        points,
        bound=float(bounds.max()),
        breaks=tuple(sorted(t for t in breaks if piece.start < t < piece.stop)),
        chord_bounds=bounds,
    )


def _difference(old: SampledSplice, new: SampledSplice, t: Array) -> Array:
    return interpolate(new.t, new.points, t) - interpolate(old.t, old.points, t)


def _at(sampled: SampledSplice, t: Array) -> Array:
    """Certificates of the chords that the finer parameters ``t`` cut."""
    bounds = chord_bounds(sampled)
    k = np.clip(sampled.t.searchsorted(t[:-1], side="right") - 1, 0, len(bounds) - 1)
    values: Array = bounds[k]
    return values


def _weight(t: Array, piece: Interval, aprons: tuple[float | None, float | None]) -> Array:
    weight = np.ones(len(t))
    for end, sign, width in zip(piece, (1, -1), aprons, strict=True):
        if width is not None:
            s = np.clip(sign * (t - end) / width, 0.0, 1.0)
            weight *= s * s * (3 - 2 * s)
    return weight


def _curvature(
    t: Array, difference: Array, piece: Interval, aprons: tuple[float | None, float | None]
) -> Array:
    """Bound how far w D leaves its chord, chord by chord."""
    first = np.zeros(len(t) - 1)  # |w'|, at most 3/2 over the width
    second = np.zeros(len(t) - 1)  # |w''|, at most 6 over its square
    for end, sign, width in zip(piece, (1, -1), aprons, strict=True):
        if width is None:
            continue
        nearest = np.minimum(sign * (t[1:] - end), sign * (t[:-1] - end))
        inside = nearest < width
        second += 2 * first * inside * (1.5 / width) + inside * (6 / width**2)
        first += inside * (1.5 / width)
    h = np.diff(t)
    size = np.linalg.norm(difference, axis=1)
    largest = np.maximum(size[1:], size[:-1])
    slope = np.linalg.norm(np.diff(difference, axis=0), axis=1) / h
    bounds: Array = h * h / 8 * (second * largest + 2 * first * slope)
    return bounds


def _finer(
    t: Array,
    difference: Array,
    piece: Interval,
    aprons: tuple[float | None, float | None],
    tolerance: float,
) -> Array:
    """Cut the chords on which the blend leaves its chord too far; once, for the bound is known."""
    bounds = _curvature(t, difference, piece, aprons)
    parts = np.ceil(np.sqrt(np.maximum(bounds / tolerance, 1.0)) * (1 + 1e-12)).astype(np.intp)
    stops = parts.cumsum()
    fractions = (np.arange(stops[-1]) - (stops - parts).repeat(parts)) / parts.repeat(parts)
    fine = np.append(t[:-1].repeat(parts) + fractions * np.diff(t).repeat(parts), t[-1])
    keep = np.concatenate(([True], fine[1:] > fine[:-1]))
    return np.asarray(fine[keep])
