"""Files: whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from multirep.errors import ScriptError
from multirep.script.files import read_bytes, read_json, write_all


def test_files_are_written_whole(tmp_path: Path) -> None:
    """Text and bytes arrive, in sub-directories too, with ordinary permissions."""
    made = write_all(tmp_path / "out", {"a.txt": "ä\n", "pictures/b.png": b"\x00"})
    assert made[0].read_bytes() == "ä\n".encode()
    assert made[1].read_bytes() == b"\x00"
    plain = tmp_path / "plain"
    plain.touch()
    assert made[0].stat().st_mode == plain.stat().st_mode


def test_a_failing_write_leaves_the_old_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """When the disk is full for the second file, the first is not replaced; nothing is left."""
    (tmp_path / "a.txt").write_text("old")
    real, calls = os.fsync, []

    def full(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) == 2:
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(ScriptError, match="No space left"):
        write_all(tmp_path, {"a.txt": "new", "b.txt": "new"})
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
    assert (tmp_path / "a.txt").read_text() == "old"


def test_a_directory_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    """A file where the directory should be: the message names it."""
    (tmp_path / "out").write_text("a file")
    with pytest.raises(ScriptError, match="out"):
        write_all(tmp_path / "out", {"a": "b"})


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        (b"{", "not JSON"),
        (b"\xff\xfe", "not UTF-8|not JSON"),
        (b"[" * 100_000, "nested too deeply|not JSON"),
        (b"1" * 5000, "not JSON"),
    ],
)
def test_bad_json_is_refused(content: bytes, problem: str, tmp_path: Path) -> None:
    """Whatever is in a file, reading it ends with data or with one sentence."""
    path = tmp_path / "data.json"
    path.write_bytes(content)
    with pytest.raises(ScriptError, match=problem):
        read_json(path)


def test_a_name_with_nul_is_refused() -> None:
    """A path that no system has is no reason for a traceback."""
    with pytest.raises(ScriptError, match="cannot be read"):
        read_bytes(Path("a\0b"))
