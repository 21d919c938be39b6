"""The panels: one representation with its controls, and all of them overlaid."""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array
from multirep.drawing.annotations import above, beneath, explained
from multirep.drawing.controls import Controls, controls_of, draw_controls
from multirep.drawing.frame import Frame, flatten
from multirep.drawing.outline import trace
from multirep.drawing.palette import (
    BODY,
    CARD,
    CHANGED,
    EDGE,
    HEADING,
    INK,
    MUTED,
    SMALL,
    hue,
)
from multirep.drawing.picture import Box, Group, Item, Lines, Marks, Text
from multirep.drawing.subject import CurveSubject, Subject
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.splices import SpliceList

#: Inner margin of a card, height of its head and foot.
MARGIN, HEAD, FOOT = 18.0, 44.0, 30.0
#: Room for controls around the drawing, of the page.
ROOM = 10.0


def card(box: Box) -> Box:
    """Return the sheet of a panel."""
    return Box(box.x, box.y, box.width, box.height, CARD, EDGE, 10.0)


def bounds(subject: Subject) -> tuple[Array, Array]:
    """Return the flat box that holds all curves, and their controls unless those run far out."""
    lower, upper = np.full(2, np.inf), np.full(2, -np.inf)
    controls: list[Array] = []
    for curve in subject.curves:
        values = [*curve.representations.values(), *([curve.before] if curve.before else [])]
        for representation in values:
            domain = representation.domain
            t = np.linspace(domain.start, domain.stop, 2001)
            flat = flatten(t, representation(t), y_up=subject.y_up)
            lower, upper = np.minimum(lower, flat.min(axis=0)), np.maximum(upper, flat.max(axis=0))
            at, points = controls_of(representation)
            if len(points):
                controls.append(flatten(at, points, y_up=subject.y_up))
        for stroke in curve.strokes:
            if stroke.shape[1] == values[0].dimension > 1:
                controls.append(flatten(np.zeros(len(stroke)), stroke, y_up=subject.y_up))
    reach = 0.15 * float((upper - lower).max())
    for flat in controls:
        lower = np.minimum(lower, np.maximum(flat.min(axis=0), lower - reach))
        upper = np.maximum(upper, np.minimum(flat.max(axis=0), upper + reach))
    if not (upper > lower).any():
        lower, upper = lower - 0.5, upper + 0.5
    return lower, upper


def drawing_area(box: Box) -> Box:
    """Return the part of a panel in which the curve stands."""
    inset = MARGIN + ROOM
    return Box(
        box.x + inset,
        box.y + HEAD + ROOM,
        box.width - 2 * inset,
        box.height - HEAD - FOOT - 2 * ROOM,
        "none",
    )


def panel(
    subject: Subject, kind: str, box: Box, lower: Array, upper: Array, *, alone: bool = False
) -> Group:
    """Draw one representation of all curves, with its controls and the changed stretches.

    When it is ``alone`` on the page it also shows the curve before the edits.
    """
    frame = Frame(drawing_area(box), lower, upper)
    colour, _ = hue(kind, subject.kinds)
    clip = _clip(box)
    items: list[Item] = []
    drawn: list[Controls] = []
    for curve in subject.curves:
        representation = curve.representations.get(kind)
        if representation is None:
            continue

        def place(t: Array, points: Array) -> Array:
            return frame(flatten(t, points, y_up=subject.y_up))

        controls = draw_controls(representation, place, colour)
        page = _page(representation, representation.domain, frame, subject.y_up)
        items += changed_stretches(curve, representation, frame, subject.y_up, 11.0)
        items += beneath(curve, representation, frame, subject.y_up)
        if alone and curve.before is not None:
            items += former_stretches(curve, curve.before, frame, subject.y_up)
        width = (2.6 if alone else 1.9) * _fineness(page, box)
        items += [*controls.polygon, Lines((page,), colour, width), *controls.items]
        items += above(curve, representation, frame, subject.y_up)
        drawn.append(controls)
    sizes = sum(c.representations[kind].size for c in subject.curves if kind in c.representations)
    words = [*dict.fromkeys(controls.note for controls in drawn)]
    if alone:
        if any(curve.changed for curve in subject.curves):
            words.append("highlighted: changed; dotted: before")
        words.append(explained(subject.curves))
    notes = "; ".join(word for word in words if word)
    return Group(
        (
            card(box),
            Marks(np.array([[box.x + MARGIN + 5, box.y + 26]]), "circle", 5.0, colour),
            Text(box.x + MARGIN + 18, box.y + 31.5, kind, HEADING, INK, bold=True),
            Text(box.x + box.width - MARGIN, box.y + 31, _count(kind, sizes), BODY, MUTED, "end"),
            Group(tuple(items), clip=clip),
            *_foot(box, notes, drawn),
        ),
        name=kind,
    )


