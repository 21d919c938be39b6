"""Files in and out: bounded when read, whole or not at all when written."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from multirep.errors import ScriptError

#: Largest input file. A million vertices in JSON take some 40 MB; larger input is more likely a
#: mistake.
LARGEST_FILE = 256 * 2**20


def read_bytes(path: Path, *, largest: int = LARGEST_FILE) -> bytes:
    """Read a whole file; ScriptError when it cannot be read or is larger than ``largest`` bytes."""
    try:
        if path.is_dir():
            raise ScriptError("is a directory, expected a file", file=str(path))
        with path.open("rb") as stream:
            data = stream.read(largest + 1)
    except FileNotFoundError:
        raise ScriptError("no such file", file=str(path)) from None
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = getattr(error, "strerror", None) or error
        raise ScriptError(f"cannot be read: {reason}", file=str(path)) from None
    if len(data) > largest:
        raise ScriptError(f"larger than {largest} bytes, the most that is read", file=str(path))
    return data


def read_json(path: Path) -> Any:
    """Read a JSON file; ScriptError when it is not UTF-8, not JSON or nested beyond reason."""
    data = read_bytes(path)
    try:
        return json.loads(data)
    except UnicodeDecodeError:
        raise ScriptError("not UTF-8 text", file=str(path)) from None
    except RecursionError:
        raise ScriptError("nested too deeply", file=str(path)) from None
    except ValueError as error:
        raise ScriptError(f"not JSON: {error}", file=str(path)) from None


def write_all(directory: Path, contents: Mapping[str, str | bytes]) -> tuple[Path, ...]:
    """Write files into a directory, each through a temporary file that is renamed.

    All contents are on the disk before the first is renamed, so a full disk leaves the old files as
    they were.

    Parameters
    ----------
    directory : Path
        Made if missing.
    contents : mapping of str to str or bytes
        Relative file name to content (text is written as UTF-8).

    Returns
    -------
    tuple of Path
        The files, in the order given.

    Raises
    ------
    ScriptError
        When the directory or a file cannot be written.
    """
    written: list[tuple[str, Path]] = []
    try:
        for name, content in contents.items():
            target = directory / name
            target.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(
                prefix=f".{target.name[:60]}.", suffix=".part", dir=target.parent
            )
            written.append((temporary, target))
            with os.fdopen(handle, "wb") as stream:
                stream.write(content.encode() if isinstance(content, str) else content)
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, 0o666 & ~_umask())
        while written:
            temporary, target = written[0]
            os.replace(temporary, target)
            written.pop(0)
    except OSError as error:
        raise ScriptError(
            f"cannot be written: {error.strerror or error}", file=str(error.filename or directory)
        ) from None
    finally:
        for temporary, _ in written:
            Path(temporary).unlink(missing_ok=True)
    return tuple(directory / name for name in contents)


def _umask() -> int:
    """Return the process's file mode mask (mkstemp makes private files; ours are ordinary ones)."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
