"""report.json and geometry.json: plain data, numbers in full precision, the same bytes every time.

Only ``seconds`` differ between two runs of the same script on the same machine.
"""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from multirep.errors import ConflictError
from multirep.representation import Representation
from multirep.script.history import StepResult
from multirep.script.reading import FORMAT
from multirep.script.running import CurveResult, Result
from multirep.splices import SpliceList


def report(result: Result) -> dict[str, Any]:
    """Return what goes into report.json."""
    return {
        "multirep": FORMAT,
        "curves": {curve.name: _curve(curve) for curve in result.curves},
        "steps": [_step(step) for step in result.steps],
    }


def geometry(result: Result) -> dict[str, Any]:
    """Return what goes into geometry.json: every representation of every curve."""
    curves: dict[str, Any] = {}
    for curve in result.curves:
        domain = next(iter(curve.representations.values())).domain
        curves[curve.name] = {"domain": [float(domain.start), float(domain.stop)]}
        for kind, representation in curve.representations.items():
            curves[curve.name][kind] = _geometry(representation)
    return {"multirep": FORMAT, "curves": curves}


def to_json(data: dict[str, Any], *, indent: int | None = None) -> str:
    """Write data as JSON text; floats by their shortest form that reads back equal."""
    separators = (",", ":") if indent is None else (",", ": ")
    return json.dumps(data, indent=indent, separators=separators, allow_nan=False) + "\n"


def _curve(curve: CurveResult) -> dict[str, Any]:
    return {
        "tolerance": curve.tolerance,
        "sizes": {kind: int(value.size) for kind, value in curve.representations.items()},
        "deviation": {
            "~".join(pair): {"lower": float(bounds.lower), "upper": float(bounds.upper)}
            for pair, bounds in curve.deviations.items()
        },
        "notes": list(curve.notes),
    }


def _step(step: StepResult) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "index": step.index,
        "what": step.what,
        "curve": step.curve,
        "changed": _pairs(step.changed),
        "seconds": step.seconds,
        "work": step.work,
        "rounds": step.rounds,
        "faded": _pairs(step.faded),
        "constraints": [{"name": name, "residual": float(r)} for name, r in step.constraints],
    }
    if step.conflict is not None:
        entry["conflict"] = _conflict(step.conflict)
    return entry


def _conflict(error: ConflictError) -> dict[str, Any]:
    return {
        "message": str(error),
        "constraints": [
            {
                "name": name,
                "where": _pairs(error.where.get(name, SpliceList.EMPTY)),
                "residual": float(error.residuals.get(name, 0.0)),
            }
            for name in error.constraints
        ],
        "cycle": list(error.cycle),
        "release": list(error.release),
    }


def _pairs(splices: SpliceList) -> list[list[float]]:
    return [[float(splice.start), float(splice.stop)] for splice in splices]


def _geometry(representation: Representation) -> dict[str, Any] | None:
    """Return the numbers that make a representation; of a plugin, what it writes itself."""
    shown: Any = representation
    if representation.name == "polyline":
        return {"t": _list(shown.t), "points": _list(shown.points)}
    if representation.name == "nurbs":
        return {
            "degree": int(shown.degree),
            "knots": _list(shown.knots),
            "points": _list(shown.points),
            "weights": _list(shown.weights),
        }
    if representation.name == "wavelet":
        return {
            "level": int(shown.level),
            "knots": _list(shown.knots),
            "points": _list(shown.points),
        }
    try:
        return representation.to_dict()
    except NotImplementedError:
        return None


def _list(values: Any) -> Any:
    return np.asarray(values, dtype=np.float64).tolist()
