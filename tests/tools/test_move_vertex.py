"""`move-vertex`: the polyline's own operation, as a tool."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.errors import EditError
from multirep.representations import Polyline
from multirep.scene import Scene
from multirep.script.strict import Mismatch, structure
from multirep.testing.laws import check_edit
from multirep.tools import MoveVertex

ZIGZAG = Polyline([0, 1, 2, 4], [[0, 0], [1, 1], [2, 0], [4, 2]])


@pytest.mark.parametrize("index", range(4))
def test_it_moves_one_vertex(index: int) -> None:
    """The vertex is there, the others are where they were; affected are the two segments."""
    edit = check_edit(ZIGZAG, lambda value: MoveVertex(index=index, to=[9, 9]).edit(value, Scene()))
    expected = np.asarray(ZIGZAG).copy()
    expected[index] = 9
    assert np.asarray(edit.value).tolist() == expected.tolist()
    assert str(edit.splices) == ["[0,1]", "[0,2]", "[1,4]", "[2,4]"][index]


def test_parameters_are_plain_and_checked() -> None:
    """Arrays become tuples; negative or fractional indices and points that are none are refused."""
    tool = MoveVertex(index=np.int64(1), to=np.array([1, 2]))  # type: ignore[arg-type]
    assert (tool.index, tool.to) == (1, (1.0, 2.0))
    assert tool == structure({"index": 1, "to": [1, 2]}, MoveVertex)
    with pytest.raises(ValueError, match="'index' must be >= 0"):
        MoveVertex(index=-1, to=[0, 0])
    with pytest.raises(TypeError, match="integer"):
        MoveVertex(index=1.5, to=[0, 0])  # type: ignore[arg-type]
    for to in ("xy", [], [np.nan, 0], 3.0):
        with pytest.raises(ValueError, match="'to' must be a list of finite numbers"):
            MoveVertex(index=0, to=to)
    with pytest.raises(Mismatch, match="index"):
        structure({"to": [1, 2]}, MoveVertex)


def test_a_vertex_that_is_not_there_is_refused() -> None:
    """The message says which there are, or how many coordinates a vertex has."""
    with pytest.raises(EditError, match="vertices 0 to 3"):
        MoveVertex(index=4, to=[0, 0]).edit(ZIGZAG, Scene())
    with pytest.raises(EditError, match="2 coordinates, got 3"):
        MoveVertex(index=1, to=[0, 0, 0]).edit(ZIGZAG, Scene())
