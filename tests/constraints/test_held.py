"""The contract of `held` and `released`, kind by kind: what is prepared stays, bit by bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.agreeing import apart
from multirep.interval import Interval
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.synchronization import hop

T = np.linspace(0, 1, 61)
POINTS = np.column_stack([5 * T, np.sin(9 * T)])


def polyline() -> Polyline:
    return Polyline(T, POINTS)


def nurbs(degree: int = 3) -> Nurbs:
    knots = np.r_[[0.0] * degree, np.linspace(0, 1, 21 - degree), [1.0] * degree]
    x = np.linspace(0, 5, 20)
    return Nurbs(degree=degree, knots=knots, points=np.column_stack([x, np.sin(2 * x)]))


def rational() -> Nurbs:
    plain = nurbs()
    weights = 2.0 ** np.sin(np.arange(plain.size))
    return Nurbs(degree=3, knots=plain.knots, points=plain.points, weights=weights)


def wavelet() -> WaveletBSpline:
    return WaveletBSpline.fit(SampledSplice(T, POINTS), tolerance=1e-2)


VALUES = {
    "polyline": polyline,
    "nurbs": nurbs,
    "quadratic": lambda: nurbs(2),
    "polygon": lambda: nurbs(1),
    "rational": rational,
    "wavelet": wavelet,
}
EVEN = st.integers(0, 32).map(lambda k: k / 32)
UNEVEN = st.floats(0, 1)


def bits(value: Any, stretch: Interval) -> bytes:
    t = np.linspace(stretch.start, stretch.stop, 101)
    return bytes(value(t).tobytes())


def bump(value: Any, a: float, b: float) -> SampledSplice:
    """A new course beside a stretch, which begins and ends where the curve stands."""
    t = np.linspace(a, b, 40)
    s = (t - a) / (b - a)
    points = value(t) + (s * (1 - s))[:, None] * [0.3, 0.5]
    return SampledSplice(t, points)


@pytest.mark.parametrize("kind", VALUES)
@given(data=st.data())
def test_a_held_stretch_survives_whatever_is_spliced_beside_it(
    kind: str, data: st.DataObject
) -> None:
    """Also where it may not be prepared, for it is kept already; the guard may be wider then."""
    value = VALUES[kind]()
    ends = data.draw(st.lists(st.one_of(EVEN, UNEVEN), min_size=2, max_size=2, unique=True))
    a, b = sorted(ends)
    if b - a < 1e-3:
        return
    interval = Interval(a, b)
    keep = SpliceList([interval]) if data.draw(st.booleans()) else SpliceList.EMPTY
    kept = bits(value, interval)
    edit, guard = value.held(interval, keep)
    assert guard.contains(interval)
    if keep:
        assert bits(edit.value, interval) == kept
        assert not edit.splices.intersects(keep)
    np.testing.assert_allclose(edit.value(T), value(T), atol=1e-13)
    again, same = edit.value.held(guard, SpliceList.EMPTY)
    assert same == guard
    assert not again.splices or kind == "wavelet"
    held, present = bits(edit.value, interval), edit.value
    for low, high in ((guard.stop, 1.0), (0.0, guard.start)):
        if high - low > 0.05:
            for _ in range(2):
                present = present.splice(bump(present, low, high), tolerance=1e-2).value
                assert bits(present, interval) == held


@pytest.mark.parametrize("kind", VALUES)
@given(data=st.data())
def test_what_was_added_can_be_taken_back(kind: str, data: st.DataObject) -> None:
    """As many controls as before, the same curve; not after the curve was bent there."""
    value = VALUES[kind]()
    a, b = sorted(data.draw(st.lists(UNEVEN, min_size=2, max_size=2, unique=True)))
    if not 0.01 < a < b - 0.01 < 0.98:
        return
    prepared, guard = value.held(Interval(a, 1.0))
    held, a = prepared.value, guard.start
    edit = held.released(a, held.size - value.size)
    assert edit.value.size == value.size
    np.testing.assert_allclose(edit.value(T), value(T), atol=1e-13)
    bent = held.splice(bump(held, a, 1.0), tolerance=1e-3).value
    kept = bent.released(a, held.size - value.size).value
    np.testing.assert_allclose(kept(T), bent(T), atol=1e-12)


def test_what_is_no_helper_is_not_taken_back() -> None:
    """A vertex off the line between its neighbours, a knot that carries a corner."""
    assert polyline().released(float(T[30]), 1).value.size == len(T)
    corner = nurbs().insert_knot(0.43, 3).value
    k = int(corner.knots.searchsorted(0.43)) - 1
    corner = corner.move_control_point(k, [1.0, 1.0]).value
    assert corner.released(0.43, 3).value.size == corner.size


@pytest.mark.parametrize("seed", range(6))
def test_at_a_border_all_representations_agree(seed: int) -> None:
    """More closely than elsewhere, so that whoever authors beside it can be followed."""
    rng = np.random.default_rng(seed)
    x = np.linspace(0, 6, 80)
    points = np.column_stack([x, np.sin(x * rng.uniform(0.5, 4))])
    curve = mr.MultiRepresentation.from_points(points, tolerance=10 ** rng.uniform(-3, -1))
    a = rng.uniform(0.05, 0.6)
    curve.freeze("ice", Interval(a, a + rng.uniform(0.05, 0.3)))
    ends = np.array(list(curve.frozen.hull))
    values = {kind: curve.view(kind) for kind in curve.kinds}
    assert apart(values, ends).max() <= 0.75 * hop(curve.tolerance)
