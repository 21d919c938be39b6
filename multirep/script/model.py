"""What a script says: frozen values, checked when they are made."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NewType

import attrs
from attrs import field, frozen, validators

from multirep.splices import SpliceList

#: A point list as nested tuples; structured by :mod:`multirep.script.strict` in one go.
Points = NewType("Points", tuple[tuple[float, ...], ...])

#: Longest name of a curve or constraint; names become keys of the report and labels of the drawing.
LONGEST_NAME = 200


def _name(instance: object, attribute: attrs.Attribute[str], value: str) -> None:
    if not value.strip() or len(value) > LONGEST_NAME or not value.isprintable():
        raise ValueError(
            f"{attribute.name!r} must be 1 to {LONGEST_NAME} printable characters, "
            f"got {value[:60]!r}"
        )


@frozen
class PointsSource:
    """Vertices and their parameters (None: chord length in [0, 1])."""

    points: Points
    t: tuple[float, ...] | None = None


@frozen
class NurbsSource:
    """A NURBS curve in numbers."""

    degree: int = field(validator=validators.ge(1))
    knots: tuple[float, ...]
    points: Points
    weights: tuple[float, ...] | None = None


@frozen
class WaveletSource:
    """A wavelet B-spline in numbers: finest level, all knots, all control points."""

    level: int = field(validator=validators.ge(0))
    knots: tuple[float, ...]
    points: Points


@frozen
class StrokesSource:
    """Strokes of a pen over each other; the curve begins as their cleaned average.

    ``noise`` and the others are the options of the tool `sketch`.
    """

    strokes: tuple[Points, ...]
    noise: float | None = None
    corner_angle: float | None = None
    corner_window: float | None = None


Source = PointsSource | NurbsSource | WaveletSource | StrokesSource


@frozen
class CurveSpec:
    """A curve of the script.

    Parameters
    ----------
    name : str
        What steps and outputs call it.
    tolerance : float
        ε, in the units of the points.
    source : Source
        Where the geometry comes from.
    representations : tuple of str or None
        Which representations are kept; None means all that are registered.
    notes : tuple of str
        What reading the source did, for people.
    line : int or None
        Where the script has it, as far as known.
    added : bool
        Whether it comes in by an ``add`` step; else it is there from the start.
    """

    name: str = field(validator=_name)
    tolerance: float = field(validator=validators.gt(0))
    source: Source
    representations: tuple[str, ...] | None = None
    notes: tuple[str, ...] = ()
    line: int | None = None
    added: bool = False


# Of a step with ``may_conflict``, a conflict is reported and changes nothing; else it ends the run.


@frozen
class ToolStep:
    """Apply a tool: ``tool`` is the structured, validated instance."""

    index: int
    curve: str
    name: str
    tool: Any
    line: int | None = None
    may_conflict: bool = False


@frozen
class ConstrainStep:
    """Add a constraint to a curve."""

    index: int
    curve: str
    kind: str
    constraint: Any
    name: str | None = None
    line: int | None = None
    may_conflict: bool = False


@frozen
class ReleaseStep:
    """Release a constraint by its name."""

    index: int
    curve: str
    name: str
    line: int | None = None


@frozen
class HistoryStep:
    """Undo or redo some gestures."""

    index: int
    what: str
    times: int
    line: int | None = None


@frozen
class AddStep:
    """Bring in a curve that is not there from the start."""

    index: int
    curve: str
    line: int | None = None


@frozen
class ToleranceStep:
    """Change the tolerance of a curve."""

    index: int
    curve: str
    tolerance: float = field(validator=validators.gt(0))
    line: int | None = None
    may_conflict: bool = False


@frozen
class ReparameterizeStep:
    """Map the parameters of a curve: "even", or old and new parameters."""

    index: int
    curve: str
    mapping: Any
    line: int | None = None
    may_conflict: bool = False


@frozen
class ViewStep:
    """Bring representations up to date now, everywhere or on some stretches; no undo step."""

    index: int
    curve: str
    kinds: tuple[str, ...]
    where: SpliceList | None = None
    line: int | None = None


@frozen
class GestureStep:
    """Several tools, and views between them, that are one undo step."""

    index: int
    curve: str
    parts: tuple[ToolStep | ViewStep, ...]
    line: int | None = None
    may_conflict: bool = False


Step = (
    ToolStep
    | ConstrainStep
    | ReleaseStep
    | HistoryStep
    | AddStep
    | ToleranceStep
    | ReparameterizeStep
    | ViewStep
    | GestureStep
)


@frozen
class Output:
    """A picture to write.

    Parameters
    ----------
    svg : str
        The file, relative to the output directory.
    show : tuple of str or None
        Which representations; None means all.
    curves : tuple of str or None
        Which curves; None means all.
    title : str or None
        What is written above; None means the name of the script.
    y : {"down", "up"}
        Where the second axis points.
    after : int or None
        Drawn when so many steps are done; None means all.
    since : int
        What changed after so many steps is highlighted, with the curve as it was then.
    strokes : bool
        Whether the strokes of the tools since then are drawn.
    """

    svg: str
    show: tuple[str, ...] | None = None
    curves: tuple[str, ...] | None = None
    title: str | None = None
    y: str = field(default="down", validator=validators.in_(("down", "up")))
    after: int | None = field(default=None, validator=validators.optional(validators.ge(0)))
    since: int = field(default=0, validator=validators.ge(0))
    strokes: bool = False


@frozen
class Script:
    """A whole script, checked; nothing in it refers to anything that is not there."""

    path: Path
    curves: tuple[CurveSpec, ...]
    steps: tuple[Step, ...] = ()
    outputs: tuple[Output, ...] = ()
