"""The curves and the drag steps that are measured."""

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
#: Harmonics of the fractal line: the same coast at every n, ever better surveyed.
HARMONICS = 2**17
#: Where on the curve things are dragged. The sweep covers the control point; the vertex is
#: elsewhere: a vertex that is dragged out of a curve which other edits have smoothed makes ever
#: narrower spikes.
VERTEX, CONTROL_POINT, SWEPT = 0.2, 0.37, 0.4


def smooth(n: int) -> Array:
    """A wavy outline of size 2: the same shape at every n."""
    t = np.linspace(0, 1, n)
    wave = 0.05 * np.stack([np.cos(40 * np.pi * t), np.sin(34 * np.pi * t)], axis=1)
    return np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1) + wave


def coast(n: int) -> Array:
    """A fractal line of size 1, rough at every scale: finer vertices add finer detail."""
    rng = np.random.default_rng(7)
    k = np.arange(1, HARMONICS + 1)
    waves = (rng.normal(size=(len(k), 2)) + 1j * rng.normal(size=(len(k), 2))) * (k**-1.6)[:, None]
    # seven eighths of a period: an open curve
    fine = np.fft.irfft(np.concatenate([np.zeros((1, 2)), waves]), axis=0)[: 7 * HARMONICS // 4]
    at = np.linspace(0, len(fine) - 1, n)
    rows = np.stack([np.interp(at, np.arange(len(fine)), column) for column in fine.T], axis=1)
    return np.asarray(rows / np.ptp(rows, axis=0).max())


CURVES: dict[str, Callable[[int], Array]] = {"smooth": smooth, "coast": coast}


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
