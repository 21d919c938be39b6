"""What makes spline programs slow or wrong unnoticed, each shown not to happen here.

Known from measuring other libraries: scipy finds spans by walking through all knots, its
constructor looks at every number, fits at data points say nothing between them, normal equations
become singular where there are no data, samplers pass over knots unseen, projections forget the
ends. Work is counted, never timed. Singular normal equations have their tests in
``splines/test_spline_least_squares.py``, chords that pass over knots in
``splines/test_spline_sampling.py``.
"""

from __future__ import annotations

import traceback
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

import multirep as mr
from multirep import blocks
from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.splines import compiled

#: Control points of a long curve, and the most knots that something local may hand to scipy.
LONG, LOCAL = 20_000, 400


def walk(n: int) -> Array:
    """A wandering course: no stretch of it is smooth."""
    steps = np.random.default_rng(1).choice([-1.0, 0.0, 1.0], size=(n, 2))
    return np.cumsum(steps + np.array([1.0, 0.0]), axis=0) / 64


def nurbs(*, rational: bool = False) -> Nurbs:
    """A long cubic."""
    inner = np.linspace(0, 1, LONG - 2)[1:-1]
    knots = np.concatenate([np.zeros(4), inner, np.ones(4)])
    weights = 1 + np.arange(LONG) % 3 / 4 if rational else None
    return Nurbs(degree=3, knots=knots, points=walk(LONG), weights=weights)


CURVES = {
    "polynomial": nurbs,
    "rational": lambda: nurbs(rational=True),
    "wavelet": lambda: WaveletBSpline(walk(2**14 + 3)),
}


@pytest.fixture(params=CURVES)
def long_curve(request: pytest.FixtureRequest) -> Representation:
    return CURVES[request.param]()


