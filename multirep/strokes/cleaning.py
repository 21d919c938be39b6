"""From the samples of a pen to a curve: noise removed, corners and ends kept."""

from __future__ import annotations

import math

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike, Indices
from multirep.errors import EditError
from multirep.strokes.corners import find_corners
from multirep.strokes.merging import gather
from multirep.strokes.noise import estimate_noise
from multirep.strokes.reading import read_stroke
from multirep.strokes.rounding import rounded
from multirep.strokes.smoothing import smooth

#: Turns from this angle on are corners: a heptagon has them, an octagon is a rough circle; and the
#: half right angles of a pixel grid are none.
CORNER_ANGLE = 50.0


@attrs.frozen(eq=False)
class Stroke:
    """A cleaned stroke.

    Parameters
    ----------
    points : (n, d) array
        Two or more; neighbours differ. Read-only.
    corners : (k,) array of int
        The inner points at which it turns abruptly, increasing.
    noise : float
        The standard deviation per coordinate that was taken for noise.
    merged : int
        How many repeated samples were dropped.
    """

    points: Array
    corners: Indices
    noise: float = 0.0
    merged: int = 0

    def reversed(self) -> Stroke:
        """Return the same stroke, drawn the other way round."""
        corners = len(self.points) - 1 - self.corners[::-1]
        return attrs.evolve(self, points=self.points[::-1], corners=corners)


def clean_stroke(
    points: ArrayLike,
    *,
    noise: float | None = None,
    corner_angle: float = CORNER_ANGLE,
    corner_window: float | None = None,
    straight: bool = False,
    what: str = "the stroke",
) -> Stroke:
    """Make a curve of what a pen drew (Grimm-Ayers 2.2.3).

    Repeated samples are merged. Where samples stand closer than they scatter, their mean stands
    for them; corners are found; and a smoothing spline that is free to turn there removes what is
    left of the noise. A corner or an end moves by about its own noise, not by the smoothing;
    samples without noise stay. Where they are few a smooth curve goes through them, from corner to
    corner.

    Parameters
    ----------
    points : (n, d) array_like
        Samples in order, at any speed; pauses, crossings and reversals are welcome.
    noise : float, optional
        Standard deviation, per coordinate and in the units of the points, of independent errors of
        the samples. By default estimated (:func:`~multirep.strokes.noise.estimate_noise`); 0 keeps
        every sample.
    corner_angle : float, optional
        Degrees; turns from here on are corners.
    corner_window : float, optional
        Arc length on either side over which a corner is judged. By default as short as the noise
        allows.
    straight : bool, optional
        Whether samples are joined by straight lines instead.
    what : str, optional
        What messages call the stroke.

    Returns
    -------
    Stroke

    Raises
    ------
    InvalidCurveError
        When the samples make no curve; says what was found.
    EditError
        When an option makes no sense.

    Notes
    -----
    Cost: linear in the samples; 1e5 of them take 0.03 to 0.2 s.

    Examples
    --------
    >>> s = np.linspace(0, 2, 400)
    >>> hook = np.stack([np.minimum(s, 1), np.maximum(s - 1, 0)], axis=1)
    >>> drawn = hook + 0.01 * np.random.default_rng(0).normal(size=hook.shape)
    >>> stroke = clean_stroke(drawn)
    >>> len(stroke.corners), round(stroke.noise, 3)
    (1, 0.01)
    >>> bool(np.abs(stroke.points[stroke.corners[0]] - [1, 0]).max() < 0.02)
    True
    """
    check_options(noise, corner_angle, corner_window)
    rows, merged = read_stroke(points, what=what)
    noise = estimate_noise(rows) if noise is None else float(noise)
    rows, corners = _smoothed(rows, noise, math.radians(corner_angle), corner_window, what)
    rows, corners = _distinct(rows, corners)
    if not straight:
        rows, corners = rounded(rows, corners)
    rows.setflags(write=False)
    return Stroke(rows, corners, noise, merged)


def _smoothed(
    rows: Array, noise: float, angle: float, window: float | None, what: str
) -> tuple[Array, Indices]:
    """Join samples that scatter, find corners, smooth between them; in terms of the size."""
    origin, scale = rows[0], float(np.abs(rows - rows[0]).max())
    gathered = gather((rows - origin) / scale, noise / scale)
    if gathered.is_noise(noise / scale):
        raise EditError(
            f"{what} spans {scale:.3g}: all of it is noise of {noise:.3g}; draw something larger, "
            "or give a smaller noise"
        )
    corners = find_corners(
        gathered.points,
        angle=angle,
        noise=noise / scale / np.sqrt(gathered.counts),
        window=None if window is None else window / scale,
    )
    smoothed = smooth(gathered.points, gathered.counts, corners, noise / scale)
    if smoothed is gathered.points and len(smoothed) == len(rows):
        return rows, corners  # untouched, bit by bit
    return origin + scale * smoothed, corners


def _distinct(rows: Array, corners: Indices) -> tuple[Array, Indices]:
    """Drop points that rounding, far from the origin, made the same as the one before."""
    keep = np.concatenate([[True], (rows[1:] != rows[:-1]).any(axis=1)])
    if keep.all():
        return rows, corners
    corners = np.unique(np.cumsum(keep)[corners] - 1)
    rows = rows[keep]
    return rows, corners[(corners > 0) & (corners < len(rows) - 1)]


def check_options(noise: float | None, corner_angle: float, corner_window: float | None) -> None:
    """Raise EditError unless the options of :func:`clean_stroke` make sense."""
    if noise is not None and not (math.isfinite(noise) and noise >= 0):
        raise EditError(f"noise must be a number >= 0, or left out to be estimated; got {noise!r}")
    if not 0 < corner_angle <= 180:
        raise EditError(f"corner_angle must be in (0, 180] degrees, got {corner_angle!r}")
    if corner_window is not None and not (math.isfinite(corner_window) and corner_window > 0):
        raise EditError(f"corner_window must be a length > 0, got {corner_window!r}")
