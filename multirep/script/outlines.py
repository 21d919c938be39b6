"""An outline of lines, Bézier curves and elliptic arcs as one exact NURBS.

Every segment is raised to a cubic, arcs as exact rational pieces; the knots at the joints have
multiplicity three, and each segment gets a share of [0, 1] that is proportional to its length.
Raising the degree and cutting arcs change nothing but rounding, so the NURBS is the drawing, not an
approximation of it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from attrs import frozen

from multirep.arrays import Array, ArrayLike

#: A segment shorter than this part of the outline has no parameter interval worth the name; it is
#: dropped.
SHORTEST_SHARE = 1e-12
#: Chords by which a segment is measured. Shares need not be exact; more chords would only cost
#: time.
CHORDS = 64


@frozen(eq=False)
class Segment:
    """A rational Bézier segment of degree 1, 2 or 3.

    Parameters
    ----------
    points : array (degree + 1, d)
    weights : array (degree + 1,) or None
        None: all one. The first and last are one.
    """

    points: Array
    weights: Array | None = None


@frozen(eq=False)
class Outline:
    """A NURBS in numbers: what :func:`join` makes.

    ``weights`` is None when all are one; ``dropped`` counts the segments without length.
    """

    degree: int
    knots: Array
    points: Array
    weights: Array | None
    dropped: int


def arc(
    start: ArrayLike,
    end: ArrayLike,
    center: ArrayLike,
    first_axis: ArrayLike,
    second_axis: ArrayLike,
    sweep: float,
) -> list[Segment]:
    """Return an elliptic arc as exact rational quadratics of at most a quarter turn each.

    Parameters
    ----------
    start, end, center : array_like (2,)
        Points in the plane; ``start`` and ``end`` lie on the ellipse.
    first_axis, second_axis : array_like (2,)
        Conjugate half-diameters: the ellipse is center + cos θ first + sin θ second.
    sweep : float
        Signed change of θ, in radians, at most a full turn.

    Returns
    -------
    list of Segment
        Weights 1, cos(δ/2), 1 for pieces of angle δ: the conic section through the ends with
        tangents along it.

    Examples
    --------
    >>> [quarter] = arc((1, 0), (0, 1), (0, 0), (1, 0), (0, 1), math.pi / 2)
    >>> quarter.points.round(12).tolist()
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    middle, frame = np.asarray(center, float), np.array([first_axis, second_axis], float)
    x, y = np.linalg.solve(frame.T, np.asarray(start, float) - middle)
    pieces = max(1, math.ceil(abs(sweep) / (math.pi / 2) - 1e-9))
    angles = math.atan2(y, x) + sweep * np.arange(pieces + 1) / pieces
    weight = math.cos(sweep / pieces / 2)
    ends = middle + np.stack([np.cos(angles), np.sin(angles)], axis=1) @ frame
    ends[0], ends[-1] = start, end
    halfway = (angles[1:] + angles[:-1]) / 2
    shoulders = middle + np.stack([np.cos(halfway), np.sin(halfway)], axis=1) @ frame / weight
    weights = np.array([1.0, weight, 1.0])
    return [
        Segment(np.stack(rows), weights)
        for rows in zip(ends[:-1], shoulders, ends[1:], strict=True)
    ]


def raise_to_cubic(segment: Segment) -> Array:
    """Return the four homogeneous control points (wx, wy, ..., w) of the segment as a cubic."""
    weights = np.ones(len(segment.points)) if segment.weights is None else segment.weights
    rows = np.column_stack([segment.points * weights[:, None], weights])
    while len(rows) < 4:
        p = len(rows)  # the degree that is being raised to
        share = np.arange(1, p)[:, None] / p
        rows = np.concatenate([rows[:1], share * rows[:-1] + (1 - share) * rows[1:], rows[-1:]])
    return rows


def join(segments: Sequence[Segment]) -> Outline:
    """Return one cubic NURBS over [0, 1] that runs through all segments in order.

    Parameters
    ----------
    segments : sequence of Segment
        Each starts where the one before ends.

    Returns
    -------
    Outline

    Raises
    ------
    ValueError
        When there is no segment with a length.
    """
    if not segments:
        raise ValueError("it has no segment")
    cubics = np.stack([raise_to_cubic(segment) for segment in segments])
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = _lengths(cubics)
    if not np.isfinite(lengths).all():
        raise ValueError("its coordinates are not finite, or too large to measure")
    kept = lengths > SHORTEST_SHARE * lengths.sum()
    if not kept.any():
        raise ValueError("it is a single point, which is not a curve")
    cubics, lengths = cubics[kept], lengths[kept]
    reached = np.cumsum(lengths)
    joints = np.concatenate([[0.0], reached[:-1] / reached[-1], [1.0]])
    # Shares are above 1e-12, far more than rounding: the joints increase strictly.
    knots = np.concatenate([[0.0], np.repeat(joints, 3), [1.0]])
    rows = np.concatenate([cubics[0, :1], cubics[:, 1:].reshape(-1, cubics.shape[2])])
    weights = rows[:, -1].copy()
    points = rows[:, :-1] / weights[:, None]
    plain = bool((weights == 1.0).all())
    return Outline(3, knots, points, None if plain else weights, int((~kept).sum()))


def _lengths(cubics: Array) -> Array:
    """Measure homogeneous cubics (n, 4, d + 1) along chords."""
    t = np.linspace(0.0, 1.0, CHORDS + 1)
    s = 1 - t
    basis = np.stack([s**3, 3 * t * s**2, 3 * t**2 * s, t**3], axis=1)
    values = np.einsum("ij,njd->nid", basis, cubics)
    points = values[..., :-1] / values[..., -1:]
    lengths: Array = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1)
    return lengths
