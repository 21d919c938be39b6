"""Scripts of whole sessions: strokes, gestures, tolerance, views, pictures at any step."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from multirep.errors import ScriptError, StepFailedError
from multirep.registry import Registry
from multirep.script.pictures import picture
from multirep.script.reading import read_script
from multirep.script.report import geometry, report
from multirep.script.running import Result, run
from multirep.strokes import curve_from_strokes

ROOT = Path(__file__).resolve().parents[2]
STROKE = [[0.1 * k, round(float(np.sin(0.1 * k)), 3)] for k in range(40)]
HEAD = f"""
multirep = 1
[[curve]]
name = "c"
tolerance = 0.01
stroke = {STROKE}
noise = 0
"""


def script(folder: Path, *tables: str, head: str = HEAD) -> Result:
    """Run a script of a head and of steps (or outputs, which say so)."""
    path = folder / "session.toml"
    text = (table if table.startswith("[[") else f"[[step]]\n{table}" for table in tables)
    path.write_text(head + "\n".join(text))
    registry = Registry.discover()
    return run(read_script(path, registry), registry)


def step(text: str) -> str:
    return f'curve = "c"\n{text}'


TOOLS = {
    "sketch": f"stroke = {STROKE[:20]}",
    "sketch of several": f"strokes = [{STROKE}, {STROKE[::-1]}]\nnoise = 0.01",
    "oversketch": f'stroke = {[[x, y + 0.05] for x, y in STROKE[10:30]]}\njoin = "C0"\nreach = 1',
    "corner": "t = 0.5\nleft = [4, 4]\nright = [4, -4]",
    "mark": "left = 0.25\nright = 0.75",
    "smooth": "level = 2.5\ninterval = [0.1, 0.9]",
    "copy-detail": 'source = "d"\nlevels = [3, 4]\nframe = "axes"',
    "show-level": 'source = "d"\nlevel = 3.5',
    "sweep": "t = 0.5\nto = [2, 2]\nlevel = 3\nhold = [0.2]\ntargets = [[0.8, 3, 0]]",
}
CONSTRAINTS = {
    "point": "t = 0.5\npoint = [2, 1.5]",
    "derivative": "t = 0.5\nleft = [4, 1]",
    "corner": "t = 0.5\npoint = [2, 1.5]\nright = [4, 1]",
    "freeze": "interval = [0.25, 0.5]",
    "freeze by a stroke": "stroke = [[1, 0.8], [1.5, 1]]\nradius = 0.3",
    "mark": "interval = [0.25, 0.5]",
}
ANOTHER = """
[[curve]]
name = "d"
tolerance = 0.01
points = [[0, 0], [1, 1], [2, 0], [3, 1], [4, 0]]
"""


@pytest.mark.parametrize("what", TOOLS)
def test_every_tool_is_a_step(what: str, tmp_path: Path) -> None:
    """With the parameters that the design names."""
    name = what.split(" ")[0]
    result = script(tmp_path, step(f'tool = "{name}"\n{TOOLS[what]}'), head=HEAD + ANOTHER)
    [done] = result.steps
    assert done.what == name
    assert done.changed or name == "mark"
    assert all(d.upper <= 0.01 for d in result.curves[0].deviations.values())


@pytest.mark.parametrize("what", CONSTRAINTS)
def test_every_constraint_is_a_step_with_residuals(what: str, tmp_path: Path) -> None:
    """Named, reported, released."""
    name = what.split(" ")[0]
    held, released = report(
        script(
            tmp_path,
            step(f'constrain = "{name}"\nname = "mine"\n{CONSTRAINTS[what]}'),
            step('release = "mine"'),
        )
    )["steps"]
    assert [entry["name"] for entry in held["constraints"]] == ["mine"]
    assert held["constraints"][0]["residual"] <= 1e-9
    assert released["what"] == "release"


def test_a_curve_begins_as_strokes(tmp_path: Path) -> None:
    """Inline or in a file, one or several: the same curve as in Python."""
    strokes = [STROKE, [[x, y + 0.02] for x, y in STROKE]]
    expected = curve_from_strokes(strokes, tolerance=0.01, noise=0).view("polyline").to_dict()
    (tmp_path / "strokes.json").write_text(f'{{"note": "mine", "strokes": {strokes}}}')
    (tmp_path / "bare.json").write_text(f"{strokes}")
    for given in (strokes, '"strokes.json"', '"bare.json"'):
        head = (
            f'multirep = 1\n[[curve]]\nname = "c"\ntolerance = 0.01\nstrokes = {given}\nnoise = 0\n'
        )
        [curve] = script(tmp_path, head=head).curves
        assert curve.representations["polyline"].to_dict() == expected
    [alone] = script(tmp_path).curves
    assert alone.representations["polyline"].size == len(STROKE)


def test_a_wavelet_begins_a_curve(tmp_path: Path) -> None:
    """In numbers, as geometry.json has them."""
    table = "wavelet = {level = 0, knots = [0,0,0,0,1,1,1,1], points = [[0,0],[1,2],[2,0],[3,1]]}"
    head = f'multirep = 1\n[[curve]]\nname = "c"\ntolerance = 0.01\n{table}\n'
    [curve] = script(tmp_path, head=head).curves
    assert np.asarray(curve.representations["wavelet"].points)[1].tolist() == [1, 2]  # type: ignore[attr-defined]


def test_the_tolerance_is_a_step(tmp_path: Path) -> None:
    """Undone like any other; the report has the last one; the command line has the last word."""
    result = script(tmp_path, step("tolerance = 1e-4"))
    assert report(result)["curves"]["c"]["tolerance"] == 1e-4
    assert all(d.upper <= 1e-4 for d in result.curves[0].deviations.values())
    assert script(tmp_path, step("tolerance = 1e-4"), "undo = 1").curves[0].tolerance == 0.01
    path, registry = tmp_path / "session.toml", Registry.discover()
    [curve] = run(read_script(path, registry, tolerance=0.5), registry).curves
    assert curve.tolerance == 0.5


def test_parameters_are_mapped_by_a_step(tmp_path: Path) -> None:
    """To even speed, or by a map."""
    even = script(tmp_path, step('tool = "move-vertex"\nindex = 3\nto = [0.3, 9]'),
                  step('reparameterize = "even"'))  # fmt: skip
    polyline: Any = even.curves[0].representations["polyline"]
    steps = np.linalg.norm(np.diff(polyline.points, axis=0), axis=1)
    np.testing.assert_allclose(np.diff(polyline.t), steps / steps.sum(), atol=1e-12)
    mapped = script(tmp_path, step("reparameterize = [[0, 0.5, 1], [0, 0.25, 1]]"))
    assert 0.25 in np.asarray(mapped.curves[0].representations["polyline"].t)  # type: ignore[attr-defined]


def test_a_gesture_is_one_step(tmp_path: Path) -> None:
    """One undo step, one entry of the report with all that it changed."""
    gesture = (
        '[[step]]\ncurve = "c"\n'
        '[[step.gesture]]\ntool = "move-vertex"\nindex = 3\nto = [0.3, 1]\n'
        '[[step.gesture]]\nview = ["nurbs", "wavelet"]\n'
        '[[step.gesture]]\ntool = "move-vertex"\nindex = 30\nto = [3, 1]\n'
    )
    [done] = script(tmp_path, gesture).steps
    assert (done.what, len(list(done.changed))) == ("gesture move-vertex", 2)
    [before] = script(tmp_path).curves
    [undone] = script(tmp_path, gesture, "undo = 1").curves
    kinds = before.representations
    assert all(kinds[k].to_dict() == undone.representations[k].to_dict() for k in kinds)


def test_a_curve_can_come_in_later(tmp_path: Path) -> None:
    """By a step that can be undone; after that it is not there."""
    move = step('tool = "move-vertex"\nindex = 3\nto = [0.3, 1]')
    both = script(tmp_path, move, 'add = "d"', head=HEAD + ANOTHER)
    assert [curve.name for curve in both.curves] == ["c", "d"]
    one = script(tmp_path, move, 'add = "d"', "undo = 1", head=HEAD + ANOTHER)
    assert [curve.name for curve in one.curves] == ["c"]
    with pytest.raises(ScriptError, match=r"step 0.*no curve named 'd'"):
        script(tmp_path, 'curve = "d"\ntool = "insert-knot"\nt = 0.5', 'add = "d"',
               head=HEAD + ANOTHER)  # fmt: skip


OUTPUT = '[[output]]\nsvg = "{0}.svg"\nafter = {0}\nsince = {1}\nstrokes = true'


def test_pictures_at_any_step_do_not_change_the_result(tmp_path: Path) -> None:
    """They show the curve as it was, and looking at it leaves no trace in the values."""
    steps = [
        step('tool = "sweep"\nat = [2, 0.9]\nto = [2, 2]\nlevel = 3'),
        step('tool = "spatula"\nradius = 0.2\npath = [[1, 0], [1, 1]]'),
        step('constrain = "mark"\ninterval = [0.25, 0.75]'),
        step('tool = "direct-manipulation"\nt = 0.5\nto = [2, 3]'),
    ]
    plain = geometry(script(tmp_path, *steps))
    result = script(tmp_path, *steps, *(OUTPUT.format(k, max(k - 1, 0)) for k in range(5)))
    assert geometry(result) == plain
    seen = [result.seen(output)[0] for output in result.script.outputs]
    assert [curve.edits for curve in seen] == [0, 1, 1, 1, 1]
    assert [len(curve.strokes) for curve in seen] == [1, 1, 1, 0, 0]
    assert [bool(curve.frozen) for curve in seen] == [False, False, False, True, True]
    assert seen[3].marks == ((0.25, 0.75),)
    assert seen[1].before is not None
    np.testing.assert_allclose(seen[0].representations["polyline"](0.3), seen[1].before(0.3))
    for output in result.script.outputs:
        assert picture(result, output).items


BAD = {
    "two kinds": ('curve = "c"\nview = "nurbs"\ntolerance = 1', "exactly one of .*'tolerance' and"),
    "no tolerance": ('curve = "c"\ntolerance = 0', "tolerance: must be > 0"),
    "a tolerance in words": ('curve = "c"\ntolerance = "x"', "tolerance: expected a number"),
    "another map": ('curve = "c"\nreparameterize = "evn"', 'reparameterize: expected "even" or'),
    "half a map": ('curve = "c"\nreparameterize = [[0, 1]]', 'reparameterize: expected "even"'),
    "a map of texts": ('curve = "c"\nreparameterize = [["0"], [1]]', r"reparameterize\[0\]\[0\]"),
    "an unknown view": ('curve = "c"\nview = "nurb"', "view: .*did you mean 'nurbs'"),
    "a view twice": ('curve = "c"\nview = ["nurbs", "nurbs"]', "view: names one .* twice"),
    "a view nowhere": ('curve = "c"\nview = "nurbs"\nwhere = [[1, 0]]', "where"),
    "an unknown curve": ('add = "x"', "add: no curve named 'x'"),
    "more than add": ('add = "c"\ncurve = "c"', "unknown key of an add step"),
    "a gesture of nothing": ('curve = "c"\ngesture = 1', r"gesture: expected tables \[\[step"),
    "a part without a tool": (
        'curve = "c"\n[[step.gesture]]\nundo = 1',
        r"gesture\[0\]: .*only",
    ),
    "a part elsewhere": (
        'curve = "c"\n[[step.gesture]]\ntool = "smooth"\nlevel = 1\ncurve = "c"',
        r"gesture\[0\].curve: a gesture is on one curve",
    ),
    "a bad part": (
        'curve = "c"\n[[step.gesture]]\ntool = "smooth"\nlevl = 1',
        r"gesture\[0\].levl: .*did you mean 'level'",
    ),
    "a constraint without": ('curve = "c"\nconstrain = "derivative"\nt = 0.5', "'left' or 'right'"),
    "after the end": (
        'undo = 1\n[[output]]\nsvg = "a.svg"\nafter = 2',
        r"output\[0\].after: ",
    ),
    "since later": (
        'undo = 1\n[[output]]\nsvg = "a.svg"\nafter = 0\nsince = 1',
        r"output\[0\].since: expected at most 0",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_wrong_is_said(what: str, tmp_path: Path) -> None:
    """With step and key, before anything runs."""
    text, match = BAD[what]
    with pytest.raises(ScriptError, match=match):
        script(tmp_path, text)


@pytest.mark.parametrize(
    ("keys", "match"),
    [
        ("stroke = [[0, 0], [0]]", r"stroke\[1\]"),
        ("strokes = [[[0, 0], [1, 0]], [[0, 0], [1, 'x']]]".replace("'", '"'), r"strokes\[1\]"),
        ("strokes = []", "there are no strokes"),
        ("stroke = [[0, 0], [0, 0]]", "needs two distinct"),
        ("stroke = [[0, 0], [1, 0]]\nnoise = -1", "noise: must be >= 0"),
        ("points = [[0, 0], [1, 0]]\nnoise = 0", "noise: does not go with 'points'"),
        ("wavelet = {level = 1, knots = [0, 1], points = [[0, 0]]}", "control points"),
        ('strokes = "none.json"', "no such file"),
    ],
)
def test_strokes_that_are_none_are_refused(keys: str, match: str, tmp_path: Path) -> None:
    """Where they stand."""
    head = f'multirep = 1\n[[curve]]\nname = "c"\ntolerance = 0.01\n{keys}\n'
    with pytest.raises(ScriptError, match=match):
        script(tmp_path, head=head)


def test_a_failed_step_of_a_gesture_names_the_step(tmp_path: Path) -> None:
    """A conflict inside it is a failure of the work."""
    with pytest.raises(StepFailedError, match="step 1"):
        script(
            tmp_path,
            step('constrain = "freeze"\ninterval = [0, 0.5]'),
            '[[step]]\ncurve = "c"\n[[step.gesture]]\ntool = "insert-vertex"\nt = 0.9\n'
            '[[step.gesture]]\ntool = "direct-manipulation"\nt = 0.25\nto = [2, 3]',
        )


EXAMPLES = ROOT / "examples"
checkout = pytest.mark.skipif(not EXAMPLES.exists(), reason="there is no checkout")


@checkout
def test_the_cat_session_runs_and_holds() -> None:
    """Every picture is of moderate size, every constraint holds, every pair is within tolerance."""
    from acceptance import problems

    from multirep.drawing.svg import to_svg

    registry = Registry.discover()
    result = run(read_script(EXAMPLES / "cat-session.toml", registry), registry)
    assert len(result.script.outputs) >= 5
    for output in result.script.outputs:
        assert len(to_svg(picture(result, output))) < 200_000
    assert problems(geometry(result), report(result)) == []
    assert {name for step in result.steps for name, _ in step.constraints} >= {"ears"}
    assert all(residual <= 1e-9 for step in result.steps for _, residual in step.constraints)


@checkout
def test_the_python_cat_is_replayed_by_its_own_script(tmp_path: Path) -> None:
    """The twin runs; what it saves gives the same cat, bit for bit."""
    twin = runpy.run_path(str(EXAMPLES / "cat_session.py"))
    twin["main"](tmp_path)
    assert (tmp_path / "cat-session.svg").stat().st_size > 1000
    registry = Registry.discover()
    [again] = run(read_script(tmp_path / "cat-session-again.toml", registry), registry).curves
    curve = twin["cat"]().curve("cat")
    for kind in ("polyline", "nurbs", "wavelet"):
        assert again.representations[kind].to_dict() == curve.view(kind).to_dict()


@checkout
@pytest.mark.skipif(not (ROOT / "docs").exists(), reason="only a checkout has the gallery")
def test_the_gallery_shows_what_its_scripts_say() -> None:
    """The page is that of the scripts as they are; every picture that it links is there."""
    gallery = runpy.run_path(str(ROOT / "docs" / "make_gallery.py"))
    assert (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8") == gallery["page"]()
    for entry in gallery["ENTRIES"]:
        assert (ROOT / "docs" / "gallery" / entry.svg).stat().st_size < 200_000, entry.svg
        assert (ROOT / entry.script).exists()
