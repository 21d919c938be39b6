"""The multiresolution wavelet B-spline.

Reading order: ``filters``, ``analysis``, ``pyramid`` (uniform levels and wavelets); ``dyadic``,
``graded`` (the stored truth), ``bspline`` (the value); ``target``, ``prediction``, ``attempt``,
``fitting``, ``splicing`` (following a polyline); ``details``, ``uniform`` (from one face to the
other), ``targets``, ``levels``, ``smoothing``, ``frames``, ``character``, ``confining`` (edits by
level); ``holding`` (stretches that stay); ``data``.
"""

from __future__ import annotations

from multirep.representations.wavelet.bspline import WaveletBSpline
from multirep.representations.wavelet.pyramid import Pyramid

__all__ = ["Pyramid", "WaveletBSpline"]
