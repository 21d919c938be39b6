"""Laws of the parameters of a tool or constraint: documented, validated, plain data."""

from __future__ import annotations

import inspect
import json
from typing import Any, get_type_hints

import attrs
import cattrs

from multirep.errors import InvariantError
from multirep.script.strict import structure

#: What no parameter of any type may be.
NEVER = (float("nan"), float("inf"), object())


def check_parameters(plugin: Any) -> None:
    """Check the fields of a tool or constraint instance.

    - Each field is described in the docstring of the class, by its name.
    - No field takes NaN, infinity or an arbitrary object.
    - The instance cannot be changed, is equal to a copy of itself, and is made again from plain
      data (JSON) as a script or a journal would.

    Raises
    ------
    InvariantError
        With the plugin as ``subject``.

    Examples
    --------
    >>> from multirep.testing import RecordingTool
    >>> check_parameters(RecordingTool(index=1, offset=(0, 1)))
    """
    kind = type(plugin)
    text = inspect.getdoc(kind) or ""
    fields = [field for field in attrs.fields(kind) if field.init]
    missing = [field.name for field in fields if field.name not in text]
    if missing:
        raise InvariantError(
            f"the docstring of {kind.__name__} does not describe {', '.join(missing)}", plugin
        )
    for field in fields:
        for wrong in NEVER:
            try:
                attrs.evolve(plugin, **{field.alias or field.name: wrong})
            except (TypeError, ValueError, ArithmeticError, LookupError):
                continue
            raise InvariantError(f"{kind.__name__}.{field.name} takes {wrong!r}", plugin)
        try:
            setattr(plugin, field.name, None)
        except AttributeError:
            continue
        raise InvariantError(f"{kind.__name__} is not frozen: {field.name} can be set", plugin)
    if attrs.evolve(plugin) != plugin:
        raise InvariantError(f"a copy of this {kind.__name__} is not equal to it", plugin)
    again = structure(as_data(plugin), kind)
    if again != plugin:
        raise InvariantError(f"{plugin!r} comes back from its data as {again!r}", plugin)


def as_data(plugin: Any) -> dict[str, Any]:
    """Return the parameters of a tool or constraint as JSON would give them back."""
    get_type_hints(type(plugin))  # the annotations must be readable, or no script can use them
    data: dict[str, Any] = json.loads(json.dumps(cattrs.unstructure(plugin)))
    return data
