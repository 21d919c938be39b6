"""The value: both faces, edits by hand, data."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline, make_lsq_spline

from multirep import Interval, SampledSplice, SpliceList
from multirep.errors import EditError, InvalidCurveError, ParameterError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet.filters import refine_uniform
from multirep.testing import check_edit
from multirep.testing import reference_wavelets as reference

WORKED = json.loads((Path(__file__).parent / "wavelets.json").read_text())["worked_decomposition"]


def graded(seed: int = 0, domain: tuple[float, float] = (0.0, 1.0)) -> WaveletBSpline:
    """Random control points on knots of levels 3 to 9."""
    rng = np.random.default_rng(seed)
    value = WaveletBSpline(rng.normal(size=(11, 2)), domain)
    for stop in (0.7, 0.6, 0.55, 0.51, 0.505, 0.502):
        a, b = (domain[0] + part * (domain[1] - domain[0]) for part in (0.5, stop))
        value = value.refine(Interval(a, b)).value
    for index in rng.integers(0, value.size, 20):
        value = value.move_control_point(int(index), rng.normal(size=2)).value
    return value


def as_scipy(value: WaveletBSpline) -> BSpline:
    return BSpline(np.asarray(value.knots), np.asarray(value.points), 3)


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-3.0, 4.0), (1e6, 1e6 + 1.0)])
def test_evaluation_agrees_with_scipy(domain):
    """Values and derivatives of all orders, at knots from both sides, in any order."""
    value = graded(1, domain)
    assert value.level == 9
    t = np.union1d(np.linspace(*domain, 301), np.asarray(value.knots))
    t = np.random.default_rng(0).permutation(t)
    assert np.abs(value(t) - as_scipy(value)(t)).max() <= 1e-13
    for order in (1, 2, 3):
        expected = as_scipy(value)(t, order)
        scale = np.abs(expected).max()
        inside = t < domain[1]
        found = value.derivative(t, order)
        assert np.abs(found - expected)[inside].max() <= 1e-9 * scale
    assert (value.derivative(t, 4) == 0).all()
    inner = np.asarray(value.knots)[4:-4]
    jumps = value.derivative(inner, 3, "right") - value.derivative(inner, 3, "left")
    assert np.abs(jumps).max() > 0.1 * np.abs(value.derivative(inner, 3)).max()


def test_scattered_parameters_of_a_long_curve_are_evaluated_alike():
    """A few far apart give the bits that many together give."""
    value = WaveletBSpline(np.random.default_rng(2).normal(size=(2**14 + 3, 2)))
    t = np.random.default_rng(3).uniform(0, 1, 20000)
    together = value(t)
    assert (value(t[:7]) == together[:7]).all()
    assert (value.derivative(t[:7], 2) == value.derivative(t, 2)[:7]).all()


@given(st.integers(0, 20), st.sets(st.integers(0, 10**6), max_size=6))
def test_refining_keeps_the_curve_and_what_it_need_not_change(seed, places):
    """Halving spans anywhere: the same curve up to rounding, and bit-identical outside."""
    value = graded(seed)
    t = np.linspace(0, 1, 501)
    for place in places:
        start = place / 10**6 * 0.9
        edit = check_edit(value, value.refine(Interval(start, start + 0.1)))
        assert np.abs(edit.value(t) - value(t)).max() <= 1e-14
        assert edit.value.size > value.size
        value = edit.value


def test_refining_everything_doubles_the_spans():
    """Without an interval all of T is refined, like applying P."""
    rows = np.random.default_rng(4).normal(size=(19, 3))
    finer = WaveletBSpline(rows).refine().value
    assert finer.level == 5
    assert np.abs(np.asarray(finer.points) - refine_uniform(rows)).max() <= 1e-15


@given(st.integers(0, 40))
def test_moving_a_control_point_moves_its_support_alone(index):
    """Four spans change, by the B-spline of that control point."""
    value = graded()
    index %= value.size
    knots, target = np.asarray(value.knots), np.array([3.0, -2.0])
    edit = check_edit(value, value.move_control_point(index, target))
    assert edit.splices == SpliceList([(knots[index], knots[index + 4])])
    way = target - value.points[index]
    hat = BSpline(knots, np.eye(value.size)[index], 3)
    t = np.linspace(0, 1, 400)
    assert np.abs(edit.value(t) - value(t) - hat(t)[:, None] * way).max() <= 1e-13


def test_moving_what_is_not_there_is_refused():
    """The message says which control points there are, or which point is none."""
    value = graded()
    with pytest.raises(EditError, match=f"0 to {value.size - 1}, got {value.size}"):
        value.move_control_point(value.size, [0, 0])
    with pytest.raises(EditError, match="2 coordinates"):
        value.move_control_point(0, [0, 0, 0])
    with pytest.raises(EditError, match="finite"):
        value.move_control_point(0, [0, np.nan])


def test_the_pyramid_of_a_uniform_curve_is_the_worked_one():
    """Base and control points of every level; asked twice, the same object comes."""
    value = WaveletBSpline(WORKED["input"])
    pyramid = value.pyramid()
    assert pyramid is value.pyramid(5)
    for level, facts in WORKED["levels"].items():
        assert np.abs(pyramid.control_points(int(level)) - facts["c"]).max() <= 5e-14
        assert np.abs(value.pyramid(int(level)).control_points() - facts["c"]).max() <= 5e-12


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-3.0, 4.0)])
def test_the_pyramid_of_a_graded_curve_gives_it_back(domain):
    """Up to the finest level it is exact: its control points are those of the refined curve."""
    value = graded(5, domain)
    points = value.pyramid().control_points()
    assert len(points) == 2**9 + 3
    t = np.linspace(*domain, 700)
    assert np.abs(WaveletBSpline(points, domain)(t) - value(t)).max() <= 1e-13


def test_above_its_level_a_curve_has_no_details():
    """A pyramid may be asked for more levels than there are."""
    value = graded(6)
    pyramid = value.pyramid(11)
    assert max(np.abs(details).max() for details in pyramid.details[9:]) <= 1e-14


@pytest.mark.parametrize("level", [0, 3, 6])
def test_coarse_pyramids_are_least_squares_projections(level):
    """Below its finest level: scipy's least squares agrees, and so does analysis."""
    value = graded(7)
    projected = value.pyramid(level).control_points()
    analysed = value.pyramid().control_points(level)
    assert np.abs(projected - analysed).max() <= 1e-12
    nodes, weights = np.polynomial.legendre.leggauss(6)
    breaks = np.linspace(0, 1, 2**10 + 1)
    t = (breaks[:-1, None] + (nodes + 1) / 2**11).ravel()
    knots = np.r_[[0] * 3, np.linspace(0, 1, 2**level + 1), [1] * 3]
    dense = make_lsq_spline(t, value(t), knots, 3, w=np.sqrt(np.tile(weights, 2**10)))
    assert np.abs(projected - dense.c).max() <= 1e-10


