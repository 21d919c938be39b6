"""What one move of a gesture worked out and the next ones need again."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import TYPE_CHECKING, Any, TypeVar

from multirep.arrays import Array, Flags, Indices

if TYPE_CHECKING:
    from multirep.splines import Factored

T = TypeVar("T")

#: What was not asked for the longest time is forgotten beyond so many things: a drag in which no
#: two moves have anything in common must not fill the memory.
MOST = 64


class Memory:
    """Remembers results by what they depend on; kept by a gesture for its moves.

    A result must depend on nothing but its key, so it can be forgotten at any time and nobody can
    tell but by the cost.

    Examples
    --------
    >>> memory = Memory()
    >>> memory.recall("2 * 3", lambda: 2 * 3)
    6
    >>> memory.recall("2 * 3", lambda: print("not asked again"))
    6
    """

    def __init__(self) -> None:
        self._found: dict[Hashable, Any] = {}

    def recall(self, key: Hashable, work_out: Callable[[], T]) -> T:
        """Return what is known under a key, or work it out."""
        result: T = self._found.pop(key) if key in self._found else work_out()
        self._found[key] = result
        if len(self._found) > MOST:
            del self._found[next(iter(self._found))]
        return result


def factored_once(memory: Memory, starts: Indices, rows: Array, free: Flags) -> Factored:
    """Return a factored system, a known one if there is one; see :func:`multirep.splines.factored`.

    Examples
    --------
    >>> import numpy as np
    >>> memory, rows, free = Memory(), np.ones((1, 2)), np.ones(2, dtype=bool)
    >>> one, other = (factored_once(memory, np.array([0]), rows, free) for _ in range(2))
    >>> one is other
    True
    """
    from multirep.splines import factored

    key = ("factored", starts.tobytes(), rows.tobytes(), free.tobytes())
    return memory.recall(key, lambda: factored(starts, rows, free))
