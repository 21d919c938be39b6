"""SVG drawings in: the one module that knows svgelements.

It hands out the sub-paths of a drawing in the drawing's own *user units*: the transforms of groups
and of ``use`` are applied, the scaling of the outermost ``viewBox`` to pixels is not. Shapes
(rectangles, circles, ...) count as paths.

Known limits: text, images, patterns and clipping are ignored; a drawing that does not say what it
means (path data that cannot be read to the end, numbers that are not finite) is refused, where a
browser would draw what it can.
"""

from __future__ import annotations

import io
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from attrs import frozen

from multirep.arrays import Array
from multirep.errors import ScriptError
from multirep.script.files import read_bytes
from multirep.script.outlines import Segment, arc

#: Bounds on a drawing: its file, its nesting, and its elements when every ``use`` is written out.
LARGEST_DRAWING, DEEPEST, MOST_ELEMENTS = 64 * 2**20, 64, 200_000
#: What the outermost element says about pixels; taken away so that user units stay.
VIEWPORT = ("viewBox", "width", "height", "x", "y", "preserveAspectRatio")
HREFS = ("href", "{http://www.w3.org/1999/xlink}href")


@frozen(eq=False)
class Subpath:
    """A connected piece of a drawing.

    ``closed`` says whether it was closed by the drawing; the closing line is then among the
    segments. ``ids`` are the ids of the shape and of the groups around it; ``fill`` is "#rrggbb" or
    None.
    """

    segments: tuple[Segment, ...]
    closed: bool
    ids: tuple[str, ...]
    fill: str | None


@frozen(eq=False)
class Drawing:
    """All sub-paths in document order; how user units become pixels ("" when they are)."""

    subpaths: tuple[Subpath, ...]
    to_pixels: str


def read_drawing(path: Path) -> Drawing:
    """Read an SVG file.

    Raises
    ------
    ScriptError
        When it is not SVG, is larger or more nested than reason allows, or holds data that cannot
        be read.
    """
    root = _parse(path, read_bytes(path, largest=LARGEST_DRAWING))
    _check_size(path, root)
    import svgelements

    viewport = ET.Element(
        root.tag, {key: root.attrib[key] for key in VIEWPORT if key in root.attrib}
    )
    width, height = _viewport_size(viewport)
    try:
        to_pixels = str(svgelements.SVG.parse(io.BytesIO(ET.tostring(viewport))).viewbox_transform)
    except Exception:  # svgelements raises whatever a bad length makes it raise
        to_pixels = ""
    for key in VIEWPORT:
        root.attrib.pop(key, None)
    source = io.BytesIO(ET.tostring(root))
    try:
        svg = svgelements.SVG.parse(
            source, reify=False, width=width, height=height, on_error="raise"
        )
        subpaths = tuple(piece for shape, ids in _shapes(svg) for piece in _subpaths(shape, ids))
    except Exception as error:  # likewise for anything else that it does not understand
        raise ScriptError(_culprit(root) or f"cannot be read: {error!r}", file=str(path)) from None
    return Drawing(subpaths, to_pixels)


def parse_color(text: str) -> str | None:
    """Return a colour as "#rrggbb" (None for "none"); ValueError when it is none that SVG knows.

    Examples
    --------
    >>> parse_color("#fd9"), parse_color("Red"), parse_color("none")
    ('#ffdd99', '#ff0000', None)
    """
    import svgelements

    plain = text.strip().lower()
    if plain == "none":
        return None
    try:
        colour = _hex(svgelements.Color(plain))
    except Exception:  # svgelements raises whatever a bad number makes it raise
        colour = None
    # What svgelements does not know it takes for black.
    written = re.fullmatch(r"#[0-9a-f]{3,4}|#[0-9a-f]{6}|#[0-9a-f]{8}|(rgb|hsl)a?\(.*\)", plain)
    named = plain.isalpha() and (plain == "black" or colour != "#000000")
    if colour is None or not (written or named):
        raise ValueError(f"no colour {text!r}; write it as in '#ffcc4e' or 'red'")
    return colour


def _hex(color: Any) -> str | None:
    if color is None or color.value is None:
        return None
    return f"#{color.red:02x}{color.green:02x}{color.blue:02x}"


# -- the document


def _parse(path: Path, data: bytes) -> ET.Element:
    if b"<!ENTITY" in data:
        raise ScriptError("declares entities, which are not expanded here", file=str(path))
    parser: Any = ET.XMLPullParser(events=("start", "end"))
    depth = count = 0
    root: ET.Element | None = None
    try:
        for start in range(0, len(data), 2**16):
            parser.feed(data[start : start + 2**16])
            for event, element in parser.read_events():
                root = element if root is None else root
                depth += 1 if event == "start" else -1
                count += event == "start"
                if depth > DEEPEST or count > MOST_ELEMENTS:
                    raise ScriptError(
                        f"more than {DEEPEST} levels or {MOST_ELEMENTS} elements", file=str(path)
                    )
        parser.close()
    except (ET.ParseError, ValueError, LookupError) as error:  # LookupError: an unknown encoding
        if isinstance(error, ScriptError):
            raise
        raise ScriptError(f"not SVG: {error}", file=str(path)) from None
    if root is None or root.tag.rpartition("}")[2] != "svg":
        found = "nothing" if root is None else f"<{root.tag.rpartition('}')[2]}>"
        raise ScriptError(f"not SVG: expected <svg> outermost, got {found}", file=str(path))
    return root


