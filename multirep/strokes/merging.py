"""Samples that stand closer together than they scatter become one."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.strokes.arc_length import norms

#: Neighbours are joined where their squared distance, averaged around, is below this many times
#: what scatter alone makes it. Larger leaves chords with clearer directions and rounds off more.
INDISTINCT = 4.0
#: Neighbours on either side over which the squared distance is averaged. Choosing by single
#: distances would join what happens to fall together and keep the extremes.
AROUND = 4
#: A squared distance this many times what scatter makes it is a jump, not part of any average;
#: scatter alone never gets there (e^-16).
JUMP = 16.0
#: A round halves a run of indistinct samples: 2^40 samples are more than anybody has.
ROUNDS = 40
#: Fewer places are not joined further.
FEWEST = 4


@attrs.frozen(eq=False)
class Gathered:
    """Places (m, d) that stand for ``counts`` (m,) samples each: their means."""

    points: Array
    counts: Array

    def is_noise(self, noise: float) -> bool:
        """Whether nothing but scatter is left: a few places, none a jump from the next."""
        if len(self.points) >= FEWEST or noise <= 0:
            return False
        return bool((_ratios(self.points, self.counts, noise) <= JUMP).all())


def gather(points: Array, noise: float) -> Gathered:
    """Replace neighbouring samples that noise alone may tell apart by their mean.

    Where a pen advances less per sample than its samples scatter, chords say nothing about the
    direction and everything about the scatter. A mean of k samples scatters sqrt(k) times less, so
    joining neighbours ends when the places stand clearly apart: where the pen was fast at once,
    where it was slow or rested after many rounds. The first and last place contain the first and
    last sample.

    Parameters
    ----------
    points : (n, d) array
    noise : float
        Standard deviation of the samples per coordinate; 0 joins nothing.

    Returns
    -------
    Gathered
        At least two places. Cost: O(n) in all.

    Examples
    --------
    >>> resting = np.random.default_rng(0).normal(size=(64, 2))
    >>> gather(np.concatenate([resting, [[50, 0], [99, 0]]]), 1.0).counts
    array([64.,  1.,  1.])
    """
    rows, counts = points, np.ones(len(points))
    if noise <= 0:
        return Gathered(rows, counts)
    for _ in range(ROUNDS):
        if len(rows) < FEWEST:
            break
        ratio = _ratios(rows, counts, noise)
        near = ratio <= JUMP
        close = near & (_around(ratio * near) <= INDISTINCT * _around(near.astype(float)))
        first = np.flatnonzero(close[::2]) * 2
        if not first.size:
            break
        together = counts[first] + counts[first + 1]
        share = (counts[first + 1] / together)[:, None]
        rows, counts = rows.copy(), counts.copy()
        rows[first] += share * (rows[first + 1] - rows[first])
        counts[first] = together
        stays = np.ones(len(rows), dtype=bool)
        stays[first + 1] = False
        rows, counts = rows[stays], counts[stays]
    return Gathered(rows, counts)


def _ratios(points: Array, counts: Array, noise: float) -> Array:
    """Squared distances of neighbours, in terms of what scatter alone makes them, (m - 1,)."""
    chords = norms(points[1:] - points[:-1]) / noise
    expected = points.shape[1] * (1 / counts[1:] + 1 / counts[:-1])
    ratios: Array = chords * chords / expected
    return ratios


def _around(values: Array) -> Array:
    """Sum of each value and up to AROUND neighbours on either side, (m,)."""
    m = len(values)
    sums = np.concatenate([[0.0], values.cumsum()])
    low = np.maximum(np.arange(m) - AROUND, 0)
    high = np.minimum(np.arange(m) + AROUND + 1, m)
    result: Array = sums[high] - sums[low]
    return result
