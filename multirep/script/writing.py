"""A journal as a script: TOML text, numbers in full precision."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import attrs
import numpy as np

from multirep.errors import MultirepError, ScriptError
from multirep.journal import (
    Added,
    Applied,
    Constrained,
    Entry,
    Gestured,
    Looked,
    Meddled,
    Released,
    Reparameterized,
    ToleranceSet,
    Travelled,
)
from multirep.multirepresentation import MultiRepresentation
from multirep.script.reading import FORMAT
from multirep.state import State

#: Lines are broken after so many characters where a list allows it.
WIDTH = 100


def written(entries: Iterable[Entry], starts: Mapping[str, State]) -> str:
    """Write what a session did.

    Parameters
    ----------
    entries : iterable of Entry
        Of a whole journal, from the first.
    starts : mapping of str to State
        The states of the curves that the session started from.

    Returns
    -------
    str
        TOML; every number reads back as the same one.

    Raises
    ------
    ScriptError
        When something cannot be said.
    """
    heads: list[str] = [f"multirep = {FORMAT}\n"]
    steps: list[str] = []
    names: set[str] = set()
    for entry in entries:
        if isinstance(entry, Added):
            if entry.curve in names:
                raise ScriptError(
                    f"two curves were called {entry.curve!r}, one after the other; a script knows "
                    "one of a name"
                )
            names.add(entry.curve)
            state = starts[entry.curve] if entry.state is None else entry.state
            heads.append(_table("curve", _source(entry, state)))
            if entry.step:
                steps.append(_table("step", {"add": entry.curve}))
            steps += [_step(look) for look in _looks(entry, state)]
        else:
            steps.append(_step(entry))
    return "\n".join([*heads, *steps])


# -- steps


def _step(entry: Entry) -> str:
    if isinstance(entry, Gestured):
        if not entry.entries:
            return _table("step", {"curve": entry.curve, "gesture": []})
        inner = (_table("step.gesture", _parameters(part, entry.curve)) for part in entry.entries)
        return "\n".join([_table("step", {"curve": entry.curve}), *inner])
    return _table("step", _parameters(entry))


def _parameters(entry: Entry, within: str | None = None) -> dict[str, object]:
    """Return the keys of a step; ``within`` is the curve of the gesture that it is part of."""
    if isinstance(entry, Travelled):
        return {"undo" if entry.undo else "redo": entry.times}
    if isinstance(entry, Meddled):
        raise ScriptError(
            f"the curve {entry.curve!r} was changed past the session (by a commit, say), which a "
            "script cannot do: make that change a tool and apply it, or go on in a new session "
            "with a curve made of a representation of this one "
            "(MultiRepresentation(curve.view(...), tolerance=...))"
        )
    keys: dict[str, object] = {} if entry.curve == within else {"curve": entry.curve}
    if isinstance(entry, Applied):
        return {**keys, "tool": entry.tool.name, **fields(entry.tool)}
    if isinstance(entry, Constrained):
        held = entry.constraint
        return {**keys, "constrain": held.name, "name": entry.name, **fields(held)}
    if isinstance(entry, Released):
        return {**keys, "release": entry.name}
    if isinstance(entry, ToleranceSet):
        return {**keys, "tolerance": entry.tolerance}
    if isinstance(entry, Reparameterized):
        return {**keys, "reparameterize": entry.mapping}
    assert isinstance(entry, Looked)
    where = {} if entry.where is None else {"where": [tuple(splice) for splice in entry.where]}
    return {**keys, "view": entry.kind, **where}


def fields(plugin: Any) -> dict[str, object]:
    """Return the parameters of a tool or constraint that are not what they are by default.

    Examples
    --------
    >>> from multirep.registry import Registry
    >>> spatula = Registry.discover().tools["spatula"]
    >>> fields(spatula(radius=0.5, path=[[0, 0], [1, 0]]))
    {'radius': 0.5, 'path': ((0.0, 0.0), (1.0, 0.0))}
    """
    found: dict[str, object] = {}
    for attribute in attrs.fields(type(plugin)):
        if not attribute.init:
            continue
        value = getattr(plugin, attribute.name)
        default: Any = attribute.default
        if value is None and default is None:
            continue  # TOML has no word for it
        found[attribute.name] = value
        try:
            _value(value)
        except TypeError as error:
            raise ScriptError(
                f"{attribute.name!r} of {plugin.name!r} cannot be written: {error}"
            ) from None
        if isinstance(default, str | bool) and value == default:
            del found[attribute.name]
    return found


# -- curves


def _source(entry: Added, state: State) -> dict[str, object]:
    """Return the keys of a curve: name, tolerance, where it comes from, representations."""
    author = state.authors.names[0]
    value: Any = state.author_value(author)
    if len(state.authors.names) > 1 or state.claims:
        raise _edited_before(entry)
    head: dict[str, object] = {"name": entry.curve, "tolerance": state.tolerance}
    tail: dict[str, object] = {"representations": list(entry.kinds)}
    try:
        data = value.to_dict()
    except NotImplementedError:
        data = {}
    if author == "polyline":
        return {**head, "t": data["t"], "points": data["points"], **tail}
    if author in ("nurbs", "wavelet"):
        return {**head, author: data, **tail}
    raise ScriptError(f"a curve of a script cannot begin as {author!r}, as {entry.curve!r} does")


def _edited_before(entry: Added) -> ScriptError:
    return ScriptError(
        f"the curve {entry.curve!r} had been edited before it was added to the session, which a "
        "script cannot do again: add a curve made of one representation of it instead "
        "(MultiRepresentation(curve.view(...), tolerance=...)), or add it before editing"
    )


def _looks(entry: Added, state: State) -> Iterator[Looked]:
    """Return the looks that bring a new curve to the state in which it was added.

    Raises
    ------
    ScriptError
        When they do not: it has a past that nobody knows.
    """
    author = state.authors.names[0]
    kinds = [type(held.value) for held in state.held.values() if held.value is not None]
    if len(kinds) == 1:
        return
    value = state.author_value(author)
    try:
        fresh = MultiRepresentation(value, tolerance=state.tolerance, kinds=kinds)
        for look in state.looks:
            fresh.view(look.kind, look.where)
    except MultirepError as error:
        raise ScriptError(f"the curve {entry.curve!r} cannot be made again: {error}") from error
    if not _same(fresh.snapshot(), state):
        raise _edited_before(entry)
    for look in state.looks:
        yield Looked(entry.curve, look.kind, look.where)


def _same(one: State, two: State) -> bool:
    """Whether all that both hold is the same, bit for bit, and equally up to date."""
    for name, held in one.held.items():
        other = two.held[name]
        if held.stale != other.stale or held.value is None or other.value is None:
            return False
        if held.value is not other.value and held.value.to_dict() != other.value.to_dict():
            return False
    return True


# -- TOML


def _table(name: str, keys: Mapping[str, object]) -> str:
    lines = [f"[[{name}]]"]
    lines += [f"{key} = {_value(value, len(key) + 3)}" for key, value in keys.items()]
    return "\n".join(lines) + "\n"


def _value(value: object, column: int = 0) -> str:
    r"""Write a value, long lists on several lines; TypeError for what TOML has nothing for.

    Examples
    --------
    >>> _value([0.1, -0.0, 3, True, 'a "b"'])
    '[0.1, -0.0, 3, true, "a \\"b\\""]'
    """
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, int | np.integer):
        return str(int(value))
    if isinstance(value, float | np.floating):
        return repr(float(value))
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        inner = (f"{_text(key)} = {_value(part)}" for key, part in value.items())
        return "{" + ", ".join(inner) + "}"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return _list([_value(part) for part in value], column)
    raise TypeError(f"TOML has nothing for {value!r:.60}")


def _text(text: str) -> str:
    """Quote a text as a basic string."""
    escapes = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    written = [
        escapes.get(c) or (c if c.isprintable() or ord(c) > 0x9F else f"\\u{ord(c):04x}")
        for c in text
    ]
    return '"' + "".join(written) + '"'


def _list(parts: list[str], column: int) -> str:
    if column + 2 + sum(len(part) + 2 for part in parts) <= WIDTH:
        return f"[{', '.join(parts)}]"
    lines, line = [], "   "
    for part in parts:
        if len(line) + len(part) + 2 > WIDTH and line.strip():
            lines.append(line)
            line = "   "
        line += f" {part},"
    return "\n".join(["[", *lines, line, "]"])
