"""Frames along a curve, one at the centre of each wavelet, in which details ride with the curve.

Detail k of level l is centred at t = (k + 1/2) / 2**l of T. Its frame there is that of the curve of
level l, which has none of the details of that level or above (Finkelstein-Salesin 1994, 3.5).

In the plane the frame is [T N]: the direction of the curve, and that turned left by 90 degrees. In
space a direction leaves the normal open. There the normal follows the curve without turning about
it (parallel transport: each frame is turned into the next by the smallest rotation), from the first
place where the curve bends at least half as much as anywhere, and where it points to the inside of
the bend. Frames of a finer level are those of the coarser one, turned likewise. So frames turn with
the curve, in the plane and in space.
"""

from __future__ import annotations

import numpy as np

from multirep.arrays import Array, Flags, Indices
from multirep.errors import EditError
from multirep.representations.wavelet.filters import level_of
from multirep.representations.wavelet.graded import clamped
from multirep.splines.evaluation import evaluate

__all__ = ["frames"]

#: Directions of a curve that is slower than this part of its greatest speed are not looked at: the
#: digits that rounding leaves of them are too few.
_SLOW = 1e-6
#: Of the largest coordinate, what rounding makes of differences of control points.
_ROUNDING = 32 * float(np.finfo(np.float64).eps)
#: A curve in space that turns by less than this in its length, as an angle, is straight.
_STRAIGHT = 1e-9


def frames(points: Array, coarser: Array | None = None) -> Array:
    """Return the frames at the centres of the wavelets that refine a curve.

    Parameters
    ----------
    points : (2**l + 3, d) array
        Control points of the curve of level l; d is 2 or 3.
    coarser : (2**(l - 1), d, d) array, optional
        The frames of the level below; without them the frames of a curve in space begin here.

    Returns
    -------
    (2**l, d, d) array
        Rotations whose columns are T, N (, B). Where the curve hardly moves the frame is that of
        the place before (in space, of the level below); if it moves nowhere, the axes.

    Raises
    ------
    EditError
        When the curve has another number of coordinates, or is straight in space and there is no
        level below: then every normal would do.

    Examples
    --------
    >>> frames(np.array([[0.0, 0], [0, 1], [0, 2], [0, 3]]))[0]
    array([[ 0., -1.],
           [ 1.,  0.]])
    """
    dimension = points.shape[1]
    if dimension not in (2, 3):
        raise EditError(
            "curves have frames in the plane and in space; this one has "
            f"{dimension} coordinate{'s' * (dimension > 1)}: use the frame 'axes'"
        )
    spans = 1 << level_of(len(points))
    u, centres = clamped(np.arange(spans + 1) / spans), (np.arange(spans) + 0.5) / spans
    velocity = evaluate(u, points, 3, centres, order=1)
    speed = np.linalg.norm(velocity, axis=1)
    noise = _ROUNDING * spans * float(np.abs(points).max())
    moving = speed > max(_SLOW * speed.max(), noise)
    if not moving.any():
        return np.tile(np.eye(dimension), (spans, 1, 1)) if coarser is None else _halves(coarser)
    if dimension == 2:
        tangents = (velocity / np.where(moving, speed, 1.0)[:, None])[_before(moving)]
        return np.stack((tangents, tangents @ np.array([[0.0, 1.0], [-1.0, 0.0]])), axis=2)
    if coarser is not None:
        parents = _halves(coarser)
        tangents = np.where(
            moving[:, None], velocity / np.where(moving, speed, 1.0)[:, None], parents[:, :, 0]
        )
        turned = _smallest_rotations(parents[:, :, 0], tangents) @ parents
        return _orthonormal(turned[:, :, 0], turned[:, :, 1])
    tangents = (velocity / np.where(moving, speed, 1.0)[:, None])[_before(moving)]
    bend = evaluate(u, points, 3, centres, order=2)
    bend -= np.einsum("md,md->m", bend, tangents)[:, None] * tangents
    bend *= np.linalg.norm(bend, axis=1)[:, None] > spans * noise
    curvature = np.linalg.norm(bend, axis=1) * moving / np.where(moving, speed, 1.0) ** 2
    turn = curvature.max() * speed.max()
    if turn < _STRAIGHT:
        raise EditError(
            f"the curve of level {level_of(len(points))} is straight (it turns by {turn:.1e} at "
            "most), so nothing says how its frame is turned about it in space: use the frame "
            "'axes', or start from a finer level"
        )
    first = int((curvature >= 0.5 * curvature.max()).argmax())
    steps = _smallest_rotations(tangents[:-1], tangents[1:])
    transport = _products(np.concatenate((np.eye(3)[None], steps)))
    normal = transport @ (transport[first].T @ (bend[first] / np.linalg.norm(bend[first])))
    return _orthonormal(tangents, normal)


def _halves(coarser: Array) -> Array:
    return np.repeat(coarser, 2, axis=0)


def _before(moving: Flags) -> Indices:
    """Index of the last moving place up to each, or of the first one at all."""
    places = np.where(moving, np.arange(len(moving)), -1)
    found: Indices = np.maximum(np.maximum.accumulate(places), moving.argmax())
    return found


def _smallest_rotations(one: Array, two: Array) -> Array:
    """Rotations (m, 3, 3) that turn unit vectors (m, 3) into others in their common plane.

    Opposite ones have no common plane; there a half turn about some normal is taken.
    """
    axis, cosine = np.cross(one, two), np.einsum("md,md->m", one, two)
    cross = np.zeros((len(one), 3, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        cross[:, i, j], cross[:, j, i] = -axis[:, k], axis[:, k]
    opposite = cosine < -1.0 + 1e-12
    factor = 1.0 / np.where(opposite, 1.0, 1.0 + cosine)
    rotations = np.eye(3) + cross + factor[:, None, None] * (cross @ cross)
    if opposite.any():
        across = np.cross(one[opposite], np.eye(3)[np.abs(one[opposite]).argmin(axis=1)])
        across /= np.linalg.norm(across, axis=1)[:, None]
        rotations[opposite] = 2.0 * across[:, :, None] * across[:, None, :] - np.eye(3)
    return rotations


def _products(matrices: Array) -> Array:
    """Return M[0], M[1] M[0], M[2] M[1] M[0], ...: by doubling, log2 steps."""
    products: Array = matrices.copy()
    reach = 1
    while reach < len(products):
        products[reach:] = products[reach:] @ products[:-reach]
        reach *= 2
    return products


def _orthonormal(tangent: Array, normal: Array) -> Array:
    """Take the rounding of many products out: T as it is, N at right angles, B their product."""
    normal = normal - np.einsum("md,md->m", tangent, normal)[:, None] * tangent
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    taken = np.empty((*tangent.shape, 3))
    taken[:, :, 0], taken[:, :, 1] = tangent, normal
    taken[:, :, 2] = np.cross(tangent, normal)
    return taken
