"""Fewer samples for long stretches: what that costs is added to the certificate."""

from __future__ import annotations

import math
from itertools import pairwise
from weakref import ref

import numpy as np

from multirep.edit import Edit
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.splines.simplification import simplified

#: So many controls of an author are thinned together, so that they can be remembered
#: together: more are thinned again for a change in one of them, fewer leave a vertex too many each.
PART = 2**11
#: Stretches that would make more parts are thinned at once: there are too many to be remembered.
MOST_PARTS = 24
#: Parts are not cut from the ends of a stretch that are shorter than this, in terms of a part.
SLIVER = 1 / 8
#: Where the first mark is, in terms of a part: off any grid that vertices may lie on, for a corner
#: at a mark would be inside of no part.
OFFSET = 0.5 * (math.sqrt(5.0) - 1.0)
#: How many stretches are remembered, and how many samples in all: more stretches are looked through
#: at each edit, more samples count in memory, fewer are soon thinned again where two places are
#: edited in turns.
KEPT = 64
KEPT_SAMPLES = 2**14


def thinned(sampled: SampledSplice, limit: float) -> SampledSplice:
    """Leave out vertices of a polyline as far as a limit lets it; the certificate says so.

    Samples that were chosen for a tolerance are as few as need be, and are left as they are.

    Parameters
    ----------
    sampled : SampledSplice
    limit : float
        How much farther from the source the polyline may be.

    Returns
    -------
    SampledSplice
        Of its breaks, those inside: at its ends it depends on nothing beyond. Cost: O(samples).

    Examples
    --------
    >>> t = np.linspace(0, 1, 9)
    >>> tent = SampledSplice(t, np.stack([t, np.abs(t - 0.5)], axis=1))
    >>> thinned(tent, 1e-6).t
    array([0. , 0.5, 1. ])
    """
    t, bounds = sampled.t, sampled.chord_bounds
    mean = sampled.bound if bounds is None else float(bounds.mean())
    if len(t) < 3 or mean > limit:
        return sampled
    kept, deviation = simplified(t, sampled.points, limit)
    deviation = deviation + (
        sampled.bound if bounds is None else np.maximum.reduceat(bounds, kept[:-1])
    )
    t = t[kept]
    breaks = set(sampled.breaks).intersection(t[1:-1].tolist()) if sampled.breaks else ()
    return SampledSplice.unchecked(
        t,
        sampled.points[kept],
        bound=float(deviation.max()),
        breaks=tuple(sorted(breaks)),
        chord_bounds=deviation,
    )


def parts(stretch: Interval, domain: Interval, controls: int) -> list[Interval]:
    """Cut a stretch where any other stretch of the same curve would be cut, too.

    At marks T / 2^k apart, with :data:`PART` controls or up to half as many in each part, were they
    evenly spread; a stretch that is no longer than a part stays whole.

    Examples
    --------
    >>> [str(part) for part in parts(Interval(0.1, 0.6), Interval(0, 1), 4 * PART)]
    ['[0.1, 0.154508]', '[0.154508, 0.404508]', '[0.404508, 0.6]']
    """
    width = domain.length / 2 ** max(math.ceil(math.log2(max(controls, 1) / PART)), 0)
    origin = domain.start + OFFSET * width
    first = math.floor((stretch.start - origin) / width + SLIVER) + 1
    last = math.ceil((stretch.stop - origin) / width - SLIVER) - 1
    if stretch.length <= width or last - first + 2 > MOST_PARTS:
        return [stretch]
    marks = [origin + k * width for k in range(first, last + 1)]
    return [Interval(*pair) for pair in pairwise([stretch.start, *marks, stretch.stop])]


class ThinnedStretches:
    """Thinned samples of an author, which are also those of its next version where it is the same.

    They depend on nothing but their stretch, not on what follows at its ends.

    Parameters
    ----------
    author : Representation
        Not kept: an old version would keep all blocks that later ones have replaced.
    """

    def __init__(self, author: Representation) -> None:
        self._author = ref(author)
        self._known: dict[tuple[float, float, float, float], SampledSplice] = {}
        self._samples = 0

    def are_of(self, author: Representation) -> bool:
        """Whether they are those of exactly this value."""
        return self._author() is author

    def recall(self, stretch: Interval, *, tolerance: float, limit: float) -> SampledSplice | None:
        """Return what is known of a stretch."""
        key = (stretch.start, stretch.stop, tolerance, limit)
        piece = self._known.pop(key, None)
        if piece is not None:
            self._known[key] = piece  # now the last to be forgotten
        return piece

    def remember(
        self, stretch: Interval, piece: SampledSplice, *, tolerance: float, limit: float
    ) -> None:
        """Keep the samples of a stretch; what was not asked for the longest time is forgotten."""
        self._known[stretch.start, stretch.stop, tolerance, limit] = piece
        self._samples += len(piece.t)
        while len(self._known) > KEPT or self._samples > KEPT_SAMPLES:
            self._samples -= len(self._known.pop(next(iter(self._known))).t)

    def followed(self, edit: Edit[Representation]) -> ThinnedStretches:
        """Return what is known of the author's next version: stretches on which it is the same."""
        after, known = ThinnedStretches(edit.value), self._known.copy()
        for splice in edit.splices:
            start, stop = splice.start, splice.stop
            known = {
                key: piece for key, piece in known.items() if key[1] <= start or stop <= key[0]
            }
        after._known = known
        after._samples = sum([len(piece.t) for piece in known.values()])
        return after
