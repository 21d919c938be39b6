"""Splice lists: canonical sets of disjoint closed parameter intervals.

A splice list is a *regular closed* set: each splice has a positive length, touching splices are
one, and the operations close their result again. So union, intersection and difference form a
Boolean algebra, equal sets are equal values, and a difference never leaves single points behind
(Grimm-Ayers 4.3 mark invalid stretches so).
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import ClassVar

from multirep.errors import IntervalError, InvariantError
from multirep.interval import Interval

#: Dyadic fractions up to this denominator print as fractions ("3/8"); all other numbers as
#: decimals.
LARGEST_DENOMINATOR = 1024


class SpliceList:
    """A canonical set of disjoint splices (immutable).

    Parameters
    ----------
    splices : iterable of Interval or pairs
        In any order, overlapping or not. Splices of zero length are dropped.

    Notes
    -----
    With k splices in the list, set operations cost O(k) in machine code (slices of tuples);
    membership O(log k).

    Examples
    --------
    >>> SpliceList.parse("[0,1/4] [1/2,3/4]") | SpliceList([(0.25, 0.5)])
    SpliceList.parse('[0,3/4]')
    >>> print(SpliceList([(0, 1)]) - SpliceList([(0.25, 0.5)]))
    [0,1/4] [1/2,1]
    """

    __slots__ = ("_starts", "_stops")
    _starts: tuple[float, ...]
    _stops: tuple[float, ...]
    EMPTY: ClassVar[SpliceList]

    def __init__(self, splices: Iterable[Interval | Sequence[float]] = ()) -> None:
        splices = list(splices)
        if len(splices) == 1:
            only = Interval.of(splices[0])
            one = only.start < only.stop
            object.__setattr__(self, "_starts", (only.start,) if one else ())
            object.__setattr__(self, "_stops", (only.stop,) if one else ())
            return
        starts: list[float] = []
        stops: list[float] = []
        for start, stop in sorted(tuple(Interval.of(splice)) for splice in splices):
            if start == stop:
                continue
            if stops and start <= stops[-1]:
                stops[-1] = max(stops[-1], stop)
            else:
                starts.append(start)
                stops.append(stop)
        object.__setattr__(self, "_starts", tuple(starts))
        object.__setattr__(self, "_stops", tuple(stops))

    @classmethod
    def of(cls, interval: Interval) -> SpliceList:
        """Return the list of one splice, or none if the interval has no length."""
        start, stop = interval.start, interval.stop
        return cls.unchecked((start,), (stop,)) if start < stop else cls.EMPTY

    @classmethod
    def unchecked(cls, starts: tuple[float, ...], stops: tuple[float, ...]) -> SpliceList:
        """Make a list of the ends of splices that are disjoint, in order and of positive length."""
        new = _new(cls)
        _set(new, "_starts", starts)
        _set(new, "_stops", stops)
        return new

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"SpliceList is immutable; cannot set {name!r}")

    @classmethod
    def parse(cls, text: str) -> SpliceList:
        """Read the text notation, as in ``"[0,1/4] [1/2,3/4]"``; :func:`str` writes it."""
        splices = []
        rest = text.strip()
        while rest:
            head, closed, tail = rest.partition("]")
            ends = head.removeprefix("[").split(",")
            if not head.startswith("[") or not closed or len(ends) != 2:
                raise IntervalError(f"expected '[a,b]' at {rest!r} in splice list {text!r}")
            try:
                splices.append(tuple(map(_read_number, ends)))
            except (ValueError, OverflowError, ZeroDivisionError):
                raise IntervalError(f"not a number in '{head}]' of splice list {text!r}") from None
            rest = tail.lstrip()
        return cls(splices)

    # -- asking ------------------------------------------------------------------------------------

    def __iter__(self) -> Iterator[Interval]:
        return map(Interval, self._starts, self._stops)

    def __len__(self) -> int:
        return len(self._starts)

    def __bool__(self) -> bool:
        return bool(self._starts)

    @property
    def is_empty(self) -> bool:
        """Whether there is no splice."""
        return not self._starts

    @property
    def hull(self) -> Interval:
        """The smallest interval that holds all splices; IntervalError when there are none."""
        if not self._starts:
            raise IntervalError("an empty splice list has no hull")
        return Interval(self._starts[0], self._stops[-1])

    @property
    def length(self) -> float:
        """The total length."""
        return sum(self._stops) - sum(self._starts)

    def contains(self, other: float | Interval | SpliceList) -> bool:
        """Whether a parameter, an interval or a whole splice list lies inside (ends included)."""
        if isinstance(other, SpliceList):
            return all(map(self._covers, other._starts, other._stops))
        if isinstance(other, Interval):
            return self._covers(other.start, other.stop)
        return self._covers(other, other)

    __contains__ = contains

    def _covers(self, start: float, stop: float) -> bool:
        k = bisect_right(self._starts, start) - 1
        return k >= 0 and stop <= self._stops[k]

    def lies_in(self, interval: Interval) -> bool:
        """Whether all splices lie inside an interval; so do none at all."""
        if not self._starts:
            return True
        return interval.start <= self._starts[0] and self._stops[-1] <= interval.stop

    # -- algebra -----------------------------------------------------------------------------------

    def __or__(self, other: SpliceList) -> SpliceList:
        if not other._starts:
            return self
        if not self._starts:
            return other
        small, large = _by_size(self, other)
        starts, stops = large._starts, large._stops
        for start, stop in zip(small._starts, small._stops, strict=True):
            i = bisect_left(stops, start)  # the first splice that reaches `start`
            j = bisect_right(starts, stop)  # one past the last that begins by `stop`
            if i < j:
                start, stop = min(start, starts[i]), max(stop, stops[j - 1])
            starts = (*starts[:i], start, *starts[j:])
            stops = (*stops[:i], stop, *stops[j:])
        return self.unchecked(starts, stops)

    def __and__(self, other: SpliceList) -> SpliceList:
        small, large = _by_size(self, other)
        starts: list[float] = []
        stops: list[float] = []
        for start, stop in zip(small._starts, small._stops, strict=True):
            i = bisect_right(large._stops, start)
            j = bisect_left(large._starts, stop)
            if i < j:
                starts += [max(start, large._starts[i]), *large._starts[i + 1 : j]]
                stops += [*large._stops[i : j - 1], min(stop, large._stops[j - 1])]
        return self.unchecked(tuple(starts), tuple(stops))

    def __sub__(self, other: SpliceList) -> SpliceList:
        starts, stops = self._starts, self._stops
        for start, stop in zip(other._starts, other._stops, strict=True):
            i = bisect_right(stops, start)
            j = bisect_left(starts, stop)
            if i >= j:
                continue
            first, last = starts[i], stops[j - 1]
            kept_starts, kept_stops = starts[:i], stops[:i]
            if first < start:
                kept_starts, kept_stops = (*kept_starts, first), (*kept_stops, start)
            if stop < last:
                kept_starts, kept_stops = (*kept_starts, stop), (*kept_stops, last)
            starts, stops = kept_starts + starts[j:], kept_stops + stops[j:]
        return self.unchecked(starts, stops)

    def intersects(self, other: SpliceList) -> bool:
        """Whether the interiors meet; cheaper than the intersection."""
        if not (self._starts and other._starts):
            return False
        small, large = _by_size(self, other)
        for start, stop in zip(small._starts, small._stops, strict=True):
            if bisect_right(large._stops, start) < bisect_left(large._starts, stop):
                return True
        return False

    # -- identity ----------------------------------------------------------------------------------

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SpliceList):
            return NotImplemented
        return self._starts == other._starts and self._stops == other._stops

    def __hash__(self) -> int:
        return hash((self._starts, self._stops))

    def __reduce__(self) -> tuple[object, ...]:
        return SpliceList, (list(zip(self._starts, self._stops, strict=True)),)

    def __str__(self) -> str:
        ends = zip(self._starts, self._stops, strict=True)
        return " ".join(f"[{_number(start)},{_number(stop)}]" for start, stop in ends)

    def __repr__(self) -> str:
        return f"SpliceList.parse({str(self)!r})"

    def check(self) -> None:
        """Raise InvariantError unless the list is canonical."""
        ends = [end for pair in zip(self._starts, self._stops, strict=True) for end in pair]
        if any(not a < b for a, b in pairwise(ends)):
            raise InvariantError("splices must be disjoint, sorted and of positive length", self)


_new, _set = object.__new__, object.__setattr__
SpliceList.EMPTY = SpliceList()


def _by_size(one: SpliceList, two: SpliceList) -> tuple[SpliceList, SpliceList]:
    return (one, two) if len(one._starts) <= len(two._starts) else (two, one)


def _read_number(text: str) -> float:
    # A Fraction of "1e999999999" would be a number of a billion digits: only plain fractions take
    # that way.
    numerator, slash, denominator = text.partition("/")
    return float(Fraction(int(numerator), int(denominator))) if slash else float(text)


def _number(value: float) -> str:
    fraction = Fraction(value)
    return str(fraction) if fraction.denominator <= LARGEST_DENOMINATOR else repr(float(value))
