"""Point, derivative and corner constraints: one least-norm solve, local, exact, even crowded."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from wavy_nurbs import wavy

import multirep as mr
from multirep.aim import Aim
from multirep.constraints import (
    CornerConstraint,
    DerivativeConstraint,
    LinearConstraint,
    PointConstraint,
)
from multirep.edit import Edit
from multirep.errors import ConflictError, EditError, FrozenError, ParameterError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.testing import check_edit

EVERYWHERE = SpliceList([(0.0, 1.0)])


def enforced(
    curve: Nurbs, *constraints: LinearConstraint, scene: Scene | None = None
) -> Edit[Nurbs]:
    """Meet all of them in one call, and check the law of edits."""
    group = {f"c{k}": constraint for k, constraint in enumerate(constraints)}
    return check_edit(
        curve,
        lambda value: LinearConstraint.enforce_together(
            group, value, EVERYWHERE, Scene() if scene is None else scene
        ),
    )


def above(point: np.ndarray, shift: list[float]) -> tuple[float, ...]:
    return tuple((point + np.array(shift)).tolist())


def residuals(curve: Nurbs, *constraints: LinearConstraint) -> float:
    return max(constraint.residual(curve) for constraint in constraints)


# -- one ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("t", [0.0, 1e-6, 0.3, 0.5, 0.999999, 1.0])
def test_a_point_is_met_to_rounding(degree: int, rational: bool, t: float) -> None:
    """Of polynomial and rational curves of any degree, anywhere."""
    curve = wavy(degree=degree, rational=rational)
    target = above(curve(t), [0.1, 0.3])
    constraint = PointConstraint(t=t, point=target)
    value = enforced(curve, constraint).value
    assert constraint.residual(value) <= 1e-14 * value.magnitude
    np.testing.assert_allclose(value(t), target, atol=1e-13)


def test_the_change_is_the_shortest() -> None:
    """As the pseudo-inverse gives it, all four control points free."""
    curve = wavy()
    t, shift = 0.5, np.array([0.04, -0.08])
    value = enforced(curve, PointConstraint(t=t, point=tuple(curve(t) + shift))).value
    moves = np.asarray(value.points) - np.asarray(curve.points)
    unit = np.eye(curve.size)
    basis = np.array(
        [Nurbs(degree=3, knots=curve.knots, points=unit[:, [i]])(t)[0] for i in range(curve.size)]
    )
    np.testing.assert_allclose(moves, np.linalg.pinv(basis[None]) @ shift[None], atol=1e-12)
    assert np.count_nonzero(np.abs(moves).max(axis=1)) == 4


def test_the_ends_of_the_curve_stay_while_they_can() -> None:
    """A point near the end moves without it; the end itself moves when it is what is asked for."""
    curve = wavy()
    t = 0.5 * float(curve.knots[4])
    near = enforced(curve, PointConstraint(t=t, point=above(curve(t), [0, 1]))).value
    assert (near(0.0) == curve(0.0)).all()
    end = enforced(curve, PointConstraint(t=0.0, point=(-1.0, 0.0))).value
    assert end(0.0).tolist() == [-1.0, 0.0]


@given(
    st.integers(1, 63).map(lambda k: k / 64),
    st.tuples(st.integers(-8, 8), st.integers(-8, 8)),
    st.tuples(st.integers(-8, 8), st.integers(-8, 8)),
    st.booleans(),
)
def test_one_sided_derivatives_are_met_and_break_the_curve_only_where_they_differ(
    t: float, left: tuple[int, int], right: tuple[int, int], rational: bool
) -> None:
    """Measured by differences of the curve itself on both sides."""
    curve = wavy(rational=rational)
    constraint = DerivativeConstraint(t=t, left=left, right=right)
    value = enforced(curve, constraint).value
    np.testing.assert_allclose(value.derivative(t, side="left"), left, atol=1e-9)
    np.testing.assert_allclose(value.derivative(t, side="right"), right, atol=1e-9)
    h = 1e-9
    np.testing.assert_allclose((value(t) - value(t - h)) / h, left, atol=1e-2)
    np.testing.assert_allclose((value(t + h) - value(t)) / h, right, atol=1e-2)
    breaks = value.sample(value.domain, tolerance=1e-2).breaks
    assert (t in breaks) == (left != right)


def test_a_one_sided_derivative_leaves_the_other_side_alone() -> None:
    """Bit by bit, beyond the knots that are expressed anew."""
    curve = wavy()
    corner = curve.insert_knot(0.5, 3).value
    constraint = DerivativeConstraint(t=0.5, left=(1.0, 2.0))
    edit = enforced(corner, constraint)
    t = np.linspace(0.5, 1, 101)[1:]
    assert (edit.value(t) == corner(t)).all()
    assert edit.splices.hull.stop == 0.5


def test_a_corner_has_its_base_point_and_both_tangents() -> None:
    """And is a break for whoever samples the curve."""
    curve = wavy()
    ear = CornerConstraint(t=0.4, point=(2.0, 2.0), left=(1.0, 9.0), right=(1.0, -9.0))
    value = enforced(curve, ear).value
    np.testing.assert_allclose(value(0.4), [2, 2], rtol=1e-15)
    np.testing.assert_allclose(value.derivative(0.4, side="left"), [1, 9], atol=1e-11)
    np.testing.assert_allclose(value.derivative(0.4, side="right"), [1, -9], atol=1e-11)
    assert value.sample(value.domain, tolerance=1e-3).breaks == (0.4,)
    again = ear.enforce(value, EVERYWHERE, Scene())
    assert again.value.size == value.size


def test_a_corner_may_leave_its_tangents_free() -> None:
    """The knot is there; the curve is as smooth as it was."""
    curve = wavy()
    point = tuple(curve(0.4).tolist())
    value = enforced(curve, CornerConstraint(t=0.4, point=point)).value
    t = np.linspace(0, 1, 101)
    np.testing.assert_allclose(value(t), curve(t), atol=1e-14)


@pytest.mark.parametrize(
    ("constraint", "error", "message"),
    [
        (PointConstraint(t=2.0, point=(0, 0)), ParameterError, "outside the domain"),
        (PointConstraint(t=0.5, point=(0, 0, 0)), EditError, "3 coordinates"),
        (DerivativeConstraint(t=0.0, left=(0, 0)), EditError, "no curve to the left"),
        (DerivativeConstraint(t=1.0, right=(0, 0)), EditError, "no curve to the right"),
        (CornerConstraint(t=1.0, point=(0, 0), right=(1, 0)), EditError, "to the right"),
    ],
)
def test_what_makes_no_sense_on_a_curve_is_refused(
    constraint: LinearConstraint, error: type[Exception], message: str
) -> None:
    """When it is added, with the curve as it was."""
    framework = mr.Framework()
    framework.add("c", mr.MultiRepresentation(wavy(), tolerance=1e-3, kinds=[Nurbs]))
    with pytest.raises(error, match=message):
        framework.constrain("c", constraint)
    assert not framework.constraints("c")


# -- many -----------------------------------------------------------------------------------------


@st.composite
def groups(draw: st.DrawFn) -> list[LinearConstraint]:
    """Points and derivatives at distinct parameters k/64."""
    places = draw(st.lists(st.integers(0, 64), min_size=1, max_size=12, unique=True))
    numbers = st.tuples(st.integers(-8, 8), st.integers(-8, 8))
    found: list[LinearConstraint] = []
    for k in places:
        if draw(st.booleans()):
            found.append(PointConstraint(t=k / 64, point=draw(numbers)))
        if not 0 < k < 64 or not draw(st.booleans()):
            continue
        slope = draw(numbers)
        right = draw(st.one_of(st.just(slope), numbers))
        found.append(DerivativeConstraint(t=k / 64, left=slope, right=right))
    return found or [PointConstraint(t=0.5, point=(0, 0))]


@given(groups(), st.integers(4, 24), st.booleans())
def test_a_group_is_met_in_one_solve(group: list[LinearConstraint], n: int, rational: bool) -> None:
    """Whatever the number of control points; knots are added where they are too few."""
    curve = wavy(n, rational=rational)
    value = enforced(curve, *group).value
    assert residuals(value, *group) <= 1e-12 * max(value.magnitude, 1)


def test_many_conditions_are_solved_in_banded_form() -> None:
    """Two hundred points on a long curve: met, and like the dense pseudo-inverse."""
    curve = wavy(400)
    t = (np.arange(200) + 0.5) / 200
    targets = curve(t) + 0.01 * np.sin(40 * t)[:, None]
    group = [PointConstraint(t=a, point=b) for a, b in zip(t, targets, strict=True)]
    value = enforced(curve, *group).value
    np.testing.assert_allclose(value(t), targets, atol=1e-12)


def test_only_what_is_broken_moves() -> None:
    """Of a long chain of overlapping claims, one broken point changes its neighbourhood alone."""
    curve = wavy(400)
    t = (np.arange(200) + 0.5) / 200
    points = curve(t)
    points[100] += [0.0, 0.01]
    group = [PointConstraint(t=a, point=b) for a, b in zip(t, points, strict=True)]
    edit = enforced(curve, *group)
    np.testing.assert_allclose(edit.value(t), points, atol=1e-13)
    assert edit.splices.hull.length < 0.03


def test_what_holds_in_the_group_keeps_holding() -> None:
    """The neighbour of a moved point stays where it is claimed."""
    curve = wavy()
    near = PointConstraint(t=0.47, point=tuple(curve(0.47).tolist()))
    moved = PointConstraint(t=0.5, point=above(curve(0.5), [0, 0.2]))
    value = enforced(curve, near, moved).value
    assert residuals(value, near, moved) <= 1e-13


def test_repeated_conditions_count_once() -> None:
    """Two constraints that say the same are no conflict."""
    same = PointConstraint(t=0.5, point=(1.0, 1.0))
    value = enforced(wavy(), same, same, CornerConstraint(t=0.5, point=(1.0, 1.0))).value
    assert same.residual(value) <= 1e-14


def test_an_aim_is_kept_beside_a_constraint() -> None:
    """What the tool asked for is a row of the solve."""
    curve = wavy()
    place = 0.47
    scene = Scene(aims=(Aim(place, tuple(curve(place).tolist())),))
    constraint = PointConstraint(t=0.5, point=above(curve(0.5), [0, 0.2]))
    value = enforced(curve, constraint, scene=scene).value
    np.testing.assert_allclose(value(place), curve(place), atol=1e-13)


# -- beside ice -----------------------------------------------------------------------------------


@pytest.mark.parametrize("t", [0.5001, 0.51, 0.55, 0.65, 0.99])
def test_the_curve_leaves_a_frozen_stretch_smoothly(t: float) -> None:
    """The solve is over what is free; two derivatives at the border stay what they were."""
    edge = 0.5
    curve = wavy().held(mr.Interval(0.2, edge))[0].value
    scene = Scene(frozen=SpliceList([(0.2, edge)]))
    constraint = PointConstraint(t=t, point=above(curve(t), [0, 0.01]))
    edit = enforced(curve, constraint, scene=scene)
    assert constraint.residual(edit.value) <= 1e-13
    s = np.linspace(0.2, edge, 301)
    assert (edit.value(s) == curve(s)).all()
    if t >= 0.51:
        for order in (1, 2):
            jump = edit.value.derivative(edge, order, "right") - curve.derivative(
                edge, order, "left"
            )
            size = np.abs(curve.derivative(edge, order, "left")).max()
            assert np.abs(jump).max() <= 1e-8 * max(size, 1)


def test_a_point_inside_the_ice_cannot_be_moved() -> None:
    """It says so with its name."""
    curve = wavy().held(mr.Interval(0.2, 0.5))[0].value
    scene = Scene(frozen=SpliceList([(0.2, 0.5)]))
    with pytest.raises(FrozenError, match=r"'c0' cannot hold at t = 0.3") as caught:
        enforced(curve, PointConstraint(t=0.3, point=(0.0, 9.0)), scene=scene)
    assert caught.value.constraints == ("c0",)
    holds = PointConstraint(t=0.3, point=tuple(curve(0.3).tolist()))
    assert not enforced(curve, holds, scene=scene).splices


# -- through all representations -------------------------------------------------------------------


def size(value: Any) -> float:
    return float(np.ptp(value(np.linspace(0, 1, 200)), axis=0).max())


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("offset", [0.0, 1e3])
def test_constraints_hold_through_edits_in_every_representation(
    scale: float, offset: float
) -> None:
    """1e-9 of the size where they live, epsilon elsewhere; far from the origin and at any scale."""
    x = np.linspace(0, 6, 120)
    points = scale * (np.column_stack([x, np.sin(x)]) + offset)
    epsilon = 1e-3 * scale
    curve = mr.MultiRepresentation.from_points(points, tolerance=epsilon)
    framework = mr.Framework()
    framework.add("c", curve)
    pin = PointConstraint(t=0.3, point=above(curve.view(Nurbs)(0.3), [0, 0.1 * scale]))
    ear = CornerConstraint(
        t=0.6,
        point=above(curve.view(Nurbs)(0.6), [0, 0.2 * scale]),
        left=(3 * scale, 5 * scale),
        right=(3 * scale, -5 * scale),
    )
    framework.constrain("c", pin, name="pin")
    framework.constrain("c", ear, name="ear")
    from multirep.tools import DirectManipulation, MoveVertex

    rng = np.random.default_rng(1)
    for _ in range(6):
        polyline = curve.view(Polyline)
        k = int(polyline.t.searchsorted(0.3 + rng.uniform(-0.03, 0.03)))
        place = polyline.points[k] + 0.05 * scale * rng.normal(size=2)
        outcome = framework.apply("c", MoveVertex(index=k, to=place))
        t = 0.6 + float(rng.uniform(0.02, 0.1))
        place = curve.view(Nurbs)(t) + 0.05 * scale * rng.normal(size=2)
        framework.apply("c", DirectManipulation(t=t, to=place))
        np.testing.assert_allclose(curve.view(Nurbs)(t), place, atol=1e-9 * 6 * scale)
        assert outcome.rounds <= 2
        nurbs = curve.view(Nurbs)
        assert residuals(nurbs, pin, ear) <= 1e-9 * size(nurbs)
        slope = nurbs.derivative(0.6, side="left")
        assert np.linalg.norm(slope - np.array(ear.left)) <= 1e-9 * size(nurbs) * (1 + offset)
        for kind in (Polyline, WaveletBSpline):
            value = curve.view(kind)
            for constraint in (pin, ear):
                assert np.linalg.norm(value(constraint.t) - constraint.point) <= epsilon
    for kind in (Polyline, WaveletBSpline):
        assert curve.deviation(Nurbs, kind).upper <= epsilon


def test_a_corner_travels_as_a_break() -> None:
    """The polyline has a vertex there, and the tangents on both sides to the tolerance."""
    curve = mr.MultiRepresentation(wavy(), tolerance=1e-3)
    framework = mr.Framework()
    framework.add("c", curve)
    ear = CornerConstraint(t=0.4, point=(2.0, 2.0), left=(1.0, 9.0), right=(1.0, -9.0))
    framework.constrain("c", ear)
    polyline = curve.view(Polyline)
    assert 0.4 in polyline.t.tolist()
    assert 0.4 in polyline.sample(polyline.domain, tolerance=1e-4).breaks
    left, right = (polyline.derivative(0.4, side=side) for side in ("left", "right"))
    assert left[1] > 5
    assert right[1] < -5
    assert curve.deviation(Nurbs, WaveletBSpline).upper <= 1e-3


def test_a_crowded_group_names_those_that_exclude_each_other() -> None:
    """Not the ones beside them."""
    crowd = [PointConstraint(t=0.5 + 1e-10 * k, point=(k, k)) for k in range(2)]
    beside = PointConstraint(t=0.55, point=(2.0, 0.0))
    with pytest.raises(ConflictError) as caught:
        enforced(wavy(), beside, *crowd)
    assert set(caught.value.constraints) == {"c1", "c2"}
