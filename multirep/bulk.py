"""First views of long curves: sampled and thinned piece by piece, with progress.

A curve of a million vertices is not fitted against all of them. It is sampled a piece at a time,
and vertices that hardly matter are left out at once; what that costs is added to the certificate.
So memory is bounded by a piece and by what the curve's shape takes, time is linear, and listeners
hear how far it is.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from multirep.composition import compose
from multirep.events import Event, Fitting
from multirep.interval import Interval
from multirep.sampled import SampledSplice, chord_bounds, join
from multirep.samples import Sampler, sample_author
from multirep.splines import simplified
from multirep.state import State

#: Curves of more stored controls than this are taken in pieces of about so many. Larger needs more
#: memory (some 200 bytes each); smaller leaves more borders of pieces, a vertex each.
PIECE = 2**16


def composed_in_pieces(
    state: State,
    kind: str,
    *,
    tolerance: float,
    limit: float,
    emit: Callable[[Event], None],
    sample: Sampler = sample_author,
) -> SampledSplice:
    """Sample the authors over all of T; if they are long, piece by piece and thinned.

    Parameters
    ----------
    state : State
    kind : str
        Who is going to be fitted, for events.
    tolerance : float
        Certified distance of the samples from each author.
    limit : float
        How much farther the polyline may be off for vertices that are left out.
    emit : callable
        Receives a :class:`~multirep.events.Fitting` after each piece.
    sample : Sampler
        May remember what it sampled before.

    Returns
    -------
    SampledSplice
        Its ``bound`` certifies the distance from the authors.
    """
    domain = state.authors.domain
    count = -(-sum(state.author_value(name).size for name in {*state.authors.names}) // PIECE)
    if count <= 1:
        return compose(state, domain, tolerance=tolerance, emit=emit, sample=sample)
    ends = np.linspace(domain.start, domain.stop, count + 1).tolist()
    pieces: list[SampledSplice] = []
    for k in range(count):
        piece = compose(
            state, Interval(*ends[k : k + 2]), tolerance=tolerance, emit=emit, sample=sample
        )
        pieces.append(_thinned(piece, limit))
        emit(Fitting(kind, k + 1, count + 1))
    return join(pieces)


def _thinned(sampled: SampledSplice, limit: float) -> SampledSplice:
    """Leave out vertices of a polyline as far as a limit lets it; the certificate says so."""
    t, bounds = sampled.t, chord_bounds(sampled)
    kept, deviation = simplified(t, sampled.points, np.full(len(bounds), limit))
    bounds = np.maximum.reduceat(bounds, kept[:-1]) + deviation
    t = t[kept]
    breaks = set(sampled.breaks).intersection(t.tolist())
    return SampledSplice(
        t,
        sampled.points[kept],
        bound=float(bounds.max()),
        breaks=tuple(sorted(breaks)),
        chord_bounds=bounds,
    )
