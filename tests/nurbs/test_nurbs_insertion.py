"""Knot insertion against other programs and a slow definition, and what it leaves alone."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from nurbs_cases import curves, random_curve, smooth_curve
from scipy.interpolate import BSpline

from multirep.arrays import Array
from multirep.blocks import BLOCK_ROWS
from multirep.errors import EditError
from multirep.representations import Nurbs
from multirep.representations.nurbs import boehm, insertion
from multirep.splices import SpliceList
from multirep.splines import compiled
from multirep.testing.laws import check_edit

new_knots = st.lists(st.integers(1, 127).map(lambda k: k / 128), min_size=1, max_size=12)


def allowed(curve: Nurbs, knots: list[float]) -> Array:
    """Those of some knots that a curve can take, in order."""
    have = np.asarray(curve.knots).tolist()
    taken: list[float] = []
    for t in knots:
        if have.count(t) + taken.count(t) < curve.degree:
            taken.append(t)
    return np.sort(np.array(taken))


def rows(curve: Nurbs) -> Array:
    """Homogeneous control points, (n, d + 1)."""
    weights = np.asarray(curve.weights)[:, None]
    return np.concatenate((np.asarray(curve.points) * weights, weights), axis=1)


def long_curve(rational: bool, blocks: int = 12) -> Nurbs:
    """A curve whose weights vary, or not."""
    curve = smooth_curve(blocks * BLOCK_ROWS)
    if not rational:
        return curve
    weights = 1 + 0.5 * np.sin(np.arange(curve.size))
    return Nurbs(degree=3, knots=curve.knots, points=curve.points, weights=weights)


def bits(curve: Nurbs) -> tuple[bytes, ...]:
    """Everything that is stored."""
    return tuple(
        np.asarray(array).tobytes() for array in (curve.knots, curve.points, curve.weights)
    )


# -- oracles ---------------------------------------------------------------------------------------


@given(curves(), new_knots)
def test_scipy_inserts_the_same_knots(curve: Nurbs, knots: list[float]) -> None:
    """One after the other, in homogeneous coordinates where there are weights."""
    new = allowed(curve, knots)
    before, p = np.asarray(curve.knots), curve.degree
    assume(len(new) > 0 and before[0] == 0.0 and before[-1] == 1.0)
    spline = BSpline(before, rows(curve), p)
    for t in new.tolist():
        spline = spline.insert_knot(t)
    value = curve.insert_knots(new).value
    assert (np.asarray(value.knots) == spline.t).all()
    scale = max(1.0, float(np.abs(spline.c).max()))
    assert np.abs(rows(value) - spline.c[: value.size]).max() <= 1e-12 * scale


@pytest.mark.parametrize("seed", range(8))
def test_splinepy_inserts_the_same_knots(seed: int) -> None:
    """Another program that knows rational curves, where it is installed."""
    splinepy = pytest.importorskip("splinepy")
    rng = np.random.default_rng(seed)
    p, n = int(rng.integers(2, 6)), 20
    knots = np.concatenate((np.zeros(p + 1), np.sort(rng.random(n - p - 1)), np.ones(p + 1)))
    points, weights = rng.normal(size=(n, 2)), rng.uniform(0.5, 2, n)
    new = np.sort(rng.random(9))
    peer = splinepy.NURBS([p], [knots], points, weights[:, None])
    peer.insert_knots(0, new.tolist())
    curve = Nurbs(degree=p, knots=knots, points=points, weights=weights)
    value = curve.insert_knots(new).value
    np.testing.assert_allclose(value.knots, np.asarray(peer.kvs[0]), rtol=0, atol=0)
    np.testing.assert_allclose(value.points, peer.cps, rtol=0, atol=1e-13)
    np.testing.assert_allclose(value.weights, np.ravel(peer.weights), rtol=1e-13)
    for t in new.tolist():
        curve = curve.insert_knot(t).value
    np.testing.assert_allclose(curve.points, peer.cps, rtol=0, atol=1e-13)
    np.testing.assert_allclose(curve.weights, np.ravel(peer.weights), rtol=1e-13)


@given(curves(), new_knots)
def test_old_control_points_keep_their_inner_knots(curve: Nurbs, knots: list[float]) -> None:
    """By definition: those whose p inner knots stay are the old ones bit by bit, all others new."""
    p, new = curve.degree, allowed(curve, knots)
    assume(len(new) > 0)
    u = np.asarray(curve.knots)
    weights = np.asarray(curve.weights)
    found = boehm.inserted(u, np.asarray(curve.points), weights, p, new)
    assert found is not None
    assert found.weights is not None
    assert (found.knots == np.sort(np.concatenate((u, new)))).all()
    old = {tuple(u[i + 1 : i + p + 1]): i for i in range(curve.size)}
    fresh = []
    for i in range(len(found.points)):
        source = old.get(tuple(found.knots[i + 1 : i + p + 1]))
        if source is None:
            fresh.append(i)
        else:
            assert found.points[i].tobytes() == np.asarray(curve.points[source]).tobytes()
            assert found.weights[i] == weights[source]
    inner = [found.knots[[i, i + p + 1]].clip(0.0, 1.0) for i in fresh]
    assert found.splices == SpliceList(inner)


# -- laws ------------------------------------------------------------------------------------------


@given(curves(rational=True), new_knots, st.data())
def test_equal_weights_stay_equal_to_the_last_bit(
    curve: Nurbs, knots: list[float], data: st.DataObject
) -> None:
    """Also where the same batch inserts knots among weights that differ."""
    new = allowed(curve, knots)
    assume(len(new) > 0)
    p, n = curve.degree, curve.size
    first = data.draw(st.integers(0, n - p - 1))
    last = data.draw(st.integers(first + p, n - 1))
    weights = np.asarray(curve.weights).copy()
    weights[first : last + 1] = 1 / 3
    points, u = np.asarray(curve.points), np.asarray(curve.knots)
    curve = Nurbs(degree=p, knots=u, points=points, weights=weights)
    plain = Nurbs(degree=p, knots=u, points=points).insert_knots(new).value
    value = curve.insert_knots(new).value
    # Rows that read no old knot but those of the pieces first + p .. last.
    inner = np.asarray(value.knots)
    low, high = u[first + p], u[last + 1]
    for i in range(value.size):
        if inner[i] >= low and inner[i + p + 1] <= high:
            assert value.weights[i] == 1 / 3
            assert value.points[i].tobytes() == plain.points[i].tobytes()


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("active", [True, False])
def test_windows_do_not_show(seed: int, active: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bits from one window around each new knot, around all, and from the whole curve."""
    if active and compiled.core is None:
        pytest.skip("the core was not built")
    monkeypatch.setattr(compiled, "active", active)
    rng = np.random.default_rng(seed)
    curve, _ = random_curve(rng)
    inner = np.asarray(curve.knots)
    new = np.concatenate((rng.random(6), inner[(inner > 0) & (inner < 1)][:2], [0.25, 0.25]))
    new = allowed(curve, new.tolist())
    found = []
    for short, bridged in ((0, 0), (0, 10**9), (10**9, 0)):
        monkeypatch.setattr(insertion, "SHORT", short)
        monkeypatch.setattr(insertion, "BRIDGED", bridged)
        edit = check_edit(curve, lambda c: c.insert_knots(new))
        found.append((bits(edit.value), edit.splices))
    assert found[0] == found[1] == found[2]


