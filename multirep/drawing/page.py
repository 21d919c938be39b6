"""The whole picture: a panel for each representation, the overlay, the deviations."""

from __future__ import annotations

import math

import numpy as np

from multirep.arrays import Array
from multirep.drawing.cards import FOOT, HEAD, MARGIN, ROOM, bounds, overlay, panel
from multirep.drawing.legend import farthest, magnifier, table, table_height
from multirep.drawing.palette import BODY, INK, MUTED, PAPER, TITLE
from multirep.drawing.picture import Box, Item, Picture, Text
from multirep.drawing.subject import Subject

#: Width of the page, its margin, the gap between panels, the height of the head.
WIDTH, BORDER, GAP, TITLE_HEIGHT = 1280.0, 34.0, 18.0, 92.0
#: What is left between the margins.
ROOM_FOR_ALL = WIDTH - 2 * BORDER
#: Curves wider than this are drawn below each other, all others side by side.
WIDE = 2.4
#: Bounds on the height of a drawing, so that neither a line nor a tower spoils the page.
LOWEST, HIGHEST = 90.0, 760.0
#: The magnified square is at least this high.
MAGNIFIED = 250.0


def draw(subject: Subject) -> Picture:
    """Draw curves with all their representations.

    Parameters
    ----------
    subject : Subject

    Returns
    -------
    Picture
        :data:`WIDTH` wide; as high as it needs.
    """
    lower, upper = bounds(subject)
    size = upper - lower
    # A vertical line has no width, a level one no height; the panels stay within their bounds.
    aspect = max(float(size[0] / size[1]), 1e-9) if size[1] > 0 else math.inf
    if len(subject.kinds) == 1:
        return _alone(subject, aspect, lower, upper)
    columns = 1 if aspect > WIDE else min(3, len(subject.kinds))
    boxes = _grid(len(subject.kinds), columns, aspect)
    items: list[Item] = [
        panel(subject, kind, box, lower, upper)
        for kind, box in zip(subject.kinds, boxes, strict=True)
    ]
    look_at = farthest(subject)
    top = boxes[-1].y + boxes[-1].height + GAP
    arrange = _below if columns == 1 else _beside
    large, listed, magnified = arrange(top, aspect, table_height(subject), look_at is not None)
    items.append(overlay(subject, large, lower, upper, look_at))
    items.append(table(subject, listed))
    if magnified is not None:
        items.append(magnifier(subject, magnified, look_at))
    height = max(listed.y + listed.height, large.y + large.height) + BORDER
    items = [Box(0, 0, WIDTH, height, PAPER), *_head(subject), *items]
    return Picture(WIDTH, height, subject.title, _describe(subject), tuple(items))


def _alone(subject: Subject, aspect: float, lower: Array, upper: Array) -> Picture:
    """Draw one representation on a page of its own: there is nothing to compare it with."""
    [kind] = subject.kinds
    height = _height(ROOM_FOR_ALL, aspect, cap=HIGHEST)
    box = Box(BORDER, TITLE_HEIGHT, ROOM_FOR_ALL, height, "none")
    page = TITLE_HEIGHT + height + BORDER
    items: list[Item] = [
        Box(0, 0, WIDTH, page, PAPER),
        *_head(subject),
        panel(subject, kind, box, lower, upper, alone=True),
    ]
    return Picture(WIDTH, page, subject.title, _describe(subject), tuple(items))


def _grid(count: int, columns: int, aspect: float) -> list[Box]:
    """Return the boxes of the panels, row by row."""
    width = (ROOM_FOR_ALL - (columns - 1) * GAP) / columns
    height = _height(width, aspect, cap=460.0 if columns > 1 else HIGHEST)
    return [
        Box(
            BORDER + (number % columns) * (width + GAP),
            TITLE_HEIGHT + (number // columns) * (height + GAP),
            width,
            height,
            "none",
        )
        for number in range(count)
    ]


def _beside(y: float, aspect: float, listed: float, magnify: bool) -> tuple[Box, Box, Box | None]:
    """Put the deviations, and below them the magnified place, at the right of the overlay."""
    side = (ROOM_FOR_ALL - 2 * GAP) / 3
    width = ROOM_FOR_ALL - side - GAP
    least = listed + (GAP + MAGNIFIED if magnify else 0.0)
    height = max(_height(width, aspect, cap=HIGHEST), least)
    x = BORDER + width + GAP
    large = Box(BORDER, y, width, height, "none")
    if not magnify:
        return large, Box(x, y, side, height, "none"), None
    rest = Box(x, y + listed + GAP, side, height - listed - GAP, "none")
    return large, Box(x, y, side, listed, "none"), rest


def _below(y: float, aspect: float, listed: float, magnify: bool) -> tuple[Box, Box, Box | None]:
    """Put the deviations, and beside them the magnified place, under the overlay."""
    height = _height(ROOM_FOR_ALL, aspect, cap=HIGHEST)
    large = Box(BORDER, y, ROOM_FOR_ALL, height, "none")
    y += height + GAP
    low = max(listed, MAGNIFIED if magnify else 0.0)
    if not magnify:
        return large, Box(BORDER, y, ROOM_FOR_ALL, low, "none"), None
    half = (ROOM_FOR_ALL - GAP) / 2
    left, right = BORDER, BORDER + half + GAP
    return large, Box(left, y, half, low, "none"), Box(right, y, half, low, "none")


def _height(width: float, aspect: float, cap: float) -> float:
    drawing = (width - 2 * (MARGIN + ROOM)) / aspect
    return HEAD + FOOT + 2 * ROOM + float(np.clip(drawing, LOWEST, cap))


def _head(subject: Subject) -> list[Item]:
    tolerances = sorted({curve.tolerance for curve in subject.curves})
    epsilon = " and ".join(f"{tolerance:g}" for tolerance in tolerances[:4])
    edits = f"after {subject.edits} edits" if subject.edits != 1 else "after one edit"
    alone = len(subject.kinds) == 1
    within = "the others" if alone else "each other"
    line = (
        f"{_many(len(subject.kinds), 'representation')} of "
        f"{'one curve' if len(subject.curves) == 1 else f'{len(subject.curves)} curves'}"
        f"{', ' + edits if subject.edits else ''}, within "
        f"\N{GREEK SMALL LETTER EPSILON} = {epsilon} of {within} for all t"
    )
    return [
        Text(BORDER + 2, 50, subject.title, TITLE, INK, bold=True),
        Text(BORDER + 2, 74, line, BODY + 1, MUTED),
        Text(WIDTH - BORDER - 2, 74, "multirep", BODY + 1, MUTED, "end"),
    ]


def _many(count: int, what: str) -> str:
    words = ("no", "one", "two", "three", "four", "five")
    number = words[count] if count < len(words) else str(count)
    return f"{number} {what}{'' if count == 1 else 's'}"


def _describe(subject: Subject) -> str:
    parts = []
    for curve in subject.curves:
        sizes = ", ".join(f"{kind}: {r.size}" for kind, r in curve.representations.items())
        bound = max((d.upper for d in curve.deviations.values()), default=0.0)
        parts.append(
            f"{curve.name} ({sizes}); proved deviation at most {bound:.3g}, "
            f"tolerance {curve.tolerance:g}"
        )
    return ". ".join(parts)
