"""Beside the curves: the deviation of every pair, and where it is largest, magnified."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from multirep.arrays import Array
from multirep.drawing.cards import MARGIN, card, overlaid
from multirep.drawing.frame import Frame, flatten
from multirep.drawing.palette import BODY, CARD, EDGE, FAINT, HEADING, INK, MUTED, SMALL, hue
from multirep.drawing.picture import Box, Group, Item, Lines, Marks, Text
from multirep.drawing.subject import CurveSubject, Subject
from multirep.interval import Interval

#: Height of the row of a pair, of the head above the first one, and of the title of a curve.
ROW, TOP, NAME = 46.0, 62.0, 26.0
#: More rows than this are not drawn; the report has them all.
MOST_ROWS = 12
#: Half the magnified square, in tolerances, and the parameters at which one looks for the largest
#: distance.
WINDOW, LOOKS = 1.6, 4001


def table_height(subject: Subject) -> float:
    """Return how much room the table of deviations takes."""
    rows = sum(len(curve.deviations) for curve in subject.curves)
    names = len(subject.curves) if len(subject.curves) > 1 else 0
    return TOP + min(rows, MOST_ROWS) * ROW + min(names, MOST_ROWS) * NAME + MARGIN


def farthest(subject: Subject) -> tuple[CurveSubject, float] | None:
    """Return a curve and a parameter at which its representations are far apart, in tolerances."""
    best, found = 0.0, None
    for curve in subject.curves:
        if len(curve.representations) < 2:
            continue
        domain = next(iter(curve.representations.values())).domain
        t = np.linspace(domain.start, domain.stop, LOOKS)
        values = [representation(t) for representation in curve.representations.values()]
        for one, two in combinations(values, 2):
            apart = np.linalg.norm(one - two, axis=1) / curve.tolerance
            k = int(apart.argmax())
            if apart[k] > best:
                best, found = float(apart[k]), (curve, float(t[k]))
    return found


def table(subject: Subject, box: Box) -> Group:
    """Draw a bar for each pair: the tolerance is its length, proved and seen deviation fill it."""
    items: list[Item] = [
        card(box),
        Text(box.x + MARGIN, box.y + 31.5, "proved deviation", HEADING, INK, bold=True),
        Text(box.x + box.width - MARGIN, box.y + 31, "for all t", BODY, MUTED, "end"),
    ]
    y, rows = box.y + TOP, 0
    for curve in subject.curves:
        if rows >= MOST_ROWS:
            break
        if len(subject.curves) > 1:
            items.append(Text(box.x + MARGIN, y + 8, curve.name, BODY, INK, bold=True))
            y += NAME
        for (one, two), deviation in curve.deviations.items():
            if rows >= MOST_ROWS:
                break
            rows += 1
            items.append(Text(box.x + MARGIN, y + 4, f"{one} \N{EN DASH} {two}", BODY, INK))
            numbers = f"seen {deviation.lower:.3g} · proved \u2264 {deviation.upper:.3g}"
            items.append(Text(box.x + box.width - MARGIN, y + 4, numbers, SMALL, MUTED, "end"))
            items += _bar(box, y + 12, deviation.lower, deviation.upper, curve.tolerance)
            y += ROW
    return Group(tuple(items), name="deviations")


def _bar(box: Box, y: float, lower: float, upper: float, tolerance: float) -> list[Item]:
    left, room = box.x + MARGIN, box.width - 2 * MARGIN - 26
    seen, proved = (room * min(value / tolerance, 1.0) for value in (lower, upper))
    return [
        Box(left, y, room, 9.0, EDGE, radius=4.5),
        Box(left, y, max(proved, 9.0), 9.0, FAINT, radius=4.5),
        Box(left, y, max(seen, 9.0), 9.0, INK, radius=4.5),
        Text(left + room + 8, y + 8.5, "\N{GREEK SMALL LETTER EPSILON}", BODY, INK),
    ]


def magnifier(subject: Subject, box: Box, look_at: tuple[CurveSubject, float] | None) -> Group:
    """Draw the place where the representations are farthest apart."""
    if look_at is None:
        return Group((), name="magnified")
    curve, t = look_at
    at = np.array([t])
    points = [representation(at) for representation in curve.representations.values()]
    flat = np.concatenate([flatten(at, point, y_up=subject.y_up) for point in points])
    middle = flat.mean(axis=0)
    half = WINDOW * curve.tolerance
    inner = Box(
        box.x + MARGIN,
        box.y + 46,
        box.width - 2 * MARGIN,
        box.height - 46 - MARGIN,
        CARD,
        EDGE,
        6.0,
    )
    reach = np.array([inner.width, inner.height]) / min(inner.width, inner.height) * half
    frame = Frame(inner, middle - reach, middle + reach)
    interval = _around(curve, t, 2.5 * float(np.linalg.norm(reach)))
    items: list[Item] = [inner]
    drawn = overlaid(curve, subject, frame, interval, (7.0, 5.0, 3.0))
    dots: list[Item] = [Lines((frame(flat),), INK, 1.2, dash=(2.0, 3.0))]
    for kind, page in zip(curve.representations, frame(flat), strict=True):
        dots.append(Marks(page[None], "circle", 4.2, hue(kind, subject.kinds)[0], CARD, 1.4))
    bar = curve.tolerance * frame.scale
    x, y = inner.x + 16, inner.y + inner.height - 16
    scale_bar = np.array([[x, y - 5], [x, y], [x + bar, y], [x + bar, y - 5]])
    items += [
        Group((*drawn, *dots), clip=inner),
        Lines((scale_bar,), INK, 1.5),
        Text(
            x + bar / 2,
            y - 8,
            f"\N{GREEK SMALL LETTER EPSILON} = {curve.tolerance:g}",
            SMALL,
            INK,
            "middle",
        ),
    ]
    return Group(
        (
            card(box),
            Text(box.x + MARGIN, box.y + 31.5, "where they differ most", HEADING, INK, bold=True),
            Text(box.x + box.width - MARGIN, box.y + 31, f"dots: t = {t:.4g}", BODY, MUTED, "end"),
            *items,
        ),
        name="magnified",
    )


def _around(curve: CurveSubject, t: float, distance: float) -> Interval:
    """Return an interval around t that leaves a circle of that radius, or reaches the ends."""
    representation = next(iter(curve.representations.values()))
    domain = representation.domain
    center: Array = representation(np.array([t]))
    width = 1e-9 * domain.length
    while width < domain.length:
        ends = np.clip([t - width, t + width], domain.start, domain.stop)
        away = np.linalg.norm(representation(ends) - center, axis=1)
        inside = (away < distance) & (ends > domain.start) & (ends < domain.stop)
        if not inside.any():
            return Interval(float(ends[0]), float(ends[1]))
        width *= 1.5
    return domain
