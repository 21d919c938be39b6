"""The contract of a tool: parameters as fields, one method that edits."""

from __future__ import annotations

import abc
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Generic, TypeVar

from multirep.aim import Aim
from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.representation import Representation
from multirep.scene import Scene

R = TypeVar("R", bound=Representation)


class Tool(abc.ABC, Generic[R]):
    """A frozen attrs class that edits one kind of representation.

    You must set ``name`` and ``edits`` and override :meth:`edit`; the fields are the tool's
    parameters. The framework hands over an up-to-date value, checks what comes back and tells the
    other representations. You may override what stands below the second line.
    """

    __slots__ = ()

    #: The name in scripts, as in "move-vertex".
    name: ClassVar[str]
    #: The representation that the tool works on.
    edits: ClassVar[type[Representation]]

    @abc.abstractmethod
    def edit(self, value: R, scene: Scene, /) -> Edit[R]:
        """Return the edited value with the splices that changed; raise to refuse."""

    # -- may override ------------------------------------------------------------------------------

    def aims(self, value: R, /) -> tuple[Aim, ...]:
        """Return the places that the edit is about, for the constraints that answer it.

        By default the place that the fields ``t`` or ``at`` mean on ``value``, which is the curve
        before the edit, with the point ``to`` if the tool has such a field. Asked only when there
        are constraints.
        """
        t, at = getattr(self, "t", None), getattr(self, "at", None)
        if t is None and at is not None and _is_point(at, value.dimension):
            t = float(value.nearest(at).t)
        if not isinstance(t, float | int) or not value.domain.contains(t):
            return ()
        to = getattr(self, "to", None)
        return (Aim(float(t), to if _is_point(to, value.dimension) else None),)

    def constrains(
        self, value: R, held: Mapping[str, Constraint[Any]], /
    ) -> Mapping[str, Constraint[Any] | None]:
        """Return constraints to add (or replace, by name) and to release (None) after the edit.

        ``value`` is the curve after it, ``held`` are the constraints of the curve by name. Nothing
        by default.
        """
        return {}


def _is_point(values: object, dimension: int) -> bool:
    return (
        isinstance(values, Sequence)
        and len(values) == dimension
        and all(isinstance(number, float | int) for number in values)
    )
