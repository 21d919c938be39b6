"""Knot operations on random knot vectors with multiplicities: what stays, what moves, where."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from nurbs_cases import curves, random_curve, smooth_curve
from scipy.interpolate import BSpline

from multirep.blocks import BLOCK_ROWS, BlockArray
from multirep.errors import EditError, ToleranceError
from multirep.representations import Nurbs
from multirep.splices import SpliceList
from multirep.testing.laws import check_edit

T = np.linspace(0, 1, 129)
EXACT = 1e-12


def multiplicity(curve: Nurbs, t: float) -> int:
    return int((np.asarray(curve.knots) == t).sum())


def apart(one: Nurbs, two: Nurbs) -> float:
    """Largest distance of two curves, over their size."""
    scale = max(one.magnitude, two.magnitude, 1e-300)
    return float(np.abs(one(T) - two(T)).max()) / scale


@given(curves(), st.integers(1, 255), st.integers(1, 3))
def test_insertion_leaves_the_curve(curve: Nurbs, place: int, times: int) -> None:
    """As many control points more, the same curve; touched are those that read the new knot."""
    t, p = place / 256, curve.degree
    have = multiplicity(curve, t)
    assume(have + times <= p)
    edit = check_edit(curve, lambda c: c.insert_knot(t, times))
    assert edit.value.size == curve.size + times
    assert multiplicity(edit.value, t) == have + times
    assert apart(curve, edit.value) <= EXACT
    knots = np.asarray(edit.value.knots)
    # Changed are the control points that read more copies than there were.
    first, last = np.flatnonzero(knots == t)[[0, -1]].tolist()
    low, high = float(knots[first + have - p]), float(knots[last - have + p])
    assert edit.splices == SpliceList([(max(low, 0.0), min(high, 1.0))])


@given(curves(rational=False), st.integers(1, 255))
def test_insertion_agrees_with_scipy(curve: Nurbs, place: int) -> None:
    """Control points of a clamped curve are those of Boehm's algorithm in scipy."""
    t, p = place / 256, curve.degree
    knots = np.asarray(curve.knots)
    assume(knots[0] == 0.0 and knots[-1] == 1.0 and multiplicity(curve, t) < p)
    expected = BSpline(knots, np.asarray(curve.points), p).insert_knot(t)
    found = curve.insert_knot(t).value
    assert (np.asarray(found.knots) == expected.t).all()
    assert np.abs(np.asarray(found.points) - expected.c[: found.size]).max() <= 1e-12


@given(curves(), st.lists(st.integers(1, 63), max_size=12))
def test_many_knots_at_once_are_the_same_as_one_by_one(curve: Nurbs, places: list[int]) -> None:
    """In any order, with repetitions, as far as multiplicities allow."""
    new: list[float] = []
    for place in places:
        t = place / 64
        if multiplicity(curve, t) + new.count(t) < curve.degree:
            new.append(t)
    edit = check_edit(curve, lambda c: c.insert_knots(new))
    one = curve
    for t in new:
        one = one.insert_knot(t).value
    assert (np.asarray(edit.value.knots) == np.asarray(one.knots)).all()
    scale = max(curve.magnitude, 1e-300)
    assert np.abs(np.asarray(edit.value.points) - np.asarray(one.points)).max() <= EXACT * scale
    assert apart(curve, edit.value) <= EXACT


@given(curves(), st.integers(1, 255))
def test_an_inserted_knot_can_be_removed(curve: Nurbs, place: int) -> None:
    """Removal proves that the curve moves by rounding only, and the control points come back."""
    t = place / 256
    assume(multiplicity(curve, t) < curve.degree)
    assume(curve.magnitude > 0)
    finer = curve.insert_knot(t).value
    tolerance = 1e-9 * curve.magnitude
    edit = check_edit(finer, lambda c: c.remove_knot(t, tolerance=tolerance))
    assert edit.bound <= tolerance
    assert (np.asarray(edit.value.knots) == np.asarray(curve.knots)).all()
    off = np.abs(np.asarray(edit.value.points) - np.asarray(curve.points)).max()
    assert off <= 1e-8 * curve.magnitude


