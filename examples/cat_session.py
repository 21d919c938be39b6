"""The cat of `cat-session.toml`, shortened, in Python: sketched, swept, given a tail and ears.

Run it in this folder: it writes `cat-session.svg` (needs nothing but multirep) and, beside it, the
session as a script, `cat-session-again.toml`, which gives the same cat bit for bit.
"""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import multirep as mr
from multirep.constraints import Freeze
from multirep.strokes import curve_from_strokes
from multirep.tools import Corner, Mark, Smooth, Spatula, Sweep

HERE = Path(__file__).resolve().parent
TAIL = [(5.2, 0.75), (5.6, 0.62), (6.4, 0.52), (7.2, 0.65), (7.8, 1.15), (8.0, 1.9), (7.9, 2.6)]


def cat() -> mr.Session:
    """Draw the cat."""
    strokes = json.loads((HERE / "data" / "cat-strokes.json").read_text())["strokes"]
    session = mr.Session()
    session.add("cat", curve_from_strokes(strokes, tolerance=0.01))
    session.apply("cat", Smooth(level=6))
    session.apply("cat", Sweep(at=(5.8, 3.2), to=(6.25, 3.45), level=3))  # a rounder back
    session.apply("cat", Sweep(at=(1.28, 5.25), to=(1.08, 5.35), level=5.5))  # the nose

    with session.gesture("cat") as gesture:  # one drag of the spatula is one undo step
        for here, there in pairwise(TAIL):
            gesture.apply(Spatula(radius=0.32, path=(here, there)))

    session.apply("cat", Corner(at=(1.95, 8.05), to=(1.9, 8.2), left=(3, 14), right=(8, -10)))
    session.apply("cat", Corner(at=(4.05, 8.08), to=(4.12, 8.24), left=(8, 10), right=(6, -10)))
    session.reparameterize("cat")

    ears = session.constrain("cat", Freeze(interval=(0.27, 0.41)), name="ears")
    session.apply("cat", Mark(left=0.46, right=0.61))
    session.apply("cat", Smooth(level=4))  # between the marks alone
    session.apply("cat", Mark(remove=True))
    session.release("cat", ears)
    return session


def main(folder: Path) -> None:
    """Write the picture and the script of the session into a folder."""
    session = cat()
    curve = session.curve("cat")
    for one, two in (("polyline", "nurbs"), ("nurbs", "wavelet"), ("wavelet", "polyline")):
        print(f"{one} - {two}: at most {curve.deviation(one, two).upper:.4f} for all t")
    points = " ".join(f"{x:.3f},{-y:.3f}" for x, y in curve.view("polyline").points)
    (folder / "cat-session.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -9 9 9.5">'
        f'<polyline points="{points}" fill="#ffcc4e" stroke="black" stroke-width="0.05"/></svg>\n'
    )
    session.save_script(folder / "cat-session-again.toml")


if __name__ == "__main__":
    main(Path.cwd())
