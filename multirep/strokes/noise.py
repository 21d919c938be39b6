"""How much the samples of a stroke scatter, from their second differences."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.strokes.arc_length import norms

#: Fewer samples say nothing about scatter: a drawing of twelve points is a drawing.
FEWEST = 16
#: Samples per block. The median over blocks keeps corners and spikes, which are in few of them, out
#: of the estimate; larger blocks estimate more steadily and separate worse.
BLOCK = 8
#: Measured on arcs and squares in the plane, drawn evenly and unevenly: what comes out, in terms of
#: the true scatter, is 0.78 to 1.02.
BIAS = 0.92
#: A variance below this part of the squared second differences is what bends leave over, not
#: scatter, of which they would be one and a half times the variance.
TOLD = 1 / 64
#: Less than this part of the largest coordinate is rounding, not scatter.
ROUNDING = 2.0**-44


def estimate_noise(points: Array) -> float:
    """Estimate the standard deviation, per coordinate, of independent errors of the samples.

    e_i is the second difference of sample i: its distance from the chord of its neighbours, at the
    place that the lengths of its two segments give. Uneven speed along a line leaves no trace in
    it. Independent errors make neighbouring e_i opposite (their covariance is minus the variance)
    and leave those three samples apart independent, while what was drawn, a bend or even a regular
    zigzag, gives both pairs the same covariance. So the difference of the two covariances is the
    variance of the errors alone.

    Parameters
    ----------
    points : (n, d) array
        Neighbours differ.

    Returns
    -------
    float
        In the units of the points, good to about a quarter on strokes of a hundred samples; 0 where
        nothing can be told: few samples, one coordinate, or errors far below the bend between
        neighbouring samples. Cost: O(n).

    Examples
    --------
    >>> s = np.linspace(0, 5, 2000)
    >>> circle = np.stack([np.cos(s), np.sin(s)], axis=1)
    >>> estimate_noise(circle)
    0.0
    >>> scatter = 0.001 * np.random.default_rng(1).normal(size=circle.shape)
    >>> round(estimate_noise(circle + scatter), 4)
    0.0008
    """
    n, dimension = points.shape
    if n < FEWEST or dimension < 2:
        return 0.0
    scale = float(np.ptp(points, axis=0).max())
    rows = (points - points[0]) / scale
    chords = norms(rows[1:] - rows[:-1])
    chords = np.maximum(chords, np.finfo(float).tiny)  # lengths that underflow
    u = (chords[:-1] / (chords[:-1] + chords[1:]))[:, None]
    second = rows[1:-1] - (rows[:-2] + u * (rows[2:] - rows[:-2]))
    # pairs about one middle, so that a bend that grows steadily cancels as well
    apart = np.einsum("ij,ij->i", second[:-3], second[3:])
    products = apart - np.einsum("ij,ij->i", second[1:-2], second[2:-1])
    blocks = max(1, len(products) // BLOCK)
    starts = np.arange(blocks) * len(products) // blocks
    counts = np.diff(np.append(starts, len(products)))
    # where the pen was slow, bends between samples hide least
    speeds = np.add.reduceat(chords[1:-3], starts) / counts
    slow = speeds.argsort(kind="stable")[: max(FEWEST // BLOCK, (blocks + 1) // 2)]
    variance = float(np.median((np.add.reduceat(products, starts) / counts)[slow]))
    squares = np.einsum("ij,ij->i", second[:-3], second[:-3])
    if variance < TOLD * float(np.median((np.add.reduceat(squares, starts) / counts)[slow])):
        return 0.0
    variance /= dimension - 1
    noise = scale * float(np.sqrt(max(variance, 0.0))) / BIAS
    return noise if noise > ROUNDING * float(np.abs(points).max()) else 0.0
