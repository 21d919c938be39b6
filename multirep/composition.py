"""What the authors say on an interval, as one sampled splice.

Every stretch is sampled from its *author*, never from a copy, so errors cannot chain (DESIGN
section 3). Two authors that meet at c may differ there by up to one hop; the composed polyline L
passes through the middle, and the chords beside c carry half the gap in their certificate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from time import perf_counter_ns

from multirep.events import Event, Sampled
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, join
from multirep.samples import Sampler, sample_author
from multirep.state import State

#: Chords beside a fixed end are certified to this part of the sampling tolerance: at such an end
#: the whole hop may be used up by the gap, so the samples must not use any of it. Smaller costs a
#: few more samples there.
SHORT_FIRST_CHORDS = 1 / 64


def compose(
    state: State,
    interval: Interval,
    *,
    tolerance: float,
    limit: float = 0.0,
    fixed: tuple[Representation | None, Representation | None] = (None, None),
    emit: Callable[[Event], None] | None = None,
    sample: Sampler = sample_author,
) -> SampledSplice:
    """Sample the authors of ``interval``, each within ``tolerance``, and join the pieces.

    Parameters
    ----------
    state : State
    interval : Interval
    tolerance : float
        Certified distance of each piece from its author.
    limit : float
        How much farther a piece may be for vertices that are left out.
    fixed : pair of Representation or None
        What the splice must meet at either end because it is the author outside; chords are
        shortened there.
    emit : callable, optional
        Receives a :class:`~multirep.events.Sampled` per piece.
    sample : Sampler
        May remember what it sampled before.

    Returns
    -------
    SampledSplice
        Its ``bound`` certifies the distance from the authors, seams included.
    """
    pieces: list[SampledSplice] = []
    for stretch, name in state.authors.segments(interval):
        begin = perf_counter_ns()
        author = state.author_value(name)
        found = [sample(author, stretch, tolerance=tolerance, limit=limit)]
        if fixed[0] is not None and stretch.start == interval.start:
            found = _short_end(author, found[0], tolerance, limit, fixed[0], sample, first=True)
        if fixed[1] is not None and stretch.stop == interval.stop:
            last = _short_end(author, found[-1], tolerance, limit, fixed[1], sample, first=False)
            found = [*found[:-1], *last]
        pieces += found
        if emit is not None:
            elapsed = (perf_counter_ns() - begin) / 1000
            samples = sum([len(piece.t) - 1 for piece in found]) + 1
            bound = max([piece.bound for piece in found])
            emit(Sampled(name, stretch, samples, bound, elapsed))
    return join(pieces)


def _short_end(
    author: Representation,
    piece: SampledSplice,
    tolerance: float,
    limit: float,
    outside: Representation,
    sample: Sampler,
    *,
    first: bool,
) -> list[SampledSplice]:
    """Sample the chord at a fixed end finely if the gap there leaves no room for its sagitta.

    A piece of one chord is cut in two, too: else `join` would charge that chord with half the gap
    of the seam at its other end.

    Returns
    -------
    list of SampledSplice
        What is fine and the rest, in their order, or the piece as it is.
    """
    end, alone = 0 if first else -1, len(piece.t) == 2
    bound = piece.bound if piece.chord_bounds is None else piece.chord_bounds[end]
    if not alone and bound <= SHORT_FIRST_CHORDS * tolerance:
        return [piece]
    there = outside(float(piece.t[end]))
    if math.dist(there.tolist(), piece.points[end].tolist()) <= tolerance:
        return [piece]
    start, stop = (piece.t[:2] if first else piece.t[-2:]).tolist()
    middle = 0.5 * start + 0.5 * stop
    ends = [start, middle, stop] if alone and start < middle < stop else [start, stop]
    share = SHORT_FIRST_CHORDS
    fine = [
        sample(author, Interval(*part), tolerance=share * tolerance, limit=share * limit)
        for part in pairwise(ends)
    ]
    if alone:
        return fine
    chords = len(piece.t) - 1
    return [*fine, piece.cut(1, chords)] if first else [piece.cut(0, chords - 1), *fine]
