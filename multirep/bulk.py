"""Long stretches, as in first views: sampled and thinned piece by piece, with progress.

A curve of a million vertices is not fitted against all of them. It is sampled a piece at a time,
and vertices that hardly matter are left out at once; what that costs is added to the certificate.
So memory is bounded by a piece and by what the curve's shape takes, time is linear, and listeners
hear how far it is.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from multirep.composition import compose
from multirep.events import Event, Fitting
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, join
from multirep.samples import Sampler, sample_author
from multirep.state import State

#: Stretches of more stored controls than this are thinned. Shorter ones are followed as they are:
#: a fit tries knots a few times, each time against all samples.
LONG = 2**10
#: They are taken in pieces of about so many. Larger needs more memory (some 200 bytes each);
#: smaller leaves more borders of pieces, a vertex each.
PIECE = 2**16


def composed_in_pieces(
    state: State,
    interval: Interval,
    kind: str,
    *,
    tolerance: float,
    limit: float,
    fixed: tuple[Representation | None, Representation | None] = (None, None),
    emit: Callable[[Event], None],
    sample: Sampler = sample_author,
) -> SampledSplice:
    """Sample the authors as :func:`compose` does; if they are long, piece by piece and thinned.

    Parameters
    ----------
    state : State
    interval : Interval
    kind : str
        Who is going to be fitted, for events.
    tolerance : float
        Certified distance of the samples from each author.
    limit : float
        How much farther the polyline may be off for vertices that are left out.
    fixed : pair of Representation or None
        See :func:`compose`.
    emit : callable
        Receives a :class:`~multirep.events.Fitting` after each piece.
    sample : Sampler
        May remember what it sampled before.

    Returns
    -------
    SampledSplice
        Its ``bound`` certifies the distance from the authors.
    """
    controls = controls_on(state, interval)
    if controls <= PIECE:
        return compose(
            state,
            interval,
            tolerance=tolerance,
            limit=limit if controls > LONG else 0.0,
            fixed=fixed,
            emit=emit,
            sample=sample,
        )
    count = -(-controls // PIECE)
    ends = np.linspace(interval.start, interval.stop, count + 1).tolist()
    pieces: list[SampledSplice] = []
    for k in range(count):
        piece = compose(
            state,
            Interval(*ends[k : k + 2]),
            tolerance=tolerance,
            limit=limit,
            fixed=(fixed[0] if k == 0 else None, fixed[1] if k == count - 1 else None),
            emit=emit,
            sample=sample,
        )
        pieces.append(piece)
        emit(Fitting(kind, k + 1, count + 1))
    return join(pieces)


def controls_on(state: State, interval: Interval) -> int:
    """About how many controls the authors have on an interval, were those of each evenly spread."""
    controls = 0.0
    for stretch, name in state.authors.segments(interval):
        controls += state.author_value(name).size * stretch.length
    return math.ceil(controls / state.authors.domain.length)
