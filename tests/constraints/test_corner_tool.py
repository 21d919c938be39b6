"""The corner tool: made, turned, moved, removed; the other representations follow it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from wavy_nurbs import wavy

import multirep as mr
from multirep.constraints import CornerConstraint, Freeze, PointConstraint
from multirep.errors import ConflictError, EditRejectedError, FrozenError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.scene import Scene
from multirep.testing import check_edit
from multirep.tools import Corner

VECTORS = st.tuples(st.integers(-8, 8), st.integers(-8, 8))


def edited(curve: Nurbs, corner: Corner) -> Nurbs:
    return check_edit(curve, lambda value: corner.edit(value, Scene())).value


def multiplicity(curve: Nurbs, t: float) -> int:
    return int((np.asarray(curve.knots) == t).sum())


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_making_a_corner_changes_no_shape(degree: int) -> None:
    """The knot has full multiplicity, the curve is what it was up to rounding."""
    curve = wavy(degree=degree)
    made = edited(curve, Corner(t=0.4))
    assert multiplicity(made, 0.4) == degree
    t = np.linspace(0, 1, 301)
    np.testing.assert_allclose(made(t), curve(t), atol=1e-13)
    assert edited(made, Corner(t=0.4)).size == made.size


@given(
    st.integers(1, 63).map(lambda k: k / 64),
    VECTORS,
    VECTORS,
    VECTORS,
    st.sampled_from([1, 2, 3, 4]),
    st.booleans(),
)
def test_the_tangents_are_what_is_asked_for(
    t: float,
    left: tuple[int, int],
    right: tuple[int, int],
    to: tuple[int, int],
    degree: int,
    rational: bool,
) -> None:
    """On both sides, of polynomial and rational curves; the base point stays or goes."""
    curve = wavy(degree=degree, rational=rational)
    turned = edited(curve, Corner(t=t, left=left, right=right))
    np.testing.assert_allclose(turned(t), curve(t), atol=1e-13)
    np.testing.assert_allclose(turned.derivative(t, side="left"), left, atol=1e-9)
    np.testing.assert_allclose(turned.derivative(t, side="right"), right, atol=1e-9)
    moved = edited(turned, Corner(t=t, to=to))
    np.testing.assert_allclose(moved(t), to, atol=1e-13)
    np.testing.assert_allclose(moved.derivative(t, side="left"), left, atol=1e-8)
    np.testing.assert_allclose(moved.derivative(t, side="right"), right, atol=1e-8)


def test_turning_one_tangent_leaves_the_other_side_alone() -> None:
    """Bit by bit."""
    corner = edited(wavy(), Corner(t=0.5, left=(1, 9), right=(1, -9)))
    turned = edited(corner, Corner(t=0.5, left=(9, 1)))
    t = np.linspace(0.5, 1, 101)
    assert (turned(t) == corner(t)).all()


def test_a_place_near_a_corner_means_the_corner() -> None:
    """As a click on its base point would; a parameter is taken at its word."""
    corner = edited(wavy(), Corner(t=0.5, left=(1, 9), right=(1, -9)))
    near = corner(0.503)
    assert Corner(at=tuple(near)).place(corner) == 0.5
    assert Corner(t=0.503).place(corner) == 0.503
    assert Corner(t=0.5 + 1e-12).place(corner) == 0.5
    assert Corner(at=tuple(corner(0.7))).place(corner) == pytest.approx(0.7, abs=1e-9)


@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("degree", [2, 3, 4])
def test_a_removed_corner_is_smooth_again(degree: int, rational: bool) -> None:
    """Within an apron of T/32; elsewhere nothing moves beyond rounding."""
    curve = wavy(degree=degree, rational=rational)
    corner = edited(curve, Corner(t=0.5, left=(4, 9), right=(4, -9)))
    smooth = edited(corner, Corner(t=0.5, remove=True))
    assert multiplicity(smooth, 0.5) < degree
    assert smooth.sample(smooth.domain, tolerance=1e-3).breaks == ()
    left, right = (smooth.derivative(0.5, side=side) for side in ("left", "right"))
    np.testing.assert_allclose(left, right, atol=1e-9)
    outside = np.r_[np.linspace(0, 0.5 - 1 / 32, 200), np.linspace(0.5 + 1 / 32, 1, 200)]
    np.testing.assert_allclose(smooth(outside), corner(outside), atol=1e-13)
    inside = np.linspace(0.5 - 1 / 32, 0.5 + 1 / 32, 200)
    assert 0.01 < np.linalg.norm(smooth(inside) - corner(inside), axis=1).max() < 0.2
    # no overshoot: what is rounded stays within the box of the two sides
    low, high = corner(inside).min(axis=0), corner(inside).max(axis=0)
    assert (smooth(inside) >= low - 2e-3).all()
    assert (smooth(inside) <= high + 2e-3).all()


def test_the_apron_keeps_off_other_corners_and_the_ends() -> None:
    """Half way to the next corner, and not beyond the curve."""
    curve = edited(edited(wavy(), Corner(t=0.5, left=(4, 9))), Corner(t=0.52, left=(9, 4)))
    smooth = edited(curve, Corner(t=0.5, remove=True))
    assert smooth.sample(smooth.domain, tolerance=1e-3).breaks == (0.52,)
    t = np.linspace(0.51, 1, 200)
    np.testing.assert_allclose(smooth(t), curve(t), atol=1e-13)
    near = edited(wavy(), Corner(t=0.01, left=(4, 9)))
    smooth = edited(near, Corner(t=0.01, remove=True))
    assert smooth.sample(near.domain, tolerance=1e-3).breaks == ()


def session() -> mr.Session:
    made = mr.Session()
    made.add("c", mr.MultiRepresentation(wavy(30), tolerance=1e-3))
    return made


def test_the_other_representations_follow_a_corner() -> None:
    """Within the tolerance; the polyline has the vertex; removed, it is smooth for all."""
    made = session()
    curve = made.curve("c")
    made.apply("c", Corner(t=0.5, left=(4.0, 9.0), right=(4.0, -9.0)))
    assert curve.deviation(Nurbs, Polyline).upper <= 1e-3
    assert curve.deviation(Nurbs, WaveletBSpline).upper <= 1e-3
    assert 0.5 in curve.view(Polyline).t.tolist()
    made.apply("c", Corner(t=0.5, remove=True))
    assert curve.deviation(Nurbs, Polyline).upper <= 1e-3
    assert curve.view(Polyline).sample(curve.domain, tolerance=1e-3).breaks == ()
    made.undo()
    assert 0.5 in curve.view(Nurbs).sample(curve.domain, tolerance=1e-3).breaks


def test_a_corner_drawn_in_a_polyline_is_one_in_the_nurbs() -> None:
    """It arrives as a break; the corner tool takes it by its place."""
    points = [[0, 0], [1, 0.01], [2, 0], [2.5, 1], [3, 2]]
    curve = mr.MultiRepresentation.from_points(points, tolerance=1e-3)
    made = mr.Session()
    made.add("c", curve)
    made.apply("c", Corner(at=(2.0, 0.0), to=(2.0, -0.5)))
    nurbs = curve.view(Nurbs)
    breaks = nurbs.sample(nurbs.domain, tolerance=1e-4).breaks
    t = float(curve.view(Polyline).nearest([2.0, -0.5]).t)
    assert any(abs(t - place) < 1e-6 for place in breaks)
    np.testing.assert_allclose(nurbs(t), [2.0, -0.5], atol=1e-3)


def test_a_corner_keeps_to_constraints() -> None:
    """One beside it is kept; one against it rejects the tool."""
    made = session()
    curve = made.curve("c")
    pin = PointConstraint(t=0.52, point=tuple(curve.view(Nurbs)(0.52).tolist()))
    made.constrain("c", pin, name="pin")
    made.apply("c", Corner(t=0.5, left=(4.0, 9.0), right=(4.0, -9.0)))
    nurbs = curve.view(Nurbs)
    assert pin.residual(nurbs) <= 1e-12
    np.testing.assert_allclose(nurbs.derivative(0.5, side="right"), [4, -9], atol=1e-6)
    ear = CornerConstraint(t=0.7, point=tuple(nurbs(0.7).tolist()), left=(1.0, 2.0))
    made.constrain("c", ear, name="ear")
    with pytest.raises(ConflictError) as caught:
        made.apply("c", Corner(t=0.7, to=(0.0, 0.0)))
    assert "ear" in caught.value.constraints


def test_a_constrained_corner_is_not_removed() -> None:
    """The constraint puts it back: the tool says so instead of doing nothing."""
    made = session()
    nurbs = made.curve("c").view(Nurbs)
    ear = CornerConstraint(t=0.5, point=tuple(nurbs(0.5).tolist()), left=(4, 9), right=(4, -9))
    made.constrain("c", ear, name="ear")
    with pytest.raises(ConflictError, match="'ear'") as caught:
        made.apply("c", Corner(t=0.5, remove=True))
    assert caught.value.release == ("ear",)


def test_a_corner_in_the_ice_is_refused_and_one_beside_it_is_made() -> None:
    """Bits stay; the tangent is exact."""
    made = session()
    made.constrain("c", Freeze(interval=(0.3, 0.5)), name="ice")
    with pytest.raises(FrozenError):
        made.apply("c", Corner(t=0.4, left=(1.0, 1.0)))
    curve = made.curve("c")
    t = np.linspace(0.3, 0.5, 101)
    before = curve.view(Nurbs)(t)
    outcome = made.apply("c", Corner(t=0.55, left=(4.0, 9.0)))
    assert not outcome.faded
    assert (curve.view(Nurbs)(t) == before).all()
    np.testing.assert_allclose(curve.view(Nurbs).derivative(0.55, side="left"), [4, 9], atol=1e-9)


def test_refusals_say_why() -> None:
    """With the numbers."""
    made = session()
    for corner, message in (
        (Corner(t=0.5, remove=True), "there is no corner at t = 0.5"),
        (Corner(t=0.0), "t = 0.0 is an end of the curve"),
        (Corner(t=0.5, left=(1.0,)), "expected 2 coordinates"),
        (Corner(), "got neither"),
    ):
        with pytest.raises(EditRejectedError, match=message):
            made.apply("c", corner)
