"""Corners of the NURBS: making, turning, moving and removing them."""

from __future__ import annotations

from typing import Literal

import numpy as np
from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.aim import Aim
from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import as_point, finite_point
from multirep.interval import Interval
from multirep.place import PlacedTool
from multirep.representations.nurbs import Nurbs
from multirep.scene import Scene
from multirep.splices import SpliceList

#: A parameter this close to a corner, in terms of T, is that corner: two knots closer than that
#: would leave no room for a curve between them.
SAME_PLACE = 1e-9
#: A point ``at`` whose nearest place is this close to a corner means that corner, as a click on its
#: base point would (half a per cent of the curve).
CLICK = 1 / 256
#: How far to both sides a removed corner is smoothed, in terms of T: at most this, at most half way
#: to the next corner, not into what is frozen.
APRON = 1 / 32
#: How closely the smooth piece is followed, in terms of the tolerance of the curve ...
CLOSENESS = 1 / 8
#: ... or, outside a session, in terms of the size of the piece.
ALONE = 1e-4


@frozen
class Corner(PlacedTool[Nurbs]):
    """Make, turn, move or remove a corner (Grimm-Ayers 5.1.1).

    The knot at the corner gets full multiplicity, so the curve may arrive with one derivative and
    leave with another; the three control points there are the base point and the ends of the two
    tangents. The corner is a ``break`` for the other representations, which follow it within the
    tolerance. Use the constraint ``corner`` to keep it through later edits.

    Parameters
    ----------
    t : float, optional
        The parameter of the corner.
    at : tuple of float, optional
        Instead of ``t``: the place on the curve nearest to it, or the corner beside that place.
    left : tuple of float, optional
        Derivative by t with which the curve arrives; as it is without it.
    right : tuple of float, optional
        Derivative by t with which the curve leaves; as it is without it.
    to : tuple of float, optional
        Where the base point goes; the tangents go with it.
    remove : bool
        Take the corner away: the curve is smooth (C2) on an apron of T/32 to both sides, less where
        another corner, a frozen stretch or an end of T is closer.

    Examples
    --------
    >>> line = Nurbs(degree=3, knots=[0, 0, 0, 0, 1, 1, 1, 1],
    ...              points=[[0, 0], [1, 0], [2, 0], [3, 0]])
    >>> roof = Corner(t=0.5, left=(3, 3), right=(3, -3)).edit(line, Scene()).value
    >>> roof.derivative(0.5, side="left"), roof.derivative(0.5)
    (array([3., 3.]), array([ 3., -3.]))
    >>> smooth = Corner(t=0.5, remove=True).edit(roof, Scene())
    >>> smooth.value.sample(line.domain, tolerance=1e-3).breaks
    ()
    """

    name = "corner"
    edits = Nurbs

    left: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t with which the curve arrives."""
    right: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Derivative by t with which the curve leaves."""
    to: tuple[float, ...] | None = field(
        default=None, converter=optional(as_point), validator=validators.optional(finite_point)
    )
    """Where the base point goes."""
    remove: bool = field(default=False, validator=validators.instance_of(bool))
    """Take the corner away."""

    def __attrs_post_init__(self) -> None:
        if self.remove and not (self.left is self.right is self.to is None):
            raise ValueError("'remove' goes without 'left', 'right' and 'to'")

    def place(self, curve: Nurbs) -> float:
        """Return the parameter that is meant.

        Raises
        ------
        EditError
            At an end of T, where the curve has one side only.
        """
        t = super().place(curve)
        near = SAME_PLACE if self.at is None else CLICK
        t = _nearest_corner(curve, t, near * curve.domain.length)
        if not curve.domain.start < t < curve.domain.stop:
            raise EditError(f"a corner lies between two sides; t = {t!r} is an end of the curve")
        return t

    def aims(self, curve: Nurbs) -> tuple[Aim, ...]:
        """Return the base point and the tangents that are asked for."""
        t = self.place(curve)
        if self.remove:
            return (Aim(t, smooth=True),)
        point = tuple(curve(t).tolist()) if self.to is None else self.to
        return (Aim(t, point, self.left, self.right),)

    def edit(self, curve: Nurbs, scene: Scene) -> Edit[Nurbs]:
        """Return the curve with the corner as asked for.

        Raises
        ------
        EditError
            When there is no corner to remove, or no room for one.
        """
        t = self.place(curve)
        if self.remove:
            return _smoothed(curve, t, scene)
        missing = curve.degree - _multiplicity(curve, t)
        edit = curve.insert_knots([t] * missing)
        turned = self._turned(edit.value, t)
        return Edit(turned.value, edit.splices | turned.splices)

    def _turned(self, curve: Nurbs, t: float) -> Edit[Nurbs]:
        """Place the base point and the tangents; the knot at ``t`` is p-fold."""
        for given in (self.left, self.right, self.to):
            if given is not None and len(given) != curve.dimension:
                raise EditError(f"expected {curve.dimension} coordinates, got {list(given)}")
        first = curve.knots.searchsorted(t)
        base = first - 1
        points = curve.points.window(base - 1, base + 2).copy()
        weights = curve.weights.window(base - 1, base + 2)
        knots = curve.knots
        spans = (t - float(knots[first - 1]), float(knots[first + curve.degree]) - t)
        if self.to is not None:
            points += np.asarray(self.to) - points[1]
        # C'(t -+) = +-(w_1 / w_0) p / h (P_0 - P_1), P_0 the base point and h the span beside
        for side, sign, given in ((0, -1, self.left), (2, 1, self.right)):
            if given is not None:
                length = spans[side // 2] / curve.degree * float(weights[1] / weights[side])
                points[side] = points[1] + sign * length * np.asarray(given)
        return curve.move_control_points(base - 1, points)


def _multiplicity(curve: Nurbs, t: float) -> int:
    knots = curve.knots
    return int(knots.searchsorted(t, "right") - knots.searchsorted(t))


def _nearest_corner(curve: Nurbs, t: float, near: float) -> float:
    """Return the corner within ``near`` of ``t`` that is closest to it, or ``t`` itself."""
    found = _corners(curve, Interval(t - near, t + near))
    return float(found[np.abs(found - t).argmin()]) if len(found) else t


def _corners(curve: Nurbs, within: Interval) -> Array:
    """Parameters of the corners in a closed interval, inside T."""
    p, domain = curve.degree, curve.domain
    low = curve.knots.searchsorted(within.start)
    high = curve.knots.searchsorted(within.stop, "right")
    knots = curve.knots.window(low, high)
    corners = np.unique(knots[: len(knots) - p + 1][knots[: len(knots) - p + 1] == knots[p - 1 :]])
    return np.asarray(corners[(corners > domain.start) & (corners < domain.stop)])


def _smoothed(curve: Nurbs, t: float, scene: Scene) -> Edit[Nurbs]:
    """Replace both sides of a corner by one quintic that meets them with two derivatives."""
    if curve.degree == 1:
        raise EditError("a curve of degree 1 has a corner at every knot; elevate its degree first")
    if _multiplicity(curve, t) < curve.degree:
        raise EditError(f"there is no corner at t = {t!r}")
    start, stop = _apron(curve, t, scene.frozen)
    h = stop - start
    sides: tuple[tuple[float, Literal["left", "right"]], ...] = ((start, "left"), (stop, "right"))
    ends = [
        (curve(at), curve.derivative(at, side=side), curve.derivative(at, 2, side))
        for at, side in sides
    ]
    rows = np.empty((6, curve.dimension))
    for sign, half, (point, slope, bend) in zip(
        (1, -1), (rows[:3], rows[:2:-1]), ends, strict=True
    ):
        half[0] = point
        half[1] = point + sign * h / 5 * slope
        half[2] = point + sign * 2 * h / 5 * slope + h * h / 20 * bend
    bridge = Nurbs(degree=5, knots=[start] * 6 + [stop] * 6, points=rows)
    size = float(np.ptp(rows, axis=0).max())
    tolerance = ALONE * size if scene.tolerance is None else CLOSENESS * scene.tolerance
    share = tolerance / 8
    sampled = bridge.sample(bridge.domain, tolerance=share)
    return curve.splice(sampled, tolerance=tolerance - share)


def _apron(curve: Nurbs, t: float, frozen: SpliceList) -> Interval:
    """Return how far the curve may change around a corner."""
    width = APRON * curve.domain.length
    widest = Interval(t - width, t + width).clipped(curve.domain)
    others = _corners(curve, widest)
    gaps = [abs(other - t) / 2 for other in others.tolist() if other != t]
    gaps += [abs(end - t) for part in frozen for end in part]
    width = min([width, t - curve.domain.start, curve.domain.stop - t, *gaps])
    return Interval(t - width, t + width)
