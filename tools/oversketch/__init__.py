"""Oversketching: a stroke replaces a stretch of the curve (Grimm-Ayers 2.2.3).

Reading order: ``tool`` (the parameters), ``gap`` (which stretch a stroke means), ``filling`` (the
new vertices: their parameters, and how they join what stands).
"""

from __future__ import annotations

from multirep.tools.oversketch.tool import Oversketch

__all__ = ["Oversketch"]
