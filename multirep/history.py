"""The moments that a session can go back or forth to, and where among them it is.

Those near the present are whole, the others faded to what differs between neighbours
(:mod:`multirep.moments`): whoever goes there passes all between, and what comes near becomes whole
again.
"""

from __future__ import annotations

from multirep.moments import (
    EARLIER,
    LATER,
    Between,
    Faded,
    Moment,
    Side,
    between,
    faded,
    together,
)

__all__ = ["History"]

#: So many moments before the present, and behind it, are kept whole, one at least. More take more
#: memory, tens of kilobytes each, which is slow until it is used again; fewer make an undo here and
#: there cost more than passing on a reference.
NEAR = 4


class History:
    """All moments of a session in the order of time.

    What comes back is bit-identical to what was there; a value that somebody still holds comes back
    as the same object.

    Examples
    --------
    >>> history = History()
    >>> for _ in range(9):
    ...     history.step(Moment({}, {}))
    >>> moment = history.travel(Moment({}, {}), -3)
    >>> history.undoable, history.redoable
    (6, 3)
    """

    def __init__(self) -> None:
        self.begin(Moment({}, {}))

    def begin(self, start: Moment) -> None:
        """Make a moment all that there is, the one before the first present; nobody goes there."""
        #: None for the present as long as nobody has left it.
        self._moments: list[Moment | Faded | None] = [start, None]
        #: What makes one of each moment and the next of the other, once it was asked for.
        self._between: list[Between | None] = [None]
        self._at = 1

    @property
    def undoable(self) -> int:
        """How many steps lead to the present."""
        return self._at - 1

    @property
    def redoable(self) -> int:
        """How many steps lead on from the present."""
        return len(self._moments) - 1 - self._at

    def step(self, present: Moment) -> None:
        """Leave the present, which was like this, by a new step; O(what changed).

        What could have been redone is dropped.
        """
        self._settle(present)
        del self._moments[self._at + 1 :], self._between[self._at :]
        self._moments.append(None)
        self._between.append(None)
        self._at += 1
        self._fade(self._at - 1 - NEAR, EARLIER)

    def travel(self, present: Moment, steps: int) -> Moment:
        """Leave the present, which was like this, for an earlier or a later moment.

        Parameters
        ----------
        present : Moment
        steps : int
            Backward if negative; no more than there are.

        Returns
        -------
        Moment
            The one there. O(what changed on the way).
        """
        self._settle(present)
        for _ in range(-steps):
            self._at -= 1
            self._make(self._at - 1, EARLIER)
            self._fade(self._at + 1 + NEAR, LATER)
        for _ in range(steps):
            self._at += 1
            self._make(self._at + 1, LATER)
            self._fade(self._at - 1 - NEAR, EARLIER)
        return self._whole(self._at)

    def start(self) -> Moment:
        """Return the moment that all began with; O(all changes on the way)."""
        there = self._whole(self._at - 1)
        for at in reversed(range(self._at - 1)):
            there, _ = self._made(at, EARLIER, there)
        return there

    # What follows keeps the neighbours of the present whole: there, everything can be made anew.

    def _settle(self, present: Moment) -> None:
        """Take note of how the present is left: somebody may have looked at something."""
        known = self._moments[self._at]
        if not (isinstance(known, Moment) and known.is_same(present)):
            self._moments[self._at] = present
            self._between[self._at - 1 : self._at + 1] = [None] * (1 + (self.redoable > 0))

    def _make(self, at: int, side: Side) -> None:
        """Make a moment whole if there is one; it is on this side of a whole neighbour."""
        if 0 <= at < len(self._moments):
            made = self._made(at, side, self._whole(at + 1 - 2 * side))
            self._moments[at], self._between[at - side] = made

    def _made(self, at: int, side: Side, neighbour: Moment) -> tuple[Moment, Between | None]:
        left, apart = self._moments[at], self._between[at - side]
        if isinstance(left, Moment):
            return left, apart
        assert left is not None
        assert apart is not None
        assert apart.makes == side
        return together(apart, left, neighbour)

    def _whole(self, at: int) -> Moment:
        moment = self._moments[at]
        assert isinstance(moment, Moment)
        return moment

    def _fade(self, at: int, side: Side) -> None:
        """Let a moment fade if there is one; it is on this side of a whole neighbour."""
        if not 0 <= at < len(self._moments):
            return
        moment, first = self._moments[at], at - side
        if not isinstance(moment, Moment):
            return
        apart = self._between[first]
        if apart is None or apart.makes != side:
            apart = between(self._whole(first), self._whole(first + 1), side)
            self._between[first] = apart
        if apart is not None:  # there were the same curves
            self._moments[at] = faded(moment, apart)
