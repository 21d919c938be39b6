"""Strokes as people draw them, made into curves: plain arrays, no representation.

Reading order: ``reading`` (what a stroke is), ``noise`` and ``merging`` and ``smoothing`` (how the
scatter of the pen goes), ``corners`` (what must stay), ``rounding`` (a smooth curve through few
samples), ``cleaning`` (all of these), ``places``, ``sliding`` and ``averaging`` (several strokes
over each other), ``blending`` (how a stroke joins what stands), ``from_strokes`` (a new curve).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.strokes.averaging import average_strokes as average_strokes
    from multirep.strokes.cleaning import Stroke as Stroke
    from multirep.strokes.cleaning import clean_stroke as clean_stroke
    from multirep.strokes.corners import find_corners as find_corners
    from multirep.strokes.from_strokes import curve_from_strokes as curve_from_strokes
    from multirep.strokes.from_strokes import sketched as sketched
    from multirep.strokes.noise import estimate_noise as estimate_noise

_HOMES = {
    "Stroke": "cleaning",
    "average_strokes": "averaging",
    "clean_stroke": "cleaning",
    "curve_from_strokes": "from_strokes",
    "estimate_noise": "noise",
    "find_corners": "corners",
    "sketched": "from_strokes",
}

__all__ = [
    "Stroke",
    "average_strokes",
    "clean_stroke",
    "curve_from_strokes",
    "estimate_noise",
    "find_corners",
    "sketched",
]


__getattr__ = on_demand(__name__, _HOMES)
