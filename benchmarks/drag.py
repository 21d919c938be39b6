"""One drag step through each representation, with both others brought up to date, against the eager program.

python -m benchmarks.drag [--curve smooth] [--sizes 100 1000 10000 100000] [--tolerance 1e-3] [--parts]
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np

import multirep as mr
from benchmarks.eager import refit
from benchmarks.timing import copying, median
from benchmarks.workloads import CURVES, drag_step, drags
from multirep.events import Fitted, Sampled
from multirep.representations import Polyline

#: Steps that are measured, after as many that are not.
STEPS = 40


def main() -> None:
    """Print one table a curve."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--curve", choices=[*CURVES], action="append")
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10_000, 100_000])
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--parts", action="store_true", help="say where the time of a step goes")
    parser.add_argument("--no-eager", action="store_true")
    options = parser.parse_args()
    print(f"copying 16 MB takes {1e3 * copying():.2f} ms here; tolerance {options.tolerance:g}")
    for name in options.curve or CURVES:
        report(name, options.sizes, options.tolerance, not options.no_eager, options.parts)


def report(name: str, sizes: list[int], tolerance: float, eager: bool, parts: bool) -> None:
    """Print a table for one curve."""
    print(f"\n{name}: ms a drag step, both other views brought up to date")
    print(
        f"{'n':>7}  {'drag':22} {'ours':>8} {'eager':>9} {'ratio':>7}   sizes (polyline, nurbs, wavelet)"
    )
    for n in sizes:
        points = CURVES[name](n)
        slow = eager_step(points, tolerance) if eager else float("nan")
        for number in range(3):
            curve = mr.MultiRepresentation.from_points(points, tolerance=tolerance)
            drag = drags(curve)[number]
            ours = median(lambda k: drag_step(curve, drag, k), count=STEPS, warm_up=STEPS)
            counts = ", ".join(
                str(curve.view(kind).size) for kind in ("polyline", "nurbs", "wavelet")
            )
            print(
                f"{n:7}  {drag.what:22} {1e3 * ours:8.2f} {1e3 * slow:9.1f} {slow / ours:7.0f}   {counts}"
            )
            if parts:
                print(f"{'':9}{parts_of(curve, drag)}")


def eager_step(points: np.ndarray, tolerance: float) -> float:
    """Seconds of one step of the eager program; few repeats where it is slow."""
    polyline = Polyline.from_points(points)
    t, rows = np.array(polyline.t), np.array(polyline.points)
    vertex = int(t.searchsorted(0.37))

    def step(k: int) -> None:
        rows[vertex, 0] += 10 * tolerance * (1 if k % 2 else -1)
        refit(t, rows, tolerance)

    return median(step, count=7 if len(t) < 5000 else 3)


def parts_of(curve: mr.MultiRepresentation, drag: object) -> str:
    """Where the time of a step goes: microseconds of sampling and fitting by kind, medians."""
    found = defaultdict(list)
    for k in range(STEPS):
        with curve.listening() as events:
            total = median(lambda _: drag_step(curve, drag, k), count=1)  # type: ignore[arg-type]  # noqa: B023
        spent: dict[str, float] = defaultdict(float)
        for event in events:
            if isinstance(event, Sampled):
                spent[f"sample {event.author}"] += event.microseconds
            elif isinstance(event, Fitted):
                spent[f"fit {event.kind}"] += event.microseconds
        spent["the rest"] = 1e6 * total - sum(spent.values())
        for what, time in spent.items():
            found[what].append(time)
    return "; ".join(f"{what} {np.median(times):.0f} µs" for what, times in found.items())


if __name__ == "__main__":
    main()
