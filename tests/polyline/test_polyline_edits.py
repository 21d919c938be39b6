"""Moving, inserting, deleting and replacing vertices: nothing else moves."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polyline_reference import check_edit
from polyline_reference import tiny_blocks as tiny_blocks

from multirep.arrays import Array
from multirep.errors import EditError, ParameterError
from multirep.representations.polyline import Polyline
from multirep.splices import SpliceList
from multirep.testing.strategies import polylines

ZIGZAG = Polyline([0, 1, 2, 4], [[0, 0], [1, 1], [2, 0], [4, 2]])


@given(polylines(max_size=40), st.data())
@pytest.mark.usefixtures("tiny_blocks")
def test_moving_a_vertex_affects_its_two_segments(
    data: tuple[Array, Array], draw: st.DataObject
) -> None:
    """The splice is [t of the vertex before, t of the one after], clipped at the ends of T."""
    t, points = data
    polyline = Polyline(t, points)
    i = draw.draw(st.integers(0, len(t) - 1))
    edit = polyline.move_vertex(i, [9.5, -9.5])
    after = check_edit(polyline, edit)
    assert edit.splices == SpliceList([(t[max(i - 1, 0)], t[min(i + 1, len(t) - 1)])])
    assert edit.splices == polyline.changes(after)
    expected = points.copy()
    expected[i] = 9.5, -9.5
    assert np.asarray(after).tolist() == expected.tolist()
    assert np.asarray(polyline).tolist() == points.tolist()


@given(polylines(max_size=40), st.data())
@pytest.mark.usefixtures("tiny_blocks")
def test_inserting_on_the_curve_changes_rounding_only(
    data: tuple[Array, Array], draw: st.DataObject
) -> None:
    """A vertex on the curve leaves the curve where it was; affected is the segment it divides."""
    t, points = data
    polyline = Polyline(t, points)
    k = draw.draw(st.integers(0, len(t) - 2))
    at = float(t[k] + draw.draw(st.floats(0.01, 0.99)) * (t[k + 1] - t[k]))
    edit = polyline.insert_vertex(at)
    after = check_edit(polyline, edit)
    assert edit.splices == SpliceList([(t[k], t[k + 1])])
    assert after.points[k + 1].tolist() == polyline(at).tolist()
    dense = np.linspace(t[0], t[-1], 999)
    np.testing.assert_allclose(after(dense), polyline(dense), atol=1e-13)


@given(polylines(min_size=3, max_size=40), st.data())
@pytest.mark.usefixtures("tiny_blocks")
def test_deleting_undoes_inserting(data: tuple[Array, Array], draw: st.DataObject) -> None:
    """Insert and delete give back the same vertices, bit by bit."""
    t, points = data
    polyline = Polyline(t, points)
    k = draw.draw(st.integers(0, len(t) - 2))
    inserted = polyline.insert_vertex(float(0.5 * (t[k] + t[k + 1])), [7, 7]).value
    edit = inserted.delete_vertex(k + 1)
    after = check_edit(inserted, edit)
    assert edit.splices == SpliceList([(t[k], t[k + 1])])
    assert np.asarray(after.t).tobytes() == t.tobytes()
    assert np.asarray(after).tolist() == points.tolist()
    assert polyline.changes(after).is_empty


@given(polylines(max_size=60), st.data())
@pytest.mark.usefixtures("tiny_blocks")
def test_any_run_of_replacements_obeys_the_law(
    data: tuple[Array, Array], draw: st.DataObject
) -> None:
    """Replacing windows by more or fewer vertices, again and again, on a flat copy beside it."""
    t, points = data
    first = polyline = Polyline(t, points)
    for _ in range(draw.draw(st.integers(1, 6))):
        start = draw.draw(st.integers(1, polyline.size - 1))
        stop = draw.draw(st.integers(start, polyline.size - 1))
        low, high = float(polyline.t[start - 1]), float(polyline.t[stop])
        count = draw.draw(st.integers(0, 20))
        new = low + (high - low) * np.arange(1, count + 1) / (count + 1)
        rows = np.stack([np.arange(count) + 0.5, np.full(count, float(start))], axis=1)
        flat_t = np.concatenate([polyline.t[:start], new, polyline.t[stop:]])
        flat = np.concatenate([polyline.points[:start], rows, polyline.points[stop:]])
        if (flat == flat[0]).all():
            continue
        polyline = check_edit(polyline, polyline.replace(start, stop, new, rows))
        assert np.asarray(polyline.t).tolist() == flat_t.tolist()
        assert np.asarray(polyline).tolist() == flat.tolist()
    assert SpliceList([first.domain]).contains(first.changes(polyline))
    mask_says(first, polyline)


def mask_says(one: Polyline, other: Polyline) -> None:
    """The changed stretches are exactly those between common segments."""

    def segments(p: Polyline) -> set[tuple[Any, ...]]:
        rows = [(s, *row) for s, row in zip(p.t.tolist(), p.points.tolist(), strict=True)]
        return set(pairwise(rows))

    common = SpliceList((a[0], b[0]) for a, b in segments(one) & segments(other))
    assert one.changes(other) == SpliceList([one.domain]) - common


@pytest.mark.usefixtures("tiny_blocks")
def test_changes_far_apart_are_reported_apart() -> None:
    """Edits far apart in a long curve are stretches of their own."""
    t = np.arange(500.0)
    polyline = Polyline(t, np.stack([t, t % 7], axis=1))
    other = polyline.move_vertex(40, [0, 0]).value.delete_vertex(300).value
    other = other.insert_vertex(450.5, [1, 1]).value.move_vertex(499, [3, 3]).value
    assert str(polyline.changes(other)) == "[39,41] [299,301] [450,451] [498,499]"
    assert polyline.changes(other) == other.changes(polyline)
    mask_says(polyline, other)


def test_moving_to_the_same_place_changes_nothing() -> None:
    """No splice, the same value."""
    edit = ZIGZAG.move_vertex(2, [2, 0])
    assert edit.value is ZIGZAG
    assert edit.splices.is_empty


def test_moving_several_vertices_is_one_edit() -> None:
    """The splice runs from the neighbour before to the neighbour after."""
    edit = ZIGZAG.move_vertices(1, [[1, 5], [2, 5]])
    check_edit(ZIGZAG, edit)
    assert str(edit.splices) == "[0,4]"


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda p: p.move_vertex(4, [0, 0]), "no vertex 4: this polyline has vertices 0 to 3"),
        (lambda p: p.move_vertex(-1, [0, 0]), "no vertex -1"),
        (lambda p: p.move_vertex(1, [0, 0, 0]), "has 2 coordinates, got 3"),
        (lambda p: p.move_vertex(1, [[0, 0]]), "2 numbers, got an array of shape"),
        (lambda p: p.move_vertex(1, [np.nan, 0]), "finite"),
        (lambda p: p.move_vertex(1, ["a", 0]), "2 numbers"),
        (lambda p: p.move_vertices(2, np.zeros((3, 2))), "vertices 2 to 4"),
        (lambda p: p.insert_vertex(1.0), "a vertex at t = 1.0 already: vertex 1"),
        (lambda p: p.insert_vertex(1.5, [1]), "has 2 coordinates, got 1"),
        (lambda p: p.delete_vertex(0), "vertex 0 is an end"),
        (lambda p: p.delete_vertex(3), "vertex 3 is an end"),
        (lambda p: p.delete_vertex(9), "no vertex 9"),
        (lambda p: p.replace(1, 2, [2.5], [[0, 0]]), "increase strictly"),
        (lambda p: p.replace(1, 2, [np.nan], [[0, 0]]), "increase strictly"),
        (lambda p: p.replace(0, 2, [0.5], [[0, 0]]), "from one end"),
        (lambda p: p.replace(0, 4, [], np.empty((0, 2))), "from one end"),
        (lambda p: p.replace(3, 2, [], np.empty((0, 2))), "vertices 3 to 2"),
        (lambda p: p.replace(1, 2, [1.0], np.zeros((2, 2))), "as many parameters"),
    ],
)
def test_edits_that_make_no_sense_are_refused(edit: Any, message: str) -> None:
    """EditError with the numbers."""
    with pytest.raises(EditError, match=message):
        edit(ZIGZAG)


def test_insertion_outside_the_domain_is_refused() -> None:
    """A parameter outside T is a parameter error."""
    with pytest.raises(ParameterError, match="outside the domain"):
        ZIGZAG.insert_vertex(4.5)


def test_a_curve_cannot_collapse_into_one_point() -> None:
    """Two distinct points must remain, or the curve could not be read back."""
    line = Polyline([0, 1, 2], [[0, 0], [1, 1], [0, 0]])
    with pytest.raises(EditError, match="one point"):
        line.delete_vertex(1)
    with pytest.raises(EditError, match="one point"):
        line.move_vertex(1, [0, 0])


def test_an_edit_shares_all_untouched_blocks() -> None:
    """At a million vertices an edit copies one block of each array that it changes."""
    t = np.arange(1e6)
    polyline = Polyline(t, np.stack([t, t], axis=1))
    before = {id(block) for block in (*polyline.t.blocks, *polyline.points.blocks)}
    for edit in (
        polyline.move_vertex(500_000, [0, 0]),
        polyline.insert_vertex(500_000.5),
        polyline.delete_vertex(500_000),
    ):
        after = (*edit.value.t.blocks, *edit.value.points.blocks)
        assert sum(id(block) not in before for block in after) <= 2


def test_the_magnitude_is_exact_after_any_edit() -> None:
    """It does not depend on the history: the largest coordinate that is there now."""
    far = ZIGZAG.move_vertex(1, [100, 0]).value
    assert far.magnitude == 100
    assert far.move_vertex(1, [1, 1]).value.magnitude == 4
