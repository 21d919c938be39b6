"""A place on a curve: a parameter, or the point nearest to given coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from attrs import field, frozen
from attrs.converters import optional
from attrs.validators import optional as or_none

from multirep.errors import EditError
from multirep.fields import as_point, finite_number, finite_point
from multirep.representation import Representation
from multirep.tool import Tool

R = TypeVar("R", bound=Representation)


@frozen
class PlacedTool(Tool[R]):
    """A tool that takes a place on the curve, as ``t = 0.37`` or as ``at = [x, y]``.

    The fields of a tool that inherits from it come after these two.

    Parameters
    ----------
    t : float, optional
        Which point of the curve. Either this or ``at``.
    at : tuple of float, optional
        The point of the curve nearest to this.

    Examples
    --------
    >>> from multirep.representations import Polyline
    >>> from multirep.tools import Sweep
    >>> Sweep(at=[3, 5], to=[3, 6], level=2).place(Polyline([0, 1], [[0, 0], [4, 0]]))
    0.75
    """

    t: float | None = field(
        default=None, converter=optional(float), validator=or_none(finite_number)
    )
    """Which point of the curve."""
    at: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=or_none(finite_point)
    )
    """The point of the curve nearest to this."""

    def place(self, curve: R) -> float:
        """Return the parameter that is meant on ``curve``; see :func:`locate`."""
        return locate(curve, self.t, self.at)


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
