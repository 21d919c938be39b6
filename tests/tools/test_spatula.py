"""`spatula`: nothing stays inside, nothing jumps through, nothing else moves."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest
from corpus import items, unpack
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.representations import Polyline
from multirep.scene import Scene
from multirep.script.strict import Mismatch, structure
from multirep.splices import SpliceList
from multirep.testing.laws import check_edit
from multirep.tools import Spatula

LINE = Polyline([0, 1], [[-8, 0], [8, 0]])
#: A chord between two points of the circle, a quarter radius apart, stays this far out.
SAGITTA = 1 - 1 / 100


def check_stroke(polyline: Polyline, radius: float, path: Any) -> Edit[Polyline]:
    """Apply the tool and check everything that must hold after any stroke."""
    tool = Spatula(radius=radius, path=path)
    edit = check_edit(polyline, tool.edit(polyline, Scene()))
    after, way = edit.value, np.array(tool.path)
    points, t = np.asarray(after), np.asarray(after.t)
    rounding = 8 * np.spacing(after.magnitude)
    assert np.linalg.norm(points - way[-1], axis=1).min() >= radius * (1 - 1e-9) - rounding
    assert to_segments(way[-1:], points).min() >= SAGITTA * radius
    assert (t[0], t[-1]) == tuple(polyline.domain)
    # vertices that the circle does not sweep over are there, bit by bit, with their parameters
    away = to_segments(np.asarray(polyline), np.concatenate([way, way[-1:]])) > radius * (1 + 1e-9)
    place = np.minimum(t.searchsorted(np.asarray(polyline.t)[away]), len(t) - 1)
    assert t[place].tolist() == np.asarray(polyline.t)[away].tolist()
    assert points[place].tobytes() == np.asarray(polyline)[away].tobytes()
    # pushed and added vertices have short segments on both sides
    old = {tuple(row) for row in np.column_stack([polyline.t, polyline.points]).tolist()}
    new = np.array([tuple(row) not in old for row in np.column_stack([t, points]).tolist()])
    pushed = new & (off_the_line(polyline, after) > 1e-9 * radius)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert (lengths[pushed[1:] | pushed[:-1]] <= 0.25 * radius * (1 + 1e-9) + rounding).all()
    return edit


def off_the_line(before: Polyline, after: Polyline) -> Array:
    """How far the vertices of ``after`` are from the curve ``before``."""
    return to_segments(np.asarray(after), np.asarray(before))


def to_segments(points: Array, line: Array) -> Array:
    """Distances of points from a polyline, the slow way."""
    start, step = line[:-1], np.diff(line, axis=0)
    square = np.where((step**2).sum(axis=1) > 0, (step**2).sum(axis=1), 1)
    best = np.full(len(points), np.inf)
    for k, point in enumerate(points):
        u = np.clip(((point - start) * step).sum(axis=1) / square, 0, 1)
        best[k] = np.linalg.norm(start + u[:, None] * step - point, axis=1).min()
    return best


def winding(polygon: Array, centre: Array) -> int:
    """How often a closed polygon winds around a point."""
    off = np.concatenate([polygon, polygon[:1]]) - centre
    turns = np.diff(np.unwrap(np.arctan2(off[:, 1], off[:, 0])))
    return round(float(turns.sum()) / (2 * np.pi))


# -- what a stroke does ----------------------------------------------------------------------------


def test_it_pushes_a_bulge_and_adds_sand() -> None:
    """A line pushed up from below follows the front of the circle."""
    edit = check_stroke(LINE, 1.0, [[0, -2], [0, 1]])
    points = np.asarray(edit.value)
    assert points.max(axis=0).tolist() == [8, pytest.approx(2.0)]
    assert len(points) > 20
    assert points[0].tolist() == [-8, 0]
    assert points[-1].tolist() == [8, 0]


def test_it_removes_sand() -> None:
    """A line of many vertices that is pushed back on itself has fewer afterwards."""
    t = np.linspace(0, 1, 2001)
    dense = Polyline(t, np.stack([16 * t - 8, np.sin(40 * t)], axis=1))
    edit = check_stroke(dense, 1.5, [[-2, -3], [-2, 0], [2, 0], [2, -4]])
    assert edit.value.size < dense.size
    lengths = np.linalg.norm(np.diff(np.asarray(edit.value), axis=0), axis=1)
    assert lengths.max() <= 1.5 / 4


def test_it_does_nothing_where_it_touches_nothing() -> None:
    """The same value, no splices: beside the curve, and when it just grazes a vertex."""
    for path in ([[0, 3]], [[-9, -2], [9, -2]], [[0, 1], [4, 1]]):
        edit = Spatula(radius=1.0, path=path).edit(LINE, Scene())
        assert edit.value is LINE
        assert edit.splices == SpliceList.EMPTY


def test_a_dab_clears_its_circle() -> None:
    """One point of a path is a place to stand; dead centre, the curve gives way upwards."""
    for centre in ([0, 0.2], [0, -0.2], [0, 0], [8, 0], [-8, 0.5]):
        check_stroke(LINE, 1.0, [centre])
    assert np.asarray(check_stroke(LINE, 1.0, [[0, 0]]).value)[:, 1].max() == 1.0


def test_each_touched_stretch_is_a_splice_of_its_own() -> None:
    """A stroke that crosses a curve four times changes four intervals and nothing in between."""
    t = np.linspace(0, 1, 401)
    strands = Polyline(t, np.stack([np.cos(np.pi * t) * 10, np.sin(np.pi * t) * 4], axis=1))
    edit = check_stroke(strands, 0.3, [[-9, -1], [-9, 3], [9, 3], [9, -1]])
    assert len(edit.splices) == 4
    assert edit.splices.length < 0.5


# -- nothing jumps through -------------------------------------------------------------------------


@given(
    st.lists(st.tuples(st.integers(-60, 60), st.integers(-60, 60)), min_size=1, max_size=5),
    st.sampled_from([0.3, 1.0, 2.5]),
)
def test_the_curve_never_crosses_over_the_spatula(
    way: list[tuple[int, int]], radius: float
) -> None:
    """Closed far below, the line winds around the centre as before, however fast the stroke."""
    line = Polyline([0, 1], [[-100, 0], [100, 0]])
    path = np.concatenate([[[0.0, -5.0]], np.array(way) / 4])
    edit = check_stroke(line, radius, path)
    below = np.array([[100.0, -100.0], [-100.0, -100.0]])
    polygon = np.concatenate([np.asarray(edit.value), below])
    assert winding(polygon, path[-1]) == winding(np.concatenate([np.asarray(line), below]), path[0])


def test_a_stroke_faster_than_the_curve_is_wide() -> None:
    """One motion over a thin loop takes the loop along: it does not appear on the other side."""
    thin = Polyline.from_points([[-5, 0], [0, 0.02], [5, 0], [5, -0.02], [0, -0.04], [-5, -0.02]])
    edit = check_stroke(thin, 0.5, [[0.3, -7], [0.3, 9]])
    near = np.abs(np.asarray(edit.value)[:, 0] - 0.3) < 0.1
    assert np.asarray(edit.value)[near, 1].min() > 9


def test_ends_are_pushed_but_stay_ends() -> None:
    """An end of the curve moves with the sand and keeps its parameter."""
    edit = check_stroke(LINE, 0.5, [[8, -1], [8, 2], [-8, 2], [-8, -3]])
    assert edit.value([0, 1]).tolist() != LINE([0, 1]).tolist()
    assert edit.value.domain == LINE.domain


def test_an_end_pushed_along_the_curve_leaves_no_debris() -> None:
    """Sand pushed back on itself is removed: a straight line stays two or three vertices."""
    edit = check_stroke(LINE, 0.5, [[9, 0], [2, 0]])
    assert edit.value.size <= 4
    assert np.asarray(edit.value)[-1] == pytest.approx([1.5, 0])


# -- parameters ------------------------------------------------------------------------------------


def test_pushed_vertices_keep_their_parameters_in_a_gentle_stroke() -> None:
    """A nudge moves vertices in space, not in T."""
    t = np.linspace(0, 1, 161)
    dense = Polyline(t, np.stack([16 * t - 8, 0 * t], axis=1))
    edit = check_stroke(dense, 1.0, [[0, -2], [0, -0.9]])
    assert set(t.tolist()) <= set(edit.value.t.tolist())
    assert edit.splices.length < 0.1


@pytest.mark.parametrize("count", [2, 161])
def test_a_long_pull_spreads_parameters_over_the_pulled_stretch_only(count: int) -> None:
    """The tail runs at an even speed; the rest keeps its parameters."""
    t = np.linspace(0, 1, count)
    line = Polyline(t, np.stack([16 * t - 8, 0 * t], axis=1))
    after = check_stroke(line, 0.5, [[0, -1], [0, 40]]).value
    at = np.array([0.0, 0.25, 0.45, 0.55, 0.75, 1.0])
    np.testing.assert_allclose(after(at), line(at), atol=1e-12)
    speed = np.linalg.norm(np.diff(np.asarray(after), axis=0), axis=1) / np.diff(after.t)
    tail = np.asarray(after)[:-1, 1] > 1
    assert speed[tail].max() <= 1.01 * speed[tail].min()
    even = 82 / (1 / 16)  # the length of the tail, over what the circle was wide in t
    assert speed.max() <= 2 * even


def test_many_small_strokes_end_in_a_refusal_and_not_in_nonsense() -> None:
    """Pulled on and on, a stretch runs out of parameters, and the tool says so."""
    value, y = LINE, -1.0
    with pytest.raises(EditError, match="no parameters are left"):  # noqa: PT012 - it takes a while
        for _ in range(4000):
            edit = Spatula(radius=0.5, path=[[0, y], [0, y + 0.1]]).edit(value, Scene())
            assert (np.diff(edit.value.t) > 0).all()
            value, y = edit.value, y + 0.1
    assert y > 5


# -- real and extreme input ------------------------------------------------------------------------


def test_strokes_over_real_curves() -> None:
    """A coastline, an airfoil and pen strokes, pushed about at random."""
    rng = np.random.default_rng(4)
    rings = sorted(items("coastlines"), key=lambda ring: ring["n"])
    curves = [np.array(unpack(rings[0])), np.array(items("airfoils")[3]["points"])]
    curves += [np.array(s, dtype=float) for d in items("strokes")[:6] for s in d["strokes"]]
    for points in curves:
        polyline = Polyline.from_points(points)
        size = float(np.ptp(points, axis=0).max())
        for _ in range(2):
            start = np.asarray(polyline)[rng.integers(polyline.size)]
            steps = np.concatenate([np.zeros((1, 2)), rng.normal(size=(3, 2)) * 0.1])
            path = start + size * np.cumsum(steps, axis=0)
            edit = check_stroke(polyline, size * float(rng.uniform(0.01, 0.1)), path)
            assert edit.splices, "the stroke starts on the curve"
            polyline = edit.value


@pytest.mark.parametrize("exponent", [-40, -20, 20, 40])
def test_any_scale_alike(exponent: int) -> None:
    """Scaled by a power of two the stroke is the same, bit by bit: no absolute thresholds."""
    scale, path = 2.0**exponent, np.array([[0, -2], [1, 1.5]])
    usual = check_stroke(LINE, 1.0, path).value
    scaled = Polyline(LINE.t, np.asarray(LINE) * scale)
    other = check_stroke(scaled, scale, path * scale).value
    assert np.asarray(other.t).tobytes() == np.asarray(usual.t).tobytes()
    assert (np.asarray(other) / scale).tobytes() == np.asarray(usual).tobytes()


def test_far_from_the_origin() -> None:
    """Coordinates of 1e9 leave room for a radius of 1, not for one of 1e-3."""
    far = Polyline(LINE.t, np.asarray(LINE) + 1e9)
    path = np.array([[0, -2], [0, 1]]) + 1e9
    assert check_stroke(far, 1.0, path).value.size > 20
    with pytest.raises(EditError, match="below the resolution"):
        Spatula(radius=1e-3, path=path).edit(far, Scene())


def test_the_cost_follows_what_is_touched() -> None:
    """The same stroke allocates no more in a curve of 1e6 vertices than in one of 1e4."""
    peaks = []
    for n in (10_000, 1_000_000):
        x = np.arange(n) * 1e-3
        polyline = Polyline(np.arange(n), np.stack([x, 0 * x], axis=1))
        assert polyline.magnitude  # the boxes are made once and kept
        tracemalloc.start()
        edit = Spatula(radius=0.05, path=[[5.0, -0.1], [5.0, 0.1]]).edit(polyline, Scene())
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        assert edit.splices.length < 200
    assert peaks[1] < 2 * peaks[0] + 100_000


@given(st.integers(1, 4), st.integers(0, 63))
def test_dense_curves_are_spaced_out_like_coarse_ones(dense: int, at: int) -> None:
    """However close vertices were, pushed ones are so far apart that no two segments need merge."""
    count = 16 * 10**dense
    t = np.linspace(0, 1, count + 1)
    line = Polyline(t, np.stack([t - at / 256, np.zeros(count + 1)], axis=1))
    edit = Spatula(radius=0.25, path=[[0.25, -0.25], [0.25, -0.125]]).edit(line, Scene())
    points = np.asarray(edit.value)
    pushed = np.flatnonzero(points[:, 1])
    assert pushed.tolist() == list(range(pushed[0], pushed[-1] + 1))
    lengths = np.linalg.norm(np.diff(points[pushed[0] : pushed[-1] + 1], axis=0), axis=1)
    assert (lengths[1:] + lengths[:-1] >= 0.25 / 8 * (1 - 1e-9)).all()
    assert lengths.max() <= 0.25 / 4
    arc = 0.25 * np.pi * 2 / 3  # from 30 to 150 degrees
    assert len(pushed) <= 4 * 8 * arc / 0.25


# -- what is refused -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"radius": 0, "path": [[0, 0]]}, "'radius' must be > 0"),
        ({"radius": float("nan"), "path": [[0, 0]]}, "'radius' must be > 0"),
        ({"radius": float("inf"), "path": [[0, 0]]}, "'radius' must be finite"),
        ({"radius": 1, "path": []}, "'path' must be a list of one point or more"),
        ({"radius": 1, "path": 3}, "'path' must be a list of one point or more"),
        ({"radius": 1, "path": [[0, 0], [1]]}, "point 1 is"),
        ({"radius": 1, "path": [[0, float("inf")]]}, "point 0 is"),
    ],
)
def test_bad_parameters_are_refused(fields: Any, message: str) -> None:
    """The message names the field and what was found."""
    with pytest.raises(ValueError, match=message):
        Spatula(**fields)


def test_scripts_say_which_key_is_wrong() -> None:
    """As a step of a script."""
    assert structure({"radius": 0.5, "path": [[0, 0], [1, 2]]}, Spatula).path == ((0, 0), (1, 2))
    with pytest.raises(Mismatch, match="path"):
        structure({"radius": 0.5, "path": [0, 0]}, Spatula)


def test_it_works_in_the_plane_only() -> None:
    """Curves and paths in space are refused, and so are strokes without end."""
    space = Polyline([0, 1], [[0, 0, 0], [1, 1, 1]])
    with pytest.raises(EditError, match="this curve has 3 coordinates"):
        Spatula(radius=1, path=[[0, 0]]).edit(space, Scene())
    with pytest.raises(EditError, match="this path has 3 coordinates"):
        Spatula(radius=1, path=[[0, 0, 0]]).edit(LINE, Scene())
    with pytest.raises(EditError, match="too long for radius"):
        Spatula(radius=1e-6, path=[[0, 0], [1, 0]]).edit(LINE, Scene())
