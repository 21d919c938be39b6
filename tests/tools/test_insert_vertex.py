"""`insert-vertex`: on the curve or beside it."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.errors import EditError, ParameterError
from multirep.representations import Polyline
from multirep.scene import Scene
from multirep.script.strict import structure
from multirep.testing.laws import check_edit
from multirep.tools import InsertVertex

ZIGZAG = Polyline([0, 1, 2, 4], [[0, 0], [1, 1], [2, 0], [4, 2]])


def test_it_inserts_on_the_curve_by_default() -> None:
    """The curve stays where it is; affected is the segment that is divided."""
    edit = check_edit(ZIGZAG, lambda value: InsertVertex(t=2.5).edit(value, Scene()))
    assert edit.value.points[3].tolist() == [2.5, 0.5]
    assert str(edit.splices) == "[2,4]"
    t = np.linspace(0, 4, 99)
    np.testing.assert_allclose(edit.value(t), ZIGZAG(t), atol=1e-15)


def test_it_inserts_where_it_is_told() -> None:
    """With `to` the curve goes there."""
    tool = structure({"t": 0.5, "to": [7, 7]}, InsertVertex)
    assert check_edit(ZIGZAG, tool.edit(ZIGZAG, Scene())).value(0.5).tolist() == [7, 7]


def test_places_that_make_no_sense_are_refused() -> None:
    """Outside T, on an existing vertex, with a point of another dimension or none."""
    with pytest.raises(ParameterError, match="outside the domain"):
        InsertVertex(t=5).edit(ZIGZAG, Scene())
    with pytest.raises(ValueError, match="'t' must be a finite number"):
        InsertVertex(t=float("nan"))
    with pytest.raises(EditError, match="already: vertex 2"):
        InsertVertex(t=2).edit(ZIGZAG, Scene())
    with pytest.raises(EditError, match="2 coordinates, got 1"):
        InsertVertex(t=2.5, to=[1]).edit(ZIGZAG, Scene())
    with pytest.raises(ValueError, match="'to' must be a list of finite numbers"):
        InsertVertex(t=2.5, to=["a"])
