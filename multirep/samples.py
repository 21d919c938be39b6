"""Samples of authors, checked, and kept for the next representation that follows the same stretch.

A stretch that a tool changed is stale in every other representation at once; it is sampled once.
"""

from __future__ import annotations

from typing import Protocol

from multirep.errors import MultirepError, PluginError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, join

#: How many are kept: the pieces of one composed splice, seams and short ends included.
KEPT = 8
#: Longer ones are not kept: they would count in memory, and are not those of a drag.
LONGEST = 4096
#: An earlier stretch is used when it covers so much of what is asked for, and leaves so many
#: chords: else sampling the rest at both ends costs more than sampling at once.
MOST = 3 / 4
FEWEST = 32


class Sampler(Protocol):
    """Samples an author on a stretch, certified within a tolerance."""

    def __call__(
        self, author: Representation, stretch: Interval, *, tolerance: float
    ) -> SampledSplice:
        """Return the samples; PluginError when what comes back is not what was asked for."""
        ...


def sample_author(author: Representation, stretch: Interval, *, tolerance: float) -> SampledSplice:
    """Sample an author; PluginError when what comes back is not what was asked for."""
    try:
        piece = author.sample(stretch, tolerance=tolerance)
    except MultirepError:
        raise
    except Exception as error:
        raise PluginError(
            f"{author.name!r}.sample failed with {type(error).__name__}: {error}", author.name
        ) from error
    if not isinstance(piece, SampledSplice) or piece.interval != stretch:
        found = piece.interval if isinstance(piece, SampledSplice) else f"a {type(piece).__name__}"
        raise PluginError(f"{author.name!r}.sample({stretch}) returned {found}", author.name)
    if not piece.bound <= tolerance:
        raise PluginError(
            f"{author.name!r}.sample certified {piece.bound:g} where {tolerance:g} was asked for",
            author.name,
        )
    return piece


class RecentSamples:
    """A :class:`Sampler` that remembers what it sampled.

    The same value, stretch and tolerance are sampled once; of a stretch that mostly overlaps an
    earlier one only the rest is sampled. Values are immutable and told apart by identity.

    Examples
    --------
    >>> from multirep.representations import Polyline
    >>> line, recent = Polyline([0, 1], [[0, 0], [1, 1]]), RecentSamples()
    >>> first = recent(line, Interval(0, 0.5), tolerance=1e-3)
    >>> recent(line, Interval(0, 0.5), tolerance=1e-3) is first
    True
    """

    def __init__(self) -> None:
        self._kept: list[tuple[Representation, float, SampledSplice]] = []

    def __call__(
        self, author: Representation, stretch: Interval, *, tolerance: float
    ) -> SampledSplice:
        """Return what was sampled before as far as it goes, and sample the rest."""
        near = [old for whose, within, old in self._kept if whose is author and within == tolerance]
        for old in near:
            if old.interval == stretch:
                return old
        for old in near:
            common = old.interval.intersection(stretch) if len(old.t) > FEWEST else None
            if common is not None and common.length >= MOST * stretch.length:
                piece = self._continued(author, old, stretch, tolerance)
                break
        else:
            piece = sample_author(author, stretch, tolerance=tolerance)
        if len(piece.t) <= LONGEST:
            self._kept = [(author, tolerance, piece), *self._kept[: KEPT - 1]]
        return piece

    @staticmethod
    def _continued(
        author: Representation, old: SampledSplice, stretch: Interval, tolerance: float
    ) -> SampledSplice:
        """Keep the chords of ``old`` that lie in ``stretch``; sample what is left at both ends."""
        first = int(old.t.searchsorted(stretch.start))
        last = int(old.t.searchsorted(stretch.stop, "right")) - 1
        if last - first < FEWEST:
            return sample_author(author, stretch, tolerance=tolerance)
        start, stop = float(old.t[first]), float(old.t[last])
        pieces = [old.cut(first, last)]
        if stretch.start < start:
            rest = Interval(stretch.start, start)
            pieces.insert(0, sample_author(author, rest, tolerance=tolerance))
        if stop < stretch.stop:
            rest = Interval(stop, stretch.stop)
            pieces.append(sample_author(author, rest, tolerance=tolerance))
        return join(pieces)
