"""What a session did, in order, as values: enough to do it again (DESIGN section 8).

Tools and constraints are recorded with their parameters, never their results. Looks are recorded
too: a representation that follows is fitted when it is looked at, so *when* that was decides its
last bits, and those of what is edited in it afterwards.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, TypeAlias

import attrs

from multirep.constraint import Constraint
from multirep.multirepresentation import MultiRepresentation
from multirep.reparameterization import ParameterMap
from multirep.splices import SpliceList
from multirep.state import State
from multirep.tool import Tool


@attrs.frozen(eq=False)
class Added:
    """A curve came in, in this state and with these kinds; ``step`` when that can be undone.

    ``state`` is None where the history of the session has it: at its far end, as differences.
    """

    curve: str
    state: State | None
    kinds: tuple[str, ...]
    step: bool


@attrs.frozen(eq=False)
class Applied:
    """A tool was applied."""

    curve: str
    tool: Tool[Any]


@attrs.frozen(eq=False)
class Constrained:
    """A constraint was added under a name."""

    curve: str
    constraint: Constraint[Any]
    name: str


@attrs.frozen(eq=False)
class Released:
    """A constraint was removed."""

    curve: str
    name: str


@attrs.frozen(eq=False)
class ToleranceSet:
    """The tolerance of a curve was changed."""

    curve: str
    tolerance: float


@attrs.frozen(eq=False)
class Reparameterized:
    """The parameters of a curve were mapped."""

    curve: str
    mapping: ParameterMap


@attrs.frozen(eq=False)
class Looked:
    """A representation was brought up to date by a look at it; no step of the history.

    ``where`` is what was asked for; None for all.
    """

    curve: str
    kind: str
    where: SpliceList | None


@attrs.frozen(eq=False)
class Meddled:
    """A curve was changed behind the session's back, which cannot be done again."""

    curve: str


@attrs.frozen(eq=False)
class Gestured:
    """Several applications, and looks between them, that are one step."""

    curve: str
    entries: tuple[Applied | Looked | Meddled, ...]


@attrs.frozen(eq=False)
class Travelled:
    """Some steps were undone, or redone."""

    undo: bool
    times: int


Entry: TypeAlias = (
    Added
    | Applied
    | Constrained
    | Released
    | ToleranceSet
    | Reparameterized
    | Looked
    | Meddled
    | Gestured
    | Travelled
)


class Journal:
    """The entries of a session, and the states in which its curves were left after the last one.

    Examples
    --------
    >>> import multirep as mr
    >>> session = mr.Session()
    >>> session.add("line", mr.MultiRepresentation.from_points([[0, 0], [1, 0]], tolerance=0.1))
    >>> nurbs = session.curve("line").view("nurbs")
    >>> session.set_tolerance("line", 0.2).changed
    SpliceList.parse('')
    >>> [type(entry).__name__ for entry in session.journal.entries]
    ['Added', 'Looked', 'ToleranceSet']
    """

    def __init__(self) -> None:
        self._entries: list[Entry] = []
        self._left: dict[str, State] = {}
        #: Looks at all of a curve, which there are after every step, by curve and kind.
        self._looked: dict[tuple[str, str], Looked] = {}

    @property
    def entries(self) -> tuple[Entry, ...]:
        """What was done so far."""
        return tuple(self._entries)

    def write(self, *entries: Entry) -> None:
        """Add entries."""
        self._entries += entries

    def remember(self, curves: Mapping[str, MultiRepresentation]) -> None:
        """Take note of the states in which curves are left; O(curves)."""
        self._left = {name: curve.snapshot() for name, curve in curves.items()}

    def unnoticed(self, curves: Mapping[str, MultiRepresentation]) -> tuple[Looked | Meddled, ...]:
        """Return what happened to curves since :meth:`remember`, and remember them as they are.

        Costs an identity test for each curve that was not touched.
        """
        found: list[Looked | Meddled] = []
        for name, curve in curves.items():
            before, after = self._left.get(name), curve.snapshot()
            if before is not None and before is not after:
                found += self._between(name, before, after)
                self._left[name] = after
        return tuple(found)

    def _between(self, curve: str, before: State, after: State) -> Iterator[Looked | Meddled]:
        """Tell looks, which change nothing but what is held, from anything else."""
        seen = len(before.looks)
        same = before.authors is after.authors and before.claims is after.claims
        if not same or before.tolerance != after.tolerance or before.looks != after.looks[:seen]:
            yield Meddled(curve)
            return
        for look in after.looks[seen:]:
            if look.where is None:
                whole = Looked(curve, look.kind, None)
                yield self._looked.setdefault((curve, look.kind), whole)
            else:
                yield Looked(curve, look.kind, look.where)
