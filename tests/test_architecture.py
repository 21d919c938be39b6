"""The layout of DESIGN section 11, checked: arrows, suites, entry points, sizes, names, docstrings.

Sources are parsed, not imported, so a forbidden import is found inside a function too.
"""

from __future__ import annotations

import ast
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import attrs
import pytest

ROOT = Path(__file__).resolve().parent.parent
FAMILIES = ("representations", "tools", "constraints")
#: A file longer than this must say in its docstring why it is so long.
LONGEST = 400
#: Names that say nothing about what is inside.
NAMELESS = {"utils", "util", "common", "helpers", "helper", "misc", "shared", "core"}
#: Imported late, because they cost more than everything else together.
SLOW = ("scipy", "networkx", "matplotlib", "cattrs", "svgelements")
#: Public functions for which a tolerance is the subject and not an accuracy.
TOLERANCE_IS_THE_SUBJECT = {
    "multirep.framework.Framework.set_tolerance",
    "multirep.multirepresentation.MultiRepresentation.tolerance",
    "multirep.sampled.SampledSplice.allowance",
    "multirep.session.Session.set_tolerance",
    "multirep.synchronization.hop",
    "multirep.tightening.with_tolerance",
}


@attrs.frozen
class Source:
    """A parsed module."""

    name: str
    path: Path
    tree: ast.Module
    lines: int

    @property
    def imports(self) -> Iterator[tuple[str, int]]:
        """Every imported module or name, absolute, with its line."""
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Import):
                yield from ((alias.name, node.lineno) for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{self.path}:{node.lineno}: a relative import"
                yield from ((f"{node.module}.{alias.name}", node.lineno) for alias in node.names)
            elif (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name | ast.Attribute)
                and getattr(node.func, "id", getattr(node.func, "attr", "")) == "import_module"
                and isinstance(node.args[0], ast.Constant)
            ):
                yield str(node.args[0].value), node.lineno


def sources() -> list[Source]:
    """Every module of the package, the three folders under their import names."""
    found = []
    for folder in ("multirep", *FAMILIES):
        top = ROOT / folder
        for path in sorted(top.rglob("*.py")):
            below = path.relative_to(top).with_suffix("").parts
            if folder == "multirep" and below[0] in FAMILIES:
                continue  # the links to the folders beside it
            parts = [*(["multirep"] if folder != "multirep" else []), folder, *below]
            name = ".".join(parts).removesuffix(".__init__")
            text = path.read_text(encoding="utf-8")
            found.append(Source(name, path, ast.parse(text), text.count("\n")))
    return found


SOURCES = sources()
each_source = pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.name)


def inside(name: str, package: str) -> bool:
    """Whether a module or name is ``package`` or lies in it."""
    return name == package or name.startswith(f"{package}.")


def family_of(name: str) -> str | None:
    """The family that a module or name belongs to."""
    return next((f for f in FAMILIES if inside(name, f"multirep.{f}")), None)


def may_import(importer: str, imported: str) -> bool:
    """Whether an arrow from one module to another is one of DESIGN section 11."""
    if inside(imported, "tests"):
        return False
    if not inside(imported, "multirep"):
        return imported.split(".")[0] not in FAMILIES  # `import tools` would be a second copy
    if inside(importer, "multirep.testing"):
        return True
    if inside(imported, "multirep.testing"):
        return False
    mine, theirs = family_of(importer), family_of(imported)
    if inside(importer, "multirep.splines"):
        return inside(imported, "multirep.splines") or inside(imported, "multirep.arrays")
    if mine is None:
        return theirs is None
    if theirs is None or importer == f"multirep.{mine}":
        return theirs in (None, mine)
    if mine == theirs == "representations":  # each knows itself and no other
        return inside(imported, ".".join(importer.split(".")[:3]))
    return theirs in (mine, "representations")


