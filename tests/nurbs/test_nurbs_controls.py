"""Moving control points and setting weights: where the curve changes, and by how much."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nurbs_cases import curves, smooth_curve

from multirep.blocks import BLOCK_ROWS
from multirep.errors import EditError
from multirep.representations import Nurbs
from multirep.splices import SpliceList
from multirep.testing.laws import check_edit, check_same


def support(curve: Nurbs, index: int) -> SpliceList:
    """[u_i, u_(i+p+1)] inside T."""
    knots = np.asarray(curve.knots)
    low, high = knots[index], knots[index + curve.degree + 1]
    start, stop = curve.domain
    return (
        SpliceList([(max(low, start), min(high, stop))])
        if high > start < stop > low
        else (SpliceList.EMPTY)
    )


@given(curves(), st.data())
def test_moving_a_control_point_touches_its_support(curve: Nurbs, data: st.DataObject) -> None:
    """Exactly [u_i, u_(i+p+1)]; each point moves by its rational basis value (NURBS book 11.1)."""
    i = data.draw(st.integers(0, curve.size - 1))
    shift = np.full(curve.dimension, 0.5)
    edit = check_edit(curve, lambda c: c.move_control_point(i, c.points[i] + shift))
    assert edit.splices == support(curve, i)
    unit = np.zeros((curve.size, 1))
    unit[i] = 1.0
    basis = Nurbs(degree=curve.degree, knots=curve.knots, points=unit, weights=curve.weights)
    t = np.linspace(0, 1, 65)
    assert np.abs(edit.value(t) - curve(t) - shift * basis(t)).max() <= 1e-12


@given(curves(), st.data())
def test_moving_several_touches_those_that_move(curve: Nurbs, data: st.DataObject) -> None:
    """Rows that are put where they were are not reported."""
    first = data.draw(st.integers(0, curve.size - 1))
    count = data.draw(st.integers(0, curve.size - first))
    moves = data.draw(st.lists(st.booleans(), min_size=count, max_size=count))
    rows = np.asarray(curve.points)[first : first + count].copy()
    rows[moves] += 1.0
    edit = check_edit(curve, lambda c: c.move_control_points(first, rows))
    expected = SpliceList.EMPTY
    for k, move in enumerate(moves):
        if move:
            expected = expected | support(curve, first + k)
    assert edit.splices == expected
    assert (np.asarray(edit.value.points)[first : first + count] == rows).all()


@given(curves(), st.data(), st.sampled_from([0.25, 1.0, 3.0]))
def test_setting_a_weight_touches_the_support(
    curve: Nurbs, data: st.DataObject, weight: float
) -> None:
    """Also where the curve was polynomial: elsewhere it stays so, bit by bit."""
    i = data.draw(st.integers(0, curve.size - 1))
    edit = check_edit(curve, lambda c: c.set_weight(i, weight))
    same = float(curve.weights[i]) == weight
    assert edit.splices == (SpliceList.EMPTY if same else support(curve, i))
    assert float(edit.value.weights[i]) == weight


@given(curves(rational=True), st.data())
def test_weights_move_points_on_lines(curve: Nurbs, data: st.DataObject) -> None:
    """Every point moves on the line through its old place and the control point (11.18-11.20)."""
    i = data.draw(st.integers(0, curve.size - 1))
    edit = curve.set_weight(i, 2 * float(curve.weights[i]))
    t = np.linspace(0, 1, 33)
    old, new, pole = curve(t), edit.value(t), curve.points[i]
    to_pole, moved = pole - old, new - old
    along = np.einsum("md,md->m", to_pole, moved)
    lengths = np.einsum("md,md->m", to_pole, to_pole)
    share = np.divide(along, lengths, out=np.zeros_like(along), where=lengths > 1e-20)
    assert np.abs(moved - share[:, None] * to_pole).max() <= 1e-11
    assert share.min() >= -1e-9
    assert share.max() <= 1


def test_weights_of_one_come_back_to_the_polynomial_curve() -> None:
    """A weight that is set and set back leaves the bits of the polynomial curve."""
    curve = smooth_curve(40)
    back = curve.set_weight(20, 2.0).value.set_weight(20, 1.0).value
    assert back.is_rational
    t = np.linspace(0, 1, 500)
    assert (back(t) == curve(t)).all()
    assert (back.derivative(t) == curve.derivative(t)).all()
    assert not curve.changes(back)
    check_same(Nurbs.from_dict(back.to_dict()), curve)


def test_long_curves_share_what_does_not_change() -> None:
    """An edit replaces one block of many; weights of a polynomial curve cost no array."""
    curve = smooth_curve(10 * BLOCK_ROWS)
    moved = curve.move_control_point(5 * BLOCK_ROWS, [0, 0]).value
    shared = {id(block) for block in curve.points.blocks}
    assert sum(id(block) in shared for block in moved.points.blocks) == len(shared) - 1
    heavy = curve.set_weight(5 * BLOCK_ROWS, 2.0).value
    assert len({id(block) for block in heavy.weights.blocks}) == 2
    assert moved.knots is curve.knots


@pytest.mark.parametrize(
    ("operation", "message"),
    [
        (lambda c: c.move_control_point(9, [0, 0]), "no control point 9; there are 9"),
        (lambda c: c.move_control_point(-1, [0, 0]), "no control point -1"),
        (lambda c: c.move_control_point(0, [0, 0, 0]), "2 coordinates"),
        (lambda c: c.move_control_point(0, [0, np.nan]), "NaN or infinity"),
        (lambda c: c.move_control_points(7, np.zeros((3, 2))), "no control point 9"),
        (lambda c: c.set_weight(9, 1.0), "no control point 9"),
        (lambda c: c.set_weight(0, 0.0), "positive and finite, got 0.0"),
        (lambda c: c.set_weight(0, -1.0), "positive and finite"),
        (lambda c: c.set_weight(0, np.inf), "positive and finite"),
    ],
)
def test_nonsense_is_refused(operation: object, message: str) -> None:
    """With the number that is wrong and what there is."""
    with pytest.raises(EditError, match=message):
        operation(smooth_curve(9))  # type: ignore[operator]
