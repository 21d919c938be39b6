"""Outlines: an SVG path and the NURBS made of it are the same curve."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import svgelements
from corpus import items
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from multirep.errors import ScriptError
from multirep.script.outlines import Outline, Segment, arc, join, raise_to_cubic
from multirep.script.svg_paths import parse_color, read_drawing


def evaluate(outline: Outline, t: np.ndarray) -> np.ndarray:
    """Evaluate with scipy, from the left at the end."""
    weights = np.ones(len(outline.points)) if outline.weights is None else outline.weights
    rows = np.c_[outline.points * weights[:, None], weights]
    value = BSpline(outline.knots, rows, outline.degree)(np.minimum(t, np.nextafter(1.0, 0.0)))
    return value[:, :-1] / value[:, -1:]


def bezier(segment: Segment, t: np.ndarray) -> np.ndarray:
    """Evaluate a segment by the sum that defines it."""
    degree = len(segment.points) - 1
    weights = np.ones(degree + 1) if segment.weights is None else segment.weights
    basis = np.stack(
        [
            math.comb(degree, i) * t**i * (1 - t) ** (degree - i) * weights[i]
            for i in range(degree + 1)
        ],
        axis=1,
    )
    return basis @ segment.points / basis.sum(axis=1, keepdims=True)


def drawing(path: Path, body: str, head: str = "") -> Path:
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>')
    return path


grid = st.integers(-640, 640).map(lambda k: k / 64)
points = st.tuples(grid, grid)


@given(st.lists(points, min_size=2, max_size=4), st.floats(0, 1))
def test_raising_the_degree_changes_nothing(corners: list[tuple[float, float]], t: float) -> None:
    """A Bézier segment of degree 1 to 3 and its cubic are the same curve at equal t."""
    control = np.array(corners)
    degree = len(control) - 1
    basis = [math.comb(degree, i) * t**i * (1 - t) ** (degree - i) for i in range(degree + 1)]
    cubic = raise_to_cubic(Segment(control))
    raised = [math.comb(3, i) * t**i * (1 - t) ** (3 - i) for i in range(4)] @ cubic
    np.testing.assert_allclose(raised[:2], basis @ control, atol=1e-13)
    assert (cubic[:, 2] == 1).all()


@given(st.floats(-math.pi, math.pi), st.floats(-2 * math.pi, 2 * math.pi), st.floats(0.1, 10))
def test_an_arc_lies_on_its_ellipse(start: float, sweep: float, ratio: float) -> None:
    """Every point of an arc lies on the ellipse, and the arc runs the right way."""
    if abs(sweep) < 1e-3:
        return
    axes = np.array([[ratio * 0.6, ratio * 0.8], [-0.8, 0.6]])
    on = lambda angle: np.array([math.cos(angle), math.sin(angle)]) @ axes  # noqa: E731
    segments = arc(on(start), on(start + sweep), (0, 0), axes[0], axes[1], sweep)
    outline = join(segments)
    t = np.linspace(0, 1, 101)
    unit = evaluate(outline, t) @ np.linalg.inv(axes)
    np.testing.assert_allclose(np.linalg.norm(unit, axis=1), 1, atol=1e-12)
    turned = np.unwrap(np.arctan2(unit[:, 1], unit[:, 0]))
    assert turned[-1] - turned[0] == pytest.approx(sweep, abs=1e-9)
    assert (np.diff(turned) * sweep > 0).all()


def test_joined_segments_share_t_by_length() -> None:
    """Knots at the joints are threefold and lie at the share of the length."""
    long = Segment(np.array([[0.0, 0.0], [3.0, 0.0]]))
    short = Segment(np.array([[3.0, 0.0], [3.0, 1.0]]))
    outline = join([long, short])
    assert outline.knots.tolist() == [0, 0, 0, 0, 0.75, 0.75, 0.75, 1, 1, 1, 1]
    assert outline.weights is None
    np.testing.assert_allclose(evaluate(outline, np.array([0.375, 0.875])), [[1.5, 0], [3, 0.5]])


def test_segments_without_length_are_dropped_and_counted() -> None:
    """A segment that stays at its point has no share of T."""
    line = Segment(np.array([[0.0, 0.0], [1.0, 0.0]]))
    dot = Segment(np.array([[1.0, 0.0], [1.0, 0.0]]))
    assert join([line, dot]).dropped == 1
    with pytest.raises(ValueError, match="single point"):
        join([dot])
    with pytest.raises(ValueError, match="no segment"):
        join([])


@pytest.mark.parametrize("icon", items("icons")[::2], ids=lambda icon: icon["name"])
def test_the_outline_is_the_drawing(icon: dict[str, str], tmp_path: Path) -> None:
    """Segment by segment, at equal parameters, an icon is what svgelements evaluates."""
    found = read_drawing(drawing(tmp_path / "icon.svg", f'<path d="{icon["d"]}"/>')).subpaths
    t = np.linspace(0, 1, 9)
    for subpath, piece in zip(found, svgelements.Path(icon["d"]).as_subpaths(), strict=True):
        segments = list(subpath.segments)
        for expected in svgelements.Path(piece):
            if isinstance(expected, svgelements.Move):
                continue
            if isinstance(expected, svgelements.Arc) and expected.start != expected.end:
                center = np.array(expected.center)
                axes = np.array([expected.prx, expected.pry]) - center
                while True:
                    segment = segments.pop(0)
                    unit = (bezier(segment, t) - center) @ np.linalg.inv(axes)
                    np.testing.assert_allclose(np.linalg.norm(unit, axis=1), 1, atol=1e-7)
                    if (segment.points[-1] == [expected.end.x, expected.end.y]).all():
                        break
            else:
                points = np.array([[p.x, p.y] for p in map(expected.point, t)])
                np.testing.assert_allclose(bezier(segments.pop(0), t), points, atol=1e-12)
        assert segments == []
        outline = join(subpath.segments)
        joints = np.unique(outline.knots)
        kept = [s for s in subpath.segments if np.ptp(s.points, axis=0).max() > 1e-9]
        inside = joints[:-1, None] + np.diff(joints)[:, None] * t[:-1]
        values = np.concatenate([bezier(segment, t[:-1]) for segment in kept])
        np.testing.assert_allclose(evaluate(outline, inside.ravel()), values, atol=1e-8)


def test_user_units_stay_and_group_transforms_apply(tmp_path: Path) -> None:
    """The viewBox does not scale; transforms of groups, `use` and nested drawings do."""
    body = (
        '<defs><path id="p" d="M0 0L1 0"/></defs>'
        '<g transform="translate(10 20) scale(2)"><path d="M1 1L2 2"/></g>'
        '<use href="#p" x="5" y="6"/>'
        '<rect id="half" width="50%" height="10"/>'
    )
    head = 'viewBox="0 0 36 36" width="72mm" height="72mm"'
    found = read_drawing(drawing(tmp_path / "d.svg", body, head))
    group, use, rect = found.subpaths
    assert group.segments[0].points.tolist() == [[12, 22], [14, 24]]
    assert use.segments[0].points.tolist() == [[5, 6], [6, 6]]
    assert rect.segments[0].points.tolist() == [[0, 0], [18, 0]]
    assert rect.closed
    assert rect.ids == ("half",)
    assert found.to_pixels.startswith("scale(7.55")


def test_a_move_splits_and_a_close_ends_a_sub_path(tmp_path: Path) -> None:
    """Sub-paths are counted as they are drawn; a lone move draws nothing."""
    d = "M0 0L1 0L1 1Z L5 5 M9 9 M2 2L3 3"
    found = read_drawing(drawing(tmp_path / "d.svg", f'<path d="{d}" fill="#FD9"/>')).subpaths
    assert [subpath.closed for subpath in found] == [True, False, False]
    assert [len(subpath.segments) for subpath in found] == [3, 1, 1]
    assert {subpath.fill for subpath in found} == {"#ffdd99"}


def test_skewed_arcs_stay_exact(tmp_path: Path) -> None:
    """A circle under a skew is the ellipse that it should be."""
    body = '<circle r="1" cx="3" cy="1" transform="matrix(2 0 1 1 0 0)"/>'
    [circle] = read_drawing(drawing(tmp_path / "d.svg", body)).subpaths
    points = evaluate(join(circle.segments), np.linspace(0, 1, 101))
    back = np.linalg.solve(np.array([[2.0, 1.0], [0.0, 1.0]]), points.T).T - [3, 1]
    np.testing.assert_allclose(np.linalg.norm(back, axis=1), 1, atol=1e-12)


BAD_DRAWINGS = {
    "words": ('<path d="hello"/>', "path 0 .* cannot be read: d = 'hello'"),
    "cut off": ('<path d="M0 0L1 1"/><path d="M0 0 Q 4"/>', "path 1 "),
    "infinite": ('<path d="M0 0 L1e400 3"/>', "path 0 "),
    "not a number": ('<path d="M0 0 L nan 3"/>', "path 0 "),
    "uses itself": ('<g id="a"><use href="#a"/></g>', "refers to itself"),
    "deep": ("<g>" * 100 + "</g>" * 100, "levels"),
    "cut off XML": ("<path", "not SVG"),
}


@pytest.mark.parametrize("what", BAD_DRAWINGS)
def test_a_bad_drawing_is_refused(what: str, tmp_path: Path) -> None:
    """The message names the file and the path in it."""
    body, message = BAD_DRAWINGS[what]
    with pytest.raises(ScriptError, match=message) as caught:
        read_drawing(drawing(tmp_path / "bad.svg", body))
    assert caught.value.file == str(tmp_path / "bad.svg")


def test_uses_of_uses_are_bounded(tmp_path: Path) -> None:
    """Twenty lines that would write out to a million shapes are refused before they do."""
    body = '<path id="g0" d="M0 0L1 1"/>'
    for level in range(1, 21):
        twice = f'<use href="#g{level - 1}"/>' * 2
        body += f'<g id="g{level}">{twice}</g>'
    with pytest.raises(ScriptError, match="elements with <use>"):
        read_drawing(drawing(tmp_path / "bomb.svg", body))


def test_entities_are_refused(tmp_path: Path) -> None:
    """Entity declarations are not expanded."""
    path = tmp_path / "bomb.svg"
    path.write_text('<!DOCTYPE svg [<!ENTITY a "aaaa">]><svg>&a;</svg>')
    with pytest.raises(ScriptError, match="entities"):
        read_drawing(path)


def test_colours() -> None:
    """Colours compare by value, and what is none is said to be none."""
    assert parse_color("#FFCC4E") == parse_color("rgb(255, 204, 78)") == "#ffcc4e"
    with pytest.raises(ValueError, match="'#gg'"):
        parse_color("#gg")
