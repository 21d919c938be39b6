"""The README's code runs as it stands."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest

README = Path(__file__).resolve().parents[1] / "README.md"
pytestmark = pytest.mark.skipif(not README.exists(), reason="there is no checkout")


def blocks(language: str) -> list[str]:
    """Return the fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", README.read_text(), re.DOTALL | re.MULTILINE)


def test_the_code_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All Python blocks in order, in one namespace: what they print is what is written."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    parser = doctest.DocTestParser()
    found = blocks("python")
    assert len(found) >= 3
    for number, block in enumerate(found):
        if ">>>" in block:
            test = parser.get_doctest(block, names, f"README block {number}", str(README), 0)
            runner.run(test, clear_globs=False)
            names = test.globs
        else:
            exec(compile(block, f"README block {number}", "exec"), names)
    assert runner.summarize().failed == 0


def test_the_growth_of_an_edit_is_what_was_measured() -> None:
    """The README promises no more than the worst drag step of the performance page keeps."""
    [promised] = re.findall(r"takes at most (\d+) times what it takes of 1 000", README.read_text())
    page = (README.parent / "docs" / "performance.md").read_text()
    [row] = re.findall(r"^\| drag step .*t\(10⁶\) : t\(10³\).*$", page, re.MULTILINE)
    _, _, _, at_worst, *_, worst, _ = [cell.strip() for cell in row.split("|")]
    assert float(at_worst) <= float(promised), worst
    assert "n = 1 000 000" in worst


def test_a_tool_takes_twenty_lines() -> None:
    """The README's plugin is as short as it says."""
    [plugin] = [block for block in blocks("python") if "mr.Tool[" in block]
    assert len(plugin.strip().splitlines()) <= 20


def test_every_file_that_is_linked_is_there() -> None:
    """Links to files of the project lead somewhere, the picture among them."""
    targets = re.findall(r"\]\((?!https?:|#)([^)#]+)", README.read_text())
    assert "docs/cat.svg" in targets
    for target in targets:
        assert (README.parent / target).exists(), target


def test_the_script_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The TOML block is a script that `multirep run` takes."""
    from click.testing import CliRunner

    from multirep.cli import main

    monkeypatch.chdir(tmp_path)
    [script] = blocks("toml")
    (tmp_path / "wave.toml").write_text(script)
    done = CliRunner().invoke(main, ["run", "wave.toml"])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "wave-out" / "wave.svg").is_file()


@pytest.mark.parametrize("family", ["tools", "constraints"])
def test_every_plugin_has_a_row(family: str) -> None:
    """The tables name all tools and constraints, and nothing else."""
    from multirep.registry import Registry

    heading = {"tools": "| tool |", "constraints": "| constraint |"}[family]
    [table] = [part for part in README.read_text().split("\n\n") if part.startswith(heading)]
    first = "".join(row.split("|")[1] for row in table.splitlines()[2:])
    assert sorted(re.findall(r"`([^`]+)`", first)) == list(getattr(Registry.discover(), family))
