"""What authors say together: each stretch from its author, seams through the middle, certified."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from multirep.authors import AuthorMap
from multirep.composition import compose
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice, chord_bounds, join
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.testing import CountingRepresentation, LoopbackRepresentation
from multirep.testing.strategies import dyadic_intervals, sampled_splices, splice_lists

T = Interval(0.0, 1.0)
gaps = st.integers(0, 16).map(lambda k: k / 64)


def wave(kind: type[LoopbackRepresentation], shift: float, n: int) -> LoopbackRepresentation:
    t = np.linspace(0, 1, n)
    return kind(t, np.column_stack([t, np.sin(5 * t) + shift]))


def state_of(splices: SpliceList, shift: float) -> State:
    """Two authors: one everywhere, the other, ``shift`` away from it, on ``splices``."""
    values: dict[str, Representation] = {
        "loopback": wave(LoopbackRepresentation, 0.0, 30),
        "counting": wave(CountingRepresentation, shift, 41),
    }
    held = {name: Held(value, SpliceList.EMPTY) for name, value in values.items()}
    authors = AuthorMap.of(T, "loopback").assigned(splices, "counting")
    return State(1.0, held, authors)


@settings(max_examples=100)
@given(splices=splice_lists(denominator=16), interval=dyadic_intervals(16), shift=gaps)
def test_each_stretch_is_certified_against_its_author(
    splices: SpliceList, interval: Interval, shift: float
) -> None:
    """On both sides of every seam L is within its chord bounds of whoever is the author there."""
    state = state_of(splices, shift)
    sampled = compose(state, interval, tolerance=1e-3)
    assert sampled.interval == interval
    assert sampled.bound == chord_bounds(sampled).max()
    for k, bound in enumerate(chord_bounds(sampled)):
        a, b = sampled.t[k], sampled.t[k + 1]
        stretches = state.authors.segments(Interval(float(a), float(b)))
        assert len(stretches) == 1, "a chord does not run across a seam"
        author = state.author_value(stretches[0][1])
        t = np.linspace(a, b, 17)
        apart = np.linalg.norm(author(t) - sampled(t), axis=1)
        assert apart.max() <= bound + 1e-12


@given(splices=splice_lists(denominator=16, max_splices=3), shift=gaps)
def test_seams_pass_through_the_middle(splices: SpliceList, shift: float) -> None:
    """Neither author is favoured where two meet: half the gap each, and nothing elsewhere."""
    state = state_of(splices, shift)
    sampled = compose(state, T, tolerance=1e-3)
    widest = 0.0
    for t, left, right in state.authors.seams:
        one, two = state.author_value(left)(t), state.author_value(right)(t)
        np.testing.assert_allclose(sampled(t), 0.5 * (one + two), rtol=0, atol=1e-14)
        widest = max(widest, float(np.linalg.norm(one - two)))
    assert sampled.bound == pytest.approx(0.5 * widest, abs=1e-12)


@given(shift=gaps.filter(bool), last=st.booleans())
def test_a_seam_near_a_fixed_end_leaves_the_end_all_its_room(shift: float, last: bool) -> None:
    """Even when one chord leads from the seam to the end, at which the gap may use up the hop."""
    seam = (28.5 if last else 0.5) / 29  # the first author's parameters are multiples of 1 / 29
    end = Interval(seam, T.stop) if last else Interval(T.start, seam)
    state = state_of(SpliceList([T]) - SpliceList([end]), shift)
    outside = wave(LoopbackRepresentation, 0.5, 30)
    sampled = compose(state, T, tolerance=1e-3, fixed=(None, outside) if last else (outside, None))
    assert chord_bounds(sampled)[-1 if last else 0] == 0.0
    assert sampled.bound == pytest.approx(0.5 * shift, abs=2e-3)  # their chords differ
    chords = sum(end.contains(float(t)) for t in sampled.t) - 1
    assert chords == 2


@given(
    left=sampled_splices(interval=Interval(0.0, 0.5)),
    right=sampled_splices(interval=Interval(0.5, 1)),
)
def test_joined_pieces_keep_their_samples(left: SampledSplice, right: SampledSplice) -> None:
    """All samples but the one at the seam come through bit by bit, corners too."""
    joined = join([left, right])
    np.testing.assert_array_equal(joined.t, np.r_[left.t, right.t[1:]])
    np.testing.assert_array_equal(joined.points[: len(left.t) - 1], left.points[:-1])
    np.testing.assert_array_equal(joined.points[len(left.t) :], right.points[1:])
    assert joined.breaks == tuple(sorted({*left.breaks, *right.breaks}))
    half = 0.5 * np.linalg.norm(left.points[-1] - right.points[0])
    expected = np.r_[chord_bounds(left), chord_bounds(right)]
    expected[[len(left.t) - 2, len(left.t) - 1]] += half
    np.testing.assert_allclose(chord_bounds(joined), expected, rtol=0, atol=1e-12)
    assert join([left]) is left