@given(curves(), st.data())
def test_removal_proves_how_far_the_curve_moves(curve: Nurbs, data: st.DataObject) -> None:
    """Never farther than the bound; refused just below it, with the bound in the error."""
    inner = sorted({t for t in np.asarray(curve.knots).tolist() if 0 < t < 1})
    assume(inner)
    t = data.draw(st.sampled_from(inner))
    times = data.draw(st.integers(1, multiplicity(curve, t)))
    try:
        edit = check_edit(curve, lambda c: c.remove_knot(t, tolerance=1e9, times=times))
    except ToleranceError:
        with pytest.raises(ToleranceError, match="stay positive"):
            curve.remove_knot(t, tolerance=1e9, times=times)
        assert curve.is_rational
        return
    moved = np.linalg.norm(edit.value(T) - curve(T), axis=1).max()
    assert moved <= edit.bound
    assert edit.value.size == curve.size - times
    assert multiplicity(edit.value, t) == multiplicity(curve, t) - times
    if edit.bound > 1e-9:
        with pytest.raises(ToleranceError, match="no less than") as info:
            curve.remove_knot(t, tolerance=0.99 * edit.bound, times=times)
        assert info.value.reachable == edit.bound


def test_the_bound_of_a_removal_is_not_idle() -> None:
    """On smooth curves it is at most a few times what the curve really moves."""
    curve = smooth_curve(30)
    for i in range(8, 22):
        edit = curve.remove_knot(float(curve.knots[i]), tolerance=1.0)
        moved = np.linalg.norm(edit.value(T) - curve(T), axis=1).max()
        assert edit.bound <= 4 * moved


@given(curves(), st.data())
def test_moving_a_knot_touches_p_spans_on_each_side(curve: Nurbs, data: st.DataObject) -> None:
    """[u_(i-p), u_(i+p)] (Juhasz-Hoffmann section 2), the hull of both places counted."""
    p, n = curve.degree, curve.size
    assume(n > p + 1)
    knots = np.asarray(curve.knots)
    i = data.draw(st.integers(p + 1, n - 1))
    share = data.draw(st.sampled_from([0.25, 0.5, 0.75]))
    to = float((1 - share) * knots[i - 1] + share * knots[i + 1])
    assume(to != knots[i])
    assume(knots[i - 1] < to < knots[i + 1])
    edit = check_edit(curve, lambda c: c.move_knot(i, to))
    low, high = max(knots[i - p], 0.0), min(knots[i + p], 1.0)
    assert edit.splices == SpliceList([(low, high)])
    assert (np.asarray(edit.value.points) == np.asarray(curve.points)).all()
    moved = knots.copy()
    moved[i] = to
    assert (np.asarray(edit.value.knots) == moved).all()


def test_moved_knots_trace_their_envelope() -> None:
    """The point at the moved knot is on a curve of one degree less (Juhasz-Hoffmann theorem 2)."""
    curve = smooth_curve(12)
    knots, points = np.asarray(curve.knots), np.asarray(curve.points)
    i, p = 6, 3
    envelope = BSpline(np.delete(knots, i)[i - p : i + p], points[i - p : i], p - 1)
    for share in (0.1, 0.4, 0.9):
        to = float((1 - share) * knots[i - 1] + share * knots[i + 1])
        value = curve.move_knot(i, to).value
        assert np.abs(value(to) - envelope(to)).max() <= 1e-13


