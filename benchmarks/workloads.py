"""The curves and the drag steps that are measured."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from attrs import frozen

import multirep as mr
from multirep.arrays import Array
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.representation import Representation

#: How far a drag step moves something, in tolerances.
STEP = 10.0
#: Level of the sweep: its width is 7/2^6 of the curve.
SWEEP_LEVEL = 6
#: Where on the curve things are dragged.
PLACE = 0.37


def smooth(n: int) -> Array:
    """A wavy outline of size 2: the same shape at every n."""
    t = np.linspace(0, 1, n)
    wave = 0.05 * np.stack([np.cos(40 * np.pi * t), np.sin(34 * np.pi * t)], axis=1)
    return np.stack([np.cos(2 * np.pi * t), np.sin(2 * np.pi * t)], axis=1) + wave


def coast(n: int) -> Array:
    """A fractal line of size 1, as rough at every scale as a coast: finer vertices add finer detail."""
    rng = np.random.default_rng(7)
    k = np.arange(1, n // 2 + 1)
    spectrum = (rng.normal(size=(len(k), 2)) + 1j * rng.normal(size=(len(k), 2))) * (k**-1.6)[
        :, None
    ]
    rows = np.fft.irfft(np.concatenate([np.zeros((1, 2)), spectrum]), n=n, axis=0)[: n - n // 8]
    rows = np.stack(
        [np.interp(np.linspace(0, 1, n), np.linspace(0, 1, len(rows)), c) for c in rows.T], 1
    )
    return np.asarray(rows / np.ptp(rows, axis=0).max())


CURVES: dict[str, Callable[[int], Array]] = {"smooth": smooth, "coast": coast}


@frozen
class Drag:
    """Moving something of one representation to and fro; ``step(value, k)`` is the k-th step's edit."""

    kind: type[Representation]
    what: str
    step: Callable[[Representation, int], mr.Edit[Representation]]


def drags(curve: mr.MultiRepresentation) -> list[Drag]:
    """The drag of each representation, around the place where it stands now."""
    size = STEP * curve.tolerance
    polyline, nurbs = curve.view(Polyline), curve.view(Nurbs)
    wavelet = curve.view(WaveletBSpline)
    vertex = min(max(polyline.t.searchsorted(PLACE), 1), polyline.size - 2)
    vertex_t, vertex_at = float(polyline.t[vertex]), np.array(polyline.points[vertex])
    control = min(max(nurbs.knots.searchsorted(PLACE) - nurbs.degree // 2, 1), nurbs.size - 2)
    control_at = np.array(nurbs.points[control])
    swept_at = wavelet(PLACE)

    def to(k: int) -> Array:
        offset = np.zeros(curve.dimension)
        offset[k % 2] = size * (1 if k % 4 < 2 else -1)
        return offset

    def move_vertex(value: Polyline, k: int) -> mr.Edit[Polyline]:
        return value.move_vertex(value.t.searchsorted(vertex_t), vertex_at + to(k))

    def move_control_point(value: Nurbs, k: int) -> mr.Edit[Nurbs]:
        return value.move_control_point(control, control_at + to(k))

    def sweep(value: WaveletBSpline, k: int) -> mr.Edit[WaveletBSpline]:
        return value.sweep(PLACE, swept_at + to(k), SWEEP_LEVEL)

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
