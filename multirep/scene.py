"""What a tool or a constraint may see of the other curves: read-only views, by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, TypeVar, overload

import attrs

from multirep.aim import Aim
from multirep.errors import UnknownNameError
from multirep.memory import Memory
from multirep.splices import SpliceList

if TYPE_CHECKING:
    from multirep.multirepresentation import MultiRepresentation
    from multirep.representation import Representation

R = TypeVar("R", bound="Representation")


@attrs.frozen(eq=False)
class Scene:
    """Read-only views of the curves of a session: representations are immutable values.

    Parameters
    ----------
    curves : mapping of str to MultiRepresentation
        By name. A tool outside a session sees an empty scene.
    frozen : SpliceList
        Where the curve that is being edited may not change. An edit that reaches in is faded out
        before the border; a tool that can do better by itself looks here.
    aims : tuple of Aim
        What the tool asked for, for the constraints that answer.
    tolerance : float or None
        The tolerance of the curve that is being edited; None outside a session.
    memory : Memory
        For what one move of a gesture works out and the next ones need again: factored systems.
    """

    _curves: Mapping[str, MultiRepresentation] = attrs.field(factory=dict)
    frozen: SpliceList = SpliceList.EMPTY
    aims: tuple[Aim, ...] = ()
    tolerance: float | None = None
    memory: Memory = attrs.field(factory=Memory)

    def __iter__(self) -> Iterator[str]:
        return iter(self._curves)

    def __len__(self) -> int:
        return len(self._curves)

    @overload
    def view(self, curve: str, kind: type[R]) -> R: ...
    @overload
    def view(self, curve: str, kind: str) -> Representation: ...
    def view(self, curve: str, kind: type[R] | str) -> R | Representation:
        """Return a representation of another curve, brought up to date."""
        if curve not in self._curves:
            raise UnknownNameError("curve", curve, self._curves)
        return self._curves[curve].view(kind)
