"""The built-in representations and a fourth one, which a plugin might add."""

from __future__ import annotations

from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline


class Quintic(Nurbs):
    """A second NURBS, of degree 5: the fourth representation."""

    name = "quintic"
    summary = "NURBS of degree 5"
    default_degree = 5


KINDS: tuple[type[Representation], ...] = (Polyline, Nurbs, WaveletBSpline, Quintic)
