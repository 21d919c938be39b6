"""What belongs to a curve without being of it: strokes, frozen stretches, marks, held points."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.drawing.frame import Frame, flatten
from multirep.drawing.outline import trace
from multirep.drawing.palette import CARD, ICE, INK, PENCIL
from multirep.drawing.picture import Item, Lines, Marks
from multirep.drawing.subject import CurveSubject
from multirep.representation import Representation
from multirep.splices import SpliceList

#: Half the length of a mark across the curve, and of its foot along it, on the page.
HALF, FOOT = 17.0, 9.0


def beneath(
    curve: CurveSubject, representation: Representation, frame: Frame, y_up: bool
) -> list[Item]:
    """Draw what lies under the curve: frozen stretches as a band, strokes as pencil lines."""
    items: list[Item] = []
    frozen = curve.frozen & SpliceList([representation.domain])
    chains = tuple(
        frame(flatten(*trace(representation, splice, frame.scale), y_up=y_up)) for splice in frozen
    )
    if chains:
        items.append(Lines(chains, ICE, 13.0))
    # a stroke has no parameters; one of functions cannot be drawn
    strokes = tuple(
        frame(flatten(np.zeros(len(stroke)), stroke, y_up=y_up))
        for stroke in curve.strokes
        if stroke.shape[1] == representation.dimension > 1
    )
    if strokes:
        items.append(Lines(strokes, PENCIL, 1.6, dash=(5.0, 3.5)))
        starts = np.array([stroke[0] for stroke in strokes])
        items.append(Marks(starts, "circle", 2.6, PENCIL))
    return items


def above(
    curve: CurveSubject, representation: Representation, frame: Frame, y_up: bool
) -> list[Item]:
    """Draw what lies on the curve: marks as brackets that open inwards, held points as diamonds."""
    items: list[Item] = []
    chains: list[Array] = []
    for start, stop in curve.marks:
        chains.append(_bracket(representation, start, 1.0, frame, y_up))
        chains.append(_bracket(representation, stop, -1.0, frame, y_up))
    if chains:
        items.append(Lines(tuple(chains), INK, 2.4))
    if curve.pins:
        at = np.array(curve.pins)
        page = frame(flatten(at, representation(at), y_up=y_up))
        items.append(Marks(page, "diamond", 6.5, CARD, INK, 2.0))
    return items


def explained(curves: tuple[CurveSubject, ...]) -> str:
    """Say what the annotations mean, as far as there are any."""
    words = [
        ("dashed: the pen", any(curve.strokes for curve in curves)),
        ("blue band: frozen", any(curve.frozen for curve in curves)),
        ("brackets: marks", any(curve.marks for curve in curves)),
        ("diamonds: held by constraints", any(curve.pins for curve in curves)),
    ]
    return "; ".join(text for text, shown in words if shown)


def _bracket(
    representation: Representation, t: float, inwards: float, frame: Frame, y_up: bool
) -> Array:
    """Return a chain of four points: a bar across the curve with a foot at either end."""
    domain = representation.domain
    near = 1e-4 * domain.length * inwards
    at = np.array([t, min(max(t + near, domain.start), domain.stop)])
    page = frame(flatten(at, representation(at), y_up=y_up))
    along = page[1] - page[0]
    size = float(np.linalg.norm(along))
    along = along / size if size > 0 else np.array([1.0, 0.0])
    across = np.array([-along[1], along[0]])
    left, right = page[0] + HALF * across, page[0] - HALF * across
    return np.array([left + FOOT * along, left, right, right + FOOT * along])