@pytest.mark.parametrize("rational", [False, True])
def test_blocks_far_from_new_knots_are_shared(rational: bool) -> None:
    """As objects; each new knot replaces a block or two of each array."""
    curve = long_curve(rational)
    for value, places in (
        (curve.insert_knot(0.3).value, 1),
        (curve.insert_knots([0.1, 0.5, 0.9]).value, 3),
    ):
        arrays = [(curve.knots, value.knots), (curve.points, value.points)]
        if rational:
            arrays.append((curve.weights, value.weights))
        for old, new in arrays:
            known = set(map(id, old.blocks))
            assert sum(id(block) not in known for block in new.blocks) <= 2 * places


@pytest.mark.skipif(compiled.core is None, reason="the core was not built")
@pytest.mark.parametrize("rational", [False, True])
def test_the_core_is_called_once_a_window(rational: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Once for one knot and for a hundred beside each other, thrice for three far apart."""
    curve = long_curve(rational)
    calls: list[str] = []

    class Watched:
        def __getattr__(self, name: str) -> object:
            calls.append(name)
            return getattr(compiled.core, name)

    watched = Watched()
    monkeypatch.setattr(boehm, "compiled", type("", (), {"active": True, "core": watched}))
    curve.insert_knot(0.3)
    assert calls == ["insert_knot"]
    for new, windows in ((np.linspace(0.3, 0.4, 100), 1), (np.array([0.1, 0.5, 0.9]), 3)):
        calls.clear()
        curve.insert_knots(new)
        assert calls == ["insert_knots"] * windows


@pytest.mark.skipif(compiled.core is None, reason="the core was not built")
@pytest.mark.parametrize("rational", [False, True])
def test_one_knot_takes_the_same_calls_in_a_curve_of_any_length(
    rational: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One search, and of each array one block is found (where there are several), and exchanged."""
    core, calls = compiled.core, []

    class Watched:
        def __getattr__(self, name: str) -> object:
            calls.append(name)
            return getattr(core, name)

    curves = [long_curve(rational, blocks) for blocks in (1, 12, 100)]
    monkeypatch.setattr(compiled, "active", True)
    monkeypatch.setattr(compiled, "core", Watched())
    arrays = 3 if rational else 2
    for curve in curves:
        calls.clear()
        curve.insert_knot(0.3137)
        several = len(curve.knots.blocks) > 1
        places = ["place"] * arrays * several
        assert calls == ["searched", *places, "insert_knot", *["with_block"] * arrays]


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("active", [True, False])
def test_one_knot_in_its_blocks_is_one_knot_in_a_window(
    rational: bool, active: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same bits and splices, at knots and between them, in the middle of blocks, at their
    borders and at both ends; a block or two of each array are copied.
    """
    if active and compiled.core is None:
        pytest.skip("the core was not built")
    monkeypatch.setattr(compiled, "active", active)
    curve = long_curve(rational, 3)
    knots = np.asarray(curve.knots)
    rows = np.arange(BLOCK_ROWS - 8, BLOCK_ROWS + 8)
    rows = np.concatenate((np.arange(3, 9), rows, [1500], rows + BLOCK_ROWS, curve.size - rows[:6]))
    rows = rows[knots[rows] < knots[rows + 1]]
    places = np.concatenate(((knots[rows] + knots[rows + 1]) / 2, knots[rows[knots[rows] > 0]]))
    found = []
    for in_blocks in (True, False):
        if not in_blocks:
            monkeypatch.setattr(insertion, "_inserted_in_blocks", lambda curve, t: None)
        found.append([curve.insert_knot(t) for t in places.tolist()])
    for one, two in zip(*found, strict=True):
        assert bits(one.value) == bits(two.value)
        assert one.splices == two.splices
    for edit in found[0]:
        pairs = [(curve.knots, edit.value.knots), (curve.points, edit.value.points)]
        for old, new in pairs + [(curve.weights, edit.value.weights)] * rational:
            known = set(map(id, old.blocks))
            assert sum(id(block) not in known for block in new.blocks) <= 2


@given(curves(), st.integers(1, 127).map(lambda k: k / 128))
def test_one_knot_is_what_scipy_inserts_and_the_same_curve(curve: Nurbs, t: float) -> None:
    """Against `BSpline.insert_knot`, to rounding; the same points everywhere."""
    before = np.asarray(curve.knots)
    assume(len(allowed(curve, [t])) > 0 and before[0] == 0.0 and before[-1] == 1.0)
    spline = BSpline(before, rows(curve), curve.degree).insert_knot(t)
    value = curve.insert_knot(t).value
    assert (np.asarray(value.knots) == spline.t).all()
    scale = max(1.0, float(np.abs(spline.c).max()))
    assert np.abs(rows(value) - spline.c[: value.size]).max() <= 1e-13 * scale
    at = np.linspace(0, 1, 65)
    assert np.abs(value(at) - curve(at)).max() <= 1e-12 * scale


@given(curves(), new_knots)
def test_knots_far_apart_do_not_meet(curve: Nurbs, knots: list[float]) -> None:
    """Distinct ones with p old knots between them: the same bits as one by one, in any order."""
    p = curve.degree
    old = np.asarray(curve.knots)
    new: list[float] = []
    for t in allowed(curve, knots).tolist():
        if not new or ((old > new[-1]) & (old < t)).sum() >= p:
            new.append(t)
    assume(new)
    one, splices = curve, SpliceList.EMPTY
    for t in reversed(new):
        edit = one.insert_knot(t)
        one, splices = edit.value, splices | edit.splices
    together = curve.insert_knots(new)
    assert bits(together.value) == bits(one)
    assert together.splices == splices


# -- refusals --------------------------------------------------------------------------------------


@pytest.mark.parametrize("active", [True, False])
def test_the_first_knot_that_is_too_many_is_named(
    active: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Among many, in one window or in several; nothing is inserted."""
    if active and compiled.core is None:
        pytest.skip("the core was not built")
    monkeypatch.setattr(compiled, "active", active)
    curve = long_curve(rational=False)
    double = curve.insert_knots([0.75] * 2 + [0.25] * 3).value
    for value, new, message in (
        (double, [0.1, 0.75, 0.25, 0.2], r"0.25 is a knot 3 times already.*up to 3 times"),
        (double, [0.75, 0.1, 0.75], r"0.75 is a knot 2 times already.*up to 3 times"),
        (curve, [0.5] * 4, r"0.5 is a knot 0 times already.*up to 3 times"),
    ):
        with pytest.raises(EditError, match=message):
            value.insert_knots(new)
    with pytest.raises(EditError, match=r"0.25 is a knot 3 times already"):
        double.insert_knot(0.25)
    with pytest.raises(EditError, match=r"inside \[0, 1\] only, not at nan"):
        curve.insert_knots([0.5, np.nan])
    with pytest.raises(EditError, match=r"inside \[0, 1\] only, not at -1.0"):
        curve.insert_knots([0.5, -1.0, 2.0])
