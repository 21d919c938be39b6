"""A new curve from strokes, for sessions and scripts that begin with a sketch."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from multirep.arrays import ArrayLike
from multirep.errors import EditError
from multirep.strokes.averaging import average_strokes
from multirep.strokes.cleaning import CORNER_ANGLE, Stroke, clean_stroke

if TYPE_CHECKING:
    from multirep.multirepresentation import MultiRepresentation
    from multirep.representation import Representation


def sketched(
    strokes: Sequence[ArrayLike],
    *,
    noise: float | None = None,
    corner_angle: float = CORNER_ANGLE,
    corner_window: float | None = None,
    straight: bool = False,
) -> Stroke:
    """Clean strokes and average them into one.

    Parameters
    ----------
    strokes : sequence of (n, d) array_like
        Drawn over each other, in any direction.
    noise, corner_angle, corner_window, straight : optional
        See :func:`~multirep.strokes.cleaning.clean_stroke`.

    Returns
    -------
    Stroke

    Raises
    ------
    InvalidCurveError, EditError
        Messages name the stroke.

    Examples
    --------
    >>> sketched([[[0, 0], [2, 0]], [[2, 0.25], [0, 0.25]]], noise=0).points.tolist()
    [[0.0, 0.125], [2.0, 0.125]]
    """
    if len(strokes) == 0:
        raise EditError("there are no strokes; draw at least one")
    one = len(strokes) == 1
    cleaned = [
        clean_stroke(
            points,
            noise=noise,
            corner_angle=corner_angle,
            corner_window=corner_window,
            straight=straight,
            what="the stroke" if one else f"stroke {number}",
        )
        for number, points in enumerate(strokes, start=1)
    ]
    return average_strokes(cleaned)


def curve_from_strokes(
    strokes: Sequence[ArrayLike],
    *,
    tolerance: float,
    noise: float | None = None,
    corner_angle: float = CORNER_ANGLE,
    corner_window: float | None = None,
    straight: bool = False,
    kinds: Iterable[type[Representation]] | None = None,
) -> MultiRepresentation:
    """Start a curve from one stroke or several over each other.

    Parameters
    ----------
    strokes : sequence of (n, d) array_like
    tolerance : float
        Of the new curve.
    noise, corner_angle, corner_window, straight : optional
        See :func:`~multirep.strokes.cleaning.clean_stroke`.
    kinds : iterable of Representation classes, optional
        Which representations to keep; by default all registered ones.

    Returns
    -------
    MultiRepresentation
        With chord-length parameters in [0, 1].

    Examples
    --------
    >>> curve = curve_from_strokes([[[0, 0], [1, 0.1], [2, 0]]], tolerance=1e-3)
    >>> curve.view("polyline").size
    5
    """
    from multirep.multirepresentation import MultiRepresentation

    stroke = sketched(strokes, noise=noise, corner_angle=corner_angle, corner_window=corner_window)
    curve = MultiRepresentation.from_points(stroke.points, tolerance=tolerance, kinds=kinds)
    curve.merged = stroke.merged
    return curve
