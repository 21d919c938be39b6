"""The contract of a tool: parameters as fields, one method that edits."""

from __future__ import annotations

import abc
from typing import ClassVar, Generic, TypeVar

from multirep.edit import Edit
from multirep.representation import Representation
from multirep.scene import Scene

R = TypeVar("R", bound=Representation)


class Tool(abc.ABC, Generic[R]):
    """A frozen attrs class that edits one kind of representation.

    You must set ``name`` and ``edits`` and override :meth:`edit`; the fields are the tool's
    parameters. The framework hands over an up-to-date value, checks what comes back and tells the
    other representations.
    """

    __slots__ = ()

    #: The name in scripts, as in "move-vertex".
    name: ClassVar[str]
    #: The representation that the tool works on.
    edits: ClassVar[type[Representation]]

    @abc.abstractmethod
    def edit(self, value: R, scene: Scene, /) -> Edit[R]:
        """Return the edited value with the splices that changed; raise to refuse."""
