"""How a stroke joins what stands on either side of it.

The stroke N keeps its shape but for an apron at each end, over which it is blended with what the
standing curve says there, E: ``R = N + (1 - b) (E - N)`` with b rising from 0 to 1 over the apron.
With b flat to order k at both ends, R meets E to order k at the join and N beyond the apron.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

import attrs
import numpy as np

from multirep.arrays import Array
from multirep.strokes.arc_length import angles_between

#: How a stroke joins: the place only, the direction as well, or two derivatives by t.
Join: TypeAlias = Literal["C0", "G1", "C2"]
#: A turn between the last two segments beyond this (radians) is a corner, of which no second
#: derivative can be told.
CORNER = 0.5


@attrs.frozen(eq=False)
class Rim:
    """What stands at an end of the gap: its parameter, place, and two derivatives by t, (d,) each.

    Derivatives are those of the curve outside the gap.
    """

    t: float
    point: Array
    first: Array
    second: Array

    @classmethod
    def of(cls, at: float, point: Array, t: Array, points: Array) -> Rim:
        """Read a rim from the polyline outside.

        Parameters
        ----------
        at : float
            The parameter of the rim.
        point : (d,) array
            The polyline there.
        t, points : (k,) and (k, d) arrays
            The two segments next to the rim, the nearest last (fewer where the curve ends): three
            vertices in the order towards the rim, so ``t`` falls where the gap lies before them.
        """
        slopes = (points[1:] - points[:-1]) / (t[1:] - t[:-1])[:, None]
        zero = np.zeros_like(point)
        if len(slopes) < 2 or angles_between(slopes[:1], slopes[1:])[0] > CORNER:
            return cls(at, point, slopes[-1], zero)
        middles = (t[1:] + t[:-1]) / 2
        second = (slopes[1] - slopes[0]) / (middles[1] - middles[0])
        return cls(at, point, slopes[1] + (at - middles[1]) * second, second)

    @property
    def direction(self) -> Array:
        """The unit tangent, towards increasing t; 0 where the curve rests."""
        largest = float(np.abs(self.first).max())
        if largest == 0.0:
            return self.first
        scaled = self.first / largest
        unit: Array = scaled / np.linalg.norm(scaled)
        return unit


def smoothstep(x: Array, order: int) -> Array:
    """Rise from 0 at 0 to 1 at 1, with ``order`` (1 or 2) derivatives 0 at both; constant outside.

    Examples
    --------
    >>> smoothstep(np.array([-1.0, 0.5, 2.0]), 2)
    array([0. , 0.5, 1. ])
    """
    x = np.clip(x, 0.0, 1.0)
    if order == 1:
        cubic: Array = x * x * (3 - 2 * x)
        return cubic
    quintic: Array = x * x * x * (10 + x * (6 * x - 15))
    return quintic


def apron_in_t(rim: Rim, length: float, apron: float, join: Join) -> float:
    """Length of an apron in the parameter.

    Parameters
    ----------
    rim : Rim
    length : float
        In the parameter, what the stroke takes for the apron.
    apron : float
        Its length along the stroke.
    join : Join
        For "C2" the standing curve, continued by its derivatives, must not go farther than the
        apron either: the shorter of the two decides.

    Examples
    --------
    >>> rim = Rim(0.0, np.zeros(2), np.array([4.0, 0.0]), np.zeros(2))
    >>> apron_in_t(rim, 0.5, 1.0, "G1"), apron_in_t(rim, 0.5, 1.0, "C2")
    (0.5, 0.25)
    """
    if join != "C2":
        return length
    speed, bend = float(np.linalg.norm(rim.first)), float(np.linalg.norm(rim.second)) / 2
    length = min(length, apron / speed) if speed > 0 else length
    return min(length, float(np.sqrt(apron / bend))) if bend > 0 else length


def blended(
    t: Array, s: Array, points: Array, rim: Rim, apron: float, join: Join, *, at_start: bool
) -> Array:
    """Bend one end of a stroke so that it joins its rim.

    Parameters
    ----------
    t, s : (m,) arrays
        Parameters of the stations, and the length along the stroke from the rim up to each.
    points : (m, d) array
        The stroke there.
    rim : Rim
    apron : float
        Its length in t.
    join : {"C0", "G1", "C2"}
        "C0" moves the stroke's end to the rim and keeps its direction there; "G1" makes it leave in
        the direction of the rim, at its own speed; "C2" with the first and second derivative by t.
    at_start : bool
        Whether the rim is where the stroke begins.

    Returns
    -------
    (m, d) array
    """
    sign = 1.0 if at_start else -1.0
    away = sign * (t - rim.t)
    fade = 1.0 - smoothstep(away / apron, 2 if join == "C2" else 1)[:, None]
    if join == "C0" or (join == "G1" and not rim.direction.any()):
        shift = rim.point - points[0 if at_start else -1]
        moved: Array = points + fade * shift
        return moved
    if join == "G1":
        # where the stroke turns away, the continuation slows down, or it would overshoot
        inside = away <= apron
        leaves = (points[inside][-1] - rim.point) if at_start else (rim.point - points[inside][0])
        aligned = 1.0 - np.clip(_cosine(rim.direction, leaves), 0.0, 1.0)
        reach = float(s[inside].max())
        travelled = s - aligned * s * s / reach if reach > 0 else s
        standing = rim.point + sign * travelled[:, None] * rim.direction
    else:
        tau = (t - rim.t)[:, None]
        standing = rim.point + tau * (rim.first + tau / 2 * rim.second)
    bent: Array = np.where(fade > 0, points + fade * (standing - points), points)
    return bent


def _cosine(unit: Array, vector: Array) -> float:
    length = float(np.linalg.norm(vector))
    return float(unit @ vector) / length if length > 0 else 1.0
