"""The multiresolution wavelet B-spline.

Reading order: ``filters``, ``analysis``, ``pyramid`` (uniform levels and wavelets); ``dyadic``,
``graded`` (the stored truth); ``target``, ``prediction``, ``fitting``, ``splicing`` (following a
polyline); ``details``, ``uniform``, ``holding`` (edits and the way between both faces); ``bspline``
(the value); ``data``.
"""

from __future__ import annotations

from multirep.representations.wavelet.bspline import WaveletBSpline
from multirep.representations.wavelet.pyramid import Pyramid

__all__ = ["Pyramid", "WaveletBSpline"]
