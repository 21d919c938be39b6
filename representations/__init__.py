"""The built-in representations; each is loaded when it is first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.representations.nurbs import Nurbs as Nurbs
    from multirep.representations.polyline import Polyline as Polyline
    from multirep.representations.wavelet import WaveletBSpline as WaveletBSpline

_HOMES = {"Polyline": "polyline", "Nurbs": "nurbs", "WaveletBSpline": "wavelet"}

__all__ = ["Nurbs", "Polyline", "WaveletBSpline"]


__getattr__ = on_demand(__name__, _HOMES)
