"""Public names of a package whose modules load when a name is first used (PEP 562)."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module


def on_demand(package: str, homes: Mapping[str, str]) -> Callable[[str], object]:
    """Return the ``__getattr__`` of a package.

    Parameters
    ----------
    package : str
        Its ``__name__``.
    homes : mapping of str to str
        For each public name the module of the package that defines it.

    Examples
    --------
    >>> load = on_demand("multirep", {"Interval": "interval"})
    >>> load("Interval")
    <class 'multirep.interval.Interval'>
    >>> load("Intervall")
    Traceback (most recent call last):
    AttributeError: module 'multirep' has no attribute 'Intervall'
    """

    def load(name: str) -> object:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(f"{package}.{homes[name]}"), name)
        setattr(sys.modules[package], name, value)
        return value

    return load
