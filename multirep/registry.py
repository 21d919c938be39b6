"""Which representations, tools and constraints there are.

A registry is an object, not a module global. ``Registry.discover()`` lists the entry points of all
installed packages, the built-in plugins among them; a class is imported when it is first asked for.
``Registry.of(...)`` works without discovery. Registration validates first and changes last.
"""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Generic, TypeVar

import attrs

from multirep.constraint import Constraint
from multirep.errors import RegistrationError, UnknownNameError
from multirep.representation import Representation
from multirep.tool import Tool

P = TypeVar("P")

#: Entry point group of each kind of plugin.
GROUPS = {
    "representation": "multirep.representations",
    "tool": "multirep.tools",
    "constraint": "multirep.constraints",
}


class Plugins(Mapping[str, type[P]], Generic[P]):
    """Plugins of one kind by name; each is imported and validated when it is first asked for."""

    def __init__(self, what: str, base: type[P]) -> None:
        self._what = what
        self._base = base
        self._entries: dict[str, EntryPoint | type[P]] = {}
        self._sources: dict[str, str] = {}

    def __getitem__(self, name: str) -> type[P]:
        if name not in self._entries:
            raise UnknownNameError(self._what, name, self._entries)
        entry = self._entries[name]
        if isinstance(entry, EntryPoint):
            try:
                plugin = entry.load()
            except Exception as error:
                raise RegistrationError(
                    f"{self._what} {name!r} from {self._sources[name]} cannot be loaded: {error}",
                    entry,
                ) from error
            validate(plugin, self._what, self._base)
            if plugin.name != name:
                raise RegistrationError(
                    f"entry point {name!r} of {self._sources[name]} leads to a {self._what} "
                    f"that calls itself {plugin.name!r}",
                    plugin,
                )
            self._entries[name] = plugin
            loaded: type[P] = plugin
            return loaded
        return entry

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._entries))

    def __len__(self) -> int:
        return len(self._entries)

    def source(self, name: str) -> str:
        """Return where a plugin comes from: its distribution, or the module of the class."""
        return self._sources[name]

    def _add(self, name: str, entry: EntryPoint | type[P], source: str) -> None:
        if name in self._entries:
            raise RegistrationError(
                f"two {self._what}s are named {name!r}: one from {self._sources[name]}, "
                f"one from {source}",
                entry,
            )
        self._entries[name] = entry
        self._sources[name] = source


class Registry:
    """The plugins that a framework can use.

    Examples
    --------
    >>> from multirep.representations import Polyline
    >>> from multirep.tools import MoveVertex
    >>> registry = Registry.of(Polyline, MoveVertex)
    >>> list(registry.representations), list(registry.tools)
    (['polyline'], ['move-vertex'])
    >>> registry.tools["move-vertx"]  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    multirep.errors.UnknownNameError: no tool named 'move-vertx'; did you mean 'move-vertex'? ...
    """

    def __init__(self) -> None:
        self.representations: Plugins[Representation] = Plugins("representation", Representation)  # type: ignore[type-abstract]
        self.tools: Plugins[Tool[Any]] = Plugins("tool", Tool)  # type: ignore[type-abstract]
        self.constraints: Plugins[Constraint[Any]] = Plugins("constraint", Constraint)  # type: ignore[type-abstract]

    @classmethod
    def of(cls, *plugins: type) -> Registry:
        """Make a registry of classes, without discovery.

        Raises
        ------
        RegistrationError
            When a class breaks its contract, when two share a name (both sources are named), or
            when a tool or constraint works on a representation that is not among them.
        """
        registry = cls()
        for plugin in plugins:
            registry.register(plugin)
        known = registry.representations.values()
        for family, attribute in ((registry.tools, "edits"), (registry.constraints, "needs")):
            for plugin in family.values():
                needed = getattr(plugin, attribute)
                if needed not in known:
                    raise RegistrationError(
                        f"{plugin.name!r} {attribute} {needed.name!r}, which is not registered; "
                        f"registered: {', '.join(map(repr, registry.representations)) or 'none'}",
                        plugin,
                    )
        return registry

    @classmethod
    def discover(cls) -> Registry:
        """Return the registry of all installed plugins; asked for once per process."""
        return _discovered()

    def register(self, plugin: type) -> None:
        """Add one class; nothing is changed when it is refused."""
        if not isinstance(plugin, type):
            raise RegistrationError(f"a plugin is a class; got {plugin!r}", plugin)
        source = f"{plugin.__module__}.{plugin.__qualname__}"
        if issubclass(plugin, Representation):
            validate(plugin, "representation", Representation)
            self.representations._add(plugin.name, plugin, source)
        elif issubclass(plugin, Tool):
            validate(plugin, "tool", Tool)
            self.tools._add(plugin.name, plugin, source)
        elif issubclass(plugin, Constraint):
            validate(plugin, "constraint", Constraint)
            self.constraints._add(plugin.name, plugin, source)
        else:
            raise RegistrationError(
                f"{source} is neither a Representation nor a Tool nor a Constraint", plugin
            )


def validate(plugin: Any, what: str, base: type) -> None:
    """Raise RegistrationError unless ``plugin`` is a complete plugin class of its kind."""
    label = getattr(plugin, "__qualname__", repr(plugin))
    if not (isinstance(plugin, type) and issubclass(plugin, base)):
        raise RegistrationError(f"{label} is not a {base.__name__}", plugin)
    if inspect.isabstract(plugin):
        missing = ", ".join(sorted(getattr(plugin, "__abstractmethods__", ())))
        raise RegistrationError(f"{what} {label} does not override: {missing}", plugin)
    name = getattr(plugin, "name", None)
    if not isinstance(name, str) or not name or name != name.strip().lower():
        raise RegistrationError(
            f"{what} {label} needs a class attribute `name` in lower case, got {name!r}", plugin
        )
    if issubclass(plugin, Tool | Constraint):
        attribute = "edits" if issubclass(plugin, Tool) else "needs"
        needed = getattr(plugin, attribute, None)
        if not (isinstance(needed, type) and issubclass(needed, Representation)):
            raise RegistrationError(
                f"{what} {name!r} needs a class attribute `{attribute}`, a Representation; "
                f"got {needed!r}",
                plugin,
            )
        if not attrs.has(plugin):
            raise RegistrationError(
                f"{what} {name!r} must be an attrs class (decorate it with @attrs.frozen): "
                "its fields are its parameters",
                plugin,
            )


@cache
def _discovered() -> Registry:
    registry = Registry()
    families: dict[str, Plugins[Any]] = {
        "representation": registry.representations,
        "tool": registry.tools,
        "constraint": registry.constraints,
    }
    for what, group in GROUPS.items():
        for entry in entry_points(group=group):
            source = entry.dist.name if entry.dist is not None else entry.value
            try:
                families[what]._add(entry.name, entry, source)
            except RegistrationError as error:
                warnings.warn(str(error), stacklevel=2)
    return registry