def _check_size(path: Path, root: ET.Element) -> None:
    """Refuse a drawing whose ``use`` elements refer to themselves or write out to too much."""
    by_id = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
    sizes: dict[ET.Element, int] = {}
    open_elements: set[ET.Element] = set()

    def size(element: ET.Element, depth: int) -> int:
        if element in open_elements or depth > 4 * DEEPEST:
            raise ScriptError("a <use> refers to itself, or too deep", file=str(path))
        if element not in sizes:
            open_elements.add(element)
            total = 1 + sum(size(child, depth + 1) for child in element)
            if element.tag.rpartition("}")[2] == "use":
                hrefs = [element.attrib[key] for key in HREFS if key in element.attrib]
                target = by_id.get(hrefs[-1].removeprefix("#")) if hrefs else None
                total += 0 if target is None else size(target, depth + 1)
            open_elements.discard(element)
            sizes[element] = total
        return sizes[element]

    if size(root, 0) > MOST_ELEMENTS:
        raise ScriptError(f"more than {MOST_ELEMENTS} elements with <use>", file=str(path))


def _viewport_size(viewport: ET.Element) -> tuple[float, float]:
    """Return what lengths in percent refer to, in user units."""
    try:
        numbers = [float(part) for part in viewport.attrib["viewBox"].replace(",", " ").split()]
        _, _, width, height = numbers
        return width, height
    except (KeyError, ValueError):
        return 300.0, 150.0  # what CSS gives a drawing without a size


def _culprit(root: ET.Element) -> str | None:
    """Say which path cannot be read, if it is a path."""
    import svgelements

    for index, element in enumerate(e for e in root.iter() if e.tag.rpartition("}")[2] == "path"):
        data = element.attrib.get("d", "")
        try:
            for segment in svgelements.Path(data):
                _segments(segment, np.eye(2), np.zeros(2))
        except Exception:
            shown = data if len(data) <= 60 else data[:57] + "..."
            return f"path {index} (counted from 0) cannot be read: d = {shown!r}"
    return None


# -- shapes


def _shapes(node: Any, ids: tuple[str, ...] = ()) -> Iterator[tuple[Any, tuple[str, ...]]]:
    import svgelements

    own = getattr(node, "id", None)
    ids = ids if own is None else (*ids, own)
    if isinstance(node, svgelements.Group | svgelements.Use):
        for child in node:
            yield from _shapes(child, ids)
    elif isinstance(node, svgelements.Shape):
        yield node, ids


def _subpaths(shape: Any, ids: tuple[str, ...]) -> Iterator[Subpath]:
    """Split a shape at its moves; a sub-path without any segment draws nothing and is skipped."""
    import svgelements

    matrix = shape.transform
    linear = np.array([[matrix.a, matrix.b], [matrix.c, matrix.d]], float)
    offset = np.array([float(matrix.e), float(matrix.f)])
    pieces: list[Segment] = []
    for segment in svgelements.Path(shape):
        if isinstance(segment, svgelements.Move):
            if pieces:
                yield Subpath(tuple(pieces), False, ids, _hex(shape.fill))
            pieces = []
            continue
        pieces += _segments(segment, linear, offset)
        if isinstance(segment, svgelements.Close):
            yield Subpath(tuple(pieces), True, ids, _hex(shape.fill))
            pieces = []
    if pieces:
        yield Subpath(tuple(pieces), False, ids, _hex(shape.fill))


def _segments(segment: Any, linear: Array, offset: Array) -> list[Segment]:
    """Return a segment of svgelements as Bézier segments in user units."""
    import svgelements

    if isinstance(segment, svgelements.Move):
        return []
    if isinstance(segment, svgelements.Arc) and segment.start != segment.end:
        center = np.array(segment.center, float)
        axes = np.array([segment.prx, segment.pry], float) - center
        sweep = float(segment.sweep or 0.0)
        if not (np.isfinite(axes).all() and math.isfinite(sweep)):
            raise ValueError("an arc is not finite")
        if abs(np.linalg.det(axes)) > 0 and sweep:
            pieces = arc(segment.start, segment.end, center, axes[0], axes[1], sweep)
            return [Segment(p.points @ linear + offset, p.weights) for p in pieces]
    names: tuple[str, ...] = ("start", "control1", "control", "control2", "end")
    if isinstance(segment, svgelements.Arc):
        names = ("start", "end")
    points = [getattr(segment, name, None) for name in names]
    rows = np.array([[p.x, p.y] for p in points if p is not None], float)
    if not np.isfinite(rows).all() or len(rows) < 2:
        raise ValueError("a point is not finite, or missing")
    return [Segment(rows @ linear + offset)]
