"""Progress on a terminal, as far as the fits of long curves; and Ctrl-C in the middle of one."""

from __future__ import annotations

import io
import json
import os
import signal
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from multirep import bulk, cli

SCRIPT = """
multirep = 1
[[curve]]
name = "wave"
tolerance = 1e-4
points = "wave.json"
[[step]]
curve = "wave"
tool = "insert-knot"
t = 0.3
"""
#: Wipes the line.
WIPE = "\r\x1b[K"


class Terminal(io.StringIO):
    """A stderr that is a terminal; ``heard`` is told what is written to it."""

    def __init__(self, heard: Callable[[str], None] = lambda text: None) -> None:
        super().__init__()
        self.heard = heard

    def isatty(self) -> bool:
        return True

    def write(self, text: str) -> int:
        self.heard(text)
        return super().write(text)

    @property
    def lines(self) -> list[str]:
        """What stood on the line of the progress, one after the other."""
        return self.getvalue().split(WIPE)


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A curve of 400 vertices, which takes seven pieces of a long one."""
    monkeypatch.setattr(bulk, "LONG", 32)
    monkeypatch.setattr(bulk, "PIECE", 64)
    t = np.linspace(0, 12, 400)
    points = np.column_stack([t, np.sin(t)]).tolist()
    (tmp_path / "wave.json").write_text(json.dumps({"points": points}))
    path = tmp_path / "wave.toml"
    path.write_text(SCRIPT)
    monkeypatch.chdir(tmp_path)
    return path


def call(terminal: io.StringIO, monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Run a command with a stderr of one's own; return the exit code."""
    monkeypatch.setattr("sys.stderr", terminal)
    with pytest.raises(SystemExit) as caught:
        cli.main(list(arguments))
    assert isinstance(caught.value.code, int)
    return caught.value.code


def test_a_terminal_is_told_each_piece_of_work_and_how_far_long_fits_are(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One line that is wiped each time, in order; nothing of it is left at the end."""
    terminal = Terminal()
    assert call(terminal, monkeypatch, "check", script.name) == 0
    first, *told, last = terminal.lines
    assert (first, last) == ("", "")
    assert told == [
        "1/3 read wave",
        "2/3 insert-knot",
        *(f"2/3 insert-knot: nurbs {k}/8" for k in range(1, 8)),
        "3/3 bound the deviations of wave",
        # the NURBS is an author now, too, of one short stretch
        *(f"3/3 bound the deviations of wave: wavelet {k}/8" for k in range(1, 8)),
    ]


def test_a_narrow_terminal_gets_lines_that_fit(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A line that wraps could not be wiped off."""
    monkeypatch.setenv("COLUMNS", "20")
    terminal = Terminal()
    assert call(terminal, monkeypatch, "check", script.name) == 0
    assert max(map(len, terminal.lines)) == 19


def test_a_pipe_is_told_nothing(script: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where stderr is no terminal nothing is written to it."""
    pipe = io.StringIO()
    assert call(pipe, monkeypatch, "check", script.name) == 0
    assert pipe.getvalue() == ""


@pytest.mark.parametrize("during", ["read wave", "insert-knot: nurbs 3/8", "wavelet 5/8"])
@pytest.mark.parametrize(
    "command", [("run", "--out", "out"), ("check",), ("render", "-o", "wave.svg")]
)
def test_an_interrupt_ends_with_one_sentence_and_nothing_written(
    script: Path, monkeypatch: pytest.MonkeyPatch, during: str, command: tuple[str, ...]
) -> None:
    """Ctrl-C while a long fit goes on: exit code 130, as shells have it, and no traceback."""

    def interrupt(text: str) -> None:
        if during in text:
            signal.raise_signal(signal.SIGINT)

    terminal = Terminal(interrupt)
    before = sorted(os.listdir())
    name, *options = command
    assert call(terminal, monkeypatch, name, script.name, *options) == 130
    assert terminal.lines[-1] == "multirep: interrupted; no file was left half-written\n"
    assert sorted(os.listdir()) == before


def test_an_interrupt_while_files_are_written_leaves_none(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second of two files is interrupted: those before it are taken away again."""
    synchronised: list[int] = []

    def sync(handle: int) -> None:
        synchronised.append(handle)
        if len(synchronised) == 2:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr("multirep.script.files.os.fsync", sync)
    assert call(Terminal(), monkeypatch, "run", script.name, "--out", "out") == 130
    assert os.listdir("out") == []
