"""The drag steps that are measured."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen

import multirep as mr
from multirep.arrays import Array
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline

#: How far a drag step moves something, in tolerances.
STEP = 10.0
#: Level of the sweep: its width is 7/2^6 of the curve.
SWEEP_LEVEL = 6
#: Where on the curve things are dragged. The sweep covers the control point; the vertex is
#: elsewhere: a vertex that is dragged out of a curve which other edits have smoothed makes ever
#: narrower spikes.
VERTEX, CONTROL_POINT, SWEPT = 0.2, 0.37, 0.4


@frozen
class Drag:
    """Moving something to and fro; ``step(value, k)`` is the edit of the k-th step."""

    kind: type[Representation]
    what: str
    step: Callable[[Representation, int], mr.Edit[Representation]]


def drags(curve: mr.MultiRepresentation) -> list[Drag]:
    """Return the drag of each representation: there and back again, by ``STEP`` tolerances."""
    size = STEP * curve.tolerance

    def offset(k: int) -> Array:
        move = np.zeros(curve.dimension)
        move[k // 2 % 2] = size if k % 2 == 0 else -size
        return move

    def move_vertex(value: Polyline, k: int) -> mr.Edit[Polyline]:
        vertex = min(max(value.t.searchsorted(VERTEX), 1), value.size - 2)
        return value.move_vertex(vertex, value.points[vertex] + offset(k))

    def move_control_point(value: Nurbs, k: int) -> mr.Edit[Nurbs]:
        near = value.knots.searchsorted(CONTROL_POINT) - value.degree // 2 - 1
        control = min(max(near, 1), value.size - 2)
        return value.move_control_point(control, value.points[control] + offset(k))

    def sweep(value: WaveletBSpline, k: int) -> mr.Edit[WaveletBSpline]:
        return value.sweep(SWEPT, value(SWEPT) + offset(k), SWEEP_LEVEL)

    return [
        Drag(Polyline, "move a vertex", move_vertex),
        Drag(Nurbs, "move a control point", move_control_point),
        Drag(WaveletBSpline, f"sweep at level {SWEEP_LEVEL}", sweep),
    ]


def drag_step(curve: mr.MultiRepresentation, drag: Drag, k: int) -> None:
    """One step: edit, commit, and both other views brought up to date."""
    value = curve.view(drag.kind)
    curve.commit(drag.kind, drag.step(value, k))
    for kind in curve.kinds:
        curve.view(kind)
