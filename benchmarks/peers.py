"""The peers, each optional: modules that may be missing, and our curves as theirs."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from benchmarks.workload import Absent, Contestant, Timed
from multirep.arrays import Array

#: Distribution of each module.
PEERS = {
    "splinepy": "splinepy",
    "pywt": "PyWavelets",
    "OCP": "cadquery-ocp-novtk",
    "geomdl": "geomdl",
}


def optional(
    module: str, name: str, step: Callable[[Any], Callable[[int], object]], **more: Any
) -> Contestant:
    """Return a peer whose step is made of its module, or who is absent where that is missing."""
    try:
        found = imported(module)
    except ImportError:
        return Absent(name, f"{PEERS[module]} is not installed")
    return Timed(name, step(found), **more)


def imported(module: str) -> Any:
    """Import a peer, quietly."""
    with contextlib.redirect_stdout(io.StringIO()):
        found = import_module(module)
    if module == "splinepy":
        # it warns of queries that did not converge, which the errors in the tables show
        import logging

        logging.getLogger("splinepy").setLevel(logging.ERROR)
    return found


def splinepy_curve(splinepy: Any, knots: Array, points: Array, degree: int = 3) -> Any:
    """Return a splinepy curve."""
    return splinepy.BSpline(degrees=[degree], knot_vectors=[knots], control_points=points)


def occ_curve(knots: Array, points: Array, degree: int = 3) -> Any:
    """Return an OpenCASCADE curve, flat in space."""
    collections, geom, gp = (import_module(f"OCP.{name}") for name in ("collections", "Geom", "gp"))
    distinct, times = np.unique(knots, return_counts=True)
    poles = collections.Array1_gp_Pnt(1, len(points))
    for place, (x, y) in enumerate(points.tolist(), 1):
        poles.SetValue(place, gp.gp_Pnt(x, y, 0.0))
    return geom.Geom_BSplineCurve(
        poles, occ_array("double", distinct), occ_array("int", times), degree
    )


def occ_array(kind: str, values: npt.NDArray[Any]) -> Any:
    """Return an OpenCASCADE array of "double" or "int"."""
    collections = import_module("OCP.collections")
    found = getattr(collections, f"Array1_{kind}")(1, len(values))
    for place, value in enumerate(values.tolist(), 1):
        found.SetValue(place, value)
    return found


def geomdl_curve(geomdl: Any, knots: Array, points: Array, degree: int = 3) -> Any:
    """Return a geomdl curve."""
    curve = import_module("geomdl.BSpline").Curve()
    curve.degree = degree
    curve.ctrlpts = points.tolist()
    curve.knotvector = knots.tolist()
    return curve
