"""The root folders, the links, the package list and the entry points agree."""

from __future__ import annotations

import importlib
import subprocess
import sys
import tomllib
from importlib.metadata import entry_points
from importlib.resources import files
from pathlib import Path

import pytest

import multirep

ROOT = Path(__file__).resolve().parents[1]
OUTER = ("representations", "tools", "constraints")
GROUPS = ("multirep.representations", "multirep.tools", "multirep.constraints")

in_the_checkout = pytest.mark.skipif(
    not (ROOT / "pyproject.toml").exists() or not Path(multirep.__file__).is_relative_to(ROOT),
    reason="the installed package is not the checkout",
)


@in_the_checkout
@pytest.mark.parametrize("name", OUTER)
def test_a_root_folder_is_the_sub_package(name: str) -> None:
    """``multirep.tools`` is the folder ``tools``, and likewise for the others."""
    module = importlib.import_module(f"multirep.{name}")
    assert module.__file__ is not None
    assert Path(module.__file__).resolve().parent == ROOT / name


@pytest.mark.parametrize("name", OUTER)
def test_no_generic_name_is_imported(name: str) -> None:
    """No module exists twice, once as ``tools`` and once as ``multirep.tools``."""
    importlib.import_module(f"multirep.{name}")
    assert name not in sys.modules


@in_the_checkout
@pytest.mark.parametrize("name", OUTER)
def test_a_link_leads_to_the_root_folder(name: str) -> None:
    """Type checkers and doctest find the sub-packages through links (a checkout may lack links)."""
    link = ROOT / "multirep" / name
    if link.is_symlink():
        assert link.resolve() == ROOT / name
        assert not link.readlink().is_absolute()
    else:
        assert link.read_text().strip() == f"../{name}"


@in_the_checkout
def test_every_package_is_shipped() -> None:
    """A folder with Python files is a package that setup.py lists; none is forgotten in a wheel."""
    listing = "import runpy, setuptools; setuptools.setup = lambda **k: print(*k['packages']); "
    listing += "runpy.run_path('setup.py')"
    done = subprocess.run(
        [sys.executable, "-c", listing], cwd=ROOT, capture_output=True, text=True, check=True
    )
    shipped = set(done.stdout.split())
    for folder in ("multirep", *OUTER):
        for module in (ROOT / folder).rglob("*.py"):
            parts = module.relative_to(ROOT).parent.parts
            name = ".".join(parts if parts[0] == "multirep" else ("multirep", *parts))
            assert name in shipped, f"{module} is in no package"


@in_the_checkout
@pytest.mark.parametrize("group", GROUPS)
def test_the_installed_entry_points_are_those_of_pyproject(group: str) -> None:
    """An entry point that was added or removed since the install would be seen by nobody."""
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    found = {
        e.name: e.value for e in entry_points(group=group) if e.dist and e.dist.name == "multirep"
    }
    assert found == declared.get(group, {})


@in_the_checkout
def test_the_versions_agree() -> None:
    """pyproject.toml, CITATION.cff, CHANGELOG.md and ``multirep.__version__`` name one version."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["version"] == multirep.__version__
    assert f"version: {multirep.__version__}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {multirep.__version__}" in (ROOT / "CHANGELOG.md").read_text()


def test_the_package_is_typed() -> None:
    """Type checkers of other projects read the annotations."""
    assert files("multirep").joinpath("py.typed").is_file()
