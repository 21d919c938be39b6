"""The least distance of a point from Bernstein pieces, with proof.

The squared distance of ``N(t) / w(t)`` from the origin is ``f / g`` with ``f = |N|**2`` and ``g =
w**2``, both in Bernstein form of degree 2p. No place of the piece is nearer than c where all
coefficients of ``f - c**2 g`` are non-negative. Around a nearest place, found by Newton's method,
they rarely all are; of the two halves on its either side, divided there by de Casteljau's
algorithm, they nearly always are: the derivative vanishes there, so the first two coefficients of a
half are equal.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import comb

import numpy as np

from multirep.arrays import Flags
from multirep.splines.arrays import Array

__all__ = ["NOISE", "least_on_piece", "least_on_pieces", "not_clear", "squared"]

#: Newton steps at most, one by one and of many pieces at once.
_STEPS = 12
_STEPS_AT_ONCE = 5
#: Gauss-Newton steps at most.
_POLISH = 4
#: A step so short is the last: convergence is quadratic.
_CONVERGED = 1e-9
#: Halves shorter than this part of their piece are not divided again: there the coefficients are
#: rounding errors, and what Newton's method found is as good as can be told.
_SHORTEST = 2.0**-20
#: Parts are not divided nearer to their ends than this.
_FROM_END = 2.0**-20
#: Rounding of coefficients, as a part of the largest of them.
NOISE = 64 * 2.0**-53
#: Where the squared distance is less than so many times that, it says little about where the
#: nearest place is, and the point itself is asked.
_NEAR = 2.0**20


@cache
def _product(degree: int) -> Array:
    """Matrix from the products of coefficients i, j to the coefficients of the product."""
    p = degree
    matrix: Array = np.zeros((2 * p + 1, p + 1, p + 1))
    for i in range(p + 1):
        for j in range(p + 1):
            matrix[i + j, i, j] = comb(p, i) * comb(p, j) / comb(2 * p, i + j)
    matrix = matrix.reshape(2 * p + 1, -1)
    matrix.setflags(write=False)
    return matrix


def squared(hulls: Array, points: Array) -> tuple[Array, Array, Array | None]:
    """Squared distances of points from pieces, in Bernstein form.

    Parameters
    ----------
    hulls : (p + 1, D, m) array
        Coefficients of the pieces; D = d, or d + 1 with a weight last.
    points : (d, m) or (d, 1) array

    Returns
    -------
    offsets : (p + 1, d, m) array
        Coefficients of N, from the point to the piece times the weight.
    f : (2p + 1, m) array
    g : (2p + 1, m) array, or None for 1
    """
    p, d = len(hulls) - 1, len(points)
    product = _product(p)
    count = hulls.shape[2]
    if hulls.shape[1] == d:
        offsets = hulls - points
        g = None
    else:
        weights = hulls[:, d]
        offsets = hulls[:, :d] - weights[:, None] * points
        g = product @ (weights[:, None] * weights).reshape(-1, count)
    pairs = np.einsum("idm,jdm->ijm", offsets, offsets)
    return offsets, product @ pairs.reshape(-1, count), g


def least_on_piece(
    offsets: list[list[float]],
    f: list[float],
    g: list[float] | None,
    u: float,
    best: float,
    slack: float,
) -> tuple[float, float] | None:
    """Return a place of one piece that is nearer than ``best``, if there is one.

    Parameters
    ----------
    offsets, f, g
        One column of what `squared` returns, as lists.
    u : float
        In [0, 1], where to begin.
    best : float
        The distance to be beaten.
    slack : float
        By how much it must be beaten for sure.

    Returns
    -------
    (distance, u) or None
        No place of the piece is nearer than the smaller of this distance and ``best`` by more than
        the slack.
    """
    found: tuple[float, float] | None = None
    noise = NOISE * max(f)
    # Parts still to be looked at: coefficients, where they begin, how long they are.
    parts = [(f, g, 0.0, 1.0, u)]
    while parts and best > slack:
        f, g, start, length, guess = parts.pop()
        floor = max(best - slack, 0.0) ** 2
        if min(_above(f, g, floor)) >= noise:
            continue
        at = _newton(f, g, guess)
        there = start + length * at
        distance, there = _polished(offsets, g is not None, there, _NEAR * noise)
        if distance < best:
            best, found = distance, (distance, there)
            floor = max(best - slack, 0.0) ** 2
        above = _above(f, g, floor)
        if not _FROM_END < at < 1.0 - _FROM_END:
            # the nearest place stands at an end: try the part itself again, then divide it
            if min(above) >= noise:
                continue
            at = 0.5
        left, right = map(min, _divided(above, at))
        if left >= noise <= right:
            continue
        fs = _divided(f, at)
        gs = (None, None) if g is None else _divided(g, at)
        lengths = length * at, length * (1.0 - at)
        starts = start, start + length * at
        for k, least in enumerate((left, right)):
            if least < noise and lengths[k] > _SHORTEST:
                half = fs[k]
                lowest = min(range(len(half)), key=half.__getitem__) / (len(half) - 1)
                parts.append((half, gs[k], starts[k], lengths[k], lowest))
    return found


def _above(f: list[float], g: list[float] | None, floor: float) -> list[float]:
    """Coefficients of f - floor g: none is negative where no place is nearer than its root."""
    if g is None:
        return [a - floor for a in f]
    return [a - floor * b for a, b in zip(f, g, strict=True)]


def _divided(f: list[float], at: float) -> tuple[list[float], list[float]]:
    """Cut in two by de Casteljau's algorithm."""
    rest = 1.0 - at
    left, right = [f[0]], [f[-1]]
    while len(f) > 1:
        f = [rest * a + at * b for a, b in pairwise(f)]
        left.append(f[0])
        right.append(f[-1])
    right.reverse()
    return left, right


