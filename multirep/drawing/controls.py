"""What holds a curve, drawn: vertices; control polygon and knots; control points by level.

Representations are told apart by what they offer, not by their class, so a plugin with knots and
weights is drawn as a NURBS and one with vertices as a polyline; anything else is drawn without
controls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from attrs import frozen

from multirep.arrays import Array, Indices
from multirep.drawing.palette import CARD, FAINT, level_colour
from multirep.drawing.picture import Item, Lines, Marks
from multirep.representation import Representation

#: More controls than this are thinned evenly; the picture says so.
MOST_CONTROLS = 700

Place = Callable[[Array, Array], Array]


@frozen(eq=False)
class Controls:
    """The drawn controls, a note on what they are, and the colour of each wavelet level.

    ``polygon`` belongs under the curve, ``items`` above it.
    """

    items: tuple[Item, ...] = ()
    note: str = ""
    polygon: tuple[Item, ...] = ()
    levels: tuple[tuple[int, str], ...] = ()


def controls_of(curve: Representation) -> tuple[Array, Array]:
    """Return the parameters (n,) and points (n, d) of the controls; empty when there are none."""
    shown: Any = curve
    points = np.asarray(getattr(shown, "points", np.zeros((0, curve.dimension))), dtype=float)
    if hasattr(shown, "t"):
        return np.asarray(shown.t, dtype=float), points
    if hasattr(shown, "knots"):
        return _greville(np.asarray(shown.knots, float), _degree(shown)), points
    return np.zeros(0), points[:0]


def draw_controls(curve: Representation, place: Place, colour: str) -> Controls:
    """Draw the controls of a representation.

    Parameters
    ----------
    curve : Representation
    place : callable
        Parameters (n,) and points (n, d) to page coordinates (n, 2).
    colour : str
        Of the curve.

    Returns
    -------
    Controls
        At most :data:`MOST_CONTROLS` of each sort; the note says which share is drawn.
    """
    shown: Any = curve
    t, points = controls_of(curve)
    if not len(points):
        return Controls(note="drawn without controls")
    step = -(-len(points) // MOST_CONTROLS)
    chosen = np.arange(0, len(points), step)
    page = place(t[chosen], points[chosen])
    thinned = f", 1 in {step} drawn" if step > 1 else ""
    if hasattr(shown, "weights"):
        return _nurbs(shown, page, chosen, place, colour, thinned)
    if hasattr(shown, "level"):
        return _wavelet(shown, page, chosen, thinned)
    radius = 1.3 if thinned else float(np.clip(150.0 / len(chosen), 1.5, 3.0))
    note = f"dots: vertices{thinned}"
    return Controls((Marks(page, "circle", radius, CARD, colour, 1.3),), note)


def _nurbs(
    shown: Any, page: Array, chosen: Indices, place: Place, colour: str, thinned: str
) -> Controls:
    radius = 1.5 if thinned else float(np.clip(220.0 / len(chosen), 1.7, 3.2))
    weighted = np.asarray(shown.weights, float)[chosen] != 1.0
    items: list[Item] = []
    ticks, count = _knot_ticks(shown, place)
    if ticks:
        items.append(Lines(tuple(ticks), colour, 1.2, opacity=0.8))
    items.append(Marks(page[~weighted], "square", radius, CARD, colour, 1.3))
    note = f"ticks: {count} knots{thinned}"
    if weighted.any():
        items.append(Marks(page[weighted], "square", radius, colour, colour, 1.3))
        note += "; filled: weight not 1"
    return Controls(tuple(items), note, _polygon(page, thinned))


def _knot_ticks(shown: Any, place: Place) -> tuple[list[Array], int]:
    """Short lines across the curve at its inner knots, longer where the knot is multiple."""
    degree = _degree(shown)
    knots = np.asarray(shown.knots, float)
    inner = knots[degree + 1 : len(knots) - degree - 1]
    values, times = np.unique(inner, return_counts=True)
    values, times = (
        values[(values > knots[degree]) & (values < knots[-degree - 1])],
        times[: len(values)],
    )
    if not len(values):
        return [], 0
    step = -(-len(values) // MOST_CONTROLS)
    start, stop = float(knots[degree]), float(knots[-degree - 1])
    near = (stop - start) * 1e-5
    middle = place(values[::step], shown(values[::step]))
    after = place(values[::step], shown(np.minimum(values[::step] + near, stop)))
    before = place(values[::step], shown(np.maximum(values[::step] - near, start)))
    along = after - before
    size = np.linalg.norm(along, axis=1, keepdims=True)
    across = np.column_stack([-along[:, 1], along[:, 0]]) / np.where(size > 0, size, 1.0)
    half = np.where(times[::step] > 1, 5.5, 3.5)[:, None]
    ends = np.stack([middle - half * across, middle + half * across], axis=1)
    return list(ends), len(values)


def _wavelet(shown: Any, page: Array, chosen: Indices, thinned: str) -> Controls:
    levels = wavelet_levels(np.asarray(shown.knots, float))[chosen]
    present = range(int(levels.min()), int(levels.max()) + 1)
    items: list[Item] = []
    shades: list[tuple[int, str]] = []
    for level in present:
        members = page[levels == level]
        if len(members):
            shades.append((level, level_colour(level, present)))
            share = (level - present.start) / max(len(present) - 1, 1)
            radius = (4.2 - 2.2 * share) * (0.75 if len(page) > 150 else 1.0)
            items.append(Marks(members, "circle", radius, shades[-1][1], CARD, 0.7))
    note = f"dots: by level{thinned}"
    return Controls(tuple(items), note, _polygon(page, thinned), tuple(shades))


def _polygon(page: Array, thinned: str) -> tuple[Item, ...]:
    """Join the control points, unless some are left out."""
    return () if thinned else (Lines((page,), FAINT, 1.0),)


def wavelet_levels(knots: Array) -> Array:
    """Return the level that each control point of a graded dyadic cubic belongs to.

    It is the level of the uniform basis function whose support has the same mean cell: -log2 of the
    cell over T.

    Examples
    --------
    >>> wavelet_levels(np.array([0, 0, 0, 0, .25, .5, .75, 1, 1, 1, 1])).tolist()
    [2, 2, 2, 2, 2, 2, 2]
    """
    starts, stops = knots[:-4], knots[4:]
    steps = np.diff(knots) > 0
    cells = np.convolve(steps, np.ones(4), mode="valid")
    length = knots[-1] - knots[0]
    levels: Array = np.rint(np.log2(cells * length / (stops - starts))).astype(int)
    return levels


def _degree(shown: Any) -> int:
    return int(getattr(shown, "degree", 3))


def _greville(knots: Array, degree: int) -> Array:
    """Knot averages: where each control point acts most."""
    windows = np.lib.stride_tricks.sliding_window_view(knots[1:-1], degree)
    averages: Array = windows.mean(axis=1)
    return averages
