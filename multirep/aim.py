"""What a tool asks for at one place of the curve, so that constraints can heed or oppose it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import attrs
import numpy as np

if TYPE_CHECKING:
    from multirep.representation import Representation

#: A derivative differs from what a tool asked for when it is off by more than this part.
TURNED = 1e-6


def _point(values: object) -> tuple[float, ...] | None:
    return None if values is None else tuple(float(value) for value in values)  # type: ignore[attr-defined]


@attrs.frozen
class Aim:
    """A place on T that an edit is about and, optionally, what the curve shall do there.

    Constraints that re-establish themselves after the edit keep what an aim says if they can. If
    they cannot, the edit is rejected: a tool never reports done what a constraint has undone.

    Parameters
    ----------
    t : float
    point : sequence of float, optional
        Where the curve shall pass at ``t``.
    left, right : sequence of float, optional
        Its derivatives by t from the left and from the right.
    smooth : bool
        Whether both shall be the same.

    Examples
    --------
    >>> Aim(0.25, (1, 2))
    Aim(t=0.25, point=(1.0, 2.0), left=None, right=None, smooth=False)
    """

    t: float
    point: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
    left: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
    right: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
    smooth: bool = False


def misses(aim: Aim, value: Representation) -> float:
    """How far a curve passes the point of an aim; 0 when it names none."""
    if aim.point is None:
        return 0.0
    return float(np.linalg.norm(value(aim.t) - np.asarray(aim.point)))


def turns(aim: Aim, value: Representation) -> float:
    """How far the derivatives are from those of an aim, in terms of their size; 0 for none."""
    if not (aim.left or aim.right or aim.smooth):
        return 0.0
    try:
        left, right = (value.derivative(aim.t, side=side) for side in ("left", "right"))
    except NotImplementedError:  # it has none: nothing is held against it
        return 0.0
    wanted = [(left, aim.left), (right, aim.right)] + [(left, right)] * aim.smooth
    worst = 0.0
    for found, goal in wanted:
        if goal is not None:
            off = float(np.linalg.norm(found - np.asarray(goal)))
            size = float(np.linalg.norm(found) + np.linalg.norm(goal))
            worst = max(worst, off / size if off else 0.0)
    return worst
