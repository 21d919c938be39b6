"""Starting is quick: nothing heavy is imported before it is needed."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

#: What takes long to import.
HEAVY = ("numpy", "scipy", "networkx", "cattrs", "svgelements", "matplotlib")
STARTS = {
    "import multirep": ["-c", "import multirep"],
    "multirep --help": ["-m", "multirep", "--help"],
    "multirep --version": ["-m", "multirep", "--version"],
    "multirep run --help": ["-m", "multirep", "run", "--help"],
}


@pytest.mark.parametrize("what", STARTS)
def test_nothing_heavy_is_imported(what: str) -> None:
    """None of the large packages is loaded by a start."""
    command = [sys.executable, "-X", "importtime", *STARTS[what]]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    loaded = {line.rpartition("|")[2].strip() for line in done.stderr.splitlines()}
    assert "multirep" in loaded
    assert loaded.isdisjoint(HEAVY)


@pytest.mark.parametrize("what", STARTS)
def test_a_start_takes_less_than_a_quarter_of_a_second(what: str) -> None:
    """The best of five; more on a machine that is too slow or busy to start bare Python."""
    best, bare = (
        min(elapsed(arguments) for _ in range(5)) for arguments in (STARTS[what], ["-c", ""])
    )
    assert best < 0.25 * max(1.0, bare / 0.05)


def elapsed(arguments: list[str]) -> float:
    """Measure one start."""
    begin = time.perf_counter()
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
    return time.perf_counter() - begin
