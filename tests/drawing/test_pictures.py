"""Pictures: what is drawn is where the curves are, and any curve can be drawn."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.drawing.controls import MOST_CONTROLS, wavelet_levels
from multirep.drawing.frame import Frame, flatten
from multirep.drawing.outline import DRAWN_WITHIN, trace
from multirep.drawing.page import WIDTH, draw
from multirep.drawing.palette import hue, level_colour
from multirep.drawing.picture import Box, Group, Item, Lines, Marks, Picture, Text
from multirep.drawing.png import to_png
from multirep.drawing.subject import CurveSubject, Subject
from multirep.drawing.svg import to_svg

SVG = "{http://www.w3.org/2000/svg}"


def subject(
    points: object, *, tolerance: float = 0.01, title: str = "t", **look: object
) -> Subject:
    """Return a curve of points in all its representations, changed in the middle."""
    curve = mr.MultiRepresentation.from_points(points, tolerance=tolerance)  # type: ignore[arg-type]
    shown = {kind: curve.view(kind) for kind in ("polyline", "nurbs", "wavelet")}
    pairs = {("nurbs", "wavelet"): curve.deviation("nurbs", "wavelet")}
    changed = mr.SpliceList([(0.25, 0.5)])
    return Subject(title, (CurveSubject("c", tolerance, shown, pairs, changed),), 2, **look)  # type: ignore[arg-type]


def parts(items: tuple[Item, ...]) -> list[Item]:
    """Return all parts of a picture, out of their groups."""
    flat: list[Item] = []
    for item in items:
        flat += parts(item.items) if isinstance(item, Group) else [item]
    return flat


WAVE = [[0, 0], [1, 2], [2, 0], [3, 1], [4, 0]]


def test_every_representation_has_a_panel_and_the_overlay_has_all() -> None:
    """Panels by name, the deviations, the tolerance and the sizes are there."""
    text = to_svg(draw(subject(WAVE)))
    root = ET.fromstring(text)
    labels = [group.get("aria-label") for group in root.iter(f"{SVG}g") if group.get("aria-label")]
    assert labels == ["polyline", "nurbs", "wavelet", "overlaid", "deviations", "magnified"]
    words = " ".join(root.itertext())
    assert "5 vertices" in words.replace("\N{THIN SPACE}", " ")
    assert "0.01" in words
    assert "proved" in words


def test_no_mark_leaves_the_page() -> None:
    """Every point that is drawn lies on the page."""
    picture = draw(subject(WAVE))
    for item in parts(picture.items):
        points = np.zeros((0, 2))
        if isinstance(item, Lines):
            points = np.concatenate(item.chains)
        elif isinstance(item, Marks):
            points = item.points
        assert np.isfinite(points).all()
        # what is clipped may run out of the magnified square
        assert (np.abs(points) < 1e5).all()
    assert picture.width == WIDTH


def test_the_drawn_line_is_the_curve() -> None:
    """A trace at a scale is within a fraction of a pixel of the curve, for all t."""
    curve = mr.MultiRepresentation.from_points(WAVE, tolerance=1e-3).view("nurbs")
    scale = 200.0
    t, points = trace(curve, curve.domain, scale)
    s = np.linspace(0, 1, 5001)
    drawn = np.stack([np.interp(s, t, column) for column in points.T], axis=1)
    apart = np.linalg.norm(drawn - curve(s), axis=1).max() * scale
    assert apart < DRAWN_WITHIN + 0.5
    np.testing.assert_allclose(points[[0, -1]], curve([0.0, 1.0]), atol=1e-12)


def test_large_curves_are_thinned_and_say_so() -> None:
    """More controls than a person sees are not all drawn, and the panel says which share is."""
    angle = np.linspace(0, 20, 3000)
    spiral = np.column_stack([angle * np.cos(angle), angle * np.sin(angle)])
    picture = draw(subject(spiral))
    marks = [item for item in parts(picture.items) if isinstance(item, Marks)]
    assert max(len(item.points) for item in marks) <= MOST_CONTROLS
    assert any(
        isinstance(item, Text) and "1 in 5 drawn" in item.text for item in parts(picture.items)
    )
    assert len(to_svg(picture)) < 400_000


@pytest.mark.parametrize(
    "points",
    [
        [[0.0], [1.0], [0.5]],
        [[0.0, 0.0], [1.0, 0.0]],
        [[0.0, 0.0], [0.0, 1.0]],
        [[0, 0, 0], [1, 2, 3], [2, 0, 1]],
        [[0, 0, 0, 1], [1, 2, 3, 0]],
        [[1e12, 1e12], [1e12 + 1e4, 1e12 + 1e4]],
        [[0, 0], [1e-12, 1e-12]],
        [[0, 0], [40, 1], [80, 0]],
        [[0, 0], [1, 40], [0, 80]],
    ],
)
def test_any_curve_can_be_drawn(points: list[list[float]]) -> None:
    """Lines, functions, space curves, tiny, huge and far ones: both formats, of finite size."""
    pytest.importorskip("matplotlib")
    size = float(np.ptp(points, axis=0).max())
    picture = draw(subject(points, tolerance=0.01 * size))
    assert 200 < picture.height < 4000
    ET.fromstring(to_svg(picture))
    assert "nan" not in to_svg(picture)
    assert to_png(picture, scale=0.25).startswith(b"\x89PNG")


def test_names_cannot_break_out_of_the_picture() -> None:
    """Whatever a curve is called, the SVG stays well-formed and holds no element of the name."""
    name = '<script>alert("1")</script> & \x00\x1b]]>'
    text = to_svg(draw(subject(WAVE, title=name)))
    root = ET.fromstring(text)
    assert not list(root.iter(f"{SVG}script"))
    assert "<script" not in text


def test_y_points_down_unless_asked() -> None:
    """As in SVG; a plot of data may want it up."""
    points = np.array([[0.0, 1.0], [2.0, 3.0]])
    t = np.array([0.0, 1.0])
    assert flatten(t, points).tolist() == points.tolist()
    assert flatten(t, points, y_up=True).tolist() == [[0.0, -1.0], [2.0, -3.0]]
    assert points.tolist() == [[0.0, 1.0], [2.0, 3.0]]


sizes = st.floats(1e-6, 1e6)


@given(sizes, sizes, st.floats(-1e6, 1e6))
def test_the_frame_fits_and_keeps_proportions(width: float, height: float, offset: float) -> None:
    """The data touch the box on two sides and leave it on none; both axes have one scale."""
    lower = np.array([offset, -offset])
    upper = lower + np.array([width, height])
    frame = Frame(Box(10, 20, 300, 200, "none"), lower, upper)
    corners = frame(np.array([lower, upper]))
    slack = 1e-4 + 300 * 1e-15 * abs(offset) / min(width, height)
    assert (corners[0] >= np.array([10, 20]) - slack).all()
    assert (corners[1] <= np.array([310, 220]) + slack).all()
    spans = corners[1] - corners[0]
    assert spans[0] == pytest.approx(300, abs=slack) or spans[1] == pytest.approx(200, abs=slack)


def test_levels_of_a_graded_curve() -> None:
    """A control point has the level of the cells that it spans; ends count like the middle."""
    knots = np.r_[[0] * 3, np.arange(5) / 8, (9 + np.arange(7)) / 16, [1] * 4]
    levels = wavelet_levels(knots)
    assert levels[0] == 3
    assert levels[-1] == 4
    assert (np.diff(levels) >= 0).all()


def test_colours_are_distinct_and_stable() -> None:
    """Built-in representations keep their colours beside plugins; levels use the whole ramp."""
    names = ("polyline", "nurbs", "wavelet", "quintic", "hermite")
    assert len({hue(name, names) for name in names}) == 5
    assert hue("nurbs", ("nurbs",)) == hue("nurbs", names)
    shades = [level_colour(level, range(3, 8)) for level in range(3, 8)]
    assert len(set(shades)) == 5
    assert level_colour(4, range(4, 5)).startswith("#")


def test_numbers_are_short_and_never_drift() -> None:
    """Relative steps of a path add up to where the chain ends, to a hundredth."""
    rng = np.random.default_rng(7)
    chain = np.cumsum(rng.normal(0, 0.4, (5000, 2)), axis=0) + 500
    picture = Picture(1000, 1000, "", "", (Lines((chain,), "#000", 1.0),))
    [path] = list(ET.fromstring(to_svg(picture)).iter(f"{SVG}path"))
    numbers = re.findall(r"-?\d*\.?\d+", path.attrib["d"])
    end = np.array(numbers, float).reshape(-1, 2).sum(axis=0)
    np.testing.assert_allclose(end, chain[-1], atol=0.0051)
    assert max(map(len, numbers)) <= 7


def test_png_has_the_size_of_the_picture(tmp_path: Path) -> None:
    """Pixels are page units times the scale."""
    pytest.importorskip("matplotlib")
    picture = Picture(
        200, 100, "", "", (Box(0, 0, 200, 100, "#ff0000"), Text(5, 50, "$a_b", 9, "#000"))
    )
    data = to_png(picture, scale=2)
    assert (int.from_bytes(data[16:20]), int.from_bytes(data[20:24])) == (400, 200)
