"""Write a picture as SVG text: a plain string writer, the same bytes for the same picture."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import numpy as np

from multirep.arrays import Array
from multirep.drawing.picture import Box, Group, Item, Lines, Marks, Picture

#: Digits after the point: a hundredth of a pixel is finer than any screen shows.
DIGITS = 2
THIN = "\N{THIN SPACE}"
#: The first that the viewer has.
FONT = "Inter, 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif"


def to_svg(picture: Picture) -> str:
    r"""Return the picture as the text of an SVG file.

    Examples
    --------
    >>> from multirep.drawing.picture import Text
    >>> text = Text(1, 2, "<x>", 8, "#000")
    >>> print("\n".join(to_svg(Picture(9, 9, "a & b", "", (text,))).splitlines()[1:]))
    <title>a &amp; b</title>
    <text x="1" y="2" font-size="8" fill="#000">&lt;x&gt;</text>
    </svg>
    """
    w, h = _number(picture.width), _number(picture.height)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}" '
        f'role="img" font-family="{FONT}">',
        f"<title>{_text(picture.title)}</title>",
    ]
    if picture.description:
        lines.append(f"<desc>{_text(picture.description)}</desc>")
    clips: list[Box] = []
    body = [line for item in picture.items for line in _item(item, clips)]
    for number, clip in enumerate(clips):
        lines.append(f'<clipPath id="clip{number}">{_rect(clip)}/></clipPath>')
    return "\n".join([*lines, *body, "</svg>", ""])


def _item(item: Item, clips: list[Box]) -> Iterator[str]:
    if isinstance(item, Group):
        attributes = f' aria-label="{_text(item.name)}"' if item.name else ""
        if item.clip is not None:
            if item.clip not in clips:
                clips.append(item.clip)
            attributes += f' clip-path="url(#clip{clips.index(item.clip)})"'
        yield f"<g{attributes}>"
        for inner in item.items:
            yield from _item(inner, clips)
        yield "</g>"
    elif isinstance(item, Lines):
        yield _lines(item)
    elif isinstance(item, Marks):
        yield _marks(item)
    elif isinstance(item, Box):
        stroke = "" if item.stroke == "none" else f' stroke="{item.stroke}"'
        yield f'{_rect(item)} fill="{item.fill}"{stroke}/>'
    else:
        anchor = "" if item.anchor == "start" else f' text-anchor="{item.anchor}"'
        weight = ' font-weight="600"' if item.bold else ""
        yield (
            f'<text x="{_number(item.x)}" y="{_number(item.y)}" font-size="{_number(item.size)}" '
            f'fill="{item.fill}"{anchor}{weight}>{_text(item.text)}</text>'
        )


def _lines(item: Lines) -> str:
    data = "".join(_chain(chain) for chain in item.chains)
    extra = "" if item.opacity == 1 else f' stroke-opacity="{_number(item.opacity)}"'
    if item.dash:
        extra += f' stroke-dasharray="{" ".join(map(_number, item.dash))}"'
    return (
        f'<path d="{data}" fill="none" stroke="{item.stroke}" stroke-width="{_number(item.width)}"'
        f' stroke-linejoin="round" stroke-linecap="round"{extra}/>'
    )


def _chain(points: Array) -> str:
    """Relative coordinates in whole hundredths, so that rounding never adds up."""
    if not len(points):
        return ""
    cells = np.rint(np.asarray(points) * 10**DIGITS).astype(np.int64)
    steps = np.diff(cells, axis=0)
    steps = steps[steps.any(axis=1)] if len(steps) else steps
    x, y = cells[0].tolist()
    moves = "".join(f"l{_cell(dx)},{_cell(dy)}" for dx, dy in steps.tolist()) or "h0"
    return f"M{_cell(x)},{_cell(y)}{moves}"


def _marks(item: Marks) -> str:
    r = _number(item.radius)
    d = _number(2 * item.radius)
    shapes = {
        "circle": (f"m-{r},0", f"a{r},{r} 0 1 0 {d},0a{r},{r} 0 1 0 -{d},0z"),
        "square": (f"m-{r},-{r}", f"h{d}v{d}h-{d}z"),
        "diamond": (f"m0,-{r}", f"l{r},{r}l-{r},{r}l-{r},-{r}z"),
    }
    offset, outline = shapes[item.shape]
    cells = np.rint(np.asarray(item.points) * 10**DIGITS).astype(np.int64).tolist()
    data = "".join(f"M{_cell(x)},{_cell(y)}{offset}{outline}" for x, y in cells)
    stroke = (
        ""
        if item.stroke == "none"
        else f' stroke="{item.stroke}" stroke-width="{_number(item.width)}"'
    )
    return f'<path d="{data}" fill="{item.fill}"{stroke}/>'


def _rect(box: Box) -> str:
    radius = f' rx="{_number(box.radius)}"' if box.radius else ""
    return (
        f'<rect x="{_number(box.x)}" y="{_number(box.y)}" width="{_number(box.width)}" '
        f'height="{_number(box.height)}"{radius}'
    )


def _number(value: float) -> str:
    return _cell(round(value * 10**DIGITS))


def _cell(hundredths: int) -> str:
    """Write a whole number of hundredths, shortly: 150 -> "1.5"."""
    whole, part = divmod(abs(hundredths), 10**DIGITS)
    sign = "-" if hundredths < 0 else ""
    fraction = f".{part:0{DIGITS}d}".rstrip("0").rstrip(".")
    return f"{sign}{whole}{fraction}"


def _text(text: str) -> str:
    """Escape; characters that XML does not allow become the replacement character."""
    # str.isprintable() says no to every space but one; the pictures group digits by thin ones
    shown = (c if c.isprintable() or c == THIN else "\N{REPLACEMENT CHARACTER}" for c in text)
    return escape("".join(shown))
