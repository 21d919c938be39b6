"""The commands: what they write, print and return."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from acceptance import problems
from click.testing import CliRunner, Result

import multirep
from multirep.cli import main
from multirep.errors import PluginError, ToleranceError

SCRIPT = """
multirep = 1

[[curve]]
name = "wave"
tolerance = 0.01
points = [[0, 0], [1, 2], [2, 0], [3, 1], [3, 1], [4, 0]]

[[step]]
curve = "wave"
tool = "move-vertex"
index = 1
to = [1, 3]

[[step]]
curve = "wave"
tool = "move-vertex"
index = 3
to = [3, 2]

[[step]]
undo = 1

[[output]]
svg = "pictures/wave.svg"
show = ["nurbs", "wavelet"]
"""


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "wave.toml"
    path.write_text(SCRIPT)
    return path


def call(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def load(folder: Path) -> tuple[Any, Any]:
    return tuple(
        json.loads((folder / name).read_text()) for name in ("geometry.json", "report.json")
    )


def test_run_writes_pictures_report_and_geometry(script: Path) -> None:
    """The default directory is the script's name with -out; the formats are those of the design."""
    done = call("run", script)
    assert done.exit_code == 0, done.output
    out = script.parent / "wave-out"
    assert sorted(path.relative_to(out).as_posix() for path in out.rglob("*.*")) == [
        "geometry.json",
        "pictures/wave.svg",
        "report.json",
    ]
    geometry, report = load(out)
    assert problems(geometry, report) == []
    assert geometry["multirep"] == report["multirep"] == 1
    wave = geometry["curves"]["wave"]
    assert wave["domain"] == [0, 1]
    assert set(wave["polyline"]) == {"t", "points"}
    assert set(wave["nurbs"]) == {"degree", "knots", "points", "weights"}
    assert set(wave["wavelet"]) == {"level", "knots", "points"}
    assert wave["polyline"]["points"][1] == [1, 3]
    assert wave["polyline"]["points"][3] == [3, 1], "the second step was undone"
    stated = report["curves"]["wave"]
    assert stated["tolerance"] == 0.01
    assert stated["sizes"]["polyline"] == 5
    assert set(stated["deviation"]) == {"nurbs~polyline", "nurbs~wavelet", "polyline~wavelet"}
    assert stated["notes"] == ["1 repeated points merged"]
    first, second, undo = report["steps"]
    assert (first["index"], first["what"], first["curve"]) == (0, "move-vertex", "wave")
    t = wave["polyline"]["t"]
    assert first["changed"] == [[t[0], t[2]]]
    assert second["changed"] == undo["changed"] == [[t[2], t[4]]]
    assert undo["what"] == "undo"
    assert set(first) == {
        "index", "what", "curve", "changed", "seconds", "work", "rounds", "faded", "constraints",
    }  # fmt: skip
    assert first["seconds"] > 0


def test_run_twice_gives_the_same_bytes(script: Path) -> None:
    """Geometry and picture are the same, the report but for the seconds."""
    for out in ("one", "two"):
        assert call("run", script, "--out", out).exit_code == 0
    one, two = script.parent / "one", script.parent / "two"
    for name in ("geometry.json", "pictures/wave.svg"):
        assert (one / name).read_bytes() == (two / name).read_bytes()
    reports = [load(out)[1] for out in (one, two)]
    for report in reports:
        for step in report["steps"]:
            step.pop("seconds")
    assert reports[0] == reports[1]


def test_the_tolerance_option_replaces_that_of_the_script(script: Path) -> None:
    """--tolerance holds for every curve; what is no tolerance is refused."""
    assert call("run", script, "--out", "fine", "--tolerance", "1e-4").exit_code == 0
    geometry, report = load(script.parent / "fine")
    assert report["curves"]["wave"]["tolerance"] == 1e-4
    assert problems(geometry, report) == []
    for value in ("0", "-1", "nan", "inf", "x"):
        refused = call("run", script, "--out", "no", "--tolerance", value)
        assert refused.exit_code == 2
        assert "--tolerance" in refused.stderr
    assert not (script.parent / "no").exists()


def test_check_prints_every_pair(script: Path) -> None:
    """The certified deviations, and nothing written."""
    done = call("check", script)
    assert done.exit_code == 0
    for pair in ("nurbs~polyline", "nurbs~wavelet", "polyline~wavelet"):
        assert pair in done.stdout
    assert list(script.parent.iterdir()) == [script]


