"""Strokes with a known answer: curves by length, drawn unevenly, with scatter."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from multirep.arrays import Array, ArrayLike

SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]


def along(vertices: ArrayLike, at: Array) -> Array:
    """Points of a polyline at parts of its length, by numpy alone."""
    rows = np.asarray(vertices, dtype=float)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(rows, axis=0), axis=1))])
    columns = [np.interp(at * length[-1], length, column) for column in rows.T]
    return np.stack(columns, axis=-1)


def circle(at: Array) -> Array:
    """Five sixths of a unit circle by part of its length."""
    angle = 5 * np.asarray(at)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def wave(at: Array) -> Array:
    """A wave of length about 7 over x in [0, 4]."""
    return np.stack([4 * np.asarray(at), np.sin(6 * np.asarray(at))], axis=-1)


def uneven(count: int, ratio: float = 20.0) -> Array:
    """Parts from 0 to 1 whose steps differ by ``ratio``."""
    steps = ratio ** (0.5 * np.sin(np.linspace(0, 17, count - 1)))
    parts = np.concatenate([[0], np.cumsum(steps)])
    return parts / parts[-1]


def scatter(points: Array, noise: float, seed: int = 0) -> Array:
    """Points with independent errors."""
    return points + noise * np.random.default_rng(seed).normal(size=points.shape)


def distances(points: Array, vertices: ArrayLike) -> Array:
    """Distance of each point from a polyline, by going through its segments."""
    rows = np.asarray(vertices, dtype=float)
    best = np.full(len(points), np.inf)
    for a, b in pairwise(rows):
        step = b - a
        u = np.clip((points - a) @ step / (step @ step), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - u[:, None] * step, axis=1))
    return best
