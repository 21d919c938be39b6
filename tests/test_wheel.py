"""The built wheel, apart from the checkout: on this Python, and on a newer one if there is any."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ("multirep", "representations", "tools", "constraints")
#: The C files of the compiled core.
CORE = "core"
BUILT_FROM = ("pyproject.toml", "setup.py", "README.md", "LICENSE")
#: Tests that need no checkout around them, and stand for the numerics, the kernel and the scripts.
SUBSET = ("splines", "kernel", "script", "cli/test_commands.py")

pytestmark = pytest.mark.skipif(
    not (ROOT / "pyproject.toml").exists(), reason="there is no checkout to build from"
)

#: Run apart from the checkout: which plugins there are, an example, where modules come from.
PROBE = """
import sys
from pathlib import Path
import multirep
from multirep.cli import main
from multirep.registry import Registry
from multirep.splines import compiled

registry = Registry.discover()
for family in (registry.representations, registry.tools, registry.constraints):
    print("plugins", *(family[name].name for name in family))
print("compiled", compiled.active)
main(["run", sys.argv[1], "--out", "out"], standalone_mode=False)
for module in list(sys.modules.values()):
    if getattr(module, "__name__", "").split(".")[0] == "multirep":
        print("from", module.__file__)
"""


def run(command: Sequence[str | Path], cwd: Path, **variables: str) -> str:
    """Run a program without what points at the checkout; return what it prints."""
    unwanted = ("PYTHONPATH", "MYPYPATH", "PYTHONHOME", "VIRTUAL_ENV")
    environment = {key: value for key, value in os.environ.items() if key not in unwanted}
    done = subprocess.run(
        [str(part) for part in command],
        cwd=cwd,
        env=environment | variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def copied(copy: Path) -> Path:
    """Copy what is built from, so that nothing is left in the checkout."""
    clutter = shutil.ignore_patterns("__pycache__", "*.so", "*.pyd")
    for folder in (*SOURCES, CORE):
        shutil.copytree(ROOT / folder, copy / folder, symlinks=True, ignore=clutter)
    for file in BUILT_FROM:
        shutil.copy(ROOT / file, copy)
    return copy


def build(tmp_path_factory: pytest.TempPathFactory, **variables: str) -> Path:
    """Build the wheel from a copy."""
    copy = copied(tmp_path_factory.mktemp("source"))
    target = tmp_path_factory.mktemp("wheel")
    wheel = [sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", target, copy]
    run(wheel, target, **variables)
    [built] = target.glob("multirep-*.whl")
    return built


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel as it comes out here, with the compiled core if there is a compiler."""
    return build(tmp_path_factory)


def has_core(wheel: Path) -> bool:
    """Whether a wheel carries the compiled core."""
    names = zipfile.ZipFile(wheel).namelist()
    return any(name.startswith("multirep/splines/_core.") and name[-3:] != "pyi" for name in names)


@pytest.fixture
def apart(tmp_path: Path) -> Path:
    """A folder with the examples and nothing else of the checkout."""
    shutil.copytree(ROOT / "examples", tmp_path / "examples")
    return tmp_path


def check_probe(printed: str, site: Path, compiled: bool) -> None:
    """Check what the probe printed: all plugins, all modules from the wheel, an example done."""
    lines = [line.split() for line in printed.splitlines()]
    representations, tools, _ = (line[1:] for line in lines if line[:1] == ["plugins"])
    assert {"polyline", "nurbs", "wavelet"} <= set(representations)
    assert {"move-vertex", "set-weight", "sweep", "spatula"} <= set(tools)
    assert [str(compiled)] in [line[1:] for line in lines if line[:1] == ["compiled"]]
    modules = [Path(line[1]) for line in lines if line[:1] == ["from"]]
    assert len(modules) > 20
    assert all(module.is_relative_to(site) for module in modules)


