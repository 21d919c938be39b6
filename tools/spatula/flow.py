"""From sand back to a polyline: parameters of new vertices, and the windows that changed."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import EditError
from multirep.tools.spatula.sand import Mask, Sand

#: A new vertex gets its parameter in proportion to the length between its neighbours that have one;
#: when that makes the curve run this many times faster somewhere than on average over the pushed
#: stretch, the parameters of the whole stretch are spread in proportion instead. Larger keeps more
#: parameters of pushed vertices; smaller keeps the speed more even, which the splines that follow
#: need.
FASTEST = 2.0
#: Shortest segment in terms of a stretch, for its share of the parameters: points may coincide.
SHORTEST = 2.0**-20


@attrs.frozen(eq=False)
class Window:
    """Vertices ``start`` .. ``stop`` - 1 of the polyline become others."""

    start: int
    stop: int
    t: Array
    points: Array


def windows(sand: Sand) -> list[Window]:
    """Return what changed in the polyline, window by window, in order.

    A window begins and ends beside vertices that were not touched, or at an end of the curve. New
    vertices on untouched segments are dropped again.

    Raises
    ------
    EditError
        When there are not enough numbers between two parameters.
    """
    touched = sand.moved.copy()
    touched[1:] |= sand.moved[:-1] & ~sand.ends[:-1]
    touched[:-1] |= sand.moved[1:] & ~sand.ends[:-1]
    kept = np.flatnonzero((sand.source >= 0) | touched)
    source, moved = sand.source[kept], sand.moved[kept]
    points, t = sand.points[kept], sand.t[kept]
    follows = np.zeros(len(kept), dtype=bool)  # whether a segment leads here from the row before
    if len(kept):
        ends = np.add.accumulate(sand.ends)[kept]
        follows[1:] = ends[1:] - sand.ends[kept][1:] == ends[:-1] - sand.ends[kept][:-1]
    plain = (source >= 0) & ~moved
    found = []
    for first, last in _groups(source, plain, follows):
        low, high = first + int(plain[first]), last - int(plain[last])
        rows = slice(first, last + 1)
        spread = _parameters(t[rows], points[rows], moved[rows])
        # an end that is not plain is a pushed end of the curve, and belongs to the window
        start = int(source[first]) + int(plain[first])
        stop = int(source[last]) + 1 - int(plain[last])
        found.append(
            Window(start, stop, spread[low - first : high - first + 1], points[low : high + 1])
        )
    return found


def _groups(source: Indices, plain: Mask, follows: Mask) -> list[tuple[int, int]]:
    """Return (first, last) rows of what lies between untouched neighbours, these included."""
    step = np.zeros(
        len(source), dtype=bool
    )  # whether the segment from the row before is an old one
    step[1:] = plain[1:] & plain[:-1] & (source[1:] == source[:-1] + 1)
    changed = follows & ~step
    # rows of one group: a segment that changed leads from each to the next
    begins = np.flatnonzero(changed[1:] & (~changed[:-1] | plain[:-1]))
    stops = np.flatnonzero(changed & np.append(~changed[1:] | plain[:-1], True))
    return list(zip(begins.tolist(), stops.tolist(), strict=True))


def _parameters(t: Array, points: Array, moved: Mask) -> Array:
    """Give all vertices of a window parameters; vertices that were not pushed keep theirs."""
    result = t.copy()
    fixed = ~moved
    fixed[0] = fixed[-1] = True  # a pushed end of the curve keeps its parameter, too
    marks = np.flatnonzero(fixed)
    for k in np.flatnonzero(marks[1:] - marks[:-1] > 1).tolist():
        run = slice(int(marks[k]), int(marks[k + 1]) + 1)
        result[run] = _spread(t[run], points[run])
    return result


def _spread(t: Array, points: Array) -> Array:
    """Give the vertices between two that stay parameters, in proportion to length where new."""
    steps = points[1:] - points[:-1]
    lengths = np.sqrt(np.einsum("ij,ij->i", steps, steps))
    lengths = np.maximum(lengths, SHORTEST * lengths.sum())
    along = np.concatenate([[0.0], lengths.cumsum()])
    known = np.isfinite(t)
    result = np.where(known, t, np.interp(along, along[known], t[known]))
    share = (t[-1] - t[0]) * lengths / along[-1]
    if (FASTEST * (result[1:] - result[:-1]) < share).any():
        result = t[0] + (t[-1] - t[0]) * (along / along[-1])
        result[-1] = t[-1]
    room = 8 * np.spacing(max(abs(t[0]), abs(t[-1])))
    if not (result[1:] - result[:-1] >= room).all():
        raise EditError(
            f"no parameters are left between t = {t[0]!r} and {t[-1]!r} for {len(t) - 2} vertices: "
            "this stretch of the curve has been pulled too long"
        )
    return result
