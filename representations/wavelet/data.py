"""The curve as plain data: level, knots in T, control points."""

from __future__ import annotations

from typing import Any

import numpy as np

from multirep.arrays import Array, frozen_array
from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.representations.wavelet.dyadic import finest_level, parameters
from multirep.representations.wavelet.graded import Graded

__all__ = ["read", "written"]

#: Knots may be off their dyadic places by this many units in the last place of T: others may have
#: rounded otherwise.
_ULPS = 8


def written(curve: Graded) -> dict[str, Any]:
    """Write a curve as ``{"level", "knots", "points"}``.

    Examples
    --------
    >>> curve = Graded.of(Interval(0, 2), np.array([0, 0, 0, 0, 1, 1, 1, 1.0]), np.zeros((4, 1)))
    >>> written(curve)["knots"], read(written(curve)).size
    ([0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0], 4)
    """
    return {
        "level": curve.level,
        "knots": curve.all_knots.tolist(),
        "points": curve.points.tolist(),
    }


def read(data: dict[str, Any]) -> Graded:
    """Read a curve.

    Raises
    ------
    InvalidCurveError
        When something is missing, or the knots are not fourfold at the ends, simple inside and
        dyadic of the level.
    """
    missing = [key for key in ("level", "knots", "points") if key not in data]
    if missing:
        raise InvalidCurveError(f"a wavelet needs {', '.join(map(repr, missing))}")
    level = data["level"]
    if not isinstance(level, int) or isinstance(level, bool) or level < 0:
        raise InvalidCurveError(f"the level must be an integer from 0, got {level!r}")
    knots, points = _numbers(data["knots"], 1, "knots"), _numbers(data["points"], 2, "points")
    count = len(points)
    if count < 4 or len(knots) != count + 4:
        raise InvalidCurveError(
            f"{count} control points need {count + 4} knots, got {len(knots)}; 4 points at least"
        )
    start, stop = float(knots[0]), float(knots[-1])
    if not start < stop or (knots[:4] != start).any() or (knots[-4:] != stop).any():
        raise InvalidCurveError("the first four knots must be equal, and so must the last four")
    domain = Interval(start, stop)
    if level > finest_level(domain):
        raise InvalidCurveError(
            f"the level can be {finest_level(domain)} at most on T = {domain}, got {level}"
        )
    cells = 2.0**level
    u: Array = np.rint((knots - start) / (stop - start) * cells) / cells
    off = np.abs(parameters(u, domain) - knots)
    if (off > _ULPS * np.spacing(max(abs(start), abs(stop)))).any():
        worst = int(off.argmax())
        raise InvalidCurveError(f"knot {worst}, {knots[worst]!r}, is not dyadic of level {level}")
    if not (u[4:-3] > u[3:-4]).all():
        raise InvalidCurveError("interior knots must increase strictly")
    return Graded.of(domain, frozen_array(u), frozen_array(points))


def _numbers(values: Any, ndim: int, what: str) -> Array:
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError):
        raise InvalidCurveError(f"the {what} must be lists of numbers") from None
    if array.ndim != ndim or not array.size or not np.isfinite(array).all():
        raise InvalidCurveError(
            f"the {what} must be finite numbers in {'rows' if ndim == 2 else 'a list'}, "
            f"got the shape {array.shape}"
        )
    return array