def test_a_knot_stays_between_its_neighbours() -> None:
    """Refused with the permissible region; a neighbour of full multiplicity is out of bounds."""
    curve = Nurbs(degree=2, knots=[0, 0, 0, 1, 2, 2, 3, 4, 4, 4], points=np.eye(7)[:, :2])
    with pytest.raises(EditError, match=r"knot 3 can move within \(0.0, 2.0\), not to 2.0"):
        curve.move_knot(3, 2.0)
    with pytest.raises(EditError, match=r"within \(0.0, 2.0\)"):
        curve.move_knot(3, 0.0)
    with pytest.raises(EditError, match=r"knot 4 can move within \[1.0, 2.0\]"):
        curve.move_knot(4, 2.5)
    assert curve.move_knot(4, 1.0).value.knots.tolist() == [0, 0, 0, 1, 1, 2, 3, 4, 4, 4]
    for outside in (2, 7):
        with pytest.raises(EditError, match="knots 3 to 6 can be moved"):
            curve.move_knot(outside, 0.5)
    with pytest.raises(EditError, match="there is no knot 10"):
        curve.move_knot(10, 0.5)
    assert not curve.move_knot(3, 1.0).splices


@settings(max_examples=30)
@given(curves(degrees=(1, 4)), st.integers(1, 3))
def test_elevation_leaves_the_curve(curve: Nurbs, times: int) -> None:
    """Each knot occurs once more for each degree: the same smoothness, the same curve."""
    edit = curve.elevate_degree(times)
    value = edit.value
    assert value.degree == curve.degree + times
    assert edit.splices == SpliceList([curve.domain])
    assert apart(curve, value) <= EXACT
    for t in np.unique(np.asarray(curve.knots)):
        if 0 < t < 1:
            assert multiplicity(value, t) == multiplicity(curve, t) + times
    Nurbs.from_dict(value.to_dict())


@given(curves(), st.sampled_from(["start", "stop"]), st.sampled_from([1.0, 2.0]))
def test_control_points_come_and_go_at_the_ends(curve: Nurbs, end: str, weight: float) -> None:
    """T stays; adding touches p spans of that end; removing brings back every bit."""
    p, n = curve.degree, curve.size
    knots = np.asarray(curve.knots)
    point = np.full(curve.dimension, 2.0)
    edit = check_edit(curve, lambda c: c.add_control_point(point, end=end, weight=weight))
    assert edit.value.domain == curve.domain
    assert edit.value.size == n + 1
    if end == "start":
        assert edit.splices == SpliceList([(0.0, min(knots[2 * p], 1.0))])
        assert (edit.value.points[0] == point).all()
    else:
        assert edit.splices == SpliceList([(max(knots[n - p], 0.0), 1.0)])
        assert (edit.value.points[n] == point).all()
    back = check_edit(edit.value, lambda c: c.remove_control_point(end=end))
    assert (np.asarray(back.value.knots) == knots).all()
    assert (np.asarray(back.value.points) == np.asarray(curve.points)).all()
    assert not curve.changes(back.value)


def test_ends_are_checked() -> None:
    """A wrong name, a wrong point, and the last p + 1 control points."""
    arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    with pytest.raises(EditError, match="'start' or 'stop', got 'left'"):
        arch.add_control_point([0, 0], end="left")
    with pytest.raises(EditError, match="2 coordinates"):
        arch.add_control_point([0, 0, 0])
    with pytest.raises(EditError, match="needs its last 3 control points"):
        arch.remove_control_point()
    longer = arch.add_control_point([3, 1]).value
    assert longer(1.0).tolist() == [3, 1]
    assert longer.knots.tolist() == [0, 0, 0, 0.5, 1, 1, 1]


def test_knots_are_checked() -> None:
    """Outside T, too often, not there, not a number of times."""
    arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 2, 2, 2], points=np.eye(5)[:, :2])
    for t in (0.0, 2.0, -1.0, np.nan):
        with pytest.raises(EditError, match="inside"):
            arch.insert_knot(t)
    with pytest.raises(EditError, match=r"1.0 is a knot 2 times already.*up to 2 times"):
        arch.insert_knot(1.0)
    with pytest.raises(EditError, match=r"is a knot 0 times already"):
        arch.insert_knot(0.5, times=3)
    with pytest.raises(EditError, match=r"is a knot 0 times already"):
        arch.insert_knot(0.5, times=10**15)
    with pytest.raises(EditError, match="whole number of 1 or more"):
        arch.insert_knot(0.5, times=0)
    with pytest.raises(EditError, match="it occurs 0 times"):
        arch.remove_knot(0.5, tolerance=1)
    with pytest.raises(EditError, match="it occurs 2 times"):
        arch.remove_knot(1.0, tolerance=1, times=3)
    with pytest.raises(EditError, match="0 or more"):
        arch.remove_knot(1.0, tolerance=-1)
    with pytest.raises(EditError, match="exceeds 25"):
        arch.elevate_degree(24)
    assert not arch.insert_knots([]).splices


