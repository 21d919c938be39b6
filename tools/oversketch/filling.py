"""New vertices for a gap: their parameters, and how they join what stands on either side."""

from __future__ import annotations

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.representations.polyline import Polyline
from multirep.sampled import interpolate
from multirep.spacing import clearance, room, told_apart
from multirep.strokes.arc_length import arc_lengths
from multirep.strokes.blending import Join, Rim, apron_in_t, blended
from multirep.tools.oversketch.gap import Gap

#: The apron over which an end is blended: this part of the stroke, or so many times the distance of
#: its end from the curve if that is longer, but never more than a third.
APRON, APRON_PER_GAP, LONGEST_APRON = 1 / 10, 8.0, 1 / 3
#: Stations in an apron: as close as the curve's vertices beside it, within these limits. With 48 a
#: chord of the blend is off by at most 1/3000 of the apron.
FEWEST, MOST = 48, 1024
#: Largest part of the stroke that may fall between two parameters with no room for more.
LOST = 1e-6


@attrs.frozen(eq=False)
class _Flow:
    """How the stroke runs through the gap: parameters and lengths along it, both non-decreasing."""

    t: Array
    s: Array

    def lengths(self, t: Array) -> Array:
        """Return lengths along the stroke at parameters."""
        return np.interp(t, self.t, self.s)

    def parameters(self, s: Array) -> Array:
        """Return parameters at lengths along the stroke."""
        return np.interp(s, self.s, self.t)


@attrs.frozen(eq=False)
class _Apron:
    """A stretch of ``length`` in t beside a rim, with stations in it."""

    rim: Rim
    length: float
    stations: Array


def fill(
    polyline: Polyline, gap: Gap, drawn: Array, *, join: Join, keep: bool, apron: float | None
) -> Edit[Polyline]:
    """Replace the stretch of a gap by a stroke.

    Parameters
    ----------
    polyline : Polyline
    gap : Gap
    drawn : (n, d) array
        The stroke, in the direction of the curve.
    join : Join
    keep : bool
        Whether the stretch keeps its parameters, with a vertex at each.
    apron : float or None
        Length of stroke over which either end is blended.

    Raises
    ------
    EditError
        When the stretch has too few parameters for the stroke.
    """
    s = arc_lengths(drawn)
    first = polyline.t.searchsorted(gap.start, "right")
    last = polyline.t.searchsorted(gap.stop, "left")
    flow = _flow(polyline, gap, s, first, last, keep)
    aprons = [
        None if free else _apron(polyline, gap, flow, join, apron, at_start=at_start)
        for at_start, free in ((True, gap.free_start), (False, gap.free_stop))
    ]
    t, along = _stations(gap, flow, s, aprons, polyline.t.window(first, last) if keep else None)
    points = interpolate(s, drawn, along)
    for at_start, side in zip((True, False), aprons, strict=True):
        if side is not None:
            rest = along if at_start else s[-1] - along
            points = blended(t, rest, points, side.rim, side.length, join, at_start=at_start)
            points[0 if at_start else -1] = side.rim.point
    # an end on a vertex is there already; a free end takes the place of the old one
    on_first = not gap.free_start and float(polyline.t[first - 1]) == gap.start
    on_last = not gap.free_stop and float(polyline.t[last]) == gap.stop
    inside = slice(int(on_first), len(t) - int(on_last))
    start = 0 if gap.free_start else first
    stop = polyline.size if gap.free_stop else last
    return polyline.replace(start, stop, t[inside], points[inside])


def _flow(polyline: Polyline, gap: Gap, s: Array, first: int, last: int, keep: bool) -> _Flow:
    even = _Flow(np.array([gap.start, gap.stop]), s[[0, -1]])
    if not keep:
        return even
    ends = polyline([gap.start, gap.stop])
    t = np.concatenate([[gap.start], polyline.t.window(first, last), [gap.stop]])
    points = np.concatenate([ends[:1], polyline.points.window(first, last), ends[1:]])
    lengths = arc_lengths(points)
    return _Flow(t, s[-1] * (lengths / lengths[-1])) if lengths[-1] > 0 else even


def _apron(
    polyline: Polyline, gap: Gap, flow: _Flow, join: Join, apron: float | None, *, at_start: bool
) -> _Apron:
    """Lay out one apron: what stands at its rim, how long it is, and where its stations are."""
    total = float(flow.s[-1])
    far = gap.far_start if at_start else gap.far_stop
    length = max(APRON * total, APRON_PER_GAP * far) if apron is None else apron
    length = min(length, LONGEST_APRON * total)
    if at_start:
        k = polyline.t.searchsorted(gap.start)
        low, high, at = max(k - 2, 0), k + 1, gap.start
        inner = float(flow.parameters(np.array([length]))[0]) - at
    else:
        k = polyline.t.searchsorted(gap.stop, "right")
        low, high, at = k - 1, min(k + 2, polyline.size), gap.stop
        inner = at - float(flow.parameters(np.array([total - length]))[0])
    order = slice(None) if at_start else slice(None, None, -1)
    outside = polyline.t.window(low, high)[order]
    rim = Rim.of(at, polyline(at), outside, polyline.points.window(low, high)[order])
    inner = apron_in_t(rim, inner, length, join)
    count = int(np.clip(inner / abs(outside[-1] - outside[-2]), FEWEST, MOST))
    sign = 1.0 if at_start else -1.0
    return _Apron(rim, inner, at + sign * inner * np.linspace(0.0, 1.0, count + 1)[1:])


def _stations(
    gap: Gap, flow: _Flow, s: Array, aprons: list[_Apron | None], kept: Array | None
) -> tuple[Array, Array]:
    """Return increasing parameters from end to end of the gap, and the lengths along the stroke."""
    extra = [side.stations for side in aprons if side is not None]
    if kept is not None:
        extra.append(kept)
    others = np.concatenate([*extra, np.empty(0)])
    others = others[(others > gap.start) & (others < gap.stop)]
    # what must be a vertex goes before the samples of the stroke
    drawn = flow.parameters(s)
    clear = clearance(drawn, np.sort(others)) >= room(gap.start, gap.stop)
    clear[[0, -1]] = True
    t = np.concatenate([drawn[clear], others])
    along = np.concatenate([s[clear], flow.lengths(others)])
    order = t.argsort(kind="stable")
    t, along = t[order], along[order]
    t[0], t[-1] = gap.start, gap.stop
    along[0], along[-1] = 0.0, s[-1]
    chosen = told_apart(t)
    lost = np.abs(np.interp(t, t[chosen], along[chosen]) - along).max()
    if lost > LOST * s[-1]:
        raise EditError(
            f"no parameters are left between t = {gap.start!r} and {gap.stop!r} for the "
            f"{len(s)} vertices of the stroke: draw over a longer stretch, or redistribute "
            "the parameters"
        )
    return t[chosen], along[chosen]