@each_source
def test_arrows_point_to_the_kernel(source: Source) -> None:
    """Kernel: no family. Representations: the kernel. Tools, constraints: both. Nobody: tests."""
    wrong = [
        f"{name} (line {line})"
        for name, line in source.imports
        if not may_import(source.name, name)
    ]
    assert not wrong, f"{source.name} must not import {', '.join(wrong)}"


@pytest.mark.parametrize(
    ("importer", "imported", "allowed"),
    [
        ("multirep.framework", "multirep.tool.Tool", True),
        ("multirep.framework", "multirep.tools.MoveVertex", False),
        ("multirep.registry", "multirep.representations", False),
        ("multirep.script.reading", "multirep.testing.laws", False),
        ("multirep.splines.basis", "multirep.interval.Interval", False),
        ("multirep.splines.basis", "multirep.arrays.Array", True),
        ("multirep.representations.nurbs.curve", "multirep.splines.basis", True),
        ("multirep.representations.nurbs.curve", "multirep.representations.nurbs.changes", True),
        ("multirep.representations.nurbs.curve", "multirep.representations.polyline", False),
        ("multirep.representations.nurbs.curve", "multirep.tools.MoveVertex", False),
        ("multirep.tools.sweep", "multirep.representations.Nurbs", True),
        ("multirep.tools.sweep", "multirep.constraints.Freeze", False),
        ("multirep.constraints.freeze", "multirep.representations.nurbs.Nurbs", True),
        ("multirep.constraints.freeze", "multirep.constraints.condition.Condition", True),
        ("multirep.tools.sweep", "tests.suites", False),
        ("multirep.tools.sweep", "tools.spatula", False),
        ("multirep.testing.laws", "multirep.representations.Nurbs", True),
        ("multirep.testing.laws", "tests.conftest", False),
    ],
)
def test_the_arrows_are_what_the_design_says(importer: str, imported: str, allowed: bool) -> None:
    """The rule itself, on examples: allowed and forbidden ones."""
    assert may_import(importer, imported) is allowed


@each_source
def test_slow_packages_are_imported_late(source: Source) -> None:
    """No module of the kernel or of a family imports them at its top level."""
    if inside(source.name, "multirep.testing"):
        return
    for node in source.tree.body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                slow = name.split(".")[0] in SLOW and source.name != "multirep.script.strict"
                assert not slow, f"{source.name}:{node.lineno} imports {name} when it is imported"


@each_source
def test_long_files_say_why(source: Source) -> None:
    """Past 400 lines the docstring of the module must give the reason."""
    if source.lines > LONGEST:
        text = ast.get_docstring(source.tree) or ""
        assert re.search(r"\blines\b|\blong\b", text), f"{source.name} has {source.lines} lines"


@each_source
def test_names_say_what_is_inside(source: Source) -> None:
    """No module is called utils, common, helpers or the like."""
    assert not set(source.name.split(".")) & NAMELESS