def test_a_deep_curve_is_projected_in_linear_time():
    """Knots of level 30 in one place; the pyramid of level 16 leaves only that detail out."""
    t = np.array([0, 0.3, 0.3 + 1e-8, 1])
    value = WaveletBSpline.fit(
        SampledSplice(t, np.array([[0, 0], [1, 0], [1, 1e-3], [0, 1]])), tolerance=1e-4
    )
    assert value.level > 16
    pyramid = value.pyramid()
    assert pyramid.level == 16
    s = np.linspace(0, 1, 1001)
    coarse = WaveletBSpline(pyramid.control_points())
    assert np.abs(coarse(s) - value(s)).max() <= 1e-3
    away = np.abs(s - 0.3) > 0.01
    assert np.abs(coarse(s) - value(s))[away].max() <= 1e-12


@pytest.mark.parametrize("level", [0, 1, 2, 3, 5])
def test_adding_a_detail_adds_its_wavelet(level):
    """Every detail of a level, on a uniform curve: the exact column of Q, scaled to peak 1."""
    q = reference.floats(reference.wavelet_matrix(level + 1)) if level < 5 else None
    flat = WaveletBSpline(np.zeros((4, 1)))
    t = np.linspace(0, 1, 4001)
    for index in range(2**level):
        edit = check_edit(flat, flat.add_detail(level, index, [2.0]))
        assert np.abs(edit.value(t)).max() == pytest.approx(2.0, rel=1e-3)
        pyramid = edit.value.pyramid(level + 1)
        expected = np.zeros((2**level, 1))
        expected[index] = 2.0
        assert np.abs(pyramid.details[level] - expected).max() <= 1e-12
        assert np.abs(pyramid.base).max() <= 1e-12
        if q is not None:
            rows = pyramid.control_points()[:, 0]
            column = q[:, index]
            place = np.abs(column).argmax()
            assert np.abs(rows * column[place] - column * rows[place]).max() <= 1e-9 * np.abs(
                column[place]
            )


@given(st.integers(0, 8), st.data())
def test_setting_a_detail_changes_it_alone(level, data):
    """On a graded curve: the other details of every level stay, the one has its value."""
    value = graded(8)
    index = data.draw(st.integers(0, 2**level - 1))
    target = np.array([0.25, -0.5])
    edit = check_edit(value, value.set_detail(level, index, target))
    before, after = value.pyramid(), edit.value.pyramid()
    assert np.abs(after.base - before.base).max() <= 1e-12
    for k, (a, b) in enumerate(zip(before.details, after.details, strict=True)):
        changed = np.abs(a - b).max(axis=1)
        if k == level:
            assert np.abs(b[index] - target).max() <= 1e-12
            changed[index] = 0.0
        assert changed.max() <= 1e-12


