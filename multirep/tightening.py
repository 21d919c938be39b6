"""Changing the tolerance: what no longer meets it becomes stale, and seams that gape are closed.

Two authors that meet at c agree there only within the hop of the tolerance under which they were
brought into step. Under a smaller tolerance the gap may be too wide for any continuous curve to
follow both; then the author on the right gives way: over a stretch beside the seam it is led into
the end of the left one. That is the one place where an authored stretch changes without a tool, by
no more than the gap.
"""

from __future__ import annotations

from collections.abc import Callable

import attrs
import numpy as np

from multirep.composition import compose
from multirep.deviation import chord_deviations
from multirep.events import Event, Fitted
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, join
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.synchronization import SAMPLING_SHARE, check_edit, evolve_stale, hop

#: A seam is closed when its gap exceeds this part of the hop; the rest is room for those who must
#: follow both.
WIDEST_SEAM = 1 / 2
#: Certified distance at which the author that gives way meets the other, in terms of the hop.
SEAM_SHARE = 1 / 8


def with_tolerance(state: State, tolerance: float, emit: Callable[[Event], None]) -> State:
    """Return the state under another tolerance.

    Loosening costs nothing. Tightening costs one certified comparison of every kind with the
    authors.

    Raises
    ------
    ToleranceError
        When a seam cannot be closed within the new tolerance.
    """
    tightened = tolerance < state.tolerance
    state = attrs.evolve(state, tolerance=tolerance)
    if not tightened:
        return state
    for seam in state.authors.seams:
        state = _close(state, *seam, emit)
    held = {name: _recheck(state, name, item) for name, item in state.held.items()}
    return attrs.evolve(state, held=held)


def _recheck(state: State, name: str, held: Held) -> Held:
    """Mark as stale where a value cannot be proved to be within the hop of the authors."""
    if held.value is None:
        return held
    delta = hop(state.tolerance)
    stale: list[Interval] = []
    for stretch, author in state.authors.segments(state.authors.domain):
        if author == name:
            continue
        t, _, proved = chord_deviations(
            held.value,
            state.author_value(author),
            stretch,
            tolerance=SAMPLING_SHARE / 4 * delta,
        )
        far = np.flatnonzero(proved > delta)
        stale += [Interval(t[k], t[k + 1]) for k in far]
    return Held(held.value, held.stale | SpliceList(stale))


def _close(
    state: State, seam: float, left: str, right: str, emit: Callable[[Event], None]
) -> State:
    """Lead the author on the right of a seam into the end of the one on the left, if they gape."""
    delta = hop(state.tolerance)
    mine, other = state.author_value(right), state.author_value(left)
    gap = other(seam) - mine(seam)
    if float(np.linalg.norm(gap)) <= WIDEST_SEAM * delta:
        return state
    (before, _), (after, _) = _beside(state, seam)
    ramp = _ramped(mine.sample(after, tolerance=SAMPLING_SHARE * SEAM_SHARE * delta), gap)
    behind = compose(
        state, before, tolerance=SAMPLING_SHARE * SEAM_SHARE * delta, fixed=(mine, None)
    )
    lead = _led_out(behind, mine)
    sampled = join([lead, ramp])
    edit = mine.splice(sampled, tolerance=SEAM_SHARE * delta)
    check_edit(mine, edit, right)
    emit(Fitted(right, sampled.interval, edit.splices, edit.value.size, edit.bound, 0.0))
    held = state.held[right]
    return evolve_stale(state, right, Held(edit.value, held.stale), SpliceList.of(after))


def _beside(state: State, seam: float) -> tuple[tuple[Interval, str], tuple[Interval, str]]:
    """Return the whole stretches left and right of a seam with their authors."""
    stretches = state.authors.segments(state.authors.domain)
    k = next(k for k, (stretch, _) in enumerate(stretches) if stretch.start == seam)
    return stretches[k - 1], stretches[k]


def _ramped(sampled: SampledSplice, gap: np.ndarray) -> SampledSplice:
    """Shift the start of a sampled splice by ``gap``, fading linearly to nothing at its end."""
    a, b = sampled.interval
    fade = ((b - sampled.t) / (b - a))[:, None]
    return attrs.evolve(sampled, points=sampled.points + fade * gap)


def _led_out(sampled: SampledSplice, value: Representation) -> SampledSplice:
    """Let a sampled splice begin where ``value`` stands, fading linearly to the samples.

    The certificate stays that of the samples: what the shift does there is rechecked afterwards.
    """
    a, b = sampled.interval
    fade = ((b - sampled.t) / (b - a))[:, None]
    return attrs.evolve(sampled, points=sampled.points + fade * (value(a) - sampled.points[0]))
