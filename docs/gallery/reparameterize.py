"""Even speed: a cat whose tail was drawn over a little stretch of T, before and after.

The dots stand at equal steps of t. After oversketching the tail has hardly any: it got the
parameters of the little stretch that it replaced, 4 % of T. Re-parameterisation maps T for all
representations together; the shape stays.

    python docs/gallery/reparameterize.py OUT.svg
"""

from __future__ import annotations

import sys
import tomllib
from pathlib import Path

import numpy as np

import multirep as mr
from multirep.drawing.picture import Group, Item, Lines, Marks, Picture, Text
from multirep.drawing.svg import to_svg
from multirep.representations import Polyline
from multirep.strokes import curve_from_strokes
from multirep.tools import Oversketch

HERE = Path(__file__).parent
INK, DOTS = "#2b2b33", "#c0392b"


def drawn() -> mr.Session:
    """Return a session with the cat and its tail, from the strokes of the oversketch example."""
    steps = tomllib.loads((HERE / "oversketch.toml").read_text(encoding="utf-8"))["step"]
    session = mr.Session()
    session.add("cat", curve_from_strokes([steps[0]["stroke"]], tolerance=0.1))
    session.apply("cat", Oversketch(stroke=steps[1]["stroke"]))
    return session


def panel(curve: mr.MultiRepresentation, title: str, left: float) -> Item:
    """Draw the curve with dots at equal steps of t."""

    def page(points: np.ndarray) -> np.ndarray:
        return np.stack([left + 4 * (points[:, 0] - 5), 350 - 4 * points[:, 1]], axis=1)

    polyline = curve.view(Polyline)
    line = Lines((page(np.asarray(polyline.points)),), INK, 1.5)
    dots = Marks(page(polyline(np.linspace(0, 1, 101))), "circle", 2.5, DOTS)
    return Group((line, dots, Text(left, 384, title, 15, INK, bold=True)), title)


def main(out: Path) -> None:
    """Write the picture."""
    session = drawn()
    curve = session.curve("cat")
    before = panel(curve, "as drawn", 20)
    session.reparameterize("cat")
    after = panel(curve, "even speed", 360)
    picture = Picture(700, 400, "Even speed", __doc__ or "", (before, after))
    out.write_text(to_svg(picture), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
