"""What a tool asks for at one place of the curve, so that constraints can heed or oppose it."""

from __future__ import annotations

import attrs


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

    Examples
    --------
    >>> Aim(0.25, (1, 2))
    Aim(t=0.25, point=(1.0, 2.0), left=None, right=None)
    """

    t: float
    point: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
    left: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
    right: tuple[float, ...] | None = attrs.field(default=None, converter=_point)
