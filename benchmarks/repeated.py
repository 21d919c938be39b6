"""A thousand drag steps on one curve: neither times nor sizes may creep up.

    python -m benchmarks.repeated [--curve smooth] [--size 1000] [--steps 1000] [--tolerance 1e-3]

Four runs: the drag of each representation to and fro, and all three in turn.
"""

from __future__ import annotations

import argparse
from time import process_time

import numpy as np

import multirep as mr
from benchmarks.workloads import CURVES, Drag, drag_step, drags


def main() -> None:
    """Print a line a tenth of each run."""
    parser = argparse.ArgumentParser(description="drag steps again and again")
    parser.add_argument("--curve", choices=[*CURVES], default="smooth")
    parser.add_argument("--size", type=int, default=1000)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--tolerance", type=float, default=1e-3)
    options = parser.parse_args()
    points = CURVES[options.curve](options.size)
    for chosen in ((0,), (1,), (2,), (0, 1, 2)):
        curve = mr.MultiRepresentation.from_points(points, tolerance=options.tolerance)
        each = drags(curve)
        run(curve, [each[k] for k in chosen], options.steps)


def run(curve: mr.MultiRepresentation, turns: list[Drag], steps: int) -> None:
    """Drag in turns and print the median CPU time and the sizes, tenth by tenth."""
    print("\n" + ", ".join(drag.what for drag in turns))
    print(f"{'steps':>6} {'ms':>8} {'fastest':>8} {'slowest':>8}   polyline, nurbs, wavelet")
    tenth = max(steps // 10, 1)
    times = []
    for k in range(steps):
        begin = process_time()
        drag_step(curve, turns[k % len(turns)], k // len(turns))
        times.append(1e3 * (process_time() - begin))
        if (k + 1) % tenth == 0:
            sizes = ", ".join(str(curve.view(x).size) for x in ("polyline", "nurbs", "wavelet"))
            print(
                f"{k + 1:6} {np.median(times):8.2f} {min(times):8.2f} {max(times):8.2f}   {sizes}"
            )
            times = []


if __name__ == "__main__":
    main()
