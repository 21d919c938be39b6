"""Frozen stretches: every bit, in every representation, through any edit, undo and release."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep.agreeing import NEAR
from multirep.constraints import Freeze, Mark
from multirep.edit import Edit
from multirep.errors import FrozenError, MultirepError
from multirep.interval import Interval
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.splices import SpliceList
from multirep.testing import check_certificate
from multirep.tools import (
    DeleteVertex,
    DirectManipulation,
    MoveControlPoint,
    MoveVertex,
    Spatula,
    Sweep,
)

KINDS: tuple[Any, ...] = (Polyline, Nurbs, WaveletBSpline)


def wave(n: int = 80, epsilon: float = 1e-3) -> mr.MultiRepresentation:
    x = np.linspace(0, 6, n)
    return mr.MultiRepresentation.from_points(np.column_stack([x, np.sin(x)]), tolerance=epsilon)


def shifted(point: np.ndarray, *by: float) -> np.ndarray:
    return point + np.array(by)


def session(curve: mr.MultiRepresentation | None = None) -> mr.Session:
    made = mr.Session()
    made.add("c", curve or wave())
    return made


def bits(curve: mr.MultiRepresentation, a: float, b: float) -> list[bytes]:
    """Everything that can be asked of a stretch: points, also at its ends, and derivatives."""
    t = np.r_[np.linspace(a, b, 257), np.nextafter(a, b), np.nextafter(b, a)]
    inside = t[(t > a) & (t < b)]
    found = []
    for kind in KINDS:
        value = curve.view(kind)
        found += [value(t).tobytes(), value.derivative(inside).tobytes()]
        found += [value(float(s)).tobytes() for s in (a, b, 0.5 * (a + b))]
    return found


def stored(curve: mr.MultiRepresentation, a: float, b: float) -> list[bytes]:
    """The stored numbers on which the interior of the stretch depends."""
    polyline, nurbs, wavelet = (curve.view(kind) for kind in KINDS)
    i, j = polyline.t.searchsorted(a, "right") - 1, polyline.t.searchsorted(b) + 1
    found = [polyline.t[i:j].tobytes(), polyline.points[i:j].tobytes()]
    for value, p in ((nurbs, nurbs.degree), (wavelet, 3)):
        i = int(np.asarray(value.knots).searchsorted(a, "right")) - 1
        j = int(np.asarray(value.knots).searchsorted(b))
        found += [value.knots[i - p + 1 : j + p].tobytes(), value.points[i - p : j].tobytes()]
    return found


def random_edits(rng: np.random.Generator, curve: mr.MultiRepresentation) -> Iterator[Any]:
    """One tool after another, anywhere on the curve."""
    while True:
        t = float(rng.uniform(0.02, 0.98))
        place = curve.view(Nurbs)(t) + 0.1 * rng.normal(size=2)
        yield DirectManipulation(t=t, to=place)
        polyline = curve.view(Polyline)
        k = int(rng.integers(1, polyline.size - 1))
        gap = min(polyline.t[k] - polyline.t[k - 1], polyline.t[k + 1] - polyline.t[k])
        shift = min(0.1, 20 * float(gap)) * rng.normal(size=2)
        yield MoveVertex(index=k, to=polyline.points[k] + shift)
        level = int(rng.integers(2, 7))
        t = float(rng.uniform(0.02, 0.98))
        place = curve.view(WaveletBSpline)(t) + 0.1 * rng.normal(size=2)
        yield Sweep(t=t, to=place, level=level)
        nurbs = curve.view(Nurbs)
        k = int(rng.integers(nurbs.size))
        width = float(nurbs.knots[k + nurbs.degree + 1] - nurbs.knots[k])
        shift = min(0.1, 20 * width) * rng.normal(size=2)
        yield MoveControlPoint(index=k, to=nurbs.points[k] + shift)
        centre = curve.view(Polyline)(float(rng.uniform(0, 1)))
        yield Spatula(radius=0.2, path=[shifted(centre, 0, 0.3), centre + 0.1 * rng.normal(size=2)])


@settings(max_examples=10)
@given(
    st.integers(0, 1000),
    st.floats(0.05, 0.8),
    st.floats(0.01, 0.3),
    st.sampled_from([1e-2, 1e-3]),
)
def test_not_a_bit_changes_through_any_edits(
    seed: int, start: float, length: float, epsilon: float
) -> None:
    """Nor by undo and redo; what is refused changes nothing; the rest stays within epsilon."""
    made = session(wave(epsilon=epsilon))
    curve, stop = made.curve("c"), min(start + length, 1.0)
    made.constrain("c", Freeze(interval=(start, stop)), name="ice")
    before = bits(curve, start, stop) + stored(curve, start, stop)
    done = 0
    rng = np.random.default_rng(seed)
    for _, tool in zip(range(15), random_edits(rng, curve), strict=False):
        refused: MultirepError | None = None
        try:
            made.apply("c", tool)
            done += 1
        except MultirepError as error:
            refused = error
        if isinstance(refused, FrozenError):
            assert refused.constraints == refused.release == ("ice",)
        assert bits(curve, start, stop) + stored(curve, start, stop) == before
    assert done >= 3
    assert curve.deviation(Polyline, Nurbs).upper <= epsilon
    assert curve.deviation(Nurbs, WaveletBSpline).upper <= epsilon
    made.undo(min(3, done))
    assert bits(curve, start, stop) == before[: len(bits(curve, start, stop))]
    made.redo(min(3, done))
    assert bits(curve, start, stop) + stored(curve, start, stop) == before


ENDS = st.lists(st.floats(0, 1), min_size=2, max_size=2, unique=True).map(sorted)


@settings(max_examples=25)
@given(st.lists(ENDS, min_size=1, max_size=3), st.randoms(use_true_random=False))
def test_freezes_and_their_release_leave_no_trace(
    stretches: list[list[float]], random: Any
) -> None:
    """Any number, overlapping or not, released in any order: not a bit is different."""
    curve = wave()
    values = {kind: curve.view(kind) for kind in KINDS}
    for name, (a, b) in enumerate(stretches):
        curve.freeze(str(name), Interval(a, b))
    for name in random.sample(range(len(stretches)), len(stretches)):
        curve.thaw(str(name))
    for kind, value in values.items():
        assert curve.view(kind) is value
    assert not curve.frozen
    assert not curve.claims


def test_what_was_made_for_a_wider_tolerance_does_not_come_back() -> None:
    """Tightened while a stretch is frozen: helpers are removed, values from before stay away."""
    x = np.linspace(0, 6, 80)
    straight_at_first = np.column_stack([x, np.maximum(x - 4, 0) ** 2])
    curve = mr.MultiRepresentation.from_points(straight_at_first, tolerance=1e-2)
    before = [curve.view(kind) for kind in KINDS]
    curve.freeze("ice", Interval(0.05, 0.13))
    curve.tolerance = 5e-3
    curve.thaw("ice")
    check_certificate(curve)
    after = [curve.view(kind) for kind in KINDS]
    assert not any(one is other for one, other in zip(before, after, strict=True))
    assert after[0].size == before[0].size


@pytest.mark.parametrize("tool", [0, 1, 2])
def test_helper_controls_are_taken_back_after_edits_elsewhere(tool: int) -> None:
    """Helper vertices and knots are gone; the curve is what it was there, up to rounding."""
    made = session()
    made.constrain("c", Freeze(interval=(0.11, 0.27)), name="ice")
    curve = made.curve("c")
    t = np.linspace(*curve.frozen.hull, 100)
    before = {kind: curve.view(kind)(t) for kind in KINDS}
    value, polyline = curve.view(KINDS[tool]), curve.view(Polyline)
    edit: Any = (
        MoveVertex(index=60, to=shifted(polyline.points[60], 0, 0.1)),
        DirectManipulation(t=0.75, to=shifted(value(0.75), 0.0, 0.1)),
        Sweep(t=0.75, to=shifted(value(0.75), 0.0, 0.1), level=5),
    )[tool]
    made.apply("c", edit)
    sizes = {kind: curve.view(kind).size for kind in KINDS}
    made.release("c", "ice")
    for kind, freed in ((Polyline, 2), (Nurbs, 6), (WaveletBSpline, 6)):
        assert curve.view(kind).size == sizes[kind] - freed
        np.testing.assert_allclose(curve.view(kind)(t), before[kind], rtol=0, atol=1e-13)


def test_what_stays_frozen_beside_a_released_freeze_is_free_when_frozen_anew() -> None:
    """Bits keep more than was asked for, and the error says so; anew it is a sliver."""
    made = session()
    made.constrain("c", Freeze(interval=(0.0, 1.0)), name="all")
    made.constrain("c", Freeze(interval=(0.3, 0.4)), name="ears")
    curve, ears = made.curve("c"), SpliceList([(0.3, 0.4)])
    kept = bits(curve, 0.3, 0.4)
    made.release("c", "all")
    assert bits(curve, 0.3, 0.4) == kept
    assert (curve.frozen - ears).length > 0.1
    t = float(curve.frozen.hull.stop) - 0.01
    move = DirectManipulation(t=t, to=shifted(curve.view(Nurbs)(t), 0.0, 0.05))
    with pytest.raises(FrozenError, match=r"'ears' keeps frozen, more than was asked for.*anew"):
        made.apply("c", move)
    made.release("c", "ears")
    made.constrain("c", Freeze(interval=(0.3, 0.4)), name="ears")
    assert (curve.frozen - ears).length < 5e-3
    made.apply("c", move)


WIDE = ENDS.filter(lambda ends: ends[1] - ends[0] >= 0.02)


@settings(max_examples=25)
@given(WIDE, WIDE, st.booleans())
def test_a_release_keeps_the_least_that_keeps_the_bits(
    other: list[float], asked: list[float], first: bool
) -> None:
    """What stays is what freezing anew would keep, if no other freeze stood in the way at first.

    Else a border may lie where a representation cannot stop; then it is where the last of them can.
    """
    curve = wave()
    wanted, outer = SpliceList([tuple(asked)]), SpliceList([tuple(other)])
    if first:
        curve.freeze("asked", wanted)
    curve.freeze("other", outer)
    clear = first or not any(curve.frozen.contains(end) for end in asked if 0 < end < 1)
    if not first:
        curve.freeze("asked", wanted)
    before = bits(curve, *asked) + stored(curve, *asked)
    curve.thaw("other")
    assert bits(curve, *asked) + stored(curve, *asked) == before
    kept = curve.frozen
    least = Interval(*asked)
    for kind in KINDS:
        guard = curve.view(kind).held(Interval(*asked), wanted)[1]
        assert (SpliceList([guard]) - kept).length <= 1e-9  # but for what guards the border
        least = least.hull(guard)
    # all kinds stop in one place, at which they also agree: that moves a border a little
    assert (kept - SpliceList([least])).length <= 2 * (NEAR + 2.0**-8)
    if clear:
        assert (kept - wanted).length <= 2 * NEAR
        curve.thaw("asked")
        curve.freeze("asked", wanted)
        assert list(kept.hull) == pytest.approx(list(curve.frozen.hull), abs=NEAR)


def test_freezes_that_overlap_outlive_each_other() -> None:
    """A border in the middle of another freeze was never prepared: bits stay all the same."""
    curve = wave()
    curve.freeze("a", Interval(0.2, 0.5))
    curve.freeze("b", Interval(0.41, 0.6))
    before = bits(curve, 0.41, 0.6)
    curve.thaw("a")
    assert curve.frozen.contains(Interval(0.41, 0.6))
    rng = np.random.default_rng(5)
    framework = mr.Framework()
    framework.add("c", curve)
    moved = 0
    for _, tool in zip(range(25), random_edits(rng, curve), strict=False):
        try:
            framework.apply("c", tool)
            moved += 1
        except MultirepError:
            pass
        assert bits(curve, 0.41, 0.6) == before
    assert moved > 5
    curve.thaw("b")
    assert not curve.frozen


def test_a_freeze_inside_another_changes_nothing() -> None:
    """It only gets a say of its own."""
    curve = wave()
    curve.freeze("a", Interval(0.2, 0.6))
    values, frozen = [curve.view(kind) for kind in KINDS], curve.frozen
    curve.freeze("b", Interval(0.3, 0.4))
    assert [curve.view(kind) for kind in KINDS] == values
    assert curve.frozen == frozen


def test_the_border_of_the_ice_is_close_to_what_was_asked_for() -> None:
    """A sliver, where knots are dyadic: some thousandths at most."""
    curve = wave()
    for k, (a, b) in enumerate([(0.1, 0.2), (1 / 3, 0.5), (0.7, 1.0)]):
        curve.freeze(f"f{k}", Interval(a, b))
    extra = curve.frozen - SpliceList([(0.1, 0.2), (1 / 3, 0.5), (0.7, 1.0)])
    assert extra.length < 5e-3
    assert curve.frozen.contains(SpliceList([(0.1, 0.2), (1 / 3, 0.5), (0.7, 1.0)]))


def test_the_whole_curve_can_be_frozen() -> None:
    """Then nothing goes."""
    made = session()
    made.constrain("c", Freeze(interval=(0.0, 1.0)), name="all")
    with pytest.raises(FrozenError):
        made.apply("c", DirectManipulation(t=0.5, to=(0.0, 0.0)))


def test_an_edit_across_the_border_keeps_what_it_asks_for_and_leaves_no_kink() -> None:
    """Direct manipulation beside the ice is solved on what is free: the point is hit, C2 holds."""
    for t in (0.52, 0.55, 0.6):
        made = session()
        made.constrain("c", Freeze(interval=(0.3, 0.5)))
        curve = made.curve("c")
        edge = curve.frozen.hull.stop
        before = [curve.view(Nurbs).derivative(edge, order, "left") for order in (1, 2)]
        target = shifted(curve.view(Nurbs)(t), 0.0, 0.05)
        outcome = made.apply("c", DirectManipulation(t=t, to=target))
        nurbs = curve.view(Nurbs)
        np.testing.assert_allclose(nurbs(t), target, atol=1e-12)
        assert not outcome.faded
        for order, slope in zip((1, 2), before, strict=True):
            found = nurbs.derivative(edge, order, "right")
            np.testing.assert_allclose(found, slope, atol=1e-6 * (1 + np.abs(slope).max()))


def test_an_edit_that_cannot_be_solved_is_faded_without_a_jump() -> None:
    """A spatula pushed across the border: continuous, and tangent to the old curve there."""
    made = session()
    made.constrain("c", Freeze(interval=(0.3, 0.5)))
    curve = made.curve("c")
    edge = curve.frozen.hull.stop
    place, slope = curve.view(Polyline)(edge), curve.view(Polyline).derivative(edge, side="left")
    path = [shifted(place, 0, 0.8), shifted(place, 0.1, 0.2)]
    outcome = made.apply("c", Spatula(radius=0.5, path=path))
    assert outcome.faded
    assert outcome.changed.hull.start >= edge
    polyline = curve.view(Polyline)
    assert (polyline(edge) == place).all()
    after = polyline.derivative(edge, side="right")
    cosine = after @ slope / np.linalg.norm(after) / np.linalg.norm(slope)
    assert cosine > 0.99
    t = np.linspace(0.5, 0.6, 50)
    assert np.abs(polyline(t) - wave().view(Polyline)(t)).max() > 0.05


# -- marks -----------------------------------------------------------------------------------------


def test_marks_leave_what_is_between_them_free() -> None:
    """Everything else is frozen, on both sides."""
    made = session()
    made.constrain("c", Mark(interval=(0.3, 0.5)), name="marks")
    curve = made.curve("c")
    before = bits(curve, 0.0, 0.3) + bits(curve, 0.5, 1.0)
    made.apply("c", DirectManipulation(t=0.4, to=(2.4, 1.5)))
    with pytest.raises(FrozenError):
        made.apply("c", DirectManipulation(t=0.2, to=(2.4, 1.5)))
    with pytest.raises(FrozenError):
        made.apply("c", DirectManipulation(t=0.7, to=(2.4, 1.5)))
    assert bits(curve, 0.0, 0.3) + bits(curve, 0.5, 1.0) == before
    np.testing.assert_allclose(curve.view(Nurbs)(0.4), [2.4, 1.5], atol=1e-12)


def test_marks_are_created_moved_and_removed() -> None:
    """By the tool, each a step that can be undone."""
    from multirep.tools import Mark as MarkTool

    made = session()
    made.apply("c", MarkTool(left=0.3))
    made.apply("c", MarkTool(right=0.6))
    made.apply("c", MarkTool(left=0.4))
    assert made.framework.constraints("c") == {"mark": Mark(interval=(0.4, 0.6))}
    made.apply("c", DirectManipulation(t=0.5, to=(3.0, 1.0)))
    made.undo(2)
    assert made.framework.constraints("c") == {"mark": Mark(interval=(0.3, 0.6))}
    made.redo(2)
    made.apply("c", MarkTool(remove=True))
    assert not made.curve("c").frozen
    with pytest.raises(MultirepError, match="no marks named 'mark'"):
        made.apply("c", MarkTool(remove=True))


def test_a_constraint_of_another_kind_is_not_taken_for_marks() -> None:
    """Its name is refused as a label."""
    from multirep.tools import Mark as MarkTool

    made = session()
    made.constrain("c", Freeze(interval=(0.1, 0.2)), name="ice")
    with pytest.raises(MultirepError, match="another kind"):
        made.apply("c", MarkTool(left=0.3, label="ice"))


def test_a_vertex_on_the_border_belongs_to_the_ice() -> None:
    """It is neither moved nor deleted, though half of what that would change is free."""
    made = session()
    made.constrain("c", Freeze(interval=(0.3, 0.5)), name="ice")
    curve = made.curve("c")
    k = int(curve.view(Polyline).t.searchsorted(curve.frozen.hull.stop))
    for tool in (MoveVertex(index=k, to=(0.0, 0.0)), DeleteVertex(index=k)):
        with pytest.raises(FrozenError):
            made.apply("c", tool)
    made.apply("c", MoveVertex(index=k + 1, to=(3.0, 0.5)))


def test_an_edit_by_hand_is_refused_as_well() -> None:
    """The kernel guards the ice, not the framework."""
    curve = wave()
    curve.freeze("ice", Interval(0.3, 0.5))
    polyline = curve.view(Polyline)
    k = int(polyline.t.searchsorted(0.4))
    edit: Edit[Any] = polyline.move_vertex(k, [0, 0])
    before = curve.snapshot()
    with pytest.raises(FrozenError, match="'ice' keeps frozen"):
        curve.commit(Polyline, edit)
    assert curve.snapshot() is before
