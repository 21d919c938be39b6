"""A stretch that several representations follow is sampled once, and never from an older value."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.errors import PluginError
from multirep.interval import Interval
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.samples import KEPT, LONGEST, RecentSamples, sample_author


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
