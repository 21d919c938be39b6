"""`delete-vertex`: any but the ends."""

from __future__ import annotations

import pytest

from multirep.errors import EditError
from multirep.representations import Polyline
from multirep.scene import Scene
from multirep.testing.laws import check_edit
from multirep.tools import DeleteVertex, InsertVertex

ZIGZAG = Polyline([0, 1, 2, 4], [[0, 0], [1, 1], [2, 0], [4, 2]])


@pytest.mark.parametrize(("index", "splices"), [(1, "[0,2]"), (2, "[1,4]")])
def test_it_deletes_one_vertex(index: int, splices: str) -> None:
    """Its neighbours are joined."""
    edit = check_edit(ZIGZAG, lambda value: DeleteVertex(index=index).edit(value, Scene()))
    assert str(edit.splices) == splices
    assert edit.value.points.tolist() == [
        row for k, row in enumerate(ZIGZAG.points.tolist()) if k != index
    ]


def test_it_undoes_an_insertion() -> None:
    """Vertices and parameters come back bit by bit."""
    value = InsertVertex(t=0.3, to=[5, 5]).edit(ZIGZAG, Scene()).value
    assert DeleteVertex(index=1).edit(value, Scene()).value.to_dict() == ZIGZAG.to_dict()


@pytest.mark.parametrize(("index", "message"), [(0, "is an end"), (3, "is an end"), (4, "0 to 3")])
def test_ends_and_missing_vertices_are_refused(index: int, message: str) -> None:
    """An open curve keeps its ends."""
    with pytest.raises(EditError, match=message):
        DeleteVertex(index=index).edit(ZIGZAG, Scene())
