"""`direct-manipulation`: it hits its target, with the smallest change, where it may."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.errors import EditError, ParameterError
from multirep.representations import Nurbs
from multirep.scene import Scene
from multirep.script.strict import structure
from multirep.testing.laws import check_edit
from multirep.testing.spline_strategies import dyadic_splines
from multirep.tools import DirectManipulation


@st.composite
def curves(draw: st.DrawFn) -> Nurbs:
    spline = draw(dyadic_splines(rational=None))
    return Nurbs(
        degree=spline.degree,
        knots=spline.knots,
        points=spline.points,
        weights=spline.weights if spline.rational else None,
    )


places = st.integers(0, 64).map(lambda k: k / 64)


def pulled(curve: Nurbs, t: float, **how: object) -> Nurbs | None:
    """The curve with its point at t pulled by (1, 1, ..); None when nothing is left to move."""
    to = curve(t) + 1.0
    tool = DirectManipulation(t=t, to=to, **how)  # type: ignore[arg-type]
    try:
        edit = check_edit(curve, lambda value: tool.edit(value, Scene()))
    except EditError:
        with pytest.raises(EditError, match="nothing is left to move"):
            tool.edit(curve, Scene())
        return None
    assert np.abs(edit.value(t) - to).max() <= 1e-9
    return edit.value


@given(curves(), places, st.booleans(), st.integers(1, 6))
def test_it_hits_the_target(curve: Nurbs, t: float, hold_ends: bool, count: int) -> None:
    """With 1 to p + 1 control points; held ends do not move; the edit is exact."""
    number = min(count, curve.degree + 1)
    value = pulled(curve, t, hold_ends=hold_ends, control_points=number)
    if value is None:
        assert hold_ends
        return
    moved = (np.asarray(value.points) != np.asarray(curve.points)).any(axis=1)
    assert moved.sum() <= number
    if hold_ends:
        assert not moved[[0, -1]].any()


@given(curves(), places, st.integers(0, 10**6))
def test_no_smaller_change_does_it(curve: Nurbs, t: float, seed: int) -> None:
    """Any other change of the same control points that hits the target has a larger norm."""
    value = pulled(curve, t, hold_ends=False)
    assert value is not None
    change = np.asarray(value.points) - np.asarray(curve.points)
    moved = change.any(axis=1, keepdims=True)
    other = change + np.random.default_rng(seed).normal(size=change.shape) * moved
    unit = Nurbs(
        degree=curve.degree,
        knots=curve.knots,
        points=np.eye(curve.size),
        weights=curve.weights,
    )
    basis = unit(t)
    way = value(t) - curve(t)
    other += basis[:, None] * (way - basis @ other) / (basis @ basis)
    assert np.abs(basis @ other - way).max() <= 1e-9
    assert np.linalg.norm(other) >= np.linalg.norm(change) - 1e-9


@given(curves(), places)
def test_it_takes_the_control_points_with_most_influence(curve: Nurbs, t: float) -> None:
    """With one control point, it is the one whose basis function is largest there."""
    value = pulled(curve, t, hold_ends=False, control_points=1)
    assert value is not None
    moved = np.flatnonzero((np.asarray(value.points) != np.asarray(curve.points)).any(axis=1))
    unit = Nurbs(
        degree=curve.degree, knots=curve.knots, points=np.eye(curve.size), weights=curve.weights
    )
    assert len(moved) == 1
    assert unit(t)[moved[0]] >= unit(t).max() - 1e-12


def test_equations_of_the_paper() -> None:
    """Bezier cubic at 1/2: weights B_i / sum B_j^2 over all (e 4), or the inner two (e 6)."""
    line = Nurbs(degree=3, knots=[0] * 4 + [1] * 4, points=[[0, 0], [1, 0], [2, 0], [3, 0]])
    basis = np.array([1, 3, 3, 1]) / 8
    free = pulled(line, 0.5, hold_ends=False)
    held = pulled(line, 0.5)
    assert free is not None
    assert held is not None
    moved = np.asarray(free.points) - np.asarray(line.points)
    assert moved == pytest.approx(np.outer(basis / (basis @ basis), [1, 1]))
    moved = np.asarray(held.points) - np.asarray(line.points)
    assert moved == pytest.approx(np.outer([0, 4 / 3, 4 / 3, 0], [1, 1]))


def test_the_place_may_be_a_point() -> None:
    """`at` means the nearest place; both or none of t and at are refused."""
    arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    edit = DirectManipulation(at=[1, 3], to=[1, 2]).edit(arch, Scene())
    assert edit.value(0.5) == pytest.approx([1, 2], abs=1e-6)
    with pytest.raises(EditError, match="got both"):
        DirectManipulation(t=0.5, at=[1, 3], to=[1, 2]).edit(arch, Scene())
    with pytest.raises(EditError, match="got neither"):
        DirectManipulation(to=[1, 2]).edit(arch, Scene())
    with pytest.raises(ParameterError, match="outside the domain"):
        DirectManipulation(t=1.5, to=[1, 2]).edit(arch, Scene())


@pytest.mark.parametrize("t", [0.0, 1.0, 1e-9])
def test_held_ends_cannot_be_pulled(t: float) -> None:
    """At and all but at an end nothing is left to move, unless the ends are let go."""
    arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    with pytest.raises(EditError, match=r"nothing is left to move.*hold_ends = false"):
        DirectManipulation(t=t, to=[5, 5]).edit(arch, Scene())
    edit = DirectManipulation(t=t, to=[5, 5], hold_ends=False).edit(arch, Scene())
    assert edit.value(t) == pytest.approx([5, 5])


def test_parameters_are_plain_and_checked() -> None:
    """All by name in scripts; counts beyond the degree and wrong dimensions are refused."""
    tool = DirectManipulation(t=0.5, to=[1, 2])
    assert tool == structure({"t": 0.5, "to": [1, 2]}, DirectManipulation)
    with pytest.raises(ValueError, match="'control_points' must be >= 1"):
        DirectManipulation(t=0.5, to=[1, 2], control_points=0)
    with pytest.raises(ValueError, match="'t' must be a finite number"):
        DirectManipulation(t=np.inf, to=[1, 2])
    with pytest.raises(TypeError, match="hold_ends"):
        DirectManipulation(t=0.5, to=[1, 2], hold_ends=1)  # type: ignore[arg-type]
    arch = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[0, 0], [1, 1], [2, 0]])
    with pytest.raises(EditError, match="at most 3 control points"):
        DirectManipulation(t=0.5, to=[1, 2], control_points=4).edit(arch, Scene())
    with pytest.raises(EditError, match="has 2 coordinates"):
        DirectManipulation(t=0.5, to=[1, 2, 3]).edit(arch, Scene())


def test_a_drag_ends_where_it_was_let_go() -> None:
    """A hundred small pulls or one large one: the same curve to rounding."""
    arch = Nurbs(degree=3, knots=[0] * 4 + [0.3, 0.6] + [1] * 4, points=np.eye(6)[:, :2] * 3)
    once = DirectManipulation(t=0.4, to=[2, 2]).edit(arch, Scene()).value
    many = arch
    for step in np.linspace(0, 1, 101)[1:]:
        way = arch(0.4) + step * (np.array([2, 2]) - arch(0.4))
        many = DirectManipulation(t=0.4, to=way).edit(many, Scene()).value
    t = np.linspace(0, 1, 99)
    assert np.abs(many(t) - once(t)).max() <= 1e-13
