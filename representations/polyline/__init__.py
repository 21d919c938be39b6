"""Polylines: vertices joined by straight lines, the form of a curve that people draw.

Reading order: ``curve`` (the value), ``chord_length`` (parameters for bare points), ``evaluation``,
``splicing`` (how a polyline follows another representation), ``simplification``, ``differences``,
``boxes``.
"""

from __future__ import annotations

from multirep.representations.polyline.chord_length import ChordLength, chord_length
from multirep.representations.polyline.curve import Polyline

__all__ = ["ChordLength", "Polyline", "chord_length"]
