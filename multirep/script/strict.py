"""Plain data (TOML, JSON) to attrs classes, strictly: nothing is converted quietly.

cattrs alone takes 2.7 for the integer 2, "3" for 3 and True for 1. The hooks here refuse all of
that, refuse what is not finite, refuse unknown keys, and say where: every error names the key, what
was found and what is allowed.
"""

from __future__ import annotations

import math
import re
import types
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from functools import lru_cache
from typing import Any, TypeVar, Union, get_args, get_origin

import attrs
import cattrs
from cattrs.errors import ClassValidationError, ForbiddenExtraKeysError, IterableValidationError

from multirep.errors import UnknownNameError
from multirep.script.model import Points

T = TypeVar("T")

#: Longest text that any key takes; longer is not a name or a path.
LONGEST_TEXT = 4096
#: How much of a wrong value an error message quotes.
LONGEST_QUOTE = 60


class Mismatch(ValueError):
    """A value does not fit its type; ``key`` is the path to it, ``problem`` says what is wrong."""

    def __init__(self, problem: str, key: str = "") -> None:
        super().__init__(f"{key}: {problem}" if key else problem)
        self.problem = problem
        self.key = key


def structure(value: object, cls: type[T]) -> T:
    """Make ``cls`` of plain data.

    Parameters
    ----------
    value : object
        Tables, lists, numbers, booleans and text as TOML or JSON give them.
    cls : type
        An attrs class, or any type that its fields may have.

    Returns
    -------
    An instance of ``cls``.

    Raises
    ------
    Mismatch
        The first thing that does not fit, unknown keys first (they explain the missing ones).

    Examples
    --------
    >>> structure(2.5, int)
    Traceback (most recent call last):
        ...
    multirep.script.strict.Mismatch: expected a whole number, got 2.5
    """
    try:
        return _converter().structure(value, cls)
    except Exception as error:
        key, problem = _explain(error)
        raise Mismatch(problem, key) from None


def check_keys(table: Mapping[str, object], allowed: Iterable[str], what: str) -> None:
    """Raise Mismatch when a table holds a key that ``what`` does not know; suggest the nearest."""
    known = sorted(allowed)
    for key in table:
        if key not in known:
            near = get_close_matches(key, known, n=1)
            hint = f"; did you mean {near[0]!r}?" if near else ";"
            raise Mismatch(f"unknown key of {what}{hint} allowed: {', '.join(known)}", key)


def structure_key(table: Mapping[str, Any], key: str, cls: Any) -> Any:
    """Make ``cls`` of one entry of a table; a Mismatch names the key."""
    try:
        return structure(table[key], cls)
    except Mismatch as error:
        raise Mismatch(error.problem, f"{key}{error.key}") from None


def check_names(names: tuple[str, ...], what: str, known: list[str], key: str) -> None:
    """Raise Mismatch when a name occurs twice or is not known."""
    if len(set(names)) < len(names):
        raise Mismatch(f"names one {what} twice: {quote(list(names))}", key)
    for name in names:
        if name not in known:
            raise Mismatch(str(UnknownNameError(what, name, known)), key)


def quote(value: object) -> str:
    """Quote a wrong value, briefly.

    Examples
    --------
    >>> quote([1, 2]), quote("x" * 99)[-5:]
    ('a list [1, 2]', 'xx...')
    """
    kinds = {bool: "", str: "text ", list: "a list ", dict: "a table ", tuple: "a list "}
    text = repr(value)
    if len(text) > LONGEST_QUOTE:
        text = text[: LONGEST_QUOTE - 3] + "..."
    return f"{kinds.get(type(value), '')}{text}"


# -- hooks: one type each


def _integer(value: object, _: object = None) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise Mismatch(f"expected a whole number, got {quote(value)}")
    if abs(value) > 2**53:
        raise Mismatch(f"expected a whole number below 2^53, got {quote(value)}")
    return value


