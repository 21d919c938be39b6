"""What is plugged in, as text: for ``multirep plugins``."""

from __future__ import annotations

import inspect
from typing import Any

import attrs

from multirep.errors import RegistrationError
from multirep.registry import Plugins, Registry


def list_plugins(registry: Registry) -> tuple[str, int]:
    """Describe every plugin.

    Parameters
    ----------
    registry : Registry

    Returns
    -------
    text : str
        What each plugin is, needs and takes, and where it comes from.
    broken : int
        How many cannot be loaded; the text says why.
    """
    lines: list[str] = []
    broken = 0
    families: tuple[tuple[str, Plugins[Any], str], ...] = (
        ("representations", registry.representations, ""),
        ("tools", registry.tools, "edits"),
        ("constraints", registry.constraints, "needs"),
    )
    for title, plugins, relation in families:
        lines += [title] if not lines else ["", title]
        if not plugins:
            lines.append("  none")
        for name in plugins:
            try:
                lines += _describe(name, plugins[name], relation, plugins.source(name))
            except RegistrationError as error:
                broken += 1
                lines.append(f"  {name}: broken: {error}")
    return "\n".join(lines), broken


def _describe(name: str, plugin: Any, relation: str, source: str) -> list[str]:
    summary = getattr(plugin, "summary", "") or (inspect.getdoc(plugin) or "").partition("\n")[0]
    needed = f"{relation} {getattr(plugin, relation).name}; " if relation else ""
    lines = [f"  {name}: {summary}", f"      {needed}from {source}"]
    if relation:
        lines += [f"      {_parameter(a)}" for a in attrs.fields(plugin) if a.init]
    return lines


def _parameter(attribute: attrs.Attribute[Any]) -> str:
    kind = attribute.type if isinstance(attribute.type, str) else _type_name(attribute.type)
    if attribute.default is attrs.NOTHING:
        return f"{attribute.name}: {kind}"
    default: Any = attribute.default
    if isinstance(default, attrs.Factory):  # type: ignore[arg-type]  # attrs types it as a function
        return f"{attribute.name}: {kind} (has a default)"
    return f"{attribute.name}: {kind} = {default!r}"


def _type_name(kind: Any) -> str:
    return kind.__name__ if isinstance(kind, type) and not hasattr(kind, "__args__") else str(kind)
