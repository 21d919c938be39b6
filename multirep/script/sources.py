"""What a curve of a script starts from, as plain numbers: points, a NURBS, a drawing."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from attrs import field, frozen, validators

from multirep.errors import ScriptError
from multirep.script.files import read_json
from multirep.script.model import (
    NurbsSource,
    Points,
    PointsSource,
    Source,
    StrokesSource,
    WaveletSource,
)
from multirep.script.strict import Mismatch, quote, structure, structure_key

T = TypeVar("T")

#: The keys of a curve table that say where its geometry comes from.
SOURCE_KEYS = (
    "points", "t", "nurbs", "wavelet", "svg", "element", "id", "fill",
    "stroke", "strokes", "noise", "corner_angle", "corner_window",
)  # fmt: skip
#: Exactly one of these is given.
ORIGINS = ("points", "nurbs", "svg", "stroke", "strokes", "wavelet")
#: How strokes are cleaned; as in the tool `sketch`.
PEN = ("noise", "corner_angle", "corner_window")
#: Keys that a data file may carry for people: where the data come from and how they may be used.
REMARKS = ("name", "title", "source", "licence", "license", "note")


@frozen
class _SvgTable:
    """Which sub-path of which drawing."""

    svg: str
    element: int = field(default=0, validator=validators.ge(0))
    id: str | None = None
    fill: str | None = None


def read_source(table: Mapping[str, Any], folder: Path) -> tuple[Source, str, tuple[str, ...]]:
    """Read where a curve comes from.

    Parameters
    ----------
    table : mapping
        A ``[[curve]]`` of the script; only :data:`SOURCE_KEYS` are looked at.
    folder : Path
        What paths are relative to.

    Returns
    -------
    source : Source
    author : str
        The representation that it is: "polyline", "nurbs" or "wavelet".
    notes : tuple of str
        What reading it did, for people.

    Raises
    ------
    Mismatch
        When the table is wrong.
    ScriptError
        When a file that it names is.
    """
    given = [key for key in ORIGINS if key in table]
    if len(given) != 1:
        found = " and ".join(given) or "none"
        raise Mismatch(f"a curve has exactly one of {', '.join(ORIGINS)}; got {found}")
    origin = given[0]
    allowed = {
        "points": ("points", "t"),
        "nurbs": ("nurbs",),
        "svg": ("svg", "element", "id", "fill"),
        "stroke": ("stroke", *PEN),
        "strokes": ("strokes", *PEN),
        "wavelet": ("wavelet",),
    }
    for key in SOURCE_KEYS:
        if key in table and key not in allowed[origin]:
            raise Mismatch(f"does not go with {origin!r}", key)
    part = {key: table[key] for key in allowed[origin] if key in table}
    if origin == "points":
        return _read_points(part, folder), "polyline", ()
    if origin == "nurbs":
        return _read_spline(part["nurbs"], folder, NurbsSource, origin), origin, ()
    if origin == "wavelet":
        return _read_spline(part["wavelet"], folder, WaveletSource, origin), origin, ()
    if origin in ("stroke", "strokes"):
        return _read_strokes(part, folder), "polyline", ()
    source, notes = _read_svg(structure(part, _SvgTable), folder)
    return source, "nurbs", notes


def _read_points(part: Mapping[str, Any], folder: Path) -> PointsSource:
    value = part["points"]
    if not isinstance(value, str):
        return structure(dict(part), PointsSource)
    path = folder / structure(value, str)
    data = _table_of(path, "points")
    if "t" in part:
        if "t" in data:
            raise Mismatch(f"given twice, here and in {value!r}", "t")
        data["t"] = part["t"]
    return _structure_file(data, PointsSource, path)


def _read_spline(value: object, folder: Path, cls: type[T], key: str) -> T:
    """Read the knots and control points of one kind, from a table or from the file it names."""
    if isinstance(value, str):
        path = folder / structure(value, str)
        return _structure_file(_table_of(path, key, bare_list=False), cls, path)
    try:
        return structure(value, cls)
    except Mismatch as error:
        raise Mismatch(error.problem, f"{key}.{error.key}" if error.key else key) from None


def _read_strokes(part: Mapping[str, Any], folder: Path) -> StrokesSource:
    """Read one stroke or several; a file holds them under "strokes", or is a bare list of them."""
    data = dict(part)
    if "stroke" in data:
        data["strokes"] = [structure_key(data, "stroke", Points)]
        del data["stroke"]
    if isinstance(data["strokes"], str):
        path = folder / structure(data["strokes"], str)
        found = _table_of(path, "strokes")
        found["strokes"] = found.pop("points", None) or found.get("strokes", [])
        pen = {key: data[key] for key in PEN if key in data}
        source = _structure_file(found | pen, StrokesSource, path)
    else:
        source = structure(data, StrokesSource)
    for key in ("noise", "corner_angle", "corner_window"):
        value = getattr(source, key)
        if value is not None and value < 0:
            raise Mismatch(f"must be >= 0, got {value!r}", key)
    return source


def _structure_file(data: dict[str, Any], cls: type[T], path: Path) -> T:
    """Make ``cls`` of the data of a file; what does not fit is the file's fault."""
    try:
        return structure(data, cls)
    except Mismatch as error:
        raise ScriptError(error.problem, file=str(path), key=error.key or None) from None


