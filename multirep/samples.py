"""Samples of authors, checked, and kept for the next representation that follows the same stretch.

A stretch that a tool changed is stale in every other representation at once; it is sampled once.
Beside it a fit takes in some of what did not change, where an author may have thousands of
vertices. These are thinned once, and not again while the author stays as it is there.
"""

from __future__ import annotations

from typing import Protocol

from multirep.edit import Edit
from multirep.errors import MultirepError, PluginError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, join
from multirep.thinning import ThinnedStretches, parts, thinned

#: How many are kept: the pieces of one composed splice, seams and short ends included.
KEPT = 8
#: Longer ones are not kept: they would count in memory, and are not those of a drag.
LONGEST = 4096
#: An earlier stretch is used when it covers so much of what is asked for, and leaves so many
#: chords: else sampling the rest at both ends costs more than sampling at once.
MOST = 3 / 4
FEWEST = 32
#: Of so many values, or versions of one, thinned stretches are kept: those of a drag, and what it
#: began with, to which an undo goes back.
VERSIONS = 6


class Sampler(Protocol):
    """Samples an author on a stretch, certified within a tolerance."""

    def __call__(
        self, author: Representation, stretch: Interval, *, tolerance: float, limit: float = 0.0
    ) -> SampledSplice:
        """Return the samples; PluginError when what comes back is not what was asked for.

        The polyline may be farther from the author by ``limit``, for vertices that are left out.
        """
        ...


def sample_author(
    author: Representation, stretch: Interval, *, tolerance: float, limit: float = 0.0
) -> SampledSplice:
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
    return thinned(piece, limit) if limit else piece


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
        self._thinned: list[ThinnedStretches] = []

    def __call__(
        self, author: Representation, stretch: Interval, *, tolerance: float, limit: float = 0.0
    ) -> SampledSplice:
        """Return what was sampled before as far as it goes, and sample the rest."""
        if limit:
            return self._sampled_thinly(author, stretch, tolerance, limit)
        near = self._near(author, tolerance)
        for old in near:
            if old.interval == stretch:
                return old
        piece = self._continued(near, author, stretch, tolerance)
        self._keep(author, tolerance, piece)
        return piece

    def _near(self, author: Representation, tolerance: float) -> list[SampledSplice]:
        return [old for whose, within, old in self._kept if whose is author and within == tolerance]

    def _keep(self, author: Representation, tolerance: float, piece: SampledSplice) -> None:
        if len(piece.t) <= LONGEST:
            self._kept = [(author, tolerance, piece), *self._kept[: KEPT - 1]]

    @staticmethod
    def _continued(
        near: list[SampledSplice], author: Representation, stretch: Interval, tolerance: float
    ) -> SampledSplice:
        """Keep the chords of one that mostly covers ``stretch``; sample the rest at both ends."""
        for old in near:
            common = old.interval.intersection(stretch) if len(old.t) > FEWEST else None
            if common is not None and common.length >= MOST * stretch.length:
                break
        else:
            return sample_author(author, stretch, tolerance=tolerance)
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

    def _sampled_thinly(
        self, author: Representation, stretch: Interval, tolerance: float, limit: float
    ) -> SampledSplice:
        """Thin a stretch part by part, and remember the parts and the whole."""
        known = self._thinned_of(author) or ThinnedStretches(author)
        others = [other for other in self._thinned if other is not known]
        self._thinned = [known, *others[: VERSIONS - 1]]
        joined = known.recall(stretch, tolerance=tolerance, limit=limit)
        if joined is not None:
            return joined
        near = self._near(author, tolerance)
        pieces, lasting = [], True
        for part in parts(stretch, author.domain, author.size):
            piece = known.recall(part, tolerance=tolerance, limit=limit)
            if piece is None:
                whole = next((old for old in near if old.interval == part), None)
                if whole is None:
                    whole = sample_author(author, part, tolerance=tolerance)
                piece = thinned(whole, limit)
                if piece is not whole:
                    known.remember(part, piece, tolerance=tolerance, limit=limit)
                else:  # as few as need be: for others, too
                    self._keep(author, tolerance, piece)
                    lasting = False
            pieces.append(piece)
        joined = join(pieces)
        if lasting and len(pieces) > 1:
            known.remember(stretch, joined, tolerance=tolerance, limit=limit)
        return joined

    def edited(self, before: Representation, edit: Edit[Representation]) -> None:
        """Hear of an edit: beside it, what was thinned of the old value is that of the new one."""
        known = self._thinned_of(before)
        if known is not None:
            self._thinned = [known.followed(edit), *self._thinned[: VERSIONS - 1]]

    def _thinned_of(self, author: Representation) -> ThinnedStretches | None:
        return next((known for known in self._thinned if known.are_of(author)), None)
