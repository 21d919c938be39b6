"""The spatula: a round tool that pushes the polyline like sand (Grimm-Ayers 5.1).

Reading order: ``tool`` (the parameters and the whole stroke), ``sand`` (the stretch being worked
on: splitting, pushing, merging), ``flow`` (parameters of new vertices).
"""

from __future__ import annotations

from multirep.tools.spatula.tool import Spatula

__all__ = ["Spatula"]