def _newton(f: list[float], g: list[float] | None, at: float) -> float:
    """Go down from ``at`` to where the derivative of f / g vanishes, or to an end."""
    powers = _to_powers(f)
    below = None if g is None else _to_powers(g)
    for _ in range(_STEPS):
        value, slope, bend = _derivatives(powers, at)
        if below is not None:
            weight, first, second = _derivatives(below, at)
            slope, bend = slope * weight - value * first, bend * weight - value * second
        if bend > 0.0:
            new = min(max(at - slope / bend, 0.0), 1.0)
        else:
            new = 0.0 if slope > 0.0 else 1.0
        moved, at = abs(new - at), new
        if moved < _CONVERGED:
            break
    return at


def _to_powers(f: list[float]) -> list[float]:
    """Coefficients of t**n, .., t, 1: differences times binomials."""
    n, powers = len(f) - 1, [f[0]]
    for k in range(1, n + 1):
        f = [b - a for a, b in pairwise(f)]
        powers.append(f[0] * comb(n, k))
    powers.reverse()
    return powers


def _derivatives(powers: list[float], at: float) -> tuple[float, float, float]:
    value = first = half = 0.0
    for c in powers:
        half = half * at + first
        first = first * at + value
        value = value * at + c
    return value, first, 2.0 * half


def _polished(
    offsets: list[list[float]], rational: bool, at: float, near: float
) -> tuple[float, float]:
    """Return |N / w| and the place, which Gauss-Newton steps improve where the square is small."""
    square, value, slope = _offset(offsets, rational, at)
    for _ in range(_POLISH):
        if square >= near:
            break
        speed = sum(x * x for x in slope)
        if not speed:
            break
        new = at - sum(x * y for x, y in zip(value, slope, strict=True)) / speed
        new = min(max(new, 0.0), 1.0)
        moved, value, slope = _offset(offsets, rational, new)
        if moved >= square:
            break
        square, at = moved, new
    return square**0.5, at


def _offset(
    offsets: list[list[float]], rational: bool, at: float
) -> tuple[float, list[float], list[float]]:
    """|N / w|**2, N / w and its derivative; the weight is the last of each row."""
    rest, degree = 1.0 - at, len(offsets) - 1
    while len(offsets) > 2:
        offsets = [
            [rest * a + at * b for a, b in zip(low, high, strict=True)]
            for low, high in pairwise(offsets)
        ]
    low, high = offsets
    value = [rest * a + at * b for a, b in zip(low, high, strict=True)]
    slope = [degree * (b - a) for a, b in zip(low, high, strict=True)]
    if rational:
        weight, change = value.pop(), slope.pop()
        value = [x / weight for x in value]
        slope = [(y - x * change) / weight for x, y in zip(value, slope, strict=True)]
    return sum(x * x for x in value), value, slope


