"""The built-in representations; each is loaded when it is first used."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multirep.representations.nurbs import Nurbs as Nurbs
    from multirep.representations.polyline import Polyline as Polyline
    from multirep.representations.wavelet import WaveletBSpline as WaveletBSpline

_HOMES = {"Polyline": "polyline", "Nurbs": "nurbs", "WaveletBSpline": "wavelet"}

__all__ = ["Nurbs", "Polyline", "WaveletBSpline"]


def __getattr__(name: str) -> object:
    """Load a public name when it is first used (PEP 562)."""
    if name in _HOMES:
        value = getattr(import_module(f"multirep.representations.{_HOMES[name]}"), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'multirep.representations' has no attribute {name!r}")
