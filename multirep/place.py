"""A place on a curve: a parameter, or the point nearest to given coordinates."""

from __future__ import annotations

from collections.abc import Sequence

from multirep.errors import EditError
from multirep.representation import Representation


def locate(curve: Representation, t: float | None, at: Sequence[float] | None) -> float:
    """Return the parameter that a tool's ``t`` or ``at`` means on ``curve``.

    Exactly one of the two must be given; ``at`` means the nearest place.

    Raises
    ------
    EditError
        When none or both are given.
    ParameterError
        When ``t`` lies outside the domain.
    """
    if (t is None) == (at is None):
        found = "neither" if t is None else "both"
        raise EditError(f"give the place either as t = 0.37 or as at = [x, y]; got {found}")
    if t is not None:
        return float(curve.parameters(t))
    assert at is not None
    return float(curve.nearest(at).t)
