"""A wave as a NURBS on uneven knots."""

from __future__ import annotations

import numpy as np

from multirep.representations import Nurbs


def wavy(n: int = 18, degree: int = 3, *, rational: bool = False, seed: int = 0) -> Nurbs:
    """``n`` control points on a sine, at knots and with weights that the seed chooses."""
    rng = np.random.default_rng(seed)
    inner = np.sort(rng.uniform(0, 1, n - degree - 1))
    knots = np.r_[[0.0] * (degree + 1), inner, [1.0] * (degree + 1)]
    x = np.linspace(0, 4, n)
    weights = 2.0 ** rng.uniform(-1, 1, n) if rational else None
    return Nurbs(
        degree=degree, knots=knots, points=np.column_stack([x, np.sin(2 * x)]), weights=weights
    )
