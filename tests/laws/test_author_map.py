"""Author maps against a list of cells, on end points k/64."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from multirep.authors import AuthorMap
from multirep.interval import Interval
from multirep.splices import SpliceList
from multirep.testing.reference_splices import mask_of
from multirep.testing.strategies import CELLS, dyadic_intervals, splice_lists

T = Interval(0.0, 1.0)
edits = st.lists(st.tuples(splice_lists(max_splices=3), st.sampled_from("abc")), max_size=8)


def made(steps: list[tuple[SpliceList, str]]) -> tuple[AuthorMap, list[str]]:
    """Assign splices to authors, in a map and cell by cell."""
    authors, cells = AuthorMap.of(T, "a"), ["a"] * CELLS
    for splices, name in steps:
        authors = authors.assigned(splices, name)
        cells = [
            name if hit else old for hit, old in zip(mask_of(splices, CELLS), cells, strict=True)
        ]
    return authors, cells


@settings(max_examples=200)
@given(edits)
def test_assignments_agree_with_a_list_of_cells(steps: list[tuple[SpliceList, str]]) -> None:
    """The last one to change a cell is its author; neighbouring stretches have different
    authors.
    """
    authors, cells = made(steps)
    stretches = list(authors)
    assert [
        name for stretch, name in stretches for _ in range(round(stretch.length * CELLS))
    ] == cells
    assert stretches[0][0].start == 0.0
    assert stretches[-1][0].stop == 1.0
    for (one, author), (two, other) in pairwise(stretches):
        assert one.stop == two.start
        assert author != other


@settings(max_examples=200)
@given(edits, st.sampled_from("abcd"))
def test_where_returns_exactly_the_cells_of_an_author(
    steps: list[tuple[SpliceList, str]], name: str
) -> None:
    """All that a name authored, and nothing for a name that authored nothing."""
    authors, cells = made(steps)
    assert mask_of(authors.where(name), CELLS).tolist() == [cell == name for cell in cells]


@settings(max_examples=200)
@given(edits, dyadic_intervals())
def test_segments_cut_an_interval_at_the_seams(
    steps: list[tuple[SpliceList, str]], interval: Interval
) -> None:
    """They cover the interval end to end, each with the author of its cells."""
    authors, cells = made(steps)
    found = authors.segments(interval)
    assert (found[0][0].start, found[-1][0].stop) == tuple(interval)
    inside = cells[round(interval.start * CELLS) : round(interval.stop * CELLS)]
    assert [name for part, name in found for _ in range(round(part.length * CELLS))] == inside
    seams = {t for t, _, _ in authors.seams}
    assert {part.start for part, _ in found[1:]} == {
        t for t in seams if interval.start < t < interval.stop
    }


@settings(max_examples=200)
@given(edits, dyadic_intervals(), st.sampled_from("abc"))
def test_room_ends_where_the_name_is_the_author(
    steps: list[tuple[SpliceList, str]], interval: Interval, name: str
) -> None:
    """It covers the interval, and is as large as it can be without a cell of the name."""
    authors, cells = made(steps)
    first, last = round(interval.start * CELLS), round(interval.stop * CELLS)
    assume(name not in cells[first:last])  # a stretch that waits for others is not one's own
    room = authors.room(interval, name)
    assert room.contains(interval)
    start, stop = round(room.start * CELLS), round(room.stop * CELLS)
    assert name not in cells[start:stop]
    assert start == 0 or cells[start - 1] == name
    assert stop == CELLS or cells[stop] == name
