"""Colours and sizes of the drawings, in one place.

The three hues are far apart for all common kinds of colour blindness (Okabe-Ito order: blue,
vermilion, green), and the overlay also tells the curves apart by width.
"""

from __future__ import annotations

PAPER = "#f5f3ee"
CARD = "#ffffff"
EDGE = "#e4e0d8"
INK = "#23262d"
MUTED = "#6f747f"
FAINT = "#c3c7cf"
#: Where the curve was changed; a highlighter under the line.
CHANGED = "#ffe08a"
#: Under a frozen stretch; and where the pen went.
ICE, PENCIL = "#bfdcf2", "#8d8f96"

#: Line and pale colour of each representation, in the order they are met; further ones start again.
HUES = (
    ("#2563a8", "#9cc4ec"),
    ("#c2500d", "#f6b98d"),
    ("#0b7a63", "#7fd1bd"),
    ("#7a3fa0", "#cba9e0"),
    ("#8a6a10", "#e3cb86"),
)
#: The built-in representations keep their hue whatever else is shown.
OWN_HUE = {"polyline": 0, "nurbs": 1, "wavelet": 2}
#: From the coarsest to the finest level.
LEVELS = ("#f2b705", "#7cc15a", "#2aa58a", "#1d7799", "#37457f", "#3c1a55")

TITLE, HEADING, BODY, SMALL = 27.0, 16.5, 13.5, 12.0


def hue(name: str, names: tuple[str, ...]) -> tuple[str, str]:
    """Return the line and the pale colour of a representation among those that are shown."""
    if name in OWN_HUE:
        return HUES[OWN_HUE[name]]
    others = [other for other in names if other not in OWN_HUE]
    return HUES[(len(OWN_HUE) + others.index(name)) % len(HUES)]


def level_colour(level: int, levels: range) -> str:
    """Return the colour of a wavelet level, spread over the levels that occur."""
    if len(levels) <= 1:
        return LEVELS[2]
    share = (level - levels.start) / (len(levels) - 1) * (len(LEVELS) - 1)
    k = min(int(share), len(LEVELS) - 2)
    return _mix(LEVELS[k], LEVELS[k + 1], share - k)


def _mix(a: str, b: str, share: float) -> str:
    channels = zip(bytes.fromhex(a[1:]), bytes.fromhex(b[1:]), strict=True)
    return "#" + "".join(f"{round((1 - share) * x + share * y):02x}" for x, y in channels)
