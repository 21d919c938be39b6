"""`move-control-point`: the operation of the NURBS, as a tool."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.errors import EditError
from multirep.representations import Nurbs
from multirep.scene import Scene
from multirep.script.strict import Mismatch, structure
from multirep.testing.laws import check_edit
from multirep.tools import MoveControlPoint

WAVE = Nurbs(
    degree=2,
    knots=[0, 0, 0, 1, 2, 3, 4, 4, 4],
    points=[[0, 0], [1, 2], [2, -2], [3, 2], [4, -2], [5, 0]],
)


@pytest.mark.parametrize("index", range(6))
def test_it_moves_one_control_point(index: int) -> None:
    """The control point is there, the others are where they were; affected is the support."""
    edit = check_edit(WAVE, lambda value: MoveControlPoint(index, [9, 9]).edit(value, Scene()))
    expected = np.asarray(WAVE.points).copy()
    expected[index] = 9
    assert np.asarray(edit.value.points).tolist() == expected.tolist()
    assert str(edit.splices) == ["[0,1]", "[0,2]", "[0,3]", "[1,4]", "[2,4]", "[3,4]"][index]


def test_parameters_are_plain_and_checked() -> None:
    """Arrays become tuples; negative or fractional indices and points that are none are refused."""
    tool = MoveControlPoint(index=np.int64(1), to=np.array([1, 2]))  # type: ignore[arg-type]
    assert (tool.index, tool.to) == (1, (1.0, 2.0))
    assert tool == structure({"index": 1, "to": [1, 2]}, MoveControlPoint)
    with pytest.raises(ValueError, match="'index' must be >= 0"):
        MoveControlPoint(index=-1, to=[0, 0])
    with pytest.raises(TypeError, match="integer"):
        MoveControlPoint(index=1.5, to=[0, 0])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="'to' must be a list of finite numbers"):
        MoveControlPoint(index=0, to=[np.nan, 0])
    with pytest.raises(Mismatch, match="index"):
        structure({"to": [1, 2]}, MoveControlPoint)


def test_what_is_not_there_is_refused() -> None:
    """The message says how many there are, or how many coordinates they have."""
    with pytest.raises(EditError, match="no control point 6; there are 6"):
        MoveControlPoint(index=6, to=[0, 0]).edit(WAVE, Scene())
    with pytest.raises(EditError, match="2 coordinates"):
        MoveControlPoint(index=1, to=[0, 0, 0]).edit(WAVE, Scene())
