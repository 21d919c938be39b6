"""Asking a constraint something: what it raises or returns amiss becomes an error that names it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

import numpy as np

from multirep.constraint import Constraint
from multirep.errors import MultirepError, PluginError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.splices import SpliceList

T = TypeVar("T")


def guarded(name: str, method: Callable[..., T], *arguments: Any) -> T:
    """Call a method of a constraint; whatever it raises becomes an error that names it."""
    try:
        return method(*arguments)
    except MultirepError:
        raise
    except Exception as error:
        raise PluginError(
            f"constraint {name!r} failed with {type(error).__name__}: {error}", name
        ) from error


def region_of(name: str, constraint: Constraint[Any], value: Representation) -> Interval:
    """Return what a constraint claims, checked and cut to T."""
    claim = guarded(name, constraint.region, value)
    try:
        return Interval.of(claim).clipped(value.domain)
    except MultirepError as error:
        raise PluginError(f"constraint {name!r} claims {claim!r}: {error}", name) from error


def residual_of(name: str, constraint: Constraint[Any], value: Representation) -> float:
    """Return what a constraint is off by, checked: one finite number, 0 or more."""
    residual: Any = guarded(name, constraint.residual, value)
    number = np.nan
    if not isinstance(residual, str | bytes):
        with suppress(TypeError, ValueError):  # of `ndim` too, for ragged lists
            number = float(residual) if np.ndim(residual) == 0 else np.nan
    if not 0 <= number < np.inf:
        raise PluginError(
            f"constraint {name!r} returned the residual {residual!r}; "
            "it must be a finite number from 0 upwards",
            name,
        )
    return number


def frozen_of(name: str, constraint: Constraint[Any], value: Representation) -> SpliceList:
    """Return what a constraint freezes, checked: splices in T, or none."""
    frozen: Any = guarded(name, constraint.frozen, value)
    if not isinstance(frozen, SpliceList):
        raise PluginError(
            f"constraint {name!r} freezes {frozen!r}; it must be a SpliceList, "
            "SpliceList.EMPTY for nothing",
            name,
        )
    if frozen and not value.domain.contains(frozen.hull):
        raise PluginError(
            f"constraint {name!r} freezes {frozen}, outside the domain {value.domain}", name
        )
    return frozen