def public(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef | ast.ClassDef]]:
    """Public functions, classes and methods of a module, with their qualified names."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_"):
            yield node.name, node
            if isinstance(node, ast.ClassDef):
                for member in node.body:
                    if isinstance(member, ast.FunctionDef) and not member.name.startswith("_"):
                        yield f"{node.name}.{member.name}", member


@each_source
def test_public_objects_have_docstrings(source: Source) -> None:
    """Modules, classes, functions and methods; overloads are documented once."""
    assert ast.get_docstring(source.tree), f"{source.name} has no docstring"
    for name, node in public(source.tree):
        overload = any(getattr(d, "id", "") == "overload" for d in node.decorator_list)
        setter = any(getattr(d, "attr", "") == "setter" for d in node.decorator_list)
        validator = any(getattr(d, "attr", "") == "validator" for d in node.decorator_list)
        if not (overload or setter or validator):
            assert ast.get_docstring(node), f"{source.name}.{name} has no docstring"


@each_source
def test_tolerances_are_keyword_only(source: Source) -> None:
    """`curve.sample(interval, 1e-3)` must not work: accuracy is said by name.

    In a family only the methods of the plugins are public, not the functions behind them.
    """
    own = {name for family in FAMILIES for name in plugins(family)}
    for name, node in public(source.tree):
        if family_of(source.name) and name.split(".")[0] not in own:
            continue
        if source.name == "multirep.cli":  # commands: click passes everything by name
            continue
        if (
            isinstance(node, ast.FunctionDef)
            and f"{source.name}.{name}" not in TOLERANCE_IS_THE_SUBJECT
        ):
            positional = [a.arg for a in (*node.args.posonlyargs, *node.args.args)]
            assert "tolerance" not in positional, f"{source.name}.{name}"


# -- plugins ---------------------------------------------------------------------------------------

BASES = {"representations": "Representation", "tools": "Tool", "constraints": "Constraint"}
SUITES = {
    "representations": ("RepresentationSuite", "representation"),
    "tools": ("ToolSuite", "tool"),
    "constraints": ("ConstraintSuite", "constraint"),
}


def base_name(node: ast.expr) -> str:
    """The last name of a base class: `mr.Tool[Polyline]` is a Tool."""
    if isinstance(node, ast.Subscript):
        node = node.value
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")


@cache
def plugins(family: str) -> dict[str, tuple[str, str]]:
    """Plugin classes of a built-in family: class name -> (its `name`, its module).

    A class that derives from the base of the family, perhaps through others (of the kernel, too),
    and sets `name`.
    """
    found = {}
    derived = {BASES[family]}
    classes = [(s, node) for s in SOURCES for node in s.tree.body if isinstance(node, ast.ClassDef)]
    known = 0
    while known < len(derived):
        known = len(derived)
        derived |= {node.name for _, node in classes if derived & set(map(base_name, node.bases))}
    for source, node in classes:
        if family_of(source.name) == family and node.name in derived:
            for statement in node.body:
                target = (
                    getattr(statement, "target", None) or getattr(statement, "targets", [None])[0]
                )
                value = getattr(statement, "value", None)
                if getattr(target, "id", "") == "name" and isinstance(value, ast.Constant):
                    found[node.name] = (value.value, source.name)
    return found


def suites(family: str) -> dict[str, list[str]]:
    """Suite classes in tests/suites: the plugin that the fixture returns -> the test classes."""
    base, fixture = SUITES[family]
    found: dict[str, list[str]] = {}
    for path in sorted((ROOT / "tests" / "suites").glob("test_*.py")):
        derived = {base}
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) and derived & set(map(base_name, node.bases)):
                derived.add(node.name)
                for member in node.body:
                    if isinstance(member, ast.FunctionDef) and member.name == fixture:
                        assert member.returns is not None, (
                            f"{path}: annotate what {fixture} returns"
                        )
                        found.setdefault(base_name(member.returns), []).append(node.name)
    return found


@pytest.mark.parametrize("family", FAMILIES)
def test_every_built_in_plugin_has_a_suite(family: str) -> None:
    """A plugin without a suite class in tests/suites is not known to keep the contract."""
    missing = sorted(set(plugins(family)) - set(suites(family)))
    assert not missing, f"no {SUITES[family][0]} for {', '.join(missing)}"


@pytest.mark.parametrize("family", FAMILIES)
def test_every_built_in_plugin_has_its_entry_point(family: str) -> None:
    """Declared in pyproject.toml as anyone else's would be: every class, and nothing else."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = project["entry-points"].get(f"multirep.{family}", {})
    found = plugins(family)
    assert {name for name, _ in found.values()} == set(declared)
    for class_name, (name, module) in found.items():
        where, _, attribute = declared[name].partition(":")
        assert attribute == class_name
        assert inside(module, where), f"{name}: {declared[name]} is not where {class_name} is"


def test_representations_and_tools_were_found() -> None:
    """The two tests above look at something: the plugins that the design names are among them."""
    assert {"Polyline", "Nurbs", "WaveletBSpline"} <= set(plugins("representations"))
    assert {"MoveVertex", "Spatula"} <= set(plugins("tools"))
