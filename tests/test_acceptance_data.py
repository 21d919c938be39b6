"""The ε contract on real input: every curve of tests/data, at three tolerances."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from acceptance import problems
from attrs import evolve
from click.testing import CliRunner
from corpus import Entry, corpus

from multirep.cli import main
from multirep.registry import Registry
from multirep.script.model import PointsSource, Script
from multirep.script.reading import read_script
from multirep.script.report import geometry, report, to_json
from multirep.script.running import run

ENTRIES = {entry.name: entry for entry in corpus()}
#: Every 38th: some of each kind, 25 in all.
SPREAD = list(ENTRIES)[::38]
#: Only at 1e-3: 81 340 vertices.
LARGEST = "land-10m/ring0@-180.0,65.1"
TOLERANCES = (1e-2, 1e-3, 1e-4)


def _read(entry: Entry, folder: Path, relative: float) -> Script:
    """Read a curve, with a tolerance relative to the larger side of its bounding box."""
    script = read_script(entry.write(folder), Registry.discover())
    [curve] = script.curves
    source = curve.source
    points = np.array(source.points)
    if not isinstance(source, PointsSource):
        from acceptance import _nurbs

        weights = source.weights or [1.0] * len(points)
        data = {
            "degree": source.degree,
            "knots": source.knots,
            "points": points,
            "weights": weights,
        }
        start, stop = source.knots[source.degree], source.knots[-source.degree - 1]
        points = _nurbs(data, start, stop)[0](np.linspace(start, stop, 1001))
    size = float(np.ptp(points, axis=0).max())
    return evolve(script, curves=(evolve(curve, tolerance=relative * size),))


def _problems(entry: Entry, folder: Path, relative: float, parameters: int) -> list[str]:
    result = run(_read(entry, folder, relative), Registry.discover())
    written: list[Any] = [json.loads(to_json(part(result))) for part in (geometry, report)]
    return problems(*written, parameters=parameters)


@pytest.mark.parametrize("name", SPREAD)
def test_a_spread_of_real_curves_is_within_every_tolerance(name: str, tmp_path: Path) -> None:
    """All pairs of representations are as close as was proved, seen with scipy alone."""
    for relative in TOLERANCES:
        assert _problems(ENTRIES[name], tmp_path, relative, 4000) == []


@pytest.mark.slow
@pytest.mark.parametrize("relative", TOLERANCES)
def test_every_real_curve_is_within_the_tolerance(relative: float, tmp_path: Path) -> None:
    """No curve of the corpus is refused, and none is farther apart than was proved."""
    failed = {}
    for name, entry in ENTRIES.items():
        if name != LARGEST or relative == 1e-3:
            found = _problems(entry, tmp_path, relative, 1500)
            if found:
                failed[name] = found
    assert failed == {}


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
    assert "dot.toml: curve[0]" in done.stderr
    assert "two distinct points" in done.stderr
    assert not (tmp_path / "out").exists()


def test_the_checker_sees_a_broken_contract(tmp_path: Path) -> None:
    """The independent check fails when a representation is moved by more than the tolerance."""
    result = run(_read(ENTRIES[SPREAD[0]], tmp_path, 1e-3), Registry.discover())
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