def test_absent_details_and_levels_are_refused():
    """The messages say what there is."""
    value = graded()
    with pytest.raises(EditError, match="details 0 to 7, got 8"):
        value.add_detail(3, 8, [0, 0])
    with pytest.raises(EditError, match="levels 0 to 45"):
        value.add_detail(46, 0, [0, 0])
    with pytest.raises(EditError, match="20"):
        value.pyramid(21)
    with pytest.raises(ParameterError):
        value.refine(Interval(0.5, 1.5))
    with pytest.raises(EditError, match="'left' or 'right'"):
        value.derivative(0.5, 1, "up")
    with pytest.raises(EditError, match="order"):
        value.derivative(0.5, -1)


@given(st.integers(0, 10), st.integers(0, 100))
def test_changes_are_found_between_any_two_versions(seed, index):
    """From either side, edits in two places: everything that differs lies inside."""
    value = graded(seed)
    one = value.move_control_point(index % value.size, [1.0, 1.0]).value
    two = value.refine(Interval(0.1, 0.2)).value
    t = np.linspace(0, 1, 800)
    for a, b in ((value, one), (one, two), (two, value)):
        found = a.changes(b)
        assert found == b.changes(a)
        differs = (a(t) != b(t)).any(axis=1)
        assert all(found.contains(float(s)) for s in t[differs])
    assert value.changes(value) == SpliceList.EMPTY


@pytest.mark.parametrize("domain", [(0.0, 1.0), (-3.0, 4.0), (1 / 3, 1e6 / 7)])
def test_data_come_back_bit_by_bit(domain):
    """Through JSON and through pickle; the level is the finest that occurs."""
    value = graded(9, domain)
    data = json.loads(json.dumps(value.to_dict()))
    assert data["level"] == 9
    assert data["knots"][0] == domain[0]
    assert data["knots"][-1] == domain[1]
    for again in (WaveletBSpline.from_dict(data), pickle.loads(pickle.dumps(value))):
        assert np.asarray(again.knots).tobytes() == np.asarray(value.knots).tobytes()
        assert np.asarray(again.points).tobytes() == np.asarray(value.points).tobytes()
        assert again.level == value.level


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"level": "3"}, "integer"),
        ({"level": True}, "integer"),
        ({"level": 60}, "at most"),
        ({"level": 0}, "dyadic"),
        ({"knots": [0, 0, 0, 0, 0.3, 1, 1, 1, 1]}, "dyadic of level 1"),
        ({"knots": [0, 0, 0, 0, 0.5, 0.5, 1, 1, 1, 1], "points": [[0]] * 6}, "increase"),
        ({"knots": [0, 0, 0, 0.1, 0.5, 1, 1, 1, 1]}, "first four"),
        ({"knots": [0, 0, 0, 0, 0.5, 1, 1, 1]}, "need 9 knots"),
        ({"knots": [0, 0, 0, 0, float("nan"), 1, 1, 1, 1]}, "finite"),
        ({"points": [[0], [1], [2], [3], ["x"]]}, "numbers"),
        ({"points": [0, 1, 2, 3, 4]}, "rows"),
    ],
)
def test_data_that_describe_no_curve_are_refused(change, message):
    """Each fault has its own message."""
    good = {"level": 1, "knots": [0, 0, 0, 0, 0.5, 1, 1, 1, 1], "points": [[0], [1], [2], [3], [4]]}
    assert WaveletBSpline.from_dict(good).size == 5
    with pytest.raises(InvalidCurveError, match=message):
        WaveletBSpline.from_dict({**good, **change})
    for key in good:
        with pytest.raises(InvalidCurveError, match=key):
            WaveletBSpline.from_dict({k: v for k, v in good.items() if k != key})


def test_control_points_that_describe_no_curve_are_refused():
    """Wrong counts, shapes and numbers."""
    for bad, message in (
        (np.zeros((6, 2)), "4, 5, 7, 11"),
        (np.zeros(5), "shape"),
        (np.full((5, 2), np.inf), "finite"),
    ):
        with pytest.raises(InvalidCurveError, match=message):
            WaveletBSpline(bad)
    value = WaveletBSpline(np.zeros((5, 2)))
    with pytest.raises(AttributeError, match="immutable"):
        value.level = 3
    assert repr(value) == "WaveletBSpline(size=5, level=1, domain=[0, 1])"
