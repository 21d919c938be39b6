"""Closed parameter intervals."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import attrs

from multirep.errors import IntervalError


@attrs.frozen(order=True)
class Interval:
    """A closed interval [start, stop] of parameters.

    Parameters
    ----------
    start, stop : float
        Finite, start <= stop.

    Raises
    ------
    IntervalError
        When reversed or not finite.

    Examples
    --------
    >>> a, b = Interval(0.25, 0.5)
    >>> Interval(0.0, 1.0).contains(b)
    True
    >>> Interval(0.0, 0.5).intersection(Interval(0.25, 1.0))
    Interval(start=0.25, stop=0.5)
    """

    start: float
    stop: float

    def __attrs_post_init__(self) -> None:
        if -math.inf < self.start <= self.stop < math.inf:
            return
        if not self.start <= self.stop:
            raise IntervalError(
                f"interval [{self.start!r}, {self.stop!r}] is reversed or not a number: "
                "start must be <= stop"
            )
        raise IntervalError(f"interval [{self.start!r}, {self.stop!r}] is not finite")

    @classmethod
    def of(cls, value: Interval | Sequence[float]) -> Interval:
        """Make an interval of an interval or a pair of numbers."""
        if isinstance(value, Interval):
            return value
        try:
            start, stop = value
            return cls(float(start), float(stop))
        except (TypeError, ValueError) as error:
            if isinstance(error, IntervalError):
                raise
            raise IntervalError(f"an interval is a pair of numbers, got {value!r}") from None

    def __iter__(self) -> Iterator[float]:
        yield self.start
        yield self.stop

    @property
    def length(self) -> float:
        """Its length, stop - start."""
        return self.stop - self.start

    @property
    def middle(self) -> float:
        """The parameter half way."""
        return 0.5 * (self.start + self.stop)

    def contains(self, other: float | Interval) -> bool:
        """Whether a parameter or a whole interval lies inside (ends included)."""
        if isinstance(other, Interval):
            return self.start <= other.start and other.stop <= self.stop
        return self.start <= other <= self.stop

    def overlaps(self, other: Interval) -> bool:
        """Whether the interiors meet."""
        return self.start < other.stop and other.start < self.stop

    def intersection(self, other: Interval) -> Interval | None:
        """Return what lies in both; None when they are apart."""
        start, stop = max(self.start, other.start), min(self.stop, other.stop)
        return Interval(start, stop) if start <= stop else None

    def hull(self, other: Interval) -> Interval:
        """Return the smallest interval that holds both."""
        return Interval(min(self.start, other.start), max(self.stop, other.stop))

    def widened(self, margin: float) -> Interval:
        """Return the interval grown by ``margin`` at both ends."""
        return Interval(self.start - margin, self.stop + margin)

    def clipped(self, bounds: Interval) -> Interval:
        """Return the part inside ``bounds``; IntervalError when there is none."""
        start, stop = max(self.start, bounds.start), min(self.stop, bounds.stop)
        if start > stop:
            raise IntervalError(f"{self} lies outside {bounds}")
        return Interval(start, stop)

    def __str__(self) -> str:
        return f"[{self.start:g}, {self.stop:g}]"
