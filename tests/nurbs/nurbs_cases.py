"""Curves, samples and smooth test courses that the NURBS tests share."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.representations import Nurbs
from multirep.sampled import SampledSplice
from multirep.testing.spline_strategies import dyadic_splines


@st.composite
def curves(
    draw: st.DrawFn,
    *,
    degrees: tuple[int, int] = (1, 5),
    rational: bool | None = None,
    max_inner: int = 6,
) -> Nurbs:
    """NURBS on [0, 1] with all numbers k/64: multiple knots, unclamped ends, any dimension."""
    spline = draw(dyadic_splines(degrees=degrees, rational=rational, max_inner=max_inner))
    knots, p = spline.knots.copy(), spline.degree
    if draw(st.booleans()):
        knots[:p] -= np.arange(p, 0, -1) / 16
    if draw(st.booleans()):
        knots[-p:] += np.arange(1, p + 1) / 8
    weights = spline.weights if spline.rational else None
    return Nurbs(degree=p, knots=knots, points=spline.points, weights=weights)


def random_curve(rng: np.random.Generator, *, degree: int | None = None) -> tuple[Nurbs, float]:
    """Make a wandering curve of any kind on [0, 1], and the scale of its coordinates."""
    p = int(rng.integers(1, 8)) if degree is None else degree
    dimension, count = int(rng.integers(1, 4)), int(rng.integers(0, 30))
    inner = np.sort(rng.random(count))
    if count and rng.random() < 0.4:
        inner = inner.repeat(rng.integers(1, p + 1, size=count))
    if rng.random() < 0.2:
        low, high = -np.sort(rng.random(p))[::-1], 1 + np.sort(rng.random(p))
        knots = np.concatenate([low, [0.0], inner, [1.0], high])
    else:
        knots = np.concatenate([[0.0] * (p + 1), inner, [1.0] * (p + 1)])
    n = len(knots) - p - 1
    scale = 10.0 ** int(rng.integers(-9, 10))
    shift = scale * float(rng.choice([0.0, 1e3]))
    points = rng.normal(size=(n, dimension)).cumsum(0) * scale + shift
    weights = None
    if rng.random() < 0.4:
        weights = np.exp(rng.normal(size=n) * float(rng.choice([0.1, 1.0])))
    return Nurbs(degree=p, knots=knots, points=points, weights=weights), scale


def smooth_curve(n: int, degree: int = 3) -> Nurbs:
    """Make a gentle planar curve of n control points on even knots."""
    inner = np.linspace(0, 1, n - degree + 1)[1:-1]
    knots = np.concatenate([[0.0] * (degree + 1), inner, [1.0] * (degree + 1)])
    t = np.array([knots[i + 1 : i + degree + 1].mean() for i in range(n)])
    points = np.stack([np.cos(7 * t) * (1 + t), np.sin(5 * t)], axis=1)
    return Nurbs(degree=degree, knots=knots, points=points)


def chord_length(points: Array) -> Array:
    """Cumulative chord length, from 0 to 1."""
    steps = np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1))
    t = np.concatenate(([0.0], steps.cumsum()))
    return np.asarray(t / t[-1])


def bump(u: Array) -> Array:
    """A bell on a straight line."""
    x = 2 * u - 1
    return np.stack([x, np.exp(-((x / 0.1) ** 2))], axis=1)


def spiral(u: Array) -> Array:
    """Four turns around a tight core."""
    radius, angle = 0.02 + u**1.5, 8 * np.pi * u
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def zigzag(u: Array) -> Array:
    """Straight lines with rounded corners."""
    return np.stack([4 * u, np.arcsin(0.98 * np.sin(8 * np.pi * u)) / np.pi], axis=1)


def doodle(u: Array) -> Array:
    """Loops of several sizes."""
    a = 2 * np.pi * u
    x = np.cos(a) + 0.3 * np.cos(7 * a) + 0.1 * np.sin(15 * a)
    y = np.sin(a) + 0.25 * np.sin(9 * a * u)
    return np.stack([x, y], axis=1)


SMOOTH: dict[str, Callable[[Array], Array]] = {
    "bump": bump,
    "spiral": spiral,
    "zigzag": zigzag,
    "doodle": doodle,
}


def course(name: str, count: int) -> SampledSplice:
    """Return a polyline through ``count`` points of a smooth curve, about even in chord length."""
    u = np.linspace(0, 1, 20 * count)
    length = chord_length(SMOOTH[name](u))
    points = SMOOTH[name](np.interp(np.linspace(0, 1, count), length, u))
    return SampledSplice(chord_length(points), points)


def largest_deviation(curve: Nurbs, sampled: SampledSplice, per_chord: int = 8) -> float:
    """Return the largest distance seen at vertices, knots and between."""
    t = sampled.t
    grid = np.concatenate([t[:-1] + np.diff(t) * k / per_chord for k in range(per_chord)])
    knots = np.asarray(curve.knots)
    inside = knots[(knots >= t[0]) & (knots <= t[-1])]
    at = np.concatenate([grid, t[-1:], inside])
    return float(np.sqrt(((curve(at) - sampled(at)) ** 2).sum(axis=1)).max())
