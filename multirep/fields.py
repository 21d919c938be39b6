"""Points and paths as parameters of tools and constraints: how they are converted and checked.

>>> import attrs
>>> @attrs.frozen
... class Drop:
...     to: tuple[float, ...] = attrs.field(converter=as_point, validator=finite_point)
>>> Drop([1, 2])
Drop(to=(1.0, 2.0))
>>> Drop([1, float("nan")])
Traceback (most recent call last):
    ...
ValueError: 'to' must be a list of finite numbers: (1.0, nan)
"""

from __future__ import annotations

import math
from typing import Any

import attrs
import numpy as np

from multirep.arrays import ArrayLike


def as_point(value: ArrayLike) -> tuple[float, ...]:
    """Convert a sequence of numbers to a tuple; what is none is left for the validator to name."""
    try:
        return tuple(float(x) for x in value)  # type: ignore[union-attr,arg-type]  # fails if not
    except (TypeError, ValueError):
        return value  # type: ignore[return-value]  # the validator names the field


def as_points(value: ArrayLike) -> tuple[tuple[float, ...], ...]:
    """Convert a sequence of points; what is none is left for the validator to name."""
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "fiu":
        return tuple(map(tuple, value.astype(np.float64).tolist()))  # strokes have 10^5 samples
    try:
        return tuple(as_point(point) for point in value)  # type: ignore[union-attr]  # fails if not
    except TypeError:
        return value  # type: ignore[return-value]  # the validator names the field


def as_interval(value: ArrayLike) -> tuple[float, float]:
    """Convert two numbers, the smaller one first; ValueError for anything else."""
    numbers = as_point(value)
    if not _is_point(numbers) or len(numbers) != 2 or not numbers[0] < numbers[1]:
        raise ValueError(f"an interval is two finite numbers, the smaller one first; got {value!r}")
    return numbers[0], numbers[1]


def positive(instance: object, attribute: attrs.Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a finite number above 0."""
    finite_number(instance, attribute, value)
    if not float(value) > 0:  # type: ignore[arg-type]  # finite_number has seen to that
        raise ValueError(f"{attribute.name!r} must be above 0: {value!r}")


def finite_number(instance: object, attribute: attrs.Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a finite number."""
    if not (isinstance(value, float) and math.isfinite(value)):
        raise ValueError(f"{attribute.name!r} must be a finite number: {value!r}")


def a_name(instance: object, attribute: attrs.Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a string that is not empty."""
    if not (isinstance(value, str) and value):
        raise ValueError(f"{attribute.name!r} must be a name: {value!r}")


def finite_point(instance: object, attribute: attrs.Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a non-empty tuple of finite numbers."""
    if not _is_point(value):
        raise ValueError(f"{attribute.name!r} must be a list of finite numbers: {value!r}")


def finite_points(instance: object, attribute: attrs.Attribute[Any], value: object) -> None:
    """Raise ValueError unless the field is a non-empty tuple of points of one dimension."""
    if not isinstance(value, tuple) or not value:
        raise ValueError(f"{attribute.name!r} must be a list of one point or more: {value!r}")
    if _are_points(value):
        return
    for k, point in enumerate(value):
        if not _is_point(point) or len(point) != len(value[0]):
            raise ValueError(
                f"{attribute.name!r} must hold points of finite numbers, all of one dimension; "
                f"point {k} is: {point!r}"
            )


def _are_points(value: tuple[object, ...]) -> bool:
    """Whether all are points, at once; what is doubtful is looked at one by one."""
    try:
        array = np.asarray(value)
    except ValueError:  # of different lengths
        return False
    plain = array.dtype == np.float64 and array.ndim == 2 and array.shape[1] > 0
    return plain and bool(np.isfinite(array).all())


def _is_point(value: object) -> bool:
    return (
        isinstance(value, tuple)
        and len(value) > 0
        and all(isinstance(x, float) and math.isfinite(x) for x in value)
    )
