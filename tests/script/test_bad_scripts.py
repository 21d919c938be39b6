"""Scripts that are wrong: a message with file, step and key, exit code 2, nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from multirep.cli import main

HEAD = 'multirep = 1\n[[curve]]\nname = "c"\ntolerance = 0.01\n'
GOOD = HEAD + "points = [[0, 0], [1, 2], [2, 0], [3, 1]]\n"


def step(text: str) -> str:
    """Return a good script with one more step, as step 1."""
    first = '[[step]]\ncurve = "c"\ntool = "move-vertex"\nindex = 1\nto = [1, 3]\n'
    return GOOD + first + "[[step]]\n" + text + "\n"


#: What is wrong, and what the message must contain.
SCRIPTS = {
    "not TOML": ("multirep = = 1", ["bad.toml", "not TOML"]),
    "nested beyond reason": ("a = " + "[" * 5000 + "]" * 5000, ["bad.toml", "not TOML"]),
    "empty": ("", ["multirep: missing"]),
    "a newer format": ("multirep = 2", ["expected format 1, got 2", "newer multirep"]),
    "a format that is no number": ('multirep = "1"', ["multirep", "whole number", "'1'"]),
    "no curve": ("multirep = 1", ["curve", "missing"]),
    "unknown table": (GOOD + "[[steps]]\nundo = 1", ["steps", "did you mean 'step'"]),
    "one bracket": (GOOD + "[step]\nundo = 1", ["expected [[step]]"]),
    "unknown key": (HEAD + "pionts = []", ["bad.toml:2", "pionts", "did you mean 'points'"]),
    "no geometry": (HEAD, ["curve[0]", "exactly one of points, nurbs, svg", "none"]),
    "two geometries": (GOOD + 'svg = "x.svg"', ["exactly one of", "points and svg"]),
    "a key of another geometry": (GOOD + "element = 1", ["element", "does not go with 'points'"]),
    "no name": (
        "multirep = 1\n[[curve]]\ntolerance = 1\npoints = [[0,0],[1,1]]",
        ["name: missing"],
    ),
    "an empty name": (GOOD.replace('"c"', '""'), ["curve[0].name", "printable characters"]),
    "a name twice": (GOOD + GOOD.removeprefix("multirep = 1\n"), ["curve[1].name", "already"]),
    "no tolerance": (GOOD.replace("tolerance = 0.01\n", ""), ["tolerance: missing"]),
    "tolerance zero": (GOOD.replace("0.01", "0"), ["curve[0].tolerance", "must be > 0"]),
    "negative tolerance": (GOOD.replace("0.01", "-1"), ["curve[0].tolerance", "must be > 0"]),
    "tolerance NaN": (GOOD.replace("0.01", "nan"), ["tolerance", "finite number", "nan"]),
    "tolerance infinite": (GOOD.replace("0.01", "inf"), ["tolerance", "finite number", "inf"]),
    "tolerance in words": (GOOD.replace("0.01", '"small"'), ["tolerance", "a number", "'small'"]),
    "tolerance below rounding": (
        GOOD.replace("0.01", "1e-300"),
        ["curve[0].tolerance", "1e-300", "smallest reachable"],
    ),
    "a point that is none": (HEAD + "points = [[0, 0], 7]", ["points[1]", "a point", "7"]),
    "a coordinate NaN": (HEAD + "points = [[0, 0], [nan, 1]]", ["points[1]", "finite", "nan"]),
    "a coordinate infinite": (HEAD + "points = [[0, 0], [1, -inf]]", ["points[1]", "finite"]),
    "a coordinate true": (HEAD + "points = [[0, 0], [1, true]]", ["points[1]", "a number", "True"]),
    "mixed dimensions": (HEAD + "points = [[0, 0], [1, 1, 1]]", ["points[1]", "2 coordinates"]),
    "one point": (HEAD + "points = [[0, 0]]", ["curve[0]", "two distinct points"]),
    "one point twice": (HEAD + "points = [[1, 1], [1, 1]]", ["curve[0]", "two distinct points"]),
    "no points": (HEAD + "points = []", ["curve[0]", "points"]),
    "too few parameters": (GOOD + "t = [0, 1]", ["curve[0]", "t"]),
    "parameters not increasing": (GOOD + "t = [0, 2, 1, 3]", ["curve[0]", "increas"]),
    "points file missing": (HEAD + 'points = "no.json"', ["points", "no such file", "no.json"]),
    "points file not JSON": (HEAD + 'points = "bad.toml"', ["bad.toml", "not JSON"]),
    "svg file missing": (HEAD + 'svg = "no.svg"', ["svg", "no such file"]),
    "svg file not SVG": (HEAD + 'svg = "bad.toml"', ["bad.toml", "not SVG"]),
    "nurbs without knots": (
        HEAD + "nurbs = {degree = 1, points = [[0, 0], [1, 1]]}",
        ["nurbs.knots", "missing"],
    ),
    "knots out of order": (
        HEAD + "nurbs = {degree = 1, knots = [0, 1, 0, 1], points = [[0, 0], [1, 1]]}",
        ["curve[0]", "knot"],
    ),
    "knots of the wrong number": (
        HEAD + "nurbs = {degree = 1, knots = [0, 0, 1], points = [[0, 0], [1, 1]]}",
        ["curve[0]", "knots"],
    ),
    "degree zero": (
        HEAD + "nurbs = {degree = 0, knots = [0, 0, 1], points = [[0, 0], [1, 1]]}",
        ["nurbs.degree", ">= 1"],
    ),
    "a weight of zero": (
        HEAD
        + "nurbs = {degree = 1, knots = [0, 0, 1, 1], points = [[0, 0], [1, 1]], weights = [1, 0]}",
        ["curve[0]", "weight"],
    ),
    "unknown representation": (
        GOOD + 'representations = ["polyline", "nurb"]',
        ["representations", "did you mean 'nurbs'"],
    ),
    "without the author": (
        GOOD + 'representations = ["nurbs"]',
        ["representations", "must contain 'polyline'"],
    ),
    "unknown tool": (
        step('curve = "c"\ntool = "spatla"'),
        ["bad.toml:11", "step 1", "tool", "did you mean 'spatula'"],
    ),
    "unknown constraint": (
        step('curve = "c"\nconstrain = "nail"'),
        ["step 1", "constrain", "no constraint named 'nail'"],
    ),
    "unknown curve": (step('curve = "d"\ntool = "sweep"'), ["step 1", "curve", "'d'", "'c'"]),
    "no curve in a step": (step('tool = "sweep"'), ["step 1", "curve", "missing"]),
    "neither tool nor undo": (step('curve = "c"'), ["step 1", "exactly one of", "only 'curve'"]),
    "tool and undo": (step('curve = "c"\ntool = "x"\nundo = 1'), ["step 1", "'tool' and 'undo'"]),
    "unknown parameter": (
        step('curve = "c"\ntool = "move-vertex"\nindx = 1\nto = [0, 0]'),
        ["step 1", "indx", "did you mean 'index'"],
    ),
    "missing parameter": (
        step('curve = "c"\ntool = "move-vertex"\nindex = 1'),
        ["step 1", "to", "missing"],
    ),
    "wrong type": (
        step('curve = "c"\ntool = "move-vertex"\nindex = 1.5\nto = [0, 0]'),
        ["step 1", "index", "whole number", "1.5"],
    ),
    "not finite": (
        step('curve = "c"\ntool = "move-vertex"\nindex = 1\nto = [0, inf]'),
        ["step 1", "to[1]", "finite", "inf"],
    ),
    "out of range": (
        step('curve = "c"\ntool = "move-vertex"\nindex = 99\nto = [0, 0]'),
        ["bad.toml:11", "step 1", "move-vertex", "99"],
    ),
    "wrong dimension": (
        step('curve = "c"\ntool = "move-vertex"\nindex = 1\nto = [0, 0, 0]'),
        ["step 1", "move-vertex", "3"],
    ),
    "t outside the domain": (
        step('curve = "c"\ntool = "insert-knot"\nt = 1.5'),
        ["step 1", "insert-knot", "1.5"],
    ),
    "negative radius": (
        step('curve = "c"\ntool = "spatula"\nradius = -1\npath = [[0, 0], [1, 1]]'),
        ["step 1", "radius", "-1"],
    ),
    "weight zero": (
        step('curve = "c"\ntool = "set-weight"\nindex = 0\nweight = 0'),
        ["step 1", "weight"],
    ),
    "undo too much": (step("undo = 2"), ["step 1", "undo", "2"]),
    "undo nothing": (step("undo = 0"), ["step 1", "undo", ">= 1"]),
    "undo true": (step("undo = true"), ["step 1", "undo", "whole number", "True"]),
    "redo nothing": (step("redo = 1"), ["step 1", "redo"]),
    "release what is not there": (step('curve = "c"\nrelease = "x"'), ["step 1", "release", "'x'"]),
    "an output that is no SVG": (GOOD + '[[output]]\nsvg = "c.png"', ["output[0].svg", ".svg"]),
    "an output outside": (GOOD + '[[output]]\nsvg = "../c.svg"', ["output[0].svg", "inside"]),
    "an absolute output": (GOOD + '[[output]]\nsvg = "/c.svg"', ["output[0].svg", "inside"]),
    "an output twice": (
        GOOD + '[[output]]\nsvg = "c.svg"\n[[output]]\nsvg = "./c.svg"',
        ["output[1].svg", "already"],
    ),
    "an output of what is not there": (
        GOOD + '[[output]]\nsvg = "c.svg"\nshow = ["wavlet"]',
        ["output[0].show", "did you mean 'wavelet'"],
    ),
}


@pytest.mark.parametrize("what", SCRIPTS)
def test_a_bad_script_is_refused_with_its_place(what: str, tmp_path: Path) -> None:
    """The message names file, step and key; the exit code is 2; nothing is written."""
    text, fragments = SCRIPTS[what]
    script = tmp_path / "bad.toml"
    script.write_text(text)
    done = CliRunner().invoke(main, ["run", str(script), "--out", str(tmp_path / "out")])
    assert done.exit_code == 2, done.output
    assert done.exception is None or isinstance(done.exception, SystemExit)
    assert "bad.toml" in done.stderr or what.startswith("points file")
    for fragment in fragments:
        assert fragment in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == [script]


def test_what_is_not_a_file_is_refused(tmp_path: Path) -> None:
    """A directory, a missing file and bytes that are no text are wrong input, too."""
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    for path, problem in (
        (tmp_path, "is a directory"),
        (tmp_path / "no.toml", "no such file"),
        (binary, "not UTF-8"),
    ):
        done = CliRunner().invoke(main, ["run", str(path)])
        assert done.exit_code == 2
        assert problem in done.stderr


def test_files_that_are_too_large_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No file is read beyond its bound."""
    script = tmp_path / "large.toml"
    script.write_text(GOOD)
    monkeypatch.setattr("multirep.script.reading.LARGEST_SCRIPT", 10)
    done = CliRunner().invoke(main, ["check", str(script)])
    assert done.exit_code == 2
    assert "larger than 10 bytes" in done.stderr