def test_the_wheel_works_apart_from_the_checkout(wheel: Path, apart: Path) -> None:
    """Plugins are found, an example runs, and nothing comes from the source tree."""
    site = apart / "site"
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", site, wheel]
    run(pip, apart)
    assert not [name for name in SOURCES[1:] if (site / name).exists()], "a generic name is shipped"
    path = {"PYTHONPATH": str(site)}
    version = run([sys.executable, "-m", "multirep", "--version"], apart, **path)
    assert version.split() == ["multirep", wheel.name.split("-")[1]]
    printed = run([sys.executable, "-c", PROBE, "examples/airfoil.toml"], apart, **path)
    check_probe(printed, site, has_core(wheel))
    for name in ("report.json", "geometry.json", "airfoil.svg"):
        assert (apart / "out" / name).is_file()


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no compiler")
def test_the_wheel_carries_the_core_if_there_is_a_compiler(wheel: Path) -> None:
    """One build for every Python from 3.11 on; the C files stay at home."""
    assert has_core(wheel)
    assert "-cp311-abi3-" in wheel.name
    assert not [name for name in zipfile.ZipFile(wheel).namelist() if name.endswith((".c", ".h"))]


def test_the_source_distribution_has_all_that_the_core_is_built_from(tmp_path: Path) -> None:
    """C files, headers, and the interface whose checksum goes into the core."""
    pytest.importorskip("setuptools")
    copy = copied(tmp_path)
    run([sys.executable, "setup.py", "-q", "sdist"], copy)
    [built] = (copy / "dist").glob("multirep-*.tar.gz")
    with tarfile.open(built) as archive:
        names = {Path(*Path(name).parts[1:]) for name in archive.getnames()}
    sources = {path.relative_to(ROOT) for path in (ROOT / CORE).iterdir()}
    assert names >= sources | {Path("setup.py"), Path("multirep/splines/_core.pyi")}


@pytest.mark.skipif(os.name == "nt", reason="compilers are found in another way there")
def test_a_wheel_without_the_core_works(
    tmp_path_factory: pytest.TempPathFactory, apart: Path
) -> None:
    """A compiler that fails stops nothing: numpy does the same work."""
    bare = build(tmp_path_factory, CC="false")
    assert not has_core(bare)
    site = apart / "site"
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", site, bare]
    run(pip, apart)
    path = {"PYTHONPATH": str(site)}
    printed = run([sys.executable, "-c", PROBE, "examples/airfoil.toml"], apart, **path)
    check_probe(printed, site, compiled=False)


def newer_python() -> Path | None:
    """Return the newest other Python from 3.12 on that can make virtual environments."""
    found: dict[tuple[int, int], Path] = {}
    versions = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    candidates = [shutil.which(f"python3.{minor}") for minor in range(12, 20)]
    candidates += [str(path) for path in versions.glob("3.*/bin/python3")]
    ask = "import sys, venv, ensurepip; print(sys.version_info[0], sys.version_info[1])"
    for candidate in filter(None, candidates):
        done = subprocess.run([candidate, "-c", ask], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            major, minor = map(int, done.stdout.split())
            if (3, 12) <= (major, minor) != sys.version_info[:2]:
                found[major, minor] = Path(candidate)
    return found[max(found)] if found else None


@pytest.mark.slow
def test_the_wheel_works_on_the_newer_numpy_stack(wheel: Path, apart: Path) -> None:
    """Python 3.12 and newer get other versions of numpy and scipy; the wheel works there, too."""
    python = newer_python()
    if python is None:
        pytest.skip("no Python from 3.12 on beside this one")
    run([python, "-m", "venv", apart / "venv"], apart)
    binaries = apart / "venv" / ("Scripts" if os.name == "nt" else "bin")
    there = binaries / "python"
    run([there, "-m", "pip", "install", "-q", f"{wheel}[testing]"], apart)
    assert run([binaries / "multirep", "--version"], apart).startswith("multirep ")
    printed = run([there, "-c", PROBE, "examples/airfoil.toml"], apart)
    check_probe(printed, apart / "venv", has_core(wheel))
    shutil.copytree(ROOT / "tests", apart / "tests")
    (apart / "pytest.ini").write_text("[pytest]\nmarkers = slow\n")
    chosen = [Path("tests") / part for part in SUBSET]
    print(run([there, "-m", "pytest", "-q", "-p", "no:cacheprovider", *chosen], apart)[-300:])
