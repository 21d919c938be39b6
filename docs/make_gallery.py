"""Make the gallery: run its scripts, write their pictures and docs/gallery.md.

    python docs/make_gallery.py [FOLDER]

FOLDER is `docs` by default. `make gallery` calls this.
"""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from attrs import evolve, frozen

from multirep.drawing.svg import to_svg
from multirep.registry import Registry
from multirep.script.pictures import picture
from multirep.script.reading import read_script
from multirep.script.running import run

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
#: A list in an excerpt keeps so many lines.
LONGEST_LIST = 3

HEAD = """# Gallery

Each picture is made by the script beside it; `make gallery` makes them all again. *GA* is Grimm
and Ayers, A Framework for Synchronized Editing of Multiple Curve Representations, Computer Graphics
Forum 17(3), 1998; *FS* is Finkelstein and Salesin, Multiresolution Curves, SIGGRAPH 1994. The cats
of `smooth` and `show-level` are after [Twemoji](../examples/data/README.md), CC BY 4.0.
"""


@frozen
class Entry:
    """A picture: its file, what it shows, the script and the steps of it that are printed."""

    svg: str
    title: str
    words: str
    script: str
    steps: tuple[int, int] = (0, 0)
    curve: bool = False
    show: tuple[str, ...] | None = None  # else what the script says


CAT = "examples/cat-session.toml"
ENTRIES = (
    Entry(
        "cat-1-sketch.svg",
        "A cat, from strokes",
        "The outline is a stroke, its back is drawn over twice; the strokes average into "
        "one curve (GA 3.1, figure 3).",
        CAT,
        curve=True,
    ),
    Entry(
        "cat-2-sweeps.svg",
        "Sweeps of three widths",
        "One tool of the wavelet B-spline, at a low, a middle and a high level (GA 3.1 and "
        "5.3, figures 2 and 4).",
        CAT,
        (1, 4),
    ),
    Entry(
        "cat-3-tail.svg",
        "A tail, with the spatula",
        "The polyline is sand that a round spatula pushes; three moves are one gesture, "
        "which is one undo step (GA 3.1 and 5.1.2, figures 5, 10 and 11).",
        CAT,
        (4, 5),
    ),
    Entry(
        "cat-4-ears.svg",
        "Ears, with the corner tool",
        "The knots of the NURBS at the tips get full multiplicity; both tangents are free "
        "(GA 3.1 and 5.1.1, figure 6).",
        CAT,
        (5, 7),
    ),
    Entry(
        "cat-5-marks.svg",
        "Marks, and what is frozen",
        "Between the marks the back is smoothed; everything else, under the blue band, is "
        "the same bit for bit in every representation (GA 5.2, figure 12).",
        CAT,
        (8, 11),
    ),
    Entry(
        "cat-6-foot.svg",
        "A foot, sketched over",
        "A stroke replaces the stretch between its ends; the tip of the tail is bent and "
        "then held by a constraint (GA 2.2.3 and 5.1.1).",
        CAT,
        (14, 17),
    ),
    Entry(
        "cat-7-all.svg",
        "All representations of the cat",
        "After seventeen steps with tools for three representations these are within the "
        "tolerance, proved for all t (GA 3.1, figure 7).",
        CAT,
    ),
    Entry(
        "sketch.svg",
        "Homing in",
        "Three strokes over each other, one of them backwards, average into one outline (GA "
        "2.2.3).",
        "docs/gallery/sketch.toml",
    ),
    Entry(
        "oversketch.svg",
        "Sketching over",
        "A tail that is twenty times as long as what it replaces, and a belly drawn against "
        "the direction (GA 2.2.3).",
        "docs/gallery/oversketch.toml",
        (1, 2),
    ),
    Entry(
        "reparameterize.svg",
        "Even parameters",
        "The dots are at equal steps of t, before and after; the shape stays (GA 6.3).",
        "docs/gallery/reparameterize.py",
    ),
    Entry(
        "smooth.svg",
        "Smoothing a stretch",
        "Details above a fractional level go, on a stretch, over which they fade out and in "
        "(GA 2.2.3; FS 3.3).",
        "docs/gallery/smooth.toml",
        (0, 1),
        show=("wavelet",),
    ),
    Entry(
        "show-level-4.svg",
        "Levels",
        "The curves of three levels beside the outline (GA 2.1.3; FS 3.1).",
        "docs/gallery/show-level.toml",
        (0, 1),
    ),
    Entry(
        "copy-detail.svg",
        "The character of another curve",
        "The coves of a coast on a plain curve, each turned with the curve (GA 2.2.4; FS 3.5).",
        "docs/gallery/copy-detail.toml",
        (0, 1),
        show=("wavelet",),
    ),
)


def pictures(script: Path, shown: dict[str, tuple[str, ...] | None]) -> dict[str, str]:
    """Run a script of either kind; return those of its pictures that the page has, as SVG text."""
    if script.suffix == ".py":
        name = f"{script.stem}.svg"
        with TemporaryDirectory() as folder:
            runpy.run_path(str(script))["main"](Path(folder) / name)
            return {name: (Path(folder) / name).read_text(encoding="utf-8")}
    registry = Registry.discover()
    with np.errstate(all="ignore"):
        result = run(read_script(script, registry), registry)
    outputs = [output for output in result.script.outputs if output.svg in shown]
    return {
        output.svg: to_svg(picture(result, evolve(output, show=shown[output.svg] or output.show)))
        for output in outputs
    }


def excerpt(entry: Entry) -> str:
    """Return what the script says in some of its steps, with long lists cut short."""
    text = (ROOT / entry.script).read_text(encoding="utf-8")
    tables = re.split(r"\n(?=(?:#[^\n]*\n)*\[\[(?:curve|step|output)\]\])", text)
    curves = [table for table in tables if "[[curve]]" in table]
    steps = [table for table in tables if "[[step]]" in table]
    chosen = (curves if entry.curve else []) + steps[slice(*entry.steps)]
    return "\n".join(_short(table) for table in chosen).strip()


def _short(table: str) -> str:
    """Leave out the middle of lists that take many lines."""
    lines: list[str] = []
    inside = 0
    for line in table.splitlines():
        inside = inside + 1 if inside or line.rstrip().endswith("= [") else 0
        if inside == LONGEST_LIST + 1 and line != "]":
            lines.append("    # ...")
        if inside <= LONGEST_LIST or line == "]":
            lines.append(line)
        if line == "]":
            inside = 0
    return "\n".join(lines) + "\n"


def page() -> str:
    """Return the text of the gallery."""
    parts = [HEAD]
    for entry in ENTRIES:
        parts.append(f"## {entry.title}\n\n![{entry.title}](gallery/{entry.svg})\n")
        parts.append(f"{entry.words}\n")
        code = excerpt(entry) if entry.script.endswith(".toml") else ""
        if code:
            parts.append(f"```toml\n{code}\n```\n")
        parts.append(f"From [{entry.script}](../{entry.script}).\n")
    return "\n".join(parts)


def main(folder: Path) -> None:
    """Write everything."""
    (folder / "gallery").mkdir(parents=True, exist_ok=True)
    shown = {entry.svg: entry.show for entry in ENTRIES}
    for script in dict.fromkeys(entry.script for entry in ENTRIES):
        for name, svg in pictures(ROOT / script, shown).items():
            (folder / "gallery" / name).write_text(svg, encoding="utf-8")
            print(f"{name}: {len(svg) // 1000} kB")
    (folder / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else DOCS)
