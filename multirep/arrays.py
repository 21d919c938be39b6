"""The array types of the whole package, and the one way to freeze an array."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

#: Float64 array; docstrings say the shape.
Array: TypeAlias = npt.NDArray[np.float64]
#: Integer indices.
Indices: TypeAlias = npt.NDArray[np.intp]
#: Truth values.
Flags: TypeAlias = npt.NDArray[np.bool_]
#: What users may pass: nested sequences, arrays, anything numpy reads.
ArrayLike: TypeAlias = npt.ArrayLike


def frozen_array(values: ArrayLike) -> Array:
    """Return ``values`` as a read-only float64 array.

    Copies only when somebody could still write to it.

    Examples
    --------
    >>> frozen_array([1, 2]).flags.writeable
    False
    """
    array: Array = np.asarray(values, dtype=np.float64)
    base = array.base
    owned = base is None or (isinstance(base, np.ndarray) and not base.flags.writeable)
    if array.flags.writeable or not owned:
        array = array.copy()
        array.setflags(write=False)
    return array