def test_check_fails_when_a_pair_exceeds_the_tolerance(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exit code 1 and the pair by name."""
    from multirep.deviation import Deviation
    from multirep.multirepresentation import MultiRepresentation

    monkeypatch.setattr(MultiRepresentation, "deviation", lambda *_: Deviation(0.0, 0.011))
    done = call("check", script)
    assert done.exit_code == 1
    assert "wave: nurbs~polyline" in done.stderr


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_render_draws_by_the_suffix(script: Path, suffix: str) -> None:
    """SVG always, PNG with matplotlib."""
    pytest.importorskip("matplotlib")
    picture = script.parent / f"picture.{suffix}"
    done = call("render", script, "-o", picture)
    assert done.exit_code == 0, done.output
    assert picture.read_bytes().startswith(b"<svg" if suffix == "svg" else b"\x89PNG")


def test_render_says_what_png_needs(script: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without matplotlib the message names the extra."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    monkeypatch.setitem(sys.modules, "matplotlib.backends.backend_agg", None)
    done = call("render", script, "-o", "p.png")
    assert done.exit_code == 2
    assert "pip install 'multirep[plot]'" in done.stderr
    assert not (script.parent / "p.png").exists()


def test_render_refuses_other_formats(script: Path) -> None:
    """Before any work is done."""
    done = call("render", script, "-o", "p.gif")
    assert done.exit_code == 2
    assert ".svg or .png" in done.stderr


def test_plugins_are_listed_with_parameters() -> None:
    """Every built-in plugin, what it edits, its parameters and where it comes from."""
    done = call("plugins")
    assert done.exit_code == 0, done.output
    for line in ("polyline:", "wavelet:", "spatula:", "edits polyline; from multirep", "radius:"):
        assert line in done.stdout


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (PluginError("tool 'move-vertex' failed with OSError: x", "move-vertex"), 1),
        (ToleranceError("no proof", tolerance=0.1), 1),
    ],
)
def test_work_that_fails_is_not_the_input_s_fault(
    script: Path, monkeypatch: pytest.MonkeyPatch, error: Exception, code: int
) -> None:
    """Exit code 1, the step by its number, nothing written."""
    from multirep.tools import MoveVertex

    def fail(*_: object) -> object:
        raise error

    monkeypatch.setattr(MoveVertex, "edit", fail)
    done = call("run", script)
    assert done.exit_code == code
    assert "wave.toml:9: step 0: " in done.stderr
    assert str(error) in done.stderr
    assert list(script.parent.iterdir()) == [script]


def test_a_conflict_is_told_in_full(script: Path) -> None:
    """Each constraint with its stretch and residual, and the way out, on the terminal."""
    pin = '[[step]]\ncurve = "wave"\nconstrain = "point"\nt = 0.5\npoint = [2, {}]\nname = "{}"\n'
    script.write_text(SCRIPT + pin.format(0, "low") + pin.format(1, "high"))
    done = call("run", script)
    assert done.exit_code == 1
    message, *lines = done.stderr.splitlines()
    assert "step 4: 'high' and 'low' ask for different points at t = 0.5, 1 apart" in message
    assert message.endswith("releasing 'low' lets it through")
    assert [line.split(" on ")[0] for line in lines] == ["  'high'", "  'low'"]
    assert all(line.endswith("off by 1") for line in lines)


def test_a_view_that_fails_at_the_end_writes_nothing(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tolerance that one representation cannot prove: exit code 1, the curve by name."""
    from multirep.multirepresentation import MultiRepresentation

    def fail(*_: object) -> object:
        raise ToleranceError("cannot be proved", tolerance=0.01)

    monkeypatch.setattr(MultiRepresentation, "deviation", fail)
    done = call("run", script)
    assert done.exit_code == 1
    assert "wave: cannot be proved" in done.stderr
    assert list(script.parent.iterdir()) == [script]


def test_an_output_directory_that_cannot_be_made(script: Path) -> None:
    """A file in its place: exit code 2 and its name."""
    (script.parent / "taken").write_text("")
    done = call("run", script, "--out", script.parent / "taken" / "deep")
    assert done.exit_code == 2
    assert "taken" in done.stderr


def test_version_and_help() -> None:
    """The version is that of the package; the help tells the exit codes."""
    assert call("--version").stdout == f"multirep {multirep.__version__}\n"
    text = call("--help").stdout
    assert "Exit codes: 0 done; 1 the work failed; 2 the input is wrong; 130 interrupted." in text
    assert call("no-such-command").exit_code == 2
