"""The ε contract, checked from the outside with scipy alone: nothing of multirep is imported here.

``python tests/acceptance.py OUT_DIR`` checks what `multirep run` wrote; :func:`problems` checks the
same data in memory. The evaluation is written anew: a polyline by its chords, a NURBS by scipy's
BSpline in homogeneous coordinates.
"""

from __future__ import annotations

import itertools
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

Evaluate = Callable[[Any], Any]


def problems(
    geometry: dict[str, Any], report: dict[str, Any], *, parameters: int = 20000
) -> list[str]:
    """Return everything in geometry.json and report.json that breaks the contract."""
    found: list[str] = []
    if set(geometry["curves"]) != set(report["curves"]):
        found.append("the two files speak of different curves")
    for name, curve in geometry["curves"].items():
        found += [
            f"{name}: {problem}" for problem in _curve(curve, report["curves"][name], parameters)
        ]
    return found


def _curve(curve: dict[str, Any], stated: dict[str, Any], parameters: int) -> Iterator[str]:
    start, stop = curve["domain"]
    readers = {"polyline": read_polyline, "nurbs": read_nurbs, "wavelet": read_wavelet}
    evaluators, breaks = {}, []
    for kind, read in readers.items():
        if curve.get(kind) is not None:
            evaluators[kind], knots = read(curve[kind], start, stop)
            breaks.append(knots)
            size = stated["sizes"][kind]
            if size != len(curve[kind]["points"]):
                yield f"{kind} is said to have {size} controls, has {len(curve[kind]['points'])}"
    if len(evaluators) < 2:
        yield "fewer than two representations"
        return
    at = np.unique(np.concatenate(breaks))
    at = at[(at >= start) & (at <= stop)]
    at = at[:: max(1, len(at) // (5 * parameters))]
    t = np.unique(np.r_[np.linspace(start, stop, parameters), at, (at[1:] + at[:-1]) / 2])
    values = {kind: evaluate(t) for kind, evaluate in evaluators.items()}
    tolerance = stated["tolerance"]
    slack = 1e-9 * tolerance + 1e-13 * max(float(np.abs(v).max()) for v in values.values())
    for one, two in itertools.combinations(sorted(evaluators), 2):
        apart = float(np.linalg.norm(values[one] - values[two], axis=1).max())
        bounds = stated["deviation"].get(f"{one}~{two}")
        if not np.isfinite(apart) or apart > tolerance + slack:
            yield f"{one}~{two}: {apart:g} apart, tolerance {tolerance:g}"
        elif bounds is None:
            yield f"{one}~{two}: no bound is reported"
        elif not apart <= bounds["upper"] + slack:
            yield f"{one}~{two}: {apart:g} apart, proved {bounds['upper']:g}"
        elif not bounds["lower"] <= bounds["upper"] + slack:
            yield f"{one}~{two}: lower bound above the upper one"
        elif bounds["upper"] > tolerance * (1 + 1e-9) + slack:
            yield f"{one}~{two}: only {bounds['upper']:g} is proved, tolerance {tolerance:g}"


def read_polyline(data: dict[str, Any], start: float, stop: float) -> tuple[Evaluate, Any]:
    t, points = np.asarray(data["t"], float), np.asarray(data["points"], float)
    assert t[0] == start, "a polyline starts where the domain does"
    assert t[-1] == stop, "a polyline stops where the domain does"
    assert (np.diff(t) > 0).all(), "its parameters increase strictly"

    def evaluate(s: Any) -> Any:
        return np.stack([np.interp(s, t, column) for column in points.T], axis=1)

    return evaluate, t


def read_nurbs(data: dict[str, Any], start: float, stop: float) -> tuple[Evaluate, Any]:
    degree = data["degree"]
    knots, points, weights = (np.asarray(data[k], float) for k in ("knots", "points", "weights"))
    assert len(knots) == len(points) + degree + 1
    assert (np.diff(knots) >= 0).all(), "knots do not decrease"
    assert (weights > 0).all(), "weights are positive"
    assert knots[degree] == start
    assert knots[-degree - 1] == stop
    spline = BSpline.construct_fast(knots, np.c_[points * weights[:, None], weights], degree)

    def evaluate(s: Any) -> Any:
        rows = spline(np.minimum(s, np.nextafter(stop, -np.inf)))
        return rows[:, :-1] / rows[:, -1:]

    return evaluate, np.unique(knots)


def read_wavelet(data: dict[str, Any], start: float, stop: float) -> tuple[Evaluate, Any]:
    knots = np.asarray(data["knots"], float)
    assert (knots[:4] == start).all(), "the first knot is fourfold"
    assert (knots[-4:] == stop).all(), "the last knot is fourfold"
    assert (np.diff(knots[3:-3]) > 0).all(), "inner knots are simple"
    cells = (knots - start) / (stop - start) * 2.0 ** data["level"]
    assert (np.abs(cells - np.rint(cells)) <= 1e-9 * 2.0 ** data["level"]).all(), "knots are dyadic"
    ones = [1.0] * len(data["points"])
    return read_nurbs({**data, "degree": 3, "weights": ones}, start, stop)


def main() -> int:
    """Check a directory that `multirep run` wrote."""
    out = Path(sys.argv[1])
    files = (json.loads((out / name).read_text()) for name in ("geometry.json", "report.json"))
    found = problems(*files)
    print("\n".join(found) or "within the tolerance, and within what was proved")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
