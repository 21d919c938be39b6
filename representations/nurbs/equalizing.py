"""Fewer knots, better placed: spans are redistributed so that each leaves the same residual.

The residual of a spline of degree p shrinks with the (p + 1)-th power of the span. So a span that
leaves the part r of what is allowed stands for r^(1 / (p + 1)) spans that leave all of it: the sum
of these numbers says how many spans are needed, equal shares of it where they belong. This is
de Boor's equidistribution with the measured residuals in place of an estimate of a derivative;
measured, it needs a quarter fewer control points than FITPACK at the same maximum error.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Indices
from multirep.representations.nurbs.problem import Breakpoints, Trial

#: Residuals below this part of the allowance count as this: they are rounding, or leaked from
#: neighbours. Larger keeps more knots where the curve is nearly polynomial.
SMALLEST_RATIO = 1e-4
#: Spans are laid out for this part of the allowance, because the residuals never equalise quite.
#: Measured on smooth curves 0.8 leaves the fewest spans after what still fails is cut.
TARGET = 0.8


def equalized(degree: int, trial: Trial, target: float = TARGET) -> Breakpoints:
    """Return as many spans as the residuals call for, with equal shares.

    Knots of full multiplicity stay where they are; all others are laid out between them anew.
    """
    p, at, times = degree, trial.breakpoints.at, trial.breakpoints.times
    shares = np.maximum(trial.worst / target, SMALLEST_RATIO) ** (1 / (p + 1))
    fixed = (times >= p).nonzero()[0]
    fixed = np.concatenate(([0], fixed[(fixed > 0) & (fixed < len(at) - 1)], [len(at) - 1]))
    shares = _smoothed(shares, fixed)
    sums = np.concatenate(([0.0], shares.cumsum()))
    marks = sums[fixed]
    needs = marks[1:] - marks[:-1]
    counts = np.maximum(np.ceil(needs), 1.0).astype(np.intp)
    ends = counts.cumsum()
    firsts = ends - counts
    wanted = (np.arange(ends[-1]) - firsts.repeat(counts)) * (needs / counts).repeat(counts)
    new = np.empty(ends[-1] + 1)
    new[:-1] = np.interp(wanted + marks[:-1].repeat(counts), sums, at)
    new[firsts] = at[fixed[:-1]]
    new[-1] = at[-1]
    new_times = np.ones(len(new), dtype=np.intp)
    new_times[firsts] = times[fixed[:-1]]
    new_times[-1] = times[-1]
    distinct = np.concatenate(([True], new[1:] > new[:-1]))
    return Breakpoints(new[distinct], new_times[distinct])


def _smoothed(shares: Array, fixed: Indices) -> Array:
    """Average each share with its neighbours between the same corners (weights 1, 2, 1)."""
    before = np.concatenate((shares[:1], shares[:-1]))
    after = np.concatenate((shares[1:], shares[-1:]))
    before[fixed[:-1]] = shares[fixed[:-1]]
    after[fixed[1:] - 1] = shares[fixed[1:] - 1]
    return np.asarray(0.25 * before + 0.5 * shares + 0.25 * after)
