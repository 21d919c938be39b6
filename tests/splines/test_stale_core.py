"""A compiled core that was built for other functions than those that are called is left out."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
import warnings
from pathlib import Path
from types import ModuleType

import pytest

from multirep.splines import compiled

ROOT = Path(__file__).resolve().parents[2]
INTERFACE = Path(compiled.__file__).with_name("_core.pyi")

#: Looks at all views with a core in the way that was built long ago.
PROBE = """
import sys, types, warnings

old = types.ModuleType("multirep.splines._core")
old.__file__ = "_core.abi3.so"
sys.modules[old.__name__] = old
with warnings.catch_warnings(record=True) as told:
    warnings.simplefilter("always")
    from multirep.splines import compiled
    import multirep as mr

    curve = mr.MultiRepresentation.from_points([[0, 0], [1, 2], [2, 0]], tolerance=1e-2)
    sizes = [curve.view(kind).size > 0 for kind in curve.kinds]
print(compiled.core, compiled.active, all(sizes), *[one.category.__name__ for one in told])
"""


def stamped(**stamp: int) -> ModuleType:
    """Return a core with a stamp, or without one, as those from before there were stamps."""
    core = ModuleType("_core")
    core.__file__ = "_core.abi3.so"
    vars(core).update(stamp)
    return core


@pytest.mark.skipif(compiled.core is None, reason="the core was not built")
def test_the_core_that_was_built_fits() -> None:
    """Its stamp is a checksum of the interface as it lies there."""
    assert compiled.fitting(compiled.core, INTERFACE) is compiled.core


@pytest.mark.parametrize("stamp", [{}, {"INTERFACE": 1}])
def test_a_stale_core_is_left_out_with_a_warning(
    stamp: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It names the file and says how to build it anew; where numpy was asked for, nothing."""
    monkeypatch.setattr(compiled, "_PURE", False)
    with pytest.warns(RuntimeWarning, match=r"_core\.abi3\.so.*pip install -e \."):
        assert compiled.fitting(stamped(**stamp), INTERFACE) is None
    monkeypatch.setattr(compiled, "_PURE", True)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert compiled.fitting(stamped(**stamp), INTERFACE) is None


def test_without_the_stub_nothing_can_be_told(tmp_path: Path) -> None:
    """Who ships no stub files has built the core from the same sources."""
    core = stamped()
    assert compiled.fitting(core, tmp_path / "_core.pyi") is core


def test_views_work_with_a_stale_core_in_the_way() -> None:
    """Numpy does it all, and there is one warning, not one a call."""
    environment = {name: value for name, value in os.environ.items() if name != "MULTIREP_PURE"}
    done = subprocess.run(
        [sys.executable, "-c", PROBE],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["None", "False", "True", "RuntimeWarning"]


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no compiler")
def test_another_interface_is_built_anew(tmp_path: Path) -> None:
    """Though no C file is newer than what was built from it."""
    if not (ROOT / "setup.py").exists():
        pytest.skip("there is no checkout to build from")
    clutter = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    for folder in ("multirep", "core", "representations", "tools", "constraints"):
        shutil.copytree(ROOT / folder, tmp_path / folder, symlinks=True, ignore=clutter)
    shutil.copy(ROOT / "setup.py", tmp_path)
    stub = tmp_path / "multirep" / "splines" / "_core.pyi"

    def fits() -> str:
        build = [sys.executable, "setup.py", "-q", "build_ext", "--inplace"]
        subprocess.run(build, cwd=tmp_path, capture_output=True, check=True)
        ask = "from multirep.splines import compiled; print(compiled.core is not None)"
        command = [sys.executable, "-W", "error", "-c", ask]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    assert fits() == "True"
    stub.write_text(stub.read_text() + "\nANOTHER: int\n")
    later = time.time() + 2.0  # builds compare whole seconds
    os.utime(stub, (later, later))
    assert fits() == "True"