def _table_of(path: Path, key: str, *, bare_list: bool = True) -> dict[str, Any]:
    """Read a JSON file that holds an object (without its remarks), or a bare list of points."""
    if not path.is_file():
        raise Mismatch(f"no such file: {str(path)!r}", key)
    data = read_json(path)
    if isinstance(data, list) and bare_list:
        return {"points": data}
    if not isinstance(data, dict):
        raise ScriptError(f"expected an object, got {quote(data)}", file=str(path))
    return {key: value for key, value in data.items() if key not in REMARKS}


def _read_svg(table: _SvgTable, folder: Path) -> tuple[NurbsSource, tuple[str, ...]]:
    from multirep.script.outlines import join
    from multirep.script.svg_paths import parse_color, read_drawing

    path = folder / table.svg
    if not path.is_file():
        raise Mismatch(f"no such file: {str(path)!r}", "svg")
    try:
        fill = None if table.fill is None else parse_color(table.fill)
    except ValueError as error:
        raise Mismatch(str(error), "fill") from None
    drawing = read_drawing(path)
    found = [
        subpath
        for subpath in drawing.subpaths
        if (table.id is None or table.id in subpath.ids)
        and (table.fill is None or subpath.fill == fill)
    ]
    chosen = [
        f"{key} {value!r}" for key, value in (("id", table.id), ("fill", table.fill)) if value
    ]
    those = f"sub-paths with {' and '.join(chosen)}" if chosen else "sub-paths"
    if not found:
        if chosen and drawing.subpaths:
            key = "id" if table.id is not None else "fill"
            ids = sorted({name for subpath in drawing.subpaths for name in subpath.ids})
            fills = sorted({str(subpath.fill or "none") for subpath in drawing.subpaths})
            known = ", ".join((ids if key == "id" else fills)[:20]) or "none"
            raise Mismatch(f"{str(path)!r} has no {those}; it has {key}s {known}", key)
        raise ScriptError("has no sub-path to draw", file=str(path))
    if table.element >= len(found):
        raise Mismatch(
            f"expected 0 to {len(found) - 1}: {str(path)!r} has {len(found)} {those}; "
            f"got {table.element}",
            "element",
        )
    subpath = found[table.element]
    try:
        outline = join(subpath.segments)
    except ValueError as error:
        raise Mismatch(f"sub-path {table.element} of {str(path)!r}: {error}", "element") from None
    notes = [f"in the user units of {table.svg}"]
    if drawing.to_pixels:
        notes[0] += f" (to pixels: {drawing.to_pixels}, not applied)"
    if subpath.closed:
        notes.append("closed, opened at its start")
    if outline.dropped:
        notes.append(f"{outline.dropped} segments without length dropped")
    source = NurbsSource(
        outline.degree,
        tuple(outline.knots.tolist()),
        Points(tuple(map(tuple, outline.points.tolist()))),
        None if outline.weights is None else tuple(outline.weights.tolist()),
    )
    return source, tuple(notes)
