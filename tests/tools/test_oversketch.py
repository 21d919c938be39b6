"""The oversketch tool: a stroke replaces a stretch, joins as asked, and nothing else moves."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.arrays import Array
from multirep.errors import EditError, EditRejectedError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.testing import ToolSuite, check_certificate, check_edit
from multirep.testing.strategies import polylines, strokes
from multirep.tools import Oversketch
from multirep.tools.oversketch.gap import find_gap

SCENE = mr.Scene()


def wave(t: Array) -> Array:
    return np.stack([4 * t, np.sin(6 * t)], axis=-1)


def bumped(start: float = 0.3, stop: float = 0.6, height: float = 0.3, off: float = 0.0) -> Array:
    """The wave between two of its parameters, with a bump on it; ``off`` above it at its ends."""
    u = np.linspace(start, stop, 120)
    bump = height * np.sin(np.pi * (u - start) / (stop - start)) + off
    return wave(u) + np.stack([0 * u, bump], axis=1)


WAVE = Polyline(np.linspace(0, 1, 201), wave(np.linspace(0, 1, 201)))


class TestOversketchSuite(ToolSuite):
    """The laws of tools."""

    malformed = (
        {},
        {"stroke": []},
        {"stroke": [[0, 0], [float("inf"), 1]]},
        {"stroke": [[0, 0], [1, 1]], "join": "G2"},
        {"stroke": [[0, 0], [1, 1]], "parameters": "even"},
        {"stroke": [[0, 0], [1, 1]], "apron": 0.0},
        {"stroke": [[0, 0], [1, 1]], "reach": -1.0},
        {"stroke": [[0, 0], [1, 1]], "noise": -1.0},
    )

    @pytest.fixture
    def value(self) -> Polyline:
        return WAVE

    @pytest.fixture(params=["C0", "G1", "C2"])
    def join(self, request: pytest.FixtureRequest) -> str:
        return str(request.param)

    @pytest.fixture(params=["redistribute", "keep"])
    def parameters(self, request: pytest.FixtureRequest) -> str:
        return str(request.param)

    @pytest.fixture
    def tool(self, join: Any, parameters: Any) -> Oversketch:
        return Oversketch(
            stroke=bumped(off=0.01),
            join=join,
            parameters=parameters,
            apron=0.2,
            reach=0.5,
            noise=0.001,
        )

    @pytest.fixture
    def refused(self) -> Sequence[Oversketch]:
        far = bumped(off=9.0)
        return (
            Oversketch(stroke=far),
            Oversketch(stroke=[[1, 1]]),
            Oversketch(stroke=[[0, 0, 0], [1, 1, 1]]),
            Oversketch(stroke=[[4.5, 0.2], [6.0, 1.0]]),
        )


class TestOversketchBeyondSuite(ToolSuite):
    """The laws of tools, for a stroke that begins on the curve and goes beyond its end."""

    @pytest.fixture
    def value(self) -> Polyline:
        return WAVE

    @pytest.fixture
    def tool(self) -> Oversketch:
        return Oversketch(stroke=[[3.0, -1.0], [4.0, -0.8], [5.0, 1.0]])


@given(polylines(min_size=4), strokes(), st.data())
def test_whatever_is_drawn_over_whatever_is_a_sound_edit(
    curve: tuple[Array, Array], stroke: Array, data: st.DataObject
) -> None:
    """Outside bit-identical, T and its ends kept, finite; or a refusal that says why."""
    polyline = Polyline(*curve)
    tool = Oversketch(
        stroke=stroke / 32.0,
        join=data.draw(st.sampled_from(["C0", "G1", "C2"])),
        parameters=data.draw(st.sampled_from(["keep", "redistribute"])),
        reach=data.draw(st.sampled_from([None, 100.0])),
    )
    try:
        tool.edit(polyline, SCENE)
    except EditError as error:
        if any(s in str(error) for s in ("too far", "one place", "no parameters", "all of it")):
            return
        raise
    edit = check_edit(polyline, lambda value: tool.edit(value, SCENE))
    assert edit.value.domain == polyline.domain
    assert np.isfinite(np.asarray(edit.value.points)).all()


@pytest.mark.parametrize("join", ["C0", "G1", "C2"])
@pytest.mark.parametrize("parameters", ["redistribute", "keep"])
def test_the_direction_of_drawing_does_not_matter(join: Any, parameters: Any) -> None:
    """The same stroke backwards gives the same curve."""
    stroke = bumped(off=0.01)
    there = Oversketch(stroke=stroke, join=join, parameters=parameters).edit(WAVE, SCENE)
    back = Oversketch(stroke=stroke[::-1], join=join, parameters=parameters).edit(WAVE, SCENE)
    assert there.splices == back.splices
    t = np.linspace(0, 1, 2001)
    assert there.value(t) == pytest.approx(back.value(t), abs=1e-9)


@pytest.mark.parametrize("join", ["C0", "G1", "C2"])
def test_the_stroke_is_led_to_the_places_of_its_ends(join: Any) -> None:
    """However far the ends were: the curve stays continuous, bit by bit, also inside segments."""
    stroke = bumped(0.3012, 0.6034, off=0.05)
    gap = find_gap(WAVE, stroke, None)
    value = Oversketch(stroke=stroke, join=join, noise=0.0).edit(WAVE, SCENE).value
    for t in (gap.start, gap.stop):
        assert t not in np.asarray(WAVE.t)
        assert value(t).tolist() == WAVE(t).tolist()


@pytest.mark.parametrize("join", ["C0", "G1", "C2"])
def test_the_middle_of_the_stroke_keeps_its_shape(join: Any) -> None:
    """Beyond the aprons the new stretch is the stroke."""
    stroke = bumped(off=0.02)
    value = Oversketch(stroke=stroke, join=join, apron=0.1, noise=0.0).edit(WAVE, SCENE).value
    new = np.asarray(value.points)
    for point in stroke[(stroke[:, 0] > 1.4) & (stroke[:, 0] < 2.2)]:
        assert np.linalg.norm(new - point, axis=1).min() <= 1e-12


def derivatives(value: Polyline, at: float, side: int) -> tuple[Array, Array]:
    """First and second derivative by t at a vertex, by a cubic through it and three on a side."""
    t, points = np.asarray(value.t), np.asarray(value.points)
    k = int(np.abs(t - at).argmin())
    assert t[k] == pytest.approx(at, abs=1e-12)
    rows = k + side * np.arange(4)
    tau = t[rows] - at
    table = np.stack([np.ones(4), tau, tau**2 / 2, tau**3 / 6], axis=1)
    solved = np.linalg.solve(table, points[rows])
    return solved[1], solved[2]


@pytest.mark.parametrize("parameters", ["redistribute", "keep"])
@pytest.mark.parametrize("end", [0.3, 0.6])
@pytest.mark.parametrize("join", ["G1", "C2"])
def test_joins_are_as_smooth_as_asked(join: Any, end: float, parameters: Any) -> None:
    """On ever finer samples of a smooth curve the jumps vanish, with measured orders."""
    jumps = []
    for count in (4000, 16000):
        t = np.linspace(0, 1, count + 1)
        curve = Polyline(t, wave(t))
        tool = Oversketch(stroke=bumped(), join=join, parameters=parameters, noise=0.0)
        value = tool.edit(curve, SCENE).value
        left, right = derivatives(value, end, -1), derivatives(value, end, 1)
        directions = [first / np.linalg.norm(first) for first, _ in (left, right)]
        jump = [np.linalg.norm(directions[0] - directions[1])]
        if join == "C2":
            jump += [np.linalg.norm(a - b) for a, b in zip(left, right, strict=True)]
        jumps.append(np.array(jump))
    orders = np.log(jumps[0] / jumps[1]) / np.log(4)
    # direction and first derivative fall with the square of the step or faster, the second linearly
    assert (orders >= [1.0, 1.7, 0.9][: len(orders)]).all()
    assert (jumps[1] <= [1e-5, 1e-5, 0.2][: len(orders)]).all()


def test_c0_keeps_the_direction_of_the_stroke() -> None:
    """A stroke that leaves at a right angle makes a corner when C0 is asked, none otherwise."""
    line = Polyline(np.linspace(0, 1, 101), np.linspace([0, 0], [10, 0], 101))
    leap = [[4.0, 0.0], [4.0, 2.0], [6.0, 2.0], [6.0, 0.0]]
    sharp = Oversketch(stroke=leap, join="C0").edit(line, SCENE).value
    smooth = Oversketch(stroke=leap, join="G1").edit(line, SCENE).value
    for value, angle in ((sharp, np.pi / 2), (smooth, 0.0)):
        slopes = [value.derivative(0.4, side=side) for side in ("left", "right")]
        unit = [slope / np.linalg.norm(slope) for slope in slopes]
        assert np.arccos(np.clip(unit[0] @ unit[1], -1, 1)) == pytest.approx(angle, abs=0.05)


def test_kept_parameters_are_vertices_with_their_share_of_the_length() -> None:
    """With "keep" the old parameters of the stretch stay, and so does the flow of the speed."""
    t = np.linspace(0, 1, 101) ** 2
    line = Polyline(t, np.linspace([0, 0], [10, 0], 101))
    stroke = np.stack([np.linspace(2, 8, 61), np.zeros(61)], axis=1)
    value = Oversketch(stroke=stroke, parameters="keep").edit(line, SCENE).value
    assert set(t.tolist()) <= set(np.asarray(value.t).tolist())
    assert value(t) == pytest.approx(np.asarray(line.points), abs=1e-9)
    even = Oversketch(stroke=stroke).edit(line, SCENE).value
    assert even(0.34)[0] == pytest.approx(2 + 6 * (0.34 - 0.04) / (0.64 - 0.04), abs=0.05)


def test_a_stroke_beyond_an_end_extends_the_curve() -> None:
    """Begun on the curve and drawn out: the curve ends where the stroke does, T stays."""
    stroke = np.array([[3.2, -0.99], [4.0, -0.6], [6.0, 1.0]])
    for drawn in (stroke, stroke[::-1]):
        value = Oversketch(stroke=drawn).edit(WAVE, SCENE).value
        assert value.domain == WAVE.domain
        assert value(1.0) == pytest.approx(stroke[-1])
        assert value(0.0).tolist() == WAVE(0.0).tolist()
    front = np.array([[-2.0, 1.0], [0.2, 0.4], [0.8, 0.93]])
    value = Oversketch(stroke=front).edit(WAVE, SCENE).value
    assert value(0.0) == pytest.approx(front[0])
    assert value(1.0).tolist() == WAVE(1.0).tolist()


def test_a_curve_whose_ends_meet_stays_open() -> None:
    """A stroke that ends where both ends of the curve are replaces the side along which it runs."""
    t = np.linspace(0, 1, 401)
    ring = Polyline(t, np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1))
    for start, stop in ((0.2, 0.0), (0.0, 0.2), (0.8, 1.0), (1.0, 0.8)):
        u = np.linspace(start, stop, 80)
        stroke = 1.02 * np.stack([np.cos(2 * np.pi * u), np.sin(2 * np.pi * u)], axis=1)
        edit = Oversketch(stroke=stroke).edit(ring, SCENE)
        low, high = sorted((start, stop))
        assert edit.splices.hull.start == pytest.approx(low, abs=0.01)
        assert edit.splices.hull.stop == pytest.approx(high, abs=0.01)


@pytest.mark.parametrize("join", ["C0", "G1", "C2"])
@pytest.mark.parametrize("parameters", ["redistribute", "keep"])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("slit", [0.0, 0.01])
def test_a_stroke_across_the_place_where_the_ends_meet_parts_there(
    join: Any, parameters: Any, backwards: bool, slit: float
) -> None:
    """It replaces a stretch at either end; the far side stays, bit by bit, and the ends meet."""
    t = np.linspace(0, 1, 401)
    angle = 2 * np.pi * (slit + (1 - 2 * slit) * t)
    ring = Polyline(t, np.stack([np.cos(angle), np.sin(angle)], axis=1))
    u = np.linspace(-0.5, 0.7, 80)
    radius = 1 + 0.2 * np.cos(np.pi * (u - 0.1) / 1.2) ** 2
    stroke = np.stack([radius * np.cos(u), radius * np.sin(u)], axis=1)[:: -1 if backwards else 1]
    edit = check_edit(
        ring,
        lambda value: Oversketch(stroke=stroke, join=join, parameters=parameters).edit(
            value, SCENE
        ),
    )
    low, high = edit.splices
    assert low.start == 0.0
    assert high.stop == 1.0
    assert low.stop == pytest.approx(0.7 / (2 * np.pi), abs=0.02)
    assert high.start == pytest.approx(1 - 0.5 / (2 * np.pi), abs=0.02)
    between = np.linspace(low.stop, high.start, 100)
    assert edit.value(between).tobytes() == ring(between).tobytes()
    assert edit.value(0.0) == pytest.approx(edit.value(1.0), abs=1e-12)
    found = edit.value(t)
    middle = np.abs(np.arctan2(found[:, 1], found[:, 0]) - 0.1) < 0.2
    assert middle.sum() > 10
    wide = 1 + 0.2 * np.cos(np.pi * (np.arctan2(found[:, 1], found[:, 0]) - 0.1) / 1.2) ** 2
    assert np.linalg.norm(found, axis=1)[middle] == pytest.approx(wide[middle], abs=2e-3)


@pytest.mark.parametrize("reach", [None, 100.0])
def test_an_open_curve_is_not_parted(reach: float | None) -> None:
    """However far the stroke goes: a detour past both ends stays between its own ends."""
    t = np.linspace(0, 1, 401)
    bow = Polyline(t, np.stack([np.cos(4 * t), np.sin(4 * t)], axis=1))
    detour = np.array([bow(0.3), [0.0, -0.5], [0.6, 0.0], [0.3, -0.6], bow(0.7)])
    edit = Oversketch(stroke=detour, reach=reach, straight=True).edit(bow, SCENE)
    assert len(edit.splices) == 1
    assert list(edit.splices.hull) == pytest.approx([0.3, 0.7], abs=0.01)


@pytest.mark.parametrize(
    ("stroke", "options", "message"),
    [
        (bumped(off=9.0), {}, r"begins 8\.98 from it and ends .* allowed is 0\.507 \(a quarter"),
        (bumped(off=1.0), {"reach": 0.5}, r"allowed is 0\.5; begin and end it on the curve"),
        ([[4.1, -0.2], [6.0, 1.0]], {}, "one place of the curve, t = 1: .*begin the stroke on"),
        ([[2.0, 0.0], [2.0, 0.7], [2.0, 0.0]], {}, "both ends of the stroke mean one place"),
        ([[0, 0, 0], [1, 1, 1]], {}, "the stroke has 3 coordinates, the curve 2"),
        ([[1, 1], [1, 1]], {}, "has no length"),
    ],
)
def test_refusals_say_how_far_and_what_is_allowed(
    stroke: Any, options: dict[str, Any], message: str
) -> None:
    """In a session: named tool, distance and limit, nothing changed."""
    session = mr.Session()
    session.add("wave", mr.MultiRepresentation(WAVE, tolerance=0.01))
    before = session.curve("wave").snapshot()
    with pytest.raises(EditRejectedError, match=f"tool 'oversketch': .*{message}"):
        session.apply("wave", Oversketch(stroke=stroke, **options))
    assert session.curve("wave").snapshot() is before


@pytest.mark.parametrize("join", ["C0", "G1", "C2"])
def test_all_representations_follow(join: Any) -> None:
    """Several oversketches through a session of three representations: certified, undoable."""
    session = mr.Session()
    session.add("wave", mr.MultiRepresentation(WAVE, tolerance=0.005))
    curve = session.curve("wave")
    first = [curve.view(kind) for kind in (Polyline, Nurbs, WaveletBSpline)]
    rng = np.random.default_rng(4)
    for start in (0.1, 0.5, 0.35):
        stroke = bumped(start, start + 0.2, 0.2)
        session.apply(
            "wave", Oversketch(stroke=stroke + 0.003 * rng.normal(size=stroke.shape), join=join)
        )
        check_certificate(curve)
    session.undo(3)
    assert [curve.view(kind) for kind in (Polyline, Nurbs, WaveletBSpline)] == first


def test_a_tail_is_drawn_and_cut_off_again() -> None:
    """A stretch may become much longer, and much shorter again."""
    angle = np.linspace(0, np.pi, 90)
    tail = np.stack([2.0 - 0.15 * np.cos(angle), 0.1 + 5 * np.sin(angle)], axis=1)
    long = Oversketch(stroke=tail).edit(WAVE, SCENE).value
    assert np.asarray(long.points)[:, 1].max() == pytest.approx(5.1, abs=0.05)
    cut = Oversketch(stroke=wave(np.linspace(0.4, 0.6, 40))).edit(long, SCENE).value
    assert np.asarray(cut.points)[:, 1].max() <= 1.01


def test_the_cost_does_not_grow_with_the_curve() -> None:
    """The same stroke over the same stretch: 10^5 vertices at most twice 10^3."""

    def prepared(count: int) -> tuple[Oversketch, Polyline]:
        x = 0.01 * np.arange(count)
        curve = Polyline.from_points(np.stack([x, np.sin(x)], axis=1))
        u = np.linspace(4, 5, 80)
        tool = Oversketch(stroke=np.stack([u, np.sin(u) + 0.3 * np.sin(np.pi * u) ** 2], axis=1))
        tool.edit(curve, SCENE)  # makes the boxes
        return tool, curve

    cases = prepared(1_000), prepared(100_000)
    seconds = [np.inf, np.inf]
    for _ in range(60):  # in turn, and time of this process: other work of the machine slows both
        for k, (tool, curve) in enumerate(cases):
            begin = time.process_time()
            tool.edit(curve, SCENE)
            seconds[k] = min(seconds[k], time.process_time() - begin)
    assert seconds[1] <= 2 * seconds[0]
