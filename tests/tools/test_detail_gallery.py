"""The worked examples of the detail tools run, and do what their comments say."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from multirep.cli import main

GALLERY = Path(__file__).resolve().parents[2] / "docs" / "gallery"


@pytest.mark.slow
@pytest.mark.parametrize("name", ["smooth", "copy-detail", "show-level"])
def test_the_example_runs(name, tmp_path):
    """All steps are done, every pair of representations is within the tolerance, pictures exist."""
    ran = CliRunner().invoke(main, ["run", str(GALLERY / f"{name}.toml"), "--out", str(tmp_path)])
    assert ran.exit_code == 0, ran.output
    report = json.loads((tmp_path / "report.json").read_text())
    assert len(list(tmp_path.glob("*.svg"))) == (3 if name == "show-level" else 1)
    assert len(report["steps"]) == (3 if name == "show-level" else 1)
