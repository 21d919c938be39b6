"""Curves and samples for the suites: certified waves, polygons, bumps on a value, odd stretches."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.testing.looking import even


def size_of(value: Representation) -> float:
    """Return the largest extent of a curve along a coordinate axis, from a grid."""
    return float(np.ptp(value(even(value.domain, 257)), axis=0).max())


def stretches(domain: Interval, seed: int) -> list[Interval]:
    """Return intervals in ``domain``: all of it, its ends, random ones, and very short ones."""
    rng, (start, stop) = np.random.default_rng(seed), domain
    length = stop - start
    found = [domain] if seed == 0 else []
    a, b = np.sort(rng.uniform(start, stop, 2))
    found += [Interval(a, b), Interval(start, b), Interval(a, stop)]
    for short in (1e-2, 1e-4, 1e-6):
        at = start + rng.uniform(0.0, 1.0 - short) * length
        found.append(Interval(at, at + short * length))
    found.append(Interval(start, start + 1e-5 * length))
    return [interval.clipped(domain) for interval in found if interval.length > 0]


def place_of(place: str, domain: Interval) -> Interval:
    """Return "inside", "start", "stop" or "everywhere" as an interval, with odd ends."""
    start, stop = domain
    at: Callable[[float], float] = lambda u: start + u * (stop - start)  # noqa: E731
    ends = {
        "inside": (at(0.2137), at(0.6011)),
        "start": (start, at(0.3719)),
        "stop": (at(0.5813), stop),
        "everywhere": (start, stop),
    }
    return Interval(*ends[place])


def bumped(
    value: Representation,
    interval: Interval,
    relative: float,
    height: float,
    *,
    absolute: bool = False,
) -> SampledSplice:
    """Sample a value at a quarter of the tolerance and raise a smooth bump of ``height`` on it.

    The bump vanishes at the ends of ``interval``; the certificate grows by what the chords cut off.
    """
    tolerance = relative if absolute else relative * size_of(value)
    sampled = value.sample(interval, tolerance=tolerance / 8)
    start, stop = interval
    if height:
        # |second derivative| of height sin^2(pi u) is at most 2 pi^2 height
        pieces = int(np.ceil(np.sqrt(2 * np.pi**2 * height / (8 * tolerance / 8)))) + 1
        sampled = refined(sampled, np.linspace(start, stop, pieces + 1)[1:-1])
        direction = np.ones(value.dimension) / np.sqrt(value.dimension)
        u = (sampled.t - start) / (stop - start)
        shift = height * np.sin(np.pi * np.clip(u, 0, 1)) ** 2
        shift[[0, -1]] = 0.0
        sampled = attrs.evolve(
            sampled,
            points=sampled.points + shift[:, None] * direction,
            bound=sampled.bound + tolerance / 8,
            chord_bounds=None
            if sampled.chord_bounds is None
            else sampled.chord_bounds + tolerance / 8,
        )
    return sampled


def refined(sampled: SampledSplice, at: Any) -> SampledSplice:
    """Return the same polyline with more vertices; pieces keep the certificate of their chord."""
    t = np.union1d(sampled.t, at)
    bounds = sampled.chord_bounds
    if bounds is not None:
        bounds = bounds[
            np.clip(sampled.t.searchsorted(t[:-1], side="right") - 1, 0, len(bounds) - 1)
        ]
    return SampledSplice(t, sampled(t), sampled.bound, sampled.breaks, bounds)


def wave(dimension: int, *, tolerance: float) -> SampledSplice:
    """Return certified samples of a smooth curve over [0, 1] whose coordinates span about 1."""
    rates = 1.0 + np.arange(dimension)
    # |S''| of sin(2 pi r u)/2 is at most 2 pi^2 r^2
    bend = 2 * np.pi**2 * np.linalg.norm(rates**2)
    pieces = int(np.ceil(np.sqrt(bend / (8 * tolerance)))) + 1
    t = np.linspace(0.0, 1.0, pieces + 1)
    points = 0.5 * np.sin(2 * np.pi * rates * t[:, None] + 0.3)
    return SampledSplice(t, points, float(bend / (8 * pieces**2)))


def polygon(dimension: int) -> SampledSplice:
    """Return a polygon over [0, 1] with three corners inside, marked as breaks."""
    t = np.array([0.0, 0.25, 0.5, 0.8125, 1.0])
    heights = np.array([0.0, 1.0, 0.25, 1.0, 0.5])
    points = np.column_stack([heights, t, t[::-1]])[:, :dimension]
    return SampledSplice(t, points, 0.0, (0.25, 0.5, 0.8125))


def has_corner(value: Representation, t: float) -> bool:
    """Whether the directions just before and just after ``t`` differ by more than a few degrees."""
    h = 1e-7 * value.domain.length
    before, at, after = value(np.array([t - h, t, t + h]))
    one, two = at - before, after - at
    apart = np.linalg.norm(two - one)
    return bool(apart > 0.1 * max(np.linalg.norm(one), np.linalg.norm(two)))


def gaping(value: Representation, length: float, part: float, *, tolerance: float) -> SampledSplice:
    """Sample in the middle of T, finely, and shift everything by ``part`` of the tolerance."""
    start, stop = value.domain
    middle, half = start + 0.47 * (stop - start), 0.5 * length * (stop - start)
    interval = Interval(middle - half, middle + half)
    sampled = value.sample(interval, tolerance=tolerance / 64)
    direction = np.ones(value.dimension) / np.sqrt(value.dimension)
    points = sampled.points + part * tolerance * direction
    return SampledSplice(sampled.t, points, sampled.bound, sampled.breaks, sampled.chord_bounds)
