"""The array types that the spline mathematics speaks of."""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "IntArray"]

Array: TypeAlias = npt.NDArray[np.float64]
"""Parameters ``(m,)``, knots ``(n + p + 1,)``, coefficients ``(n, D)``."""

IntArray: TypeAlias = npt.NDArray[np.intp]
"""Span indices ``(m,)``."""
