"""A stretch that several representations follow is sampled once, and never from an older value."""

import gc
import weakref
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

import multirep as mr
from multirep.errors import PluginError
from multirep.interval import Interval
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.samples import KEPT, LONGEST, VERSIONS, RecentSamples, sample_author
from multirep.thinning import KEPT as KEPT_THINNED
from multirep.thinning import KEPT_SAMPLES, MOST_PARTS, OFFSET, PART, SLIVER, parts


class Counting(Polyline):
    """A polyline that counts how often it is sampled."""

    name = "counting"
    asked: list[Interval] = []  # noqa: RUF012 - emptied by each test

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Sample and count."""
        self.asked.append(interval)
        return super().sample(interval, tolerance=tolerance)


def test_a_first_view_of_two_representations_samples_the_author_once() -> None:
    """Both the NURBS and the wavelet follow the same samples of T."""
    Counting.asked.clear()
    t = np.linspace(0, 1, 33)
    author = Counting(t, np.stack([t, np.sin(9 * t)], axis=1))
    curve = mr.MultiRepresentation(author, tolerance=1e-2, kinds=[Counting, Nurbs, WaveletBSpline])
    curve.view(Nurbs)
    curve.view(WaveletBSpline)
    assert Counting.asked == [Interval(0, 1)]


def test_an_edited_author_is_sampled_anew() -> None:
    """Samples belong to a value: after an edit they are those of the new value."""
    t = np.linspace(0, 1, 9)
    before = Polyline(t, -t[:, None])
    after = before.move_vertex(4, [1.0]).value
    recent, where = RecentSamples(), Interval(0.25, 0.75)
    assert recent(before, where, tolerance=1e-3).points.max() == -0.25
    assert recent(after, where, tolerance=1e-3).points.max() == 1.0
    assert recent(before, where, tolerance=1e-3).points.max() == -0.25


def test_another_stretch_or_tolerance_is_sampled_anew() -> None:
    """What is found again was asked for in the very same words."""
    line = Polyline([0, 1], [[0, 0], [1, 1]])
    recent = RecentSamples()
    one = recent(line, Interval(0, 0.5), tolerance=1e-3)
    assert recent(line, Interval(0, 0.5), tolerance=1e-4) is not one
    assert recent(line, Interval(0, 0.25), tolerance=1e-3).interval == Interval(0, 0.25)
    assert recent(line, Interval(0, 0.5), tolerance=1e-3) is one


def test_only_few_and_short_samples_are_kept() -> None:
    """The memory of recent samples is bounded, whatever the curve."""
    t = np.linspace(0, 1, LONGEST + 2)
    long = Polyline(t, t[:, None])
    recent = RecentSamples()
    assert recent(long, long.domain, tolerance=1e-3) is not recent(
        long, long.domain, tolerance=1e-3
    )
    line = Polyline([0, 1], [[0, 0], [1, 1]])
    first = recent(line, Interval(0, 1), tolerance=1e-3)
    for k in range(1, KEPT + 1):
        recent(line, Interval(0, k / 64), tolerance=1e-3)
    assert recent(line, Interval(0, 1), tolerance=1e-3) is not first


def test_a_sample_that_misses_its_tolerance_names_the_author() -> None:
    """Nothing that an author did not certify is passed on."""

    class Careless(Polyline):
        name = "careless"

        def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
            return SampledSplice([interval.start, interval.stop], [[0, 0], [1, 1]], bound=1.0)

    with pytest.raises(PluginError, match=r"'careless'\.sample certified 1"):
        sample_author(Careless([0, 1], [[0, 0], [1, 1]]), Interval(0, 1), tolerance=0.5)


@given(
    st.lists(st.integers(0, 64), min_size=2, max_size=2, unique=True),
    st.lists(st.integers(0, 64), min_size=2, max_size=2, unique=True),
)
def test_what_overlaps_an_earlier_stretch_is_certified_like_any_other(
    one: list[int], two: list[int]
) -> None:
    """Kept chords and newly sampled ends together keep to the tolerance and to the curve."""
    t = np.linspace(0, 1, 33)
    author = Nurbs.fit(SampledSplice(t, np.stack([t, np.sin(40 * t)], axis=1)), tolerance=1e-2)
    recent, tolerance = RecentSamples(), 1e-4
    recent(author, Interval(min(one) / 64, max(one) / 64), tolerance=tolerance)
    piece = recent(author, Interval(min(two) / 64, max(two) / 64), tolerance=tolerance)
    assert piece.interval == Interval(min(two) / 64, max(two) / 64)
    assert piece.bound <= tolerance
    assert np.array_equal(piece.points, author(piece.t))
    dense = np.unique(np.concatenate((piece.t, np.linspace(*piece.interval, 500))))
    off = np.linalg.norm(author(dense) - piece(dense), axis=1)
    assert off.max() <= piece.bound * (1 + 1e-9)


def test_of_a_longer_stretch_only_the_rest_is_sampled() -> None:
    """What an earlier representation asked for is not sampled again for one that reaches out."""
    Counting.asked.clear()
    t = np.linspace(0, 1, 1025)
    author = Counting(t, np.stack([t, np.sin(9 * t)], axis=1))
    recent = RecentSamples()
    recent(author, Interval(0.25, 0.75), tolerance=1e-4)
    recent(author, Interval(0.125, 0.75), tolerance=1e-4)
    assert Counting.asked == [Interval(0.25, 0.75), Interval(0.125, 0.25)]
    recent(author, Interval(0.125, 0.9), tolerance=1e-4)
    assert Counting.asked[2:] == [Interval(0.75, 0.9)]


def waves(n: int) -> Polyline:
    """A polyline on representable parameters, with more vertices than its shape needs."""
    t = np.arange(n + 1) / n
    return Polyline(t, np.stack([t, np.sin(9 * t)], axis=1))


@example(where=[0, 32], edited=[129, 131], off=0.0, sharp=True)  # a corner comes at its end
@given(
    st.lists(st.integers(0, 64), min_size=2, max_size=2, unique=True),
    st.lists(st.integers(0, 256), min_size=2, max_size=2, unique=True),
    st.sampled_from([0.0, 2.0**-9]),
    st.booleans(),
)
def test_beside_an_edit_thinned_samples_are_those_of_the_new_value(
    where: list[int], edited: list[int], off: float, sharp: bool
) -> None:
    """They are the same, bit for bit, as those of somebody who has seen nothing before."""
    start, stop = min(where) / 64, max(where) / 64
    stretch = Interval(start + (off if start else 0.0), stop - (off if stop < 1 else 0.0))
    if stretch.length <= 0:
        return
    before, recent = waves(256), RecentSamples()
    ask = {"tolerance": 1e-3, "limit": 1e-3}
    recent(before, stretch, **ask)
    low, high = sorted(edited)
    rows = before.points[low:high] + np.array([0.0, 0.5 if sharp else 1e-5])
    edit = before.move_vertices(low, rows)
    recent.edited(before, edit)
    found = recent(edit.value, stretch, **ask)
    fresh = RecentSamples()(edit.value, stretch, **ask)
    assert found.interval == fresh.interval == stretch
    assert found.breaks == fresh.breaks
    assert found.bound == fresh.bound
    assert found.t.tobytes() == fresh.t.tobytes()
    assert found.points.tobytes() == fresh.points.tobytes()


def test_beside_an_edit_nothing_is_thinned_again() -> None:
    """A stretch that ends where an edit begins is not sampled again; one that overlaps it is."""
    t = np.arange(1025) / 1024
    value = Counting(t, np.stack([t, np.sin(9 * t)], axis=1))
    recent, beside = RecentSamples(), Interval(0.25, 0.5)
    ask = {"tolerance": 1e-3, "limit": 1e-3}
    Counting.asked.clear()
    first = recent(value, beside, **ask)
    assert len(first.t) < 64
    for low in (513, 700):
        edit = value.move_vertices(low, value.points[low : low + 9] + 0.5)
        recent.edited(value, edit)
        value = edit.value
        assert recent(value, beside, **ask) is first
    assert Counting.asked == [beside]
    edit = value.move_vertices(512, value.points[512:513] + 0.5)
    recent.edited(value, edit)
    assert recent(edit.value, beside, **ask) is not first
    assert recent(value, beside, **ask) is first  # after an undo


def test_thinned_samples_are_certified() -> None:
    """What was left out is added to the certificate, which stays within both limits together."""
    value, stretch = waves(1024), Interval(0.1, 0.7)
    piece = RecentSamples()(value, stretch, tolerance=1e-4, limit=1e-3)
    assert piece.interval == stretch
    assert len(piece.t) < 100
    assert piece.bound <= 1.1e-3
    t = np.linspace(*stretch, 5000)
    assert np.linalg.norm(value(t) - piece(t), axis=1).max() <= piece.bound


def test_parts_are_thinned_once_wherever_a_stretch_ends() -> None:
    """Of a stretch that is longer or shorter than before, only the ends are sampled."""
    n = 8 * PART
    t = np.linspace(0, 1, n)
    value, recent = Counting(t, np.stack([t, np.sin(9 * t)], axis=1)), RecentSamples()
    ask = {"tolerance": 1e-3, "limit": 1e-3}
    Counting.asked.clear()
    recent(value, Interval(0.1, 0.7), **ask)
    marks = [(k + OFFSET) / 8 for k in range(5)]
    assert [a for a, _ in Counting.asked] == [0.1, *marks[1:]]
    Counting.asked.clear()
    piece = recent(value, Interval(0.15, 0.71), **ask)
    assert Counting.asked == [Interval(0.15, marks[1]), Interval(marks[-1], 0.71)]
    fresh = RecentSamples()(value, Interval(0.15, 0.71), **ask)
    assert piece.t.tobytes() == fresh.t.tobytes()
    assert piece.points.tobytes() == fresh.points.tobytes()


@st.composite
def stretches(draw: st.DrawFn) -> Interval:
    """Draw a stretch of [-1, 1], short or long, at any place."""
    a, b = draw(st.floats(-1, 1)), draw(st.sampled_from([1.0, 2.0**-7, 2.0**-12]))
    stop = min(a + b, 1.0)
    assume(a < stop)
    return Interval(a, stop)


@given(st.integers(1, 2**20), stretches(), stretches())
def test_stretches_are_cut_at_the_same_places(size: int, one: Interval, two: Interval) -> None:
    """Parts follow each other from end to end; none is a sliver, unless the whole stretch is."""
    mine, theirs = (parts(stretch, Interval(-1, 1), size) for stretch in (one, two))
    width = 2 / 2 ** max(int(np.ceil(np.log2(size / PART))), 0)
    assert (mine[0].start, mine[-1].stop) == tuple(one)
    assert all(left.stop == right.start for left, right in pairwise(mine))
    assert len(mine) == 1 or min(part.length for part in mine) >= SLIVER * width * (1 - 1e-9)
    assert len(mine) <= MOST_PARTS
    if len(theirs) > 1:
        cuts, margin = {part.stop for part in theirs[:-1]}, 1.001 * SLIVER * width
        for part in mine[:-1]:
            assert part.stop in cuts or not two.start + margin < part.stop < two.stop - margin


def test_only_few_thinned_samples_are_kept() -> None:
    """The memory of thinned samples is bounded, and holds no values that an edit has replaced."""
    value, recent = waves(1024), RecentSamples()
    for k in range(2 * KEPT_THINNED):
        recent(value, Interval(k / 1024, 0.5 + k / 1024), tolerance=1e-3, limit=1e-3)
    for _ in range(2 * VERSIONS):
        edit = value.move_vertices(1000, value.points[1000:] + 1.0)
        recent.edited(value, edit)
        value = edit.value
    assert [len(known._known) <= KEPT_THINNED for known in recent._thinned] == [True] * VERSIONS
    recent.edited(value, value.move_vertices(0, value.points[:] + 1.0))
    assert not recent._thinned[0]._known


def test_thinned_samples_keep_no_value_alive() -> None:
    """An old version would keep all blocks that later ones have replaced."""
    recent, value = RecentSamples(), waves(4 * PART)
    recent(value, Interval(0, 0.5), tolerance=1e-3, limit=1e-3)
    recent.edited(value, value.move_vertex(7 * PART // 2, [0.0, 0.1]))
    known = weakref.ref(value)
    del value
    for _ in range(KEPT):  # samples that were not thinned have their bound
        recent(waves(8), Interval(0, 1), tolerance=1e-3)
    gc.collect()
    assert known() is None


def test_thinned_samples_that_are_many_are_not_kept() -> None:
    """Where hardly anything can be left out, only as many as a small piece of memory holds."""
    t = np.linspace(0, 1, 4 * KEPT_SAMPLES)
    rough = Polyline(t, np.stack([t, np.arange(len(t)) % 8 // 4], axis=1))
    recent = RecentSamples()
    for k in range(16):
        piece = recent(rough, Interval(k / 16, (k + 1) / 16), tolerance=1e-3, limit=1e-3)
        assert KEPT_SAMPLES / 16 < len(piece.t) < KEPT_SAMPLES / 2
        [known] = recent._thinned
        assert known._samples == sum(len(piece.t) for piece in known._known.values())
        assert 0 < known._samples <= KEPT_SAMPLES
    before = known._samples
    recent.edited(rough, rough.move_vertices(0, rough.points[:4] + 1.0))
    assert 0 < recent._thinned[0]._samples <= before


def test_samples_that_are_few_are_shared_whatever_may_be_left_out() -> None:
    """Nothing can be left out of those of a spline: they are kept once."""
    t = np.linspace(0, 1, 33)
    author = Nurbs.fit(SampledSplice(t, np.stack([t, np.sin(40 * t)], axis=1)), tolerance=1e-2)
    recent, stretch = RecentSamples(), Interval(0.25, 0.75)
    piece = recent(author, stretch, tolerance=1e-4, limit=1e-6)
    assert recent(author, stretch, tolerance=1e-4) is piece
    assert recent(author, stretch, tolerance=1e-4, limit=1e-6) is piece
