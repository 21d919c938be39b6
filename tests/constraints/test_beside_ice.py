"""Every built-in tool across the border of a frozen stretch: solved on what is free, or faded."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import multirep as mr
from multirep.constraints import Freeze
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.tools import (
    CopyDetail,
    Corner,
    DirectManipulation,
    InsertKnot,
    MoveControlPoint,
    Oversketch,
    SetWeight,
    ShowLevel,
    Sketch,
    Smooth,
    Spatula,
    Sweep,
)

KINDS: tuple[Any, ...] = (Polyline, Nurbs, WaveletBSpline)
#: What is frozen, and a place beside it, closer than the natural support of any tool.
ICE = (0.25, 0.5)
T = 0.53


def session() -> mr.Session:
    made = mr.Session()
    x = np.linspace(0, 6, 121)
    rough = 0.02 * np.sin(60 * x)
    for name, y in (("c", np.sin(x) + rough), ("other", 0.1 * np.cos(40 * x))):
        points = np.column_stack([x, y])
        made.add(name, mr.MultiRepresentation.from_points(points, tolerance=1e-3))
    made.constrain("c", Freeze(interval=ICE), name="ice")
    return made


def moved(curve: mr.MultiRepresentation, *by: float, t: float = T) -> tuple[float, ...]:
    return tuple((curve.view(Polyline)(t) + by).tolist())


def sweep(curve: mr.MultiRepresentation, t: float, level: float, **others: Any) -> Sweep:
    return Sweep(t=t, to=moved(curve, 0, 0.1, t=t), level=level, **others)


def border(curve: mr.MultiRepresentation) -> int:
    """The control point at the border itself, whose support is half frozen."""
    return int(curve.view(Nurbs).knots.searchsorted(curve.frozen.hull.stop)) - 1


def pull(curve: mr.MultiRepresentation) -> MoveControlPoint:
    index = border(curve)
    to = tuple((curve.view(Nurbs).points[index] + [0, 0.01]).tolist())
    return MoveControlPoint(index=index, to=to)


def stroke(curve: mr.MultiRepresentation) -> list[list[float]]:
    t = np.linspace(0.45, 0.6, 30)
    bump = np.sin(np.linspace(0, np.pi, 30))[:, None]
    return (curve.view(Polyline)(t) + 0.2 * bump * [0, 1]).tolist()


#: Makes the tool, and whether it solves on what is free by itself.
TOOLS: dict[str, tuple[Callable[[mr.MultiRepresentation], Any], bool]] = {
    "direct manipulation": (lambda c: DirectManipulation(t=T, to=moved(c, 0, 0.1)), True),
    "sweep": (lambda c: sweep(c, 0.65, 4), True),
    "fractional sweep": (lambda c: sweep(c, 0.65, 4.5), True),
    "sweep of two": (lambda c: sweep(c, 0.65, 4, hold=[0.9]), True),
    "sweep too wide for the place": (lambda c: sweep(c, T, 2), False),
    "smooth": (lambda c: Smooth(level=3), True),
    "smooth a stretch": (lambda c: Smooth(level=3, interval=(0.4, 0.8)), True),
    "copy detail": (lambda c: CopyDetail(source="other", levels=[5, 6]), True),
    "show level": (lambda c: ShowLevel(source="other", level=4), True),
    "corner": (lambda c: Corner(t=T, left=(10, 20), right=(10, -20)), True),
    "insert knot": (lambda c: InsertKnot(t=T), True),
    "control point": (pull, False),
    "weight": (lambda c: SetWeight(index=border(c), weight=3), False),
    "spatula": (lambda c: Spatula(radius=0.4, path=[moved(c, 0, 0.7), moved(c, 0, 0.3)]), False),
    "oversketch": (lambda c: Oversketch(stroke=stroke(c)), False),
    "sketch": (lambda c: Sketch(stroke=[[0, 0], [3, 3], [6, 0]]), False),
}


@pytest.mark.parametrize("tool", TOOLS)
def test_no_bit_of_the_ice_changes_and_there_is_no_jump(tool: str) -> None:
    """Tools that can are solved on the free controls, nothing of them is faded out.

    The others are. In all representations the ice is what it was, and the curve leaves it from
    where it ends, in its old direction (a spline that follows what was faded: up to the tolerance).
    """
    make, solves = TOOLS[tool]
    made = session()
    curve = made.curve("c")
    ice = curve.frozen.hull
    t = np.linspace(ice.start, ice.stop, 200)
    values = {kind: curve.view(kind) for kind in KINDS}
    before = {kind: value(t).tobytes() for kind, value in values.items()}
    outcome = made.apply("c", make(curve))
    assert bool(outcome.faded) is not solves
    assert outcome.changed
    assert not outcome.changed.intersects(curve.frozen)
    for kind in KINDS:
        value = curve.view(kind)
        assert value(t).tobytes() == before[kind]
        assert not values[kind].changes(value).intersects(curve.frozen)
    for end, inner, outer in ((ice.start, "right", "left"), (ice.stop, "left", "right")):
        author = who(curve, end, outer)
        value = curve.view(author)
        inside, outside = (value.derivative(end, side=side) for side in (inner, outer))
        assert (value(end) == values[author](end)).all()
        cosine = inside @ outside / np.linalg.norm(inside) / np.linalg.norm(outside)
        assert cosine > (0.99 if solves or author is Polyline else 0.8)


def who(curve: mr.MultiRepresentation, t: float, side: str) -> Any:
    """The author beside a parameter."""
    beside = np.nextafter(t, 0.0 if side == "left" else 1.0)
    [name] = [name for part, name in curve.authors if part.contains(float(beside))]
    return {kind.name: kind for kind in KINDS}[name]