def _number(value: object, _: object = None) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Mismatch(f"expected a number, got {quote(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise Mismatch(f"expected a finite number, got {quote(value)}")
    return number


def _boolean(value: object, _: object = None) -> bool:
    if not isinstance(value, bool):
        raise Mismatch(f"expected true or false, got {quote(value)}")
    return value


def _text(value: object, _: object = None) -> str:
    if not isinstance(value, str):
        raise Mismatch(f"expected text, got {quote(value)}")
    if len(value) > LONGEST_TEXT or "\0" in value:
        raise Mismatch(
            f"expected at most {LONGEST_TEXT} characters without NUL, got {quote(value)}"
        )
    return value


def _points(value: object, _: object = None) -> Points:
    if not isinstance(value, list | tuple):
        raise Mismatch(f"expected a list of points, got {quote(value)}")
    rows: list[tuple[float, ...]] = []
    for i, row in enumerate(value):
        if not isinstance(row, list | tuple) or not row:
            raise Mismatch(f"expected a point [x, y, ...], got {quote(row)}", f"[{i}]")
        if rows and len(row) != len(rows[0]):
            raise Mismatch(
                f"expected {len(rows[0])} coordinates as in the first point, got {quote(row)}",
                f"[{i}]",
            )
        try:
            rows.append(tuple(map(_number, row)))
        except Mismatch as error:
            raise Mismatch(error.problem, f"[{i}]") from None
    return Points(tuple(rows))


def _sequence(cls: Any) -> Callable[[object, object], object]:
    """Make the hook of a tuple or list type."""
    members = get_args(cls)
    each = get_origin(cls) is list or (len(members) == 2 and members[1] is Ellipsis)

    def hook(value: object, _: object) -> object:
        if not isinstance(value, list | tuple):
            raise Mismatch(f"expected a list, got {quote(value)}")
        if not each and len(value) != len(members):
            raise Mismatch(f"expected a list of {len(members)}, got {quote(value)}")
        items = []
        for i, item in enumerate(value):
            try:
                items.append(_converter().structure(item, members[0] if each else members[i]))
            except Exception as error:
                key, problem = _explain(error)
                raise Mismatch(problem, _join(f"[{i}]", key)) from None
        return items if get_origin(cls) is list else tuple(items)

    return hook


def _origin(cls: Any) -> Any:
    return get_origin(cls)


def _union(cls: Any) -> Callable[[object, object], object]:
    """Make the hook of a union: the first member that fits, or the error of the closest."""
    members = [member for member in get_args(cls) if member is not type(None)]
    optional = len(members) < len(get_args(cls))

    def hook(value: object, _: object) -> object:
        if value is None and optional:
            return None
        errors = []
        for member in members:
            try:
                return _converter().structure(value, member)
            except Exception as error:
                errors.append(_explain(error))
        key, problem = max(errors, key=lambda error: len(error[0]))  # the deepest got farthest
        if not key and len(errors) > 1:
            expected = [text.partition(", got ")[0].removeprefix("expected ") for _, text in errors]
            problem = f"expected {' or '.join(dict.fromkeys(expected))}, got {quote(value)}"
        raise Mismatch(problem, key)

    return hook


def _table(cls: Any) -> Callable[[object, object], object]:
    """Make the hook of an attrs class."""
    from cattrs.gen import make_dict_structure_fn

    build = make_dict_structure_fn(cls, _converter(), _cattrs_forbid_extra_keys=True)

    def hook(value: object, _: object) -> object:
        if not isinstance(value, Mapping):
            raise Mismatch(f"expected a table, got {quote(value)}")
        return build(value, cls)

    return hook


@lru_cache(maxsize=1)
def _converter() -> cattrs.Converter:
    """Return the one strict converter (it caches what it learns about classes)."""
    converter = cattrs.Converter(forbid_extra_keys=True, detailed_validation=True)
    for cls, hook in ((int, _integer), (float, _number), (bool, _boolean), (str, _text)):
        converter.register_structure_hook(cls, hook)
    converter.register_structure_hook_factory(
        lambda cls: _origin(cls) in (tuple, list) and bool(get_args(cls)), _sequence
    )
    converter.register_structure_hook_factory(
        lambda cls: _origin(cls) in (Union, types.UnionType), _union
    )
    converter.register_structure_hook_func(lambda cls: cls is Points, _points)
    converter.register_structure_hook_factory(attrs.has, _table)
    return converter


# -- errors


def _explain(error: BaseException) -> tuple[str, str]:
    """Return the key path and the problem of the first error in what cattrs raised."""
    if isinstance(error, Mismatch):
        return error.key, error.problem
    if isinstance(error, ClassValidationError):
        located, others = error.group_exceptions()
        for other in others:
            if isinstance(other, ForbiddenExtraKeysError):
                return _unknown_key(other)
        for inner, note in located:
            key, problem = _explain(inner)
            if isinstance(inner, KeyError):
                problem = "missing"
            return _join(note.name, key), problem
        return _explain(others[0])
    if isinstance(error, IterableValidationError):
        inner, at = error.group_exceptions()[0][0]
        key, problem = _explain(inner)
        return _join(f"[{at.index}]", key), problem
    return _validator(error)


def _unknown_key(error: ForbiddenExtraKeysError) -> tuple[str, str]:
    known = [a.name for a in attrs.fields(error.cl) if a.init]
    what = getattr(error.cl, "name", None)
    try:
        check_keys(
            dict.fromkeys(sorted(error.extra_fields)),
            known,
            repr(what) if isinstance(what, str) else error.cl.__name__,
        )
    except Mismatch as mismatch:
        return mismatch.key, mismatch.problem
    return "", str(error)


def _validator(error: BaseException) -> tuple[str, str]:
    """Read the field out of a validator's message: ``'index' must be >= 0: -1``."""
    message = error.args[0] if error.args and isinstance(error.args[0], str) else str(error)
    match = re.match(r"^'(\w+)' (must .*?)(?:: (.*))?$", message, re.DOTALL)
    if match is None:
        return "", message or type(error).__name__
    key, rule, found = match.groups()
    return key, rule if found is None else f"{rule}, got {found}"


def _join(outer: str, inner: str) -> str:
    return f"{outer}{inner}" if not inner or inner.startswith("[") else f"{outer}.{inner}"
