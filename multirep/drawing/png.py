"""Write a picture as PNG, through matplotlib (extra ``plot``)."""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from multirep.drawing.picture import Box, Group, Item, Lines, Marks, Picture, Shape
from multirep.errors import MissingExtraError

#: Page units per inch, as for matplotlib's own sizes; only the ratio to ``scale`` matters.
UNITS_PER_INCH = 100.0
#: matplotlib measures strokes and text in points.
POINTS_PER_UNIT = 72.0 / UNITS_PER_INCH


def to_png(picture: Picture, *, scale: float = 2.0) -> bytes:
    """Return the picture as the bytes of a PNG file.

    Parameters
    ----------
    picture : Picture
    scale : float
        Pixels per page unit.

    Raises
    ------
    MissingExtraError
        When matplotlib is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("PNG pictures", "matplotlib", "plot") from None
    size = picture.width / UNITS_PER_INCH, picture.height / UNITS_PER_INCH
    figure = Figure(figsize=size, dpi=UNITS_PER_INCH * scale)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(0, picture.width)
    axes.set_ylim(picture.height, 0)
    axes.set_axis_off()
    for order, (item, clip) in enumerate(_flat(picture.items, None)):
        _draw(axes, item, clip, order)
    stream = io.BytesIO()
    write: Any = canvas.print_png  # matplotlib leaves it untyped
    write(stream, metadata={"Software": None})
    return stream.getvalue()


def _flat(items: tuple[Item, ...], clip: Box | None) -> list[tuple[Shape, Box | None]]:
    """Resolve groups; the innermost clip counts (clips are nested here)."""
    flat: list[tuple[Shape, Box | None]] = []
    for item in items:
        if isinstance(item, Group):
            flat += _flat(item.items, item.clip or clip)
        else:
            flat.append((item, clip))
    return flat


def _draw(axes: Any, item: Shape, clip: Box | None, order: int) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import FancyBboxPatch, Rectangle

    artist: Any
    if isinstance(item, Lines):
        width = item.width * POINTS_PER_UNIT
        dash = (0, [length / item.width for length in item.dash]) if item.dash else "solid"
        artist = LineCollection(
            [np.asarray(chain) for chain in item.chains],
            colors=item.stroke, linewidths=width, alpha=item.opacity, linestyles=[dash],
            capstyle="round", joinstyle="round",
        )  # fmt: skip
        axes.add_collection(artist, autolim=False)
    elif isinstance(item, Marks):
        area = (2 * item.radius * POINTS_PER_UNIT) ** 2
        shape = {"circle": "o", "square": "s", "diamond": "D"}[item.shape]
        points = np.asarray(item.points).reshape(-1, 2)
        artist = axes.scatter(
            points[:, 0], points[:, 1], area, item.fill, marker=shape,
            edgecolors=item.stroke, linewidths=item.width * POINTS_PER_UNIT,
        )  # fmt: skip
    elif isinstance(item, Box):
        corner = (item.x, item.y)
        look: dict[str, Any] = {
            "facecolor": item.fill,
            "edgecolor": item.stroke,
            "linewidth": POINTS_PER_UNIT,
        }
        if item.radius:
            style = f"round,pad=0,rounding_size={item.radius}"
            artist = FancyBboxPatch(corner, item.width, item.height, boxstyle=style, **look)
        else:
            artist = Rectangle(corner, item.width, item.height, **look)
        axes.add_patch(artist)
    else:
        align = {"start": "left", "middle": "center", "end": "right"}[item.anchor]
        artist = axes.text(
            item.x, item.y, item.text.replace("$", r"\$"), fontsize=item.size * POINTS_PER_UNIT,
            color=item.fill, ha=align, va="baseline", fontweight="bold" if item.bold else "normal",
        )  # fmt: skip
    artist.set_zorder(order)
    if clip is not None:
        artist.set_clip_path(
            Rectangle((clip.x, clip.y), clip.width, clip.height, transform=axes.transData)
        )
