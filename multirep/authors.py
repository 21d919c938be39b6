"""Who authored what: a piecewise constant map from T to the names of representations."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator

import attrs

from multirep.interval import Interval
from multirep.splices import SpliceList


@attrs.frozen
class AuthorMap:
    """For each t, the representation that last changed the curve there by a tool or a constraint.

    Neighbouring stretches have different authors. With k stretches, a look-up costs O(log k) and an
    assignment O(k) in machine code.

    Examples
    --------
    >>> authors = AuthorMap.of(Interval(0, 1), "polyline")
    >>> authors = authors.assigned(SpliceList([(0.2, 0.4)]), "nurbs")
    >>> [(str(interval), name) for interval, name in authors]
    [('[0, 0.2]', 'polyline'), ('[0.2, 0.4]', 'nurbs'), ('[0.4, 1]', 'polyline')]
    >>> print(authors.room(Interval(0.5, 0.6), "nurbs"))
    [0.4, 1]
    """

    domain: Interval
    starts: tuple[float, ...]
    names: tuple[str, ...]

    @classmethod
    def of(cls, domain: Interval, name: str) -> AuthorMap:
        """Return a map with one author everywhere."""
        return cls(domain, (domain.start,), (name,))

    def __iter__(self) -> Iterator[tuple[Interval, str]]:
        return iter(self.segments(self.domain))

    def segments(self, interval: Interval) -> tuple[tuple[Interval, str], ...]:
        """Return the stretches of ``interval`` in order, each with its author."""
        i = max(bisect_right(self.starts, interval.start) - 1, 0)
        j = max(bisect_left(self.starts, interval.stop), i + 1)
        if j == i + 1:  # one author, as in most steps of a drag
            return ((interval, self.names[i]),)
        marks = [interval.start, *self.starts[i + 1 : j], interval.stop]
        pieces = zip(marks, marks[1:], self.names[i:j], strict=False)
        return tuple((Interval(a, b), name) for a, b, name in pieces)

    def assigned(self, splices: SpliceList, name: str) -> AuthorMap:
        """Return the map after ``name`` changed the curve on ``splices``."""
        starts, names = self.starts, self.names
        for start, stop in splices:
            i = bisect_left(starts, start)  # stretches before i begin before `start`
            j = bisect_right(starts, stop)
            after = names[j - 1]  # who goes on after `stop`
            middle_starts: tuple[float, ...] = (start,)
            middle_names: tuple[str, ...] = (name,)
            if stop < self.domain.stop:
                middle_starts += (stop,)
                middle_names += (after,)
            if i and names[i - 1] == name:  # join the stretch on the left
                middle_starts, middle_names = middle_starts[1:], middle_names[1:]
            if stop < self.domain.stop and after == name:  # and the one on the right
                middle_starts, middle_names = middle_starts[:-1], middle_names[:-1]
            starts = (*starts[:i], *middle_starts, *starts[j:])
            names = (*names[:i], *middle_names, *names[j:])
        return AuthorMap(self.domain, starts, names)

    def where(self, name: str) -> SpliceList:
        """Return all that ``name`` authored."""
        stops = (*self.starts[1:], self.domain.stop)
        pieces = zip(self.starts, stops, self.names, strict=True)
        return SpliceList((a, b) for a, b, author in pieces if author == name)

    def room(self, interval: Interval, name: str) -> Interval:
        """Return the largest interval around ``interval`` in which ``name`` is not the author."""
        i = max(bisect_right(self.starts, interval.start) - 1, 0)
        while i > 0 and self.names[i - 1] != name:
            i -= 1
        j = max(bisect_left(self.starts, interval.stop), i + 1)
        while j < len(self.names) and self.names[j] != name:
            j += 1
        start = interval.start if self.names[i] == name else self.starts[i]
        stop = self.starts[j] if j < len(self.starts) else self.domain.stop
        return Interval(min(start, interval.start), max(stop, interval.stop))

    @property
    def seams(self) -> tuple[tuple[float, str, str], ...]:
        """The parameters where one author meets another: (t, left, right)."""
        return tuple(zip(self.starts[1:], self.names, self.names[1:], strict=False))
