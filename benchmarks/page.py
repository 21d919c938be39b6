"""docs/performance.md and docs/performance.svg, from results."""

from __future__ import annotations

from pathlib import Path

from benchmarks.goals import goal_table
from benchmarks.picture import draw
from benchmarks.results import Results
from benchmarks.tables import filled, machine_line, table
from benchmarks.workloads import WORKLOADS

DOCS = Path(__file__).parent.parent / "docs"
PAGE, PICTURE = DOCS / "performance.md", DOCS / "performance.svg"


def write(results: Results) -> tuple[Path, Path]:
    """Fill the tables of the page, whose text is written by hand, and draw the picture."""
    parts = {name: table(list(results.of(name))) for name in WORKLOADS}
    parts |= {"machine": machine_line(results), "goals": goal_table(results)}
    PAGE.write_text(filled(PAGE.read_text(encoding="utf-8"), parts), encoding="utf-8")
    draw(results, PICTURE)
    return PAGE, PICTURE
