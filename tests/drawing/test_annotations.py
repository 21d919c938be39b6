"""What is drawn with a curve: pen strokes, frozen stretches, marks, held points."""

from __future__ import annotations

import numpy as np

import multirep as mr
from multirep.drawing.page import draw
from multirep.drawing.palette import ICE, INK, PENCIL
from multirep.drawing.picture import Group, Item, Lines, Marks, Picture, Text
from multirep.drawing.subject import CurveSubject, Subject
from multirep.drawing.svg import to_svg

WAVE = [[0, 0], [1, 2], [2, 0], [3, 1], [4, 0]]


def drawn(kinds: tuple[str, ...] = ("polyline",), **annotations: object) -> Picture:
    curve = mr.MultiRepresentation.from_points(WAVE, tolerance=0.01)
    shown = {kind: curve.view(kind) for kind in kinds}
    return draw(Subject("t", (CurveSubject("c", 0.01, shown, {}, **annotations),)))  # type: ignore[arg-type]


def parts(items: tuple[Item, ...]) -> list[Item]:
    flat: list[Item] = []
    for item in items:
        flat += parts(item.items) if isinstance(item, Group) else [item]
    return flat


def lines(picture: Picture, colour: str) -> list[Lines]:
    found = [item for item in parts(picture.items) if isinstance(item, Lines)]
    return [item for item in found if item.stroke == colour]


def words(picture: Picture) -> str:
    return " ".join(item.text for item in parts(picture.items) if isinstance(item, Text))


def test_a_plain_curve_has_no_annotations() -> None:
    """And nothing is said of them."""
    picture = drawn()
    assert not lines(picture, ICE) + lines(picture, PENCIL)
    assert "frozen" not in words(picture)


def test_frozen_stretches_are_bands_under_the_curve() -> None:
    """One for each stretch, within the curve."""
    picture = drawn(frozen=mr.SpliceList([(-1, 0.25), (0.5, 0.75)]))
    [band] = lines(picture, ICE)
    assert len(band.chains) == 2
    assert "blue band: frozen" in words(picture)


def test_strokes_are_drawn_where_they_are_and_make_room() -> None:
    """In the units of the curve; a stroke of another dimension is left out."""
    stroke = np.array([[0.0, 2.0], [4.0, 2.0]])
    picture = drawn(strokes=(stroke, np.zeros((3, 3))))
    [line] = lines(picture, PENCIL)
    [chain] = line.chains
    curve = max(lines(picture, "#2563a8"), key=lambda item: item.width).chains[0]
    np.testing.assert_allclose(chain[:, 0], curve[[0, -1], 0], atol=1e-6)
    np.testing.assert_allclose(chain[0, 1], curve[:, 1].max(), atol=1e-6)


def test_marks_open_towards_what_is_free() -> None:
    """The feet of both brackets point to each other along the curve."""
    picture = drawn(marks=((0.1, 0.2),))
    [both] = [item for item in lines(picture, INK) if len(item.chains) == 2]
    left, right = both.chains
    between = right[1:3].mean(axis=0) - left[1:3].mean(axis=0)
    assert (left[0] - left[1]) @ between > 0 > (right[0] - right[1]) @ between
    assert "brackets: marks" in words(picture)


def test_held_points_are_diamonds_on_the_curve() -> None:
    """In every panel and in the overlay."""
    for kinds, count in ((("polyline",), 1), (("polyline", "nurbs"), 3)):
        picture = drawn(kinds, pins=(0.0, 1.0))
        diamonds = [
            item
            for item in parts(picture.items)
            if isinstance(item, Marks) and item.shape == "diamond"
        ]
        assert len(diamonds) == count
        assert all(len(item.points) == 2 for item in diamonds)


def test_one_representation_has_a_page_of_its_own() -> None:
    """No overlay, nothing to compare; the curve before the edits is in the panel."""
    curve = mr.MultiRepresentation.from_points(WAVE, tolerance=0.01)
    before, everywhere = curve.view("polyline"), mr.SpliceList([(0, 1)])
    picture = drawn(before=before, changed=everywhere)
    assert "overlaid" not in words(picture)
    assert "dotted: before" in words(picture)
    assert any(item.dash == (0.5, 4.5) for item in lines(picture, INK))


def test_functions_have_no_strokes() -> None:
    """A stroke has no parameters over which it could be drawn."""
    curve = mr.MultiRepresentation.from_points([[0.0], [1.0], [0.0]], tolerance=0.01)
    shown = {"polyline": curve.view("polyline")}
    subject = CurveSubject("c", 0.01, shown, {}, strokes=(np.zeros((3, 1)),), pins=(0.5,))
    assert not lines(draw(Subject("t", (subject,))), PENCIL)


def test_digits_are_grouped_in_the_file_too() -> None:
    """The thin space is a space, not a character that nobody knows."""
    picture = Picture(9, 9, "t", "", (Text(0, 0, "1\N{THIN SPACE}000\x00", 9, INK),))
    assert "1\N{THIN SPACE}000\N{REPLACEMENT CHARACTER}" in to_svg(picture)