@pytest.mark.parametrize("seed", range(40))
def test_operations_on_wild_curves(seed: int) -> None:
    """Degrees to 7, coordinates from 1e-9 to 1e12, any multiplicity: sound edits, same curve."""
    rng = np.random.default_rng(100 + seed)
    curve, _ = random_curve(rng)
    free = [t for t in rng.random(3).tolist() if multiplicity(curve, t) < curve.degree]
    finer = check_edit(curve, lambda c: c.insert_knots(free)).value
    assert apart(curve, finer) <= EXACT
    tolerance = 1e-6 * curve.magnitude
    for t in free:
        finer = check_edit(finer, finer.remove_knot(t, tolerance=tolerance)).value
    assert apart(curve, finer) <= 1e-8
    assert apart(curve, curve.elevate_degree().value) <= EXACT


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_many_knots_far_apart_are_inserted_in_windows(degree: int, rational: bool) -> None:
    """The same as one after the other, though only windows around them are looked at."""
    n = 3 * BLOCK_ROWS
    rng = np.random.default_rng(degree)
    curve = smooth_curve(n, degree)
    if rational:
        weights = rng.uniform(0.5, 2, n)
        curve = Nurbs(degree=degree, knots=curve.knots, points=curve.points, weights=weights)
    t = rng.random(12)
    new = np.concatenate([t, t[:2] + 1e-9, np.asarray(curve.knots)[[n // 2] * (degree - 1)]])
    together = curve.insert_knots(new)
    one_by_one, splices = curve, SpliceList.EMPTY
    for knot in np.sort(new).tolist():
        edit = one_by_one.insert_knot(knot)
        one_by_one, splices = edit.value, splices | edit.splices
    value = together.value
    np.testing.assert_array_equal(np.asarray(value.knots), np.asarray(one_by_one.knots))
    np.testing.assert_allclose(value.points, one_by_one.points, rtol=0, atol=1e-14)
    np.testing.assert_allclose(value.weights, one_by_one.weights, rtol=1e-14)
    assert splices.contains(together.splices)
    at = np.sort(rng.random(2000))
    np.testing.assert_allclose(value(at), curve(at), rtol=0, atol=1e-13)
    outside = np.array([s for s in at if not together.splices.contains(float(s))])
    assert len(outside) > 1900
    assert (value(outside) == curve(outside)).all()


def test_inserting_reads_windows_only(monkeypatch: pytest.MonkeyPatch) -> None:
    """One knot, or ten far apart, on a long curve: a few dozen control points each are read."""
    curve = smooth_curve(12 * BLOCK_ROWS)
    opened: list[int] = []
    window = BlockArray.window

    def watched(array: BlockArray, start: int, stop: int) -> np.ndarray:
        opened.append(stop - start)
        return window(array, start, stop)

    monkeypatch.setattr(BlockArray, "window", watched)
    curve.insert_knot(0.3)
    assert sum(opened) < 32
    opened.clear()
    curve.insert_knots(np.linspace(0.05, 0.95, 10))
    assert sum(opened) < 10 * 64


def test_the_size_is_measured_when_somebody_asks() -> None:
    """Blocks that two versions share are measured once, whichever is asked first."""
    curve = smooth_curve(4 * BLOCK_ROWS)
    moved = curve.move_control_point(5, [7.0, -9.0]).value
    assert moved.magnitude == 9.0
    assert curve.magnitude == np.abs(np.asarray(curve.points)).max()
    assert moved.insert_knot(0.5).value.magnitude == 9.0
