"""A smooth curve through samples that scatter: a discrete smoothing spline with free kinks."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.strokes.arc_length import norms

#: Bandwidths tried, in median distances of neighbouring samples: from hardly any smoothing to
#: where the mean over a window is as good as it needs to be.
NARROWEST, WIDEST = 0.35, 48.0
#: Bandwidths from one to the next; finer changes the result by a few percent of the noise.
STEP = 2**0.5
#: No two samples count as closer than this part of the median distance: bounds the condition of
#: the system at about (WIDEST / SHORTEST)^4 = 2e10.
SHORTEST = 1 / 8


def smooth(points: Array, counts: Array, corners: Indices, noise: float) -> Array:
    """Remove independent errors from samples along a curve.

    Minimises sum w_i |g_i - p_i|^2 + lambda sum |second difference of g at i|^2, by divided
    differences over the chord length (the discrete smoothing spline of Whittaker and Reinsch); at
    corners the second term is left out, so that a kink costs nothing. Straight lines and the
    straight continuation at the ends cost nothing either. lambda minimises an unbiased estimate of
    the distance from the error-free samples, residual + 2 noise^2 d tr H (Mallows' C_p), over a
    fixed series of bandwidths.

    Parameters
    ----------
    points : (n, d) array
    counts : (n,) array
        How many samples each stands for: its error has the standard deviation noise/sqrt(count).
    corners : (k,) array of int
        Increasing, inner samples.
    noise : float
        Standard deviation of one sample per coordinate.

    Returns
    -------
    (n, d) array
        Cost: O(n), one pentadiagonal solve per bandwidth.
    """
    from scipy.linalg import solveh_banded

    n, dimension = points.shape
    if n < 4 or noise <= 0:
        return points
    chords = norms(points[1:] - points[:-1])
    median = float(np.median(chords))
    h = np.maximum(chords / median, SHORTEST)
    rough = _roughness(h, corners)
    spread = np.concatenate([[h[0]], h[1:] + h[:-1], [h[-1]]]) / 2
    density = counts / spread
    origin = points.mean(axis=0)
    rows = points - origin
    best, risk = rows, 2 * noise**2 * dimension * n
    bandwidth = NARROWEST
    while bandwidth <= WIDEST:
        weight = float(np.median(density)) * bandwidth**4
        system = weight * rough
        system[2] += counts
        smoothed = solveh_banded(system, counts[:, None] * rows, check_finite=False)
        residual = smoothed - rows
        lost = float(np.einsum("i,ij,ij->", counts, residual, residual))
        # equivalent kernel: sample i keeps this part of itself
        kept = np.minimum(spread / (8**0.5 * (weight / density) ** 0.25), 1.0)
        freedom = float(kept.sum()) + len(corners) + 2
        estimate = lost + 2 * noise**2 * dimension * freedom
        if estimate < risk:
            best, risk = smoothed, estimate
        bandwidth *= STEP
    result: Array = best + origin
    return result


def _roughness(h: Array, corners: Indices) -> Array:
    """Return D^T W D of the second divided differences, upper banded form (3, n)."""
    a, c = 1 / h[:-1], 1 / h[1:]
    w = 2 / (h[:-1] + h[1:])
    w[corners - 1] = 0.0
    b = -(a + c)
    n = len(h) + 1
    bands = np.zeros((3, n))
    bands[2, :-2] += w * a * a
    bands[2, 1:-1] += w * b * b
    bands[2, 2:] += w * c * c
    bands[1, 1:-1] += w * a * b
    bands[1, 2:] += w * b * c
    bands[0, 2:] += w * a * c
    return bands
