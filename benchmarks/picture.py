"""The picture: one drag step against the number of vertices, ours and the eager programs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.results import Results

OURS = {
    "move a vertex": "#0b6e4f",
    "move a control point": "#2a9d8f",
    "sweep at level 6": "#8ab17d",
}
EAGER = {"eager, quick": "#e76f51", "eager, frugal": "#9d0208"}
#: Milliseconds that have a label.
TICKS = {1: "1 ms", 10: "10 ms", 100: "100 ms", 1e3: "1 s", 1e4: "10 s", 1e5: "100 s"}
COLOURS = OURS | EAGER


def draw(results: Results, path: Path) -> None:
    """Write an SVG; the same results give the same bytes."""
    import matplotlib as mpl

    mpl.use("svg")
    from matplotlib.figure import Figure

    settings: dict[Any, Any] = {"svg.hashsalt": "multirep", "svg.fonttype": "none", "font.size": 10}
    with mpl.rc_context(settings):
        figure = Figure(figsize=(9, 4.4), layout="constrained")
        pair = figure.subplots(1, 2, sharey=True)
        for axes, curve in zip(pair, ("smooth", "coast"), strict=True):
            for name, colour in COLOURS.items():
                points = series(results, curve, name)
                if not points:
                    continue
                n, low, middle, high = zip(*points, strict=True)
                style = "o-" if name in OURS else "s--"
                axes.loglog(n, middle, style, color=colour, label=name, markersize=4)
                axes.fill_between(n, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.set_title({"smooth": "a wavy outline", "coast": "a fractal coast"}[curve])
            axes.set_xlabel("vertices")
            axes.grid(which="major", color="#dddddd", linewidth=0.6)
            axes.spines[["top", "right"]].set_visible(False)
        pair[0].set_yticks([*TICKS], [*TICKS.values()])
        pair[0].set_ylabel("CPU time of one drag step, all views up to date")
        handles, labels = pair[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=5, frameon=False)
        figure.savefig(path, format="svg", metadata={"Date": None, "Creator": "multirep"})


def series(results: Results, curve: str, name: str) -> list[tuple[float, float, float, float]]:
    """Return vertices, and quartiles and median in milliseconds, at tolerance 1e-3."""
    found = []
    for cell in results.of("drag"):
        for entry in cell.entries:
            wanted = (cell.curve, cell.tolerance, entry.name) == (curve, 1e-3, name)
            if wanted and entry.median and entry.low and entry.high:
                found.append((cell.size, 1e3 * entry.low, 1e3 * entry.median, 1e3 * entry.high))
    return sorted(found)
