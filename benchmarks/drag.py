"""One drag step through each representation, both others brought up to date, and the eager program.

python -m benchmarks.drag [--curve smooth] [--sizes 100 1000 10000 100000] [--tolerance 1e-3]
                          [--parts] [--no-eager]
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from time import perf_counter, process_time

import numpy as np

import multirep as mr
from benchmarks.eager import PROGRAMS
from benchmarks.timing import copying, median
from benchmarks.workloads import CURVES, STEP, VERTEX, Drag, drag_step, drags
from multirep.events import Fitted, Sampled
from multirep.representations import Polyline

#: Steps that are measured, after as many that are not.
STEPS = 60


def main() -> None:
    """Print one table a curve."""
    parser = argparse.ArgumentParser(description="one drag step, against an eager program")
    parser.add_argument("--curve", choices=[*CURVES], action="append")
    parser.add_argument("--sizes", type=int, nargs="+", default=[100, 1000, 10_000, 100_000])
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--parts", action="store_true", help="say where the time of a step goes")
    parser.add_argument("--no-eager", action="store_true", help="leave out the eager program")
    options = parser.parse_args()
    print(f"copying 16 MB takes {1e3 * copying():.2f} ms here; tolerance {options.tolerance:g}")
    for name in options.curve or CURVES:
        report(name, options)


def report(name: str, options: argparse.Namespace) -> None:
    """Print a table for one curve."""
    print(f"\n{name}: CPU ms a drag step, median (fastest), and polyline, nurbs, wavelet sizes")
    first: dict[str, float] = {}
    for n in options.sizes:
        points = CURVES[name](n)
        eager: list[float] = []
        for program in [] if options.no_eager else PROGRAMS:
            seconds, found = eager_step(program, points, options.tolerance)
            eager.append(seconds)
            print(f"{n:7}  {program:22} {1e3 * seconds:8.1f}          {found}")
        for number in range(3):
            curve = mr.MultiRepresentation.from_points(points, tolerance=options.tolerance)
            drag = drags(curve)[number]
            times = measured(curve, drag)
            ours = float(np.median(times))
            if n == 1000:
                first[drag.what] = ours
            sizes = ", ".join(str(curve.view(x).size) for x in ("polyline", "nurbs", "wavelet"))
            growth = f"; {ours / first[drag.what]:.2f} of n = 1000" if drag.what in first else ""
            ratios = " and ".join(f"{seconds / ours:.0f}" for seconds in eager)
            print(
                f"{n:7}  {drag.what:22} {1e3 * ours:8.2f} ({1e3 * min(times):5.2f})  {sizes}"
                + (f";  eager / ours {ratios}" if eager else "")
                + growth
            )
            if options.parts:
                print(f"{'':9}{parts_of(curve, drag)}")


def measured(curve: mr.MultiRepresentation, drag: Drag) -> list[float]:
    """CPU seconds of each step, once things have settled."""
    times = []
    for k in range(2 * STEPS):
        begin = process_time()
        drag_step(curve, drag, k)
        times.append(process_time() - begin)
    return times[STEPS:]


def eager_step(program: str, points: np.ndarray, tolerance: float) -> tuple[float, str]:
    """CPU seconds of one step of an eager program, and its fits; few repeats where it is slow."""
    polyline = Polyline.from_points(points)
    t, rows = np.array(polyline.t), np.array(polyline.points)
    vertex = int(t.searchsorted(VERTEX))
    at = rows[vertex].copy()
    fits = []

    def step(k: int) -> None:
        rows[vertex] = at
        rows[vertex, k % 2] += STEP * tolerance
        fits.append(PROGRAMS[program](t, rows, tolerance))

    few = len(t) > 5000
    seconds = median(step, count=1 if few else 5, warm_up=0 if few else 1)
    fit = fits[-1]
    missed = max(fit.free_error, fit.uniform_error) / tolerance
    warning = f"; misses the tolerance by a factor of {missed:.1f}" if missed > 1 else ""
    return seconds, f"{fit.free} and {fit.uniform} control points{warning}"


def parts_of(curve: mr.MultiRepresentation, drag: Drag) -> str:
    """Where the time of a step goes: microseconds of sampling and fitting by kind, medians."""
    spent = defaultdict(list)
    for k in range(STEPS):
        with curve.listening() as events:
            begin = perf_counter()
            drag_step(curve, drag, k)
            total = 1e6 * (perf_counter() - begin)
        parts: dict[str, float] = defaultdict(float)
        for event in events:
            if isinstance(event, Sampled):
                parts[f"sample {event.author}"] += event.microseconds
            elif isinstance(event, Fitted):
                parts[f"fit {event.kind}"] += event.microseconds
        parts["the rest"] = total - sum(parts.values())
        for what, time in parts.items():
            spent[what].append(time)
    return "; ".join(f"{what} {np.median(times):.0f} µs" for what, times in spent.items())


if __name__ == "__main__":
    main()
