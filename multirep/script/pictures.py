"""The pictures of a script's result."""

from __future__ import annotations

from multirep.drawing.page import draw
from multirep.drawing.picture import Picture
from multirep.drawing.subject import CurveSubject, Subject
from multirep.script.model import Output
from multirep.script.running import Result


def picture(result: Result, output: Output) -> Picture:
    """Draw what an output of a script asks for.

    Parameters
    ----------
    result : Result
    output : Output
        Which curves and representations; :attr:`Output.svg` is not looked at.
    """
    curves = []
    edits = 0
    for curve in result.seen(output):
        if output.curves is not None and curve.name not in output.curves:
            continue
        shown = {
            kind: value
            for kind, value in curve.representations.items()
            if output.show is None or kind in output.show
        }
        pairs = {
            pair: bounds
            for pair, bounds in curve.deviations.items()
            if pair[0] in shown and pair[1] in shown
        }
        before = curve.before if curve.changed else None
        edits += curve.edits
        curves.append(
            CurveSubject(
                curve.name,
                curve.tolerance,
                shown,
                pairs,
                curve.changed,
                before,
                strokes=curve.strokes if output.strokes else (),
                frozen=curve.frozen,
                marks=curve.marks,
                pins=curve.pins,
            )
        )
    title = output.title or result.script.path.stem
    return draw(Subject(title, tuple(curves), edits, output.y == "up"))