@cache
def _powers(degree: int) -> Array:
    """Matrix from Bernstein coefficients to those of 1, t, .. t**n."""
    n = degree
    matrix = np.zeros((n + 1, n + 1))
    for k in range(n + 1):
        for i in range(k + 1):
            matrix[k, i] = (-1) ** (k - i) * comb(n, k) * comb(k, i)
    matrix.setflags(write=False)
    return matrix


def least_on_pieces(
    offsets: Array, weights: Array | None, f: Array, g: Array | None, u: Array
) -> tuple[Array, Array]:
    """Find a nearest place on each of many pieces, without proof.

    Parameters
    ----------
    offsets : (p + 1, d, m) array
    weights : (p + 1, m) array or None
    f, g : (2p + 1, m) arrays
        See `squared`.
    u : (m,) array
        Where to begin.

    Returns
    -------
    (distance, u) : (m,) arrays
    """
    n = len(f) - 1
    order = np.arange(n + 1.0)[:, None]
    powers = _powers(n) @ f
    first, second = order[1:] * powers[1:], order[1:-1] * (order[2:] * powers[2:])
    if g is not None:
        other = _powers(n) @ g
        first_g, second_g = order[1:] * other[1:], order[1:-1] * (order[2:] * other[2:])
    for _ in range(_STEPS_AT_ONCE):
        slope, bend = _horner(first, u), _horner(second, u)
        if g is not None:
            value, weight = _horner(powers, u), _horner(other, u)
            slope, bend = (
                slope * weight - value * _horner(first_g, u),
                bend * weight - value * _horner(second_g, u),
            )
        with np.errstate(divide="ignore", invalid="ignore"):
            step = slope / bend
        down = bend <= 0.0
        if down.any():
            step[down] = np.sign(slope[down])
        u = u - step
        np.maximum(u, 0.0, out=u)
        np.minimum(u, 1.0, out=u)
    square, value, slope = _offsets(offsets, weights, u)
    near = (square < _NEAR * NOISE * f.max(axis=0)).nonzero()[0]
    if len(near):
        offsets = offsets[:, :, near]
        weights = None if weights is None else weights[:, near]
        least, at, value, slope = square[near], u[near], value[:, near], slope[:, near]
        for _ in range(_POLISH):
            speed = np.einsum("dm,dm->m", slope, slope)
            step = np.einsum("dm,dm->m", value, slope) / np.where(speed > 0.0, speed, 1.0)
            new = np.minimum(np.maximum(at - step, 0.0), 1.0)
            moved, value, slope = _offsets(offsets, weights, new)
            better = moved < least
            if not better.any():
                break
            least, at = np.where(better, moved, least), np.where(better, new, at)
        u[near], square[near] = at, least
    return np.sqrt(square), u


def _offsets(offsets: Array, weights: Array | None, u: Array) -> tuple[Array, Array, Array]:
    """|N / w|**2, N / w and its derivative, (m,) and twice (d, m)."""
    value, slope = _cast(offsets, u)
    if weights is not None:
        weight, change = _cast(weights, u)
        value = value / weight
        slope = (slope - value * change) / weight
    return np.einsum("dm,dm->m", value, value), value, slope


def _cast(rows: Array, u: Array) -> tuple[Array, Array]:
    """De Casteljau: the value and the derivative."""
    rest, degree = 1.0 - u, len(rows) - 1
    for _ in range(degree - 1):
        rows = rest * rows[:-1] + u * rows[1:]
    low, high = rows
    return rest * low + u * high, degree * (high - low)


def _horner(powers: Array, u: Array) -> Array:
    value: Array = powers[-1]
    for row in powers[-2::-1]:
        value = value * u
        value += row
    return value


def not_clear(f: Array, u: Array) -> Flags:
    """Whether a half, divided at ``u``, (m,), has a negative coefficient; (m,)."""
    rest = 1.0 - u
    least = np.minimum(f[0], f[-1])
    while len(f) > 1:
        f = rest * f[:-1] + u * f[1:]
        np.minimum(least, f[0], out=least)
        np.minimum(least, f[-1], out=least)
    return np.asarray(least < 0.0)
