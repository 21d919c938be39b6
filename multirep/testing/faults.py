"""Tools that go wrong, each in one way: none of them may change a curve."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import attrs
import numpy as np

from multirep.edit import Edit
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.testing.doubles import CountingRepresentation
from multirep.testing.looking import even
from multirep.testing.loopback import LoopbackRepresentation
from multirep.tool import Tool


def faulty_tools(
    kind: type[Representation], operation: Callable[[Any], Edit[Any]]
) -> dict[str, Tool[Any]]:
    """Tools that make a sound edit and then spoil it, each in one way, by what they do.

    Parameters
    ----------
    kind : class
        The representation that they edit.
    operation : callable
        A sound edit of a value of ``kind`` that changes the curve.

    Returns
    -------
    dict of str to Tool
        None of them may change a curve; each error must name the tool.

    Examples
    --------
    >>> tools = faulty_tools(LoopbackRepresentation, lambda line: line.move(1, [1, 1]))
    >>> tools["returns None"].name
    'returns-none'
    """

    def raises(value: Any) -> Edit[Any]:
        operation(value)
        raise ZeroDivisionError("a bug in the tool")

    def beyond(value: Any) -> Edit[Any]:
        edit, stop = operation(value), value.domain.stop
        return Edit(edit.value, edit.splices | SpliceList([(stop, stop + 1)]))

    def half(value: Any) -> Edit[Any]:
        edit = operation(value)
        return Edit(
            edit.value, edit.splices - SpliceList([(edit.splices.hull.middle, value.domain.stop)])
        )

    faults: dict[str, Callable[[Any], Any]] = {
        "raises": raises,
        "returns None": lambda value: None,
        "returns the bare value": lambda value: operation(value).value,
        "returns another kind": lambda value: Edit(_other_kind(value), operation(value).splices),
        "returns splices of a wrong type": lambda value: Edit(
            operation(value).value,
            list(operation(value).splices),  # type: ignore[arg-type]
        ),
        "returns NaN": lambda value: _spoilt(operation(value), np.nan),
        "returns infinity": lambda value: _spoilt(operation(value), np.inf),
        "reports nothing": lambda value: Edit(operation(value).value, SpliceList.EMPTY),
        "reports half of what it changed": half,
        "reports splices outside T": beyond,
    }

    def tool(what: str, fault: Callable[[Any], Any]) -> Tool[Any]:
        body = {
            "__slots__": (),
            "__doc__": f"A tool that {what}.",
            "name": what.lower().replace(" ", "-"),
            "edits": kind,
            "edit": lambda self, value, scene: fault(value),
        }
        return attrs.frozen(type("FaultyTool", (Tool,), body))()  # type: ignore[no-any-return]

    return {what: tool(what, fault) for what, fault in faults.items()}


def _other_kind(value: Representation) -> Representation:
    t = even(value.domain, 5)
    if type(value) is LoopbackRepresentation:
        return CountingRepresentation(t, value(t))
    return LoopbackRepresentation(t, value(t))


def _spoilt(edit: Edit[Any], number: float) -> Edit[Any]:
    """Return the edit with one coordinate of its value replaced by ``number``."""
    value = copy.copy(edit.value)
    points = np.array(value.points)
    points[len(points) // 2, 0] = number
    stored = value.points
    spoilt = stored.replaced(0, len(points), points) if hasattr(stored, "replaced") else points
    for name in _attribute_names(value):
        if getattr(value, name, None) is stored:
            object.__setattr__(value, name, spoilt)
            return Edit(value, SpliceList([value.domain]))
    raise TypeError(f"cannot find where a {type(value).__name__} stores its points")


def _attribute_names(value: object) -> set[str]:
    slots = (name for kind in type(value).__mro__ for name in getattr(kind, "__slots__", ()))
    return {*slots, *getattr(value, "__dict__", {})}
