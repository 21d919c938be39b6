"""The ε contract on real input: every curve of tests/data, at three tolerances."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from acceptance import problems, read_nurbs
from attrs import asdict, evolve
from click.testing import CliRunner
from corpus import KINDS, ONE_POINT, Entry, corpus

from multirep.cli import main
from multirep.errors import ScriptError
from multirep.registry import Registry
from multirep.script.model import PointsSource, Script
from multirep.script.reading import read_script
from multirep.script.report import geometry, report, to_json
from multirep.script.running import Result, run

ENTRIES = {entry.name: entry for entry in corpus()}
#: Every 38th: some of each kind, 25 in all.
SPREAD = list(ENTRIES)[::38]
#: Only at 1e-3: 81 340 vertices.
LARGEST = "land-10m/ring0@-180.0,65.1"
TOLERANCES = (1e-2, 1e-3, 1e-4)


def _read(entry: Entry, folder: Path) -> tuple[Script, float]:
    """Read a curve; return the script and the larger side of the curve's bounding box."""
    script = read_script(entry.write(folder), Registry.discover())
    source = script.curves[0].source
    points = np.array(source.points)
    if not isinstance(source, PointsSource):
        data = {**asdict(source), "weights": source.weights or [1.0] * len(points)}
        start, stop = source.knots[source.degree], source.knots[-source.degree - 1]
        points = read_nurbs(data, start, stop)[0](np.linspace(start, stop, 1001))
    return script, float(np.ptp(points, axis=0).max())


def _run(script: Script, tolerance: float) -> Result:
    curves = tuple(evolve(curve, tolerance=tolerance) for curve in script.curves)
    return run(evolve(script, curves=curves), Registry.discover())


def _failed(entry: Entry, folder: Path, parameters: int) -> list[str]:
    """Return what breaks the contract at any tolerance."""
    script, size = _read(entry, folder)
    found: list[str] = []
    for relative in TOLERANCES if entry.name != LARGEST else TOLERANCES[1:2]:
        result = _run(script, relative * size)
        written: list[Any] = [json.loads(to_json(part(result))) for part in (geometry, report)]
        found += problems(*written, parameters=parameters)
    return found


@pytest.mark.parametrize("name", SPREAD)
def test_a_spread_of_real_curves_is_within_every_tolerance(name: str, tmp_path: Path) -> None:
    """All pairs of representations are as close as was proved, seen with scipy alone."""
    assert _failed(ENTRIES[name], tmp_path, 4000) == []


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_real_curve_is_within_every_tolerance(kind: str, tmp_path: Path) -> None:
    """No curve of the corpus is refused, and none is farther apart than was proved."""
    entries = [e for e in ENTRIES.values() if e.kind == kind and e.name not in ONE_POINT]
    failed = {entry.name: _failed(entry, tmp_path, 1500) for entry in entries}
    assert {name: found for name, found in failed.items() if found} == {}


@pytest.mark.parametrize("name", ONE_POINT)
def test_a_sub_path_of_one_point_is_refused(name: str, tmp_path: Path) -> None:
    """The two anchors in the glyphs are no curves; the message says which sub-path and why."""
    with pytest.raises(ScriptError, match=r"sub-path 1 of .* single point, which is not a curve"):
        _read(ENTRIES[name], tmp_path)


def test_the_corpus_is_complete() -> None:
    """Sub-paths of 60 icons, 84 of glyphs, 534 strokes, 30 airfoils, 5 rings, 34 NURBS curves."""
    assert len(ENTRIES) == 262 + 84 + 534 + 30 + 5 + 34
    assert ENTRIES[LARGEST].vertices == 81341


@pytest.mark.parametrize("points", ["[[3.0, 4.0]]", "[[3.0, 4.0], [3.0, 4.0]]"])
def test_a_stroke_of_one_point_is_refused(points: str, tmp_path: Path) -> None:
    """A single point is not a curve; the message says so and nothing is written."""
    script = tmp_path / "dot.toml"
    script.write_text(
        f'multirep = 1\n[[curve]]\nname = "dot"\ntolerance = 0.1\npoints = {points}\n'
    )
    done = CliRunner().invoke(main, ["run", str(script), "--out", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert "dot.toml:2: curve[0]" in done.stderr
    assert "two distinct points" in done.stderr
    assert not (tmp_path / "out").exists()


def test_the_checker_sees_a_broken_contract(tmp_path: Path) -> None:
    """The independent check fails when a representation is moved by more than the tolerance."""
    script, size = _read(ENTRIES[SPREAD[0]], tmp_path)
    result = _run(script, 1e-3 * size)
    written, stated = geometry(result), report(result)
    moved = np.array(written["curves"]["curve"]["wavelet"]["points"])
    moved += 1.1 * result.curves[0].tolerance
    written["curves"]["curve"]["wavelet"]["points"] = moved.tolist()
    assert len(problems(written, stated)) == 2


def test_the_checker_runs_alone(tmp_path: Path) -> None:
    """The checker is a program too, for directories that `multirep run` wrote."""
    script = ENTRIES[SPREAD[3]].write(tmp_path, 0.05)
    out = tmp_path / "out"
    assert CliRunner().invoke(main, ["run", str(script), "--out", str(out)]).exit_code == 0
    checker = Path(__file__).with_name("acceptance.py")
    done = subprocess.run(
        [sys.executable, checker, out], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