@pytest.fixture
def walks(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The spans that scipy walks through in each evaluation: from each parameter to the next."""
    found: list[int] = []
    call = BSpline.__call__

    def watched(spline: Any, t: Any, *more: Any) -> Any:
        at = np.ravel(t)
        spans = np.clip(spline.t.searchsorted(at, "right") - 1, spline.k, len(spline.c) - 1)
        found.append(int(np.abs(np.diff(spans, prepend=spline.k)).sum()))
        return call(spline, t, *more)

    monkeypatch.setattr(BSpline, "__call__", watched)
    monkeypatch.setattr(compiled, "active", False)
    return found


@pytest.fixture
def handed(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The knots that the core is handed as an array in each evaluation: none in a rope."""
    if compiled.core is None:
        pytest.skip("the core was not built")
    found: list[int] = []

    class Watched:
        def __getattr__(self, name: str) -> Any:
            return getattr(core, name)

        def points(self, knots: Any, *more: Any) -> None:
            found.append(len(knots) if isinstance(knots, np.ndarray) else 0)
            core.points(knots, *more)

    core = compiled.core
    monkeypatch.setattr(compiled, "core", Watched())
    monkeypatch.setattr(compiled, "active", True)
    return found


# -- scipy's walk through the knots ----------------------------------------------------------------


def test_one_point_is_no_walk(long_curve: Representation, walks: list[int]) -> None:
    """Wherever it is on a long curve, derivatives too."""
    for t in (0.0, 0.3, 0.7312, 1.0):
        long_curve(t)
        long_curve([t])
        long_curve.derivative([t])
    assert walks
    assert max(walks) <= 4


def test_one_point_is_a_window_for_the_core(long_curve: Representation, handed: list[int]) -> None:
    """Of one span at most, whichever way it is asked for."""
    for t in (0.0, 0.3, 0.7312, 1.0):
        long_curve(t)
        long_curve([t])
        long_curve.derivative([t])
    assert len(handed) >= 12
    assert max(handed) <= 8


def test_points_far_apart_are_windows_for_the_core(
    long_curve: Representation, handed: list[int]
) -> None:
    """Derivatives too."""
    long_curve([0.99, 0.01])
    long_curve.derivative([0.99, 0.01])
    assert len(handed) >= 3
    assert max(handed) <= 8


@pytest.mark.parametrize("curve", ["polynomial", "rational", "wavelet"])
def test_many_points_are_read_from_the_blocks(
    curve: str, handed: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """No array is copied as a whole; the bits are those of the spans one by one, and numpy's."""
    value = CURVES[curve]()
    t = np.random.default_rng(2).random(LONG)
    t[:100] = np.asarray(value.knots)[50:150]
    lengths: list[int] = []
    window = BlockArray.window

    def watched(array: BlockArray, start: int, stop: int) -> Array:
        lengths.append(stop - start)
        return window(array, start, stop)

    monkeypatch.setattr(BlockArray, "window", watched)
    together = value(t)
    assert max(lengths, default=0) <= 8
    assert set(handed) == {0}
    np.testing.assert_array_equal(together[:300], [value(s) for s in t[:300].tolist()])
    monkeypatch.setattr(compiled, "active", False)
    np.testing.assert_array_equal(together, value(t))


def test_many_points_in_no_order_are_one_walk(long_curve: Representation, walks: list[int]) -> None:
    """From the first span to the last at most once, in whatever order they come."""
    t = np.random.default_rng(2).random(LONG)
    values = long_curve(t)
    assert sum(walks) <= LONG
    order = t.argsort()
    np.testing.assert_array_equal(values[order], long_curve(t[order]))


@pytest.mark.parametrize("curve", ["polynomial", "rational"])
def test_two_points_far_apart_are_no_walk(curve: str, walks: list[int]) -> None:
    """Few parameters all over a long curve are evaluated where they are."""
    CURVES[curve]()([0.99, 0.01])
    assert sum(walks) <= 8


# -- O(n) in what is local -------------------------------------------------------------------------


def small_blocks_curve(monkeypatch: pytest.MonkeyPatch) -> mr.MultiRepresentation:
    """A curve whose three representations have many blocks, all views up to date."""
    monkeypatch.setattr(blocks, "BLOCK_ROWS", 64)
    curve = mr.MultiRepresentation.from_points(walk(1500), tolerance=0.004)
    for kind in curve.kinds:
        curve.view(kind)
    return curve


def drag(curve: mr.MultiRepresentation, kind: type[Any], k: int) -> None:
    """Move what a representation offers in the middle; bring all views up to date."""
    value: Any = curve.view(kind)
    middle = value.size // 2
    to = value.points[middle] + [0.0, 0.04 * (-1) ** k]
    move = value.move_vertex if kind is Polyline else value.move_control_point
    curve.commit(kind, move(middle, to))
    for name in curve.kinds:
        curve.view(name)


def arrays(curve: mr.MultiRepresentation) -> list[BlockArray]:
    """Return the long arrays of all representations; knots of a wavelet are points, counted."""
    polyline, spline, wavelet = (curve.view(kind) for kind in (Polyline, Nurbs, WaveletBSpline))
    return [polyline.t, polyline.points, spline.knots, spline.points, wavelet.points]


@pytest.mark.parametrize("kind", [Polyline, Nurbs, WaveletBSpline])
def test_a_drag_step_constructs_no_spline_of_scipy(
    kind: type[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The constructor looks at every knot and coefficient; nothing here needs it."""
    curve = small_blocks_curve(monkeypatch)

    constructed: list[str] = []
    construct = BSpline.__init__

    def watched(spline: BSpline, *more: Any, **options: Any) -> None:
        constructed.append(traceback.format_stack(limit=2)[0])
        construct(spline, *more, **options)

    monkeypatch.setattr(BSpline, "__init__", watched)
    for k in range(3):
        drag(curve, kind, k)
    curve.view(Nurbs).insert_knot(0.51234)
    curve.view(Nurbs).insert_knots([0.1234, 0.51234])
    assert constructed == []


@pytest.mark.parametrize("kind", [Polyline, Nurbs, WaveletBSpline])
def test_a_drag_step_hands_scipy_a_window(kind: type[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    """Never the knots of the whole curve."""
    curve = small_blocks_curve(monkeypatch)
    drag(curve, kind, 0)
    lengths: list[int] = []
    construct = BSpline.construct_fast.__func__

    def watched(cls: type[BSpline], t: Any, *more: Any) -> BSpline:
        lengths.append(len(t))
        return construct(cls, t, *more)

    monkeypatch.setattr(BSpline, "construct_fast", classmethod(watched))
    monkeypatch.setattr(compiled, "active", False)
    drag(curve, kind, 1)
    curve.view(Nurbs)([0.4, 0.401])
    assert max(lengths) <= LOCAL < len(curve.view(Nurbs).knots) / 4


@pytest.mark.parametrize("kind", [Polyline, Nurbs, WaveletBSpline])
def test_a_drag_step_leaves_nearly_all_blocks_alone(
    kind: type[Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The snapshot from before shares every block but a few with the present state."""
    curve = small_blocks_curve(monkeypatch)
    before = arrays(curve)
    drag(curve, kind, 0)
    for old, new in zip(before, arrays(curve), strict=True):
        known = set(map(id, old.blocks))
        assert len(old.blocks) > 20
        assert sum(id(block) not in known for block in new.blocks) <= 4


def test_a_thousand_edits_in_one_place_leave_blocks_even(monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks neither crumble nor swell where the same place is edited again and again.

    Many small ones make every edit slower, and so does a large one.
    """
    monkeypatch.setattr(blocks, "BLOCK_ROWS", 64)
    array = BlockArray.of(np.arange(4096.0))
    rng = np.random.default_rng(3)
    for grows in (True, False):
        for _ in range(500):
            start = 2000 + int(rng.integers(0, 32))
            kept = int(rng.integers(0, 3))
            stop = start + (kept if grows else 12)
            array = array.replaced(start, stop, np.zeros(kept + 10 * grows))
        lengths = [len(block) for block in array.blocks]
        assert max(lengths) <= 2 * 64
        assert len(lengths) <= 2 * len(array) / 64 + 4


# -- fits that are right at the data only ----------------------------------------------------------


@pytest.mark.parametrize("kind", [Nurbs, WaveletBSpline])
def test_few_vertices_and_a_fine_tolerance(kind: type[Any]) -> None:
    """Below the chord error of the data a fit at the vertices is off by many tolerances between."""
    t = np.linspace(0, 1, 100)
    points = np.stack([np.cos(6 * t), np.sin(12 * t)], axis=1)
    tolerance = 1e-5
    curve = mr.MultiRepresentation.from_points(points, tolerance=tolerance)
    assert curve.deviation(Polyline, kind).upper <= tolerance
    at = np.linspace(0, 1, 50_001)
    apart = np.linalg.norm(curve.view(Polyline)(at) - curve.view(kind)(at), axis=1)
    assert apart.max() <= tolerance


@pytest.mark.parametrize("kind", [Nurbs, WaveletBSpline])
def test_long_chords_beside_crowds_of_vertices(kind: type[Any]) -> None:
    """Spans without a single vertex do not make the normal equations singular."""
    rng = np.random.default_rng(4)
    crowd = np.sort(rng.random(300)) * 0.01
    t = np.unique(np.concatenate([[0.0], 0.2 + crowd, [0.5], 0.8 + crowd, [1.0]]))
    points = np.stack([t, 0.01 * rng.normal(size=len(t))], axis=1)
    curve = mr.MultiRepresentation.from_points(points, t=t, tolerance=1e-3)
    assert curve.deviation(Polyline, kind).upper <= 1e-3


@pytest.mark.parametrize("kind", [Nurbs, WaveletBSpline])
def test_the_knots_change_with_the_edit(kind: type[Any]) -> None:
    """A vertex moved by ten tolerances is followed with new knots: the old ones cannot."""
    t = np.linspace(0, 1, 1001)
    points = np.stack([np.cos(6 * t), np.sin(12 * t)], axis=1)
    curve = mr.MultiRepresentation.from_points(points, t=t, tolerance=1e-3)
    before = curve.view(kind).knots
    value = curve.view(Polyline)
    curve.commit(Polyline, value.move_vertex(500, value.points[500] + [0.0, 0.01]))
    after = curve.view(kind).knots
    near = [int(k.searchsorted(0.505) - k.searchsorted(0.495)) for k in (before, after)]
    assert near[1] >= near[0] + 3
    assert curve.deviation(Polyline, kind).upper <= 1e-3


# -- forgotten ends, snapped parameters ------------------------------------------------------------


@pytest.mark.parametrize("kind", [Polyline, Nurbs, WaveletBSpline])
def test_the_nearest_place_may_be_an_end(kind: type[Any]) -> None:
    """Where no foot of a perpendicular is nearer, and where there is none at all."""
    t = np.linspace(0, 1, 50)
    points = np.stack([t, 0.1 * np.sin(9 * t)], axis=1)
    value = mr.MultiRepresentation.from_points(points, tolerance=1e-3).view(kind)
    for end, point in ((0.0, [-3.0, 0.0]), (1.0, [4.0, 0.2])):
        found = value.nearest(point)
        assert found.t == end
        away = np.linalg.norm(value(end) - np.array(point))
        assert found.distance == pytest.approx(away, rel=1e-15)


@pytest.mark.parametrize("apart", [2.0**-14, 2.0**-30, 2.0**-52])
def test_parameters_beside_a_knot_are_not_moved_onto_it(apart: float) -> None:
    """At a corner the points on both sides follow the two lines exactly."""
    corner = Nurbs(degree=1, knots=[0, 0, 0.5, 1, 1], points=[[0.0], [1.0], [0.0]])
    assert corner(0.5 - apart / 2)[0] == 1 - apart
    assert corner(0.5 + apart / 2)[0] == pytest.approx(1 - apart, abs=2.0**-52)