def overlay(
    subject: Subject,
    box: Box,
    lower: Array,
    upper: Array,
    look_at: tuple[CurveSubject, float] | None,
) -> Group:
    """Draw all representations on top of each other; ``look_at`` is magnified elsewhere."""
    frame = Frame(drawing_area(box), lower, upper)
    items: list[Item] = []
    for curve in subject.curves:
        first = next(iter(curve.representations.values()))
        items += changed_stretches(curve, first, frame, subject.y_up, 15.0)
        if curve.before is not None:
            items += former_stretches(curve, curve.before, frame, subject.y_up)
        items += beneath(curve, first, frame, subject.y_up)
        items += overlaid(curve, subject, frame, first.domain, (7.0, 3.4, 1.3))
        items += above(curve, first, frame, subject.y_up)
    if look_at is not None:
        curve, t = look_at
        point = next(iter(curve.representations.values()))(np.array([t]))
        page = frame(flatten(np.array([t]), point, y_up=subject.y_up))
        items.append(Marks(page, "circle", 11.0, "none", INK, 1.6))
    foot = "drawn within each other, the widest first"
    if any(curve.changed for curve in subject.curves):
        foot += "; highlighted: changed by the edits; dotted: before"
    annotations = explained(subject.curves)
    foot += f"; {annotations}" if annotations else ""
    return Group(
        (
            card(box),
            Text(box.x + MARGIN, box.y + 31.5, "all of them, overlaid", HEADING, INK, bold=True),
            *_key(subject, box),
            Group(tuple(items), clip=_clip(box)),
            Text(box.x + MARGIN, box.y + box.height - 13, _fit(foot, box.width), SMALL, MUTED),
        ),
        name="overlaid",
    )


def overlaid(
    curve: CurveSubject,
    subject: Subject,
    frame: Frame,
    interval: Interval,
    widths: tuple[float, ...],
) -> list[Item]:
    """Draw all representations of a curve as nested strokes, the widest and palest first."""
    items: list[Item] = []
    for number, (kind, representation) in enumerate(curve.representations.items()):
        colour, pale = hue(kind, subject.kinds)
        last = number == len(curve.representations) - 1
        width = widths[min(number, len(widths) - 1)]
        page = _page(representation, interval, frame, subject.y_up)
        width *= _fineness(page, frame.box)
        items.append(Lines((page,), colour if last else pale, width))
    return items


def changed_stretches(
    curve: CurveSubject, representation: Representation, frame: Frame, y_up: bool, width: float
) -> list[Item]:
    """Draw the changed stretches as a highlighter under the line."""
    stretches = curve.changed & SpliceList([representation.domain])
    chains = tuple(_page(representation, splice, frame, y_up) for splice in stretches)
    return [Lines(chains, CHANGED, width)] if chains else []


def former_stretches(
    curve: CurveSubject, before: Representation, frame: Frame, y_up: bool
) -> list[Item]:
    """Draw the changed stretches as they were before the edits."""
    stretches = curve.changed & SpliceList([before.domain])
    chains = tuple(_page(before, splice, frame, y_up) for splice in stretches)
    return [Lines(chains, INK, 1.5, dash=(0.5, 4.5))] if chains else []


def _page(representation: Representation, interval: Interval, frame: Frame, y_up: bool) -> Array:
    return frame(flatten(*trace(representation, interval, frame.scale), y_up=y_up))


def _fineness(page: Array, box: Box) -> float:
    """Return by how much a line that winds a lot is drawn thinner: 1 for most, down to a third."""
    length = float(np.linalg.norm(np.diff(page, axis=0), axis=1).sum())
    return float(np.clip(5.0 * (box.width + box.height) / max(length, 1.0), 1 / 3, 1.0))


def _clip(box: Box) -> Box:
    return Box(box.x + 2, box.y + HEAD - 4, box.width - 4, box.height - HEAD - FOOT + 8, "none")


def _count(kind: str, size: int) -> str:
    what = "vertices" if kind == "polyline" else "control points"
    return f"{size:,} {what}".replace(",", "\N{THIN SPACE}")


def _key(subject: Subject, box: Box) -> list[Item]:
    """Name the strokes at the right of the head."""
    items: list[Item] = []
    x = box.x + box.width - MARGIN
    for number, kind in reversed(list(enumerate(subject.kinds))):
        colour, pale = hue(kind, subject.kinds)
        last = number == len(subject.kinds) - 1
        items.append(Text(x, box.y + 31, kind, BODY, MUTED, "end"))
        x -= 7.2 * len(kind) + 10
        stroke = np.array([[x - 22, box.y + 26.5], [x, box.y + 26.5]])
        items.append(Lines((stroke,), colour if last else pale, (7.0, 3.4, 1.6)[min(number, 2)]))
        x -= 40
    return items


def _foot(box: Box, notes: str, drawn: list[Controls]) -> list[Item]:
    """Say what the controls are; a wavelet's levels get their colours, the coarsest first."""
    y = box.y + box.height - 13
    levels = dict(shade for controls in drawn for shade in controls.levels)
    items: list[Item] = [Text(box.x + MARGIN, y, _fit(notes, box.width), SMALL, MUTED)]
    if len(drawn) > 1:
        return items  # each curve has levels of its own
    x = box.x + box.width - MARGIN
    ends = (min(levels, default=0), max(levels, default=0))
    for level, colour in sorted(levels.items(), reverse=True):
        if level == ends[1]:
            items.append(Text(x, y, str(level), SMALL, MUTED, "end"))
            x -= 7.5 * len(str(level)) + 7.0
        items.append(Marks(np.array([[x, y - 4]]), "circle", 3.4, colour))
        x -= 10.0
        if level == ends[0] < ends[1]:
            items.append(Text(x + 2.0, y, str(level), SMALL, MUTED, "end"))
    return items


def _fit(text: str, width: float) -> str:
    """Cut a note that would run out of its panel (a letter takes about half its size)."""
    room = int((width - 2 * MARGIN) / (0.52 * SMALL))
    return text if len(text) <= room else text[: room - 1] + "\N{HORIZONTAL ELLIPSIS}"
