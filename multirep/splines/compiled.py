"""Whether the compiled core is there: the same mathematics in one call instead of dozens.

An edit works on short arrays, where a numpy call costs more than its arithmetic. The core, the C
files in the project's folder ``core``, takes over there; the numpy functions stay as its reference
and do all the work where the core was not built or ``MULTIREP_PURE`` is set in the environment.

An editable install does not build the core anew when its sources change. One that was built for
other functions than those of ``_core.pyi`` is not used: it would fail in the middle of an edit, or
worse, not fail.
"""

import os
import warnings
import zlib
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

__all__ = ["active", "core", "fitting"]

_PURE = bool(os.environ.get("MULTIREP_PURE"))


def fitting(built: ModuleType, interface: Path) -> ModuleType | None:
    """Return a core if it was built for an interface; else None, with a RuntimeWarning.

    Parameters
    ----------
    built : module
        Its ``INTERFACE`` is a checksum, which setup.py has put there.
    interface : Path
        The stub file that says what the core offers; without it, nothing can be told.
    """
    try:
        wanted = zlib.crc32(interface.read_bytes()) & 0x7FFFFFFF  # as in setup.py
    except OSError:
        return built
    if getattr(built, "INTERFACE", None) == wanted:
        return built
    if not _PURE:
        warnings.warn(
            f"the compiled core, {built.__file__}, was built for another version of multirep and "
            "is left out: numpy does the same work, five to eight times as slowly. Build it anew, "
            "in a checkout with 'pip install -e .', elsewhere with "
            "'pip install --force-reinstall --no-deps multirep'",
            RuntimeWarning,
            stacklevel=2,
        )
    return None


if TYPE_CHECKING:
    from multirep.splines import _core as core
else:
    try:
        from multirep.splines import _core
    except ImportError:
        core = None
    else:
        core = fitting(_core, Path(__file__).with_name("_core.pyi"))

#: Whether functions hand their work to the core.
active: bool = core is not None and not _PURE
