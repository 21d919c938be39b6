"""What a picture is made of: a few shapes in page units (pixels, y down)."""

from __future__ import annotations

from typing import TypeAlias

from attrs import frozen

from multirep.arrays import Array


@frozen(eq=False)
class Lines:
    """Connected lines through points, one chain an array of shape (n, 2)."""

    chains: tuple[Array, ...]
    stroke: str
    width: float
    opacity: float = 1.0
    dash: tuple[float, ...] = ()


@frozen(eq=False)
class Marks:
    """Equal marks at points (n, 2): "circle", "square" or "diamond", of a given radius."""

    points: Array
    shape: str
    radius: float
    fill: str
    stroke: str = "none"
    width: float = 0.0


@frozen
class Box:
    """A rectangle, perhaps with round corners."""

    x: float
    y: float
    width: float
    height: float
    fill: str
    stroke: str = "none"
    radius: float = 0.0


@frozen
class Text:
    """One line of text; ``anchor`` is "start", "middle" or "end"."""

    x: float
    y: float
    text: str
    size: float
    fill: str
    anchor: str = "start"
    bold: bool = False


@frozen(eq=False)
class Group:
    """Things that belong together; what lies outside ``clip`` is not seen."""

    items: tuple[Item, ...]
    name: str = ""
    clip: Box | None = None


Shape: TypeAlias = Lines | Marks | Box | Text
Item: TypeAlias = Shape | Group


@frozen(eq=False)
class Picture:
    """A whole picture; ``title`` and ``description`` are for those who cannot see it."""

    width: float
    height: float
    title: str
    description: str
    items: tuple[Item, ...]
