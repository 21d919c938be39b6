"""The real curves of tests/data as script files, one curve each."""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from attrs import frozen

DATA = Path(__file__).parent / "data"
KINDS = ("icons", "glyphs", "strokes", "airfoils", "coastlines", "nurbs")
#: Two glyphs have an anchor: a sub-path that is closed where it starts, and nothing else.
ONE_POINT = ("DejaVuSans/U+016F/1", "DejaVuSans/U+0117/1")


@frozen
class Entry:
    """A curve: its data file, its name, the keys that give its geometry, files to lay beside."""

    kind: str
    name: str
    keys: str
    files: dict[str, str]
    vertices: int = 0

    def write(self, folder: Path, tolerance: float = 1.0) -> Path:
        """Write the script of this curve and the files that it names."""
        for name, text in self.files.items():
            (folder / name).write_text(text, encoding="utf-8")
        script = folder / "script.toml"
        script.write_text(
            f'multirep = 1\n[[curve]]\nname = "curve"\ntolerance = {tolerance!r}\n{self.keys}\n',
            encoding="utf-8",
        )
        return script


def items(kind: str) -> list[dict[str, Any]]:
    """Return the items of a data file."""
    data = json.loads((DATA / f"{kind}.json").read_text(encoding="utf-8"))
    found: list[dict[str, Any]] = data["items"]
    return found


def corpus() -> Iterator[Entry]:
    """Yield every curve."""
    for icon in items("icons"):
        yield from _drawing("icons", icon["name"], icon["d"], icon["subpaths"])
    for glyph in items("glyphs"):
        d = " ".join(" ".join(map(str, command)) for command in glyph["commands"])
        yield from _drawing("glyphs", glyph["name"], d, glyph["subpaths"])
    for drawing in items("strokes"):
        for number, stroke in enumerate(drawing["strokes"]):
            yield _points("strokes", f"{drawing['name']}/{number}", stroke)
    for airfoil in items("airfoils"):
        yield _points("airfoils", airfoil["name"], airfoil["points"])
    for ring in items("coastlines"):
        points = unpack(ring)
        yield _points("coastlines", ring["name"], [*points, points[0]])
    for curve in items("nurbs"):
        points = np.array(curve["points"])
        if np.ptp(points[:, 2]) == 0:
            points = points[:, :2]
        data = {k: curve[k] for k in ("degree", "knots", "weights")} | {"points": points.tolist()}
        files = {"curve.json": json.dumps(data)}
        yield Entry("nurbs", curve["name"], 'nurbs = "curve.json"', files)


def _drawing(kind: str, name: str, d: str, subpaths: int) -> Iterator[Entry]:
    svg = f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{d}"/></svg>'
    for element in range(subpaths):
        keys = f'svg = "drawing.svg"\nelement = {element}'
        yield Entry(kind, f"{name}/{element}", keys, {"drawing.svg": svg})


def _points(kind: str, name: str, points: list[list[float]]) -> Entry:
    files = {"points.json": json.dumps(points)}
    return Entry(kind, name, 'points = "points.json"', files, len(points))


def unpack(ring: dict[str, Any]) -> list[list[float]]:
    """Unpack a ring: zlib over zig-zag varints of the steps of quantised x, then y."""
    values, shift, value = [], 0, 0
    for byte in zlib.decompress(base64.b64decode(ring["data"])):
        value |= (byte & 127) << shift
        shift += 7
        if not byte & 128:
            values.append((value >> 1) ^ -(value & 1))
            shift = value = 0
    steps = np.array(values[: 2 * ring["n"]]).reshape(2, -1)
    cells = np.cumsum(steps, axis=1).T
    points: list[list[float]] = (cells * ring["scale"] + ring["translate"]).tolist()
    return points
