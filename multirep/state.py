"""The whole state of a multi-representation as one frozen value; a snapshot is a reference."""

from __future__ import annotations

from collections.abc import Mapping

import attrs

from multirep.authors import AuthorMap
from multirep.representation import Representation
from multirep.splices import SpliceList


@attrs.frozen(eq=False)
class Held:
    """One kind: its value when last brought up to date (None before) and where it is stale."""

    value: Representation | None
    stale: SpliceList


@attrs.frozen(eq=False)
class Preparation:
    """The value that a kind got for a stretch to be frozen, and the one from before.

    ``tolerance`` is the one that the latter was made for.
    """

    value: Representation
    before: Representation
    tolerance: float


@attrs.frozen(eq=False)
class Look:
    """A view that brought something up to date; ``where`` is what was asked for, None for all."""

    kind: str
    where: SpliceList | None


@attrs.frozen(eq=False)
class State:
    """Tolerance, held representations by name, the authors, and what is frozen.

    Parameters
    ----------
    tolerance : float
    held : mapping of str to Held
    authors : AuthorMap
    claims : mapping of str to SpliceList
        What each freeze, by name, asked for: bit-identical in every representation.
    frozen : SpliceList
        Where nothing may change: the claims and the little around them that some representation
        needs to hold them still (:meth:`~multirep.Representation.held`).
    added : mapping of str to mapping of float to int
        How many controls each kind got at the ends of frozen stretches, to be taken back later.
    preparations : mapping of str to Preparation
        What freezing has made of each kind.
    looks : tuple of Look
        The views since the last change of the curve, in order: with the authors and the values
        before, they determine every bit of what is held.
    """

    tolerance: float
    held: Mapping[str, Held]
    authors: AuthorMap
    claims: Mapping[str, SpliceList] = attrs.field(factory=dict)
    frozen: SpliceList = SpliceList.EMPTY
    added: Mapping[str, Mapping[float, int]] = attrs.field(factory=dict)
    preparations: Mapping[str, Preparation] = attrs.field(factory=dict)
    looks: tuple[Look, ...] = ()

    def with_held(self, name: str, held: Held) -> State:
        """Return the state with another value of one kind."""
        return self._with({**self.held, name: held}, self.authors, self.looks)

    def with_values(self, held: Mapping[str, Held], authors: AuthorMap) -> State:
        """Return the state with other values and authors, and the same looks."""
        return self._with(held, authors, self.looks)

    def with_author(self, held: Mapping[str, Held], authors: AuthorMap) -> State:
        """Return the state after somebody changed the curve; nobody has looked yet."""
        return self._with(held, authors, ())

    def looked(self, kind: str, where: SpliceList | None, held: Held) -> State:
        """Return the state after one more look, and with what it brought up to date."""
        looks = (*self.looks, Look(kind, where))
        return self._with({**self.held, kind: held}, self.authors, looks)

    def _with(self, held: Mapping[str, Held], authors: AuthorMap, looks: tuple[Look, ...]) -> State:
        # not attrs.evolve, which takes ten times as long: this is part of every step of a drag
        return State(
            self.tolerance,
            held,
            authors,
            self.claims,
            self.frozen,
            self.added,
            self.preparations,
            looks,
        )

    def author_value(self, name: str) -> Representation:
        """Return the value of a kind that is the author somewhere."""
        value = self.held[name].value
        assert value is not None, f"{name} is an author without a value"
        return value
