"""Sampled splices: a stretch of a curve as a polyline with a proved deviation (Grimm-Ayers 4.3)."""

from __future__ import annotations

from itertools import pairwise

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike, frozen_array
from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.splines import compiled

#: So many pieces are joined in one call: as many as there are in a splice with both ends.
FEW = 4


def _optional_array(values: ArrayLike | None) -> Array | None:
    return None if values is None else frozen_array(values)


@attrs.frozen(eq=False)
class SampledSplice:
    """The polyline L over [a, b] that stands for a stretch of a source curve.

    Parameters
    ----------
    t : (m + 1,) array
        Strictly increasing parameters; the first is a, the last is b.
    points : (m + 1, d) array
        L(t) there; linear in between.
    bound : float
        Certified: ``||source(t) - L(t)|| <= bound`` for all t in [a, b].
    breaks : tuple of float
        The parameters, each one of ``t``, at which the source has a corner.
    chord_bounds : (m,) array, optional
        The same certificate chord by chord, where the maker knows it; none exceeds ``bound``.

    Examples
    --------
    >>> points = [[0, 0], [1, 1], [2, 0]]
    >>> L = SampledSplice([0, 1, 2], points, bound=0.25, chord_bounds=[0.25, 0.125])
    >>> L(0.5)
    array([0.5, 0.5])
    >>> L.allowance(0.5)
    array([0.5  , 0.625])
    """

    t: Array = attrs.field(converter=frozen_array)
    points: Array = attrs.field(converter=frozen_array)
    bound: float = 0.0
    breaks: tuple[float, ...] = ()
    chord_bounds: Array | None = attrs.field(default=None, converter=_optional_array)

    def __attrs_post_init__(self) -> None:
        if self.t.ndim != 1 or self.points.ndim != 2 or len(self.t) != len(self.points):
            raise InvalidCurveError(
                f"a sampled splice needs (m,) parameters and (m, d) points, "
                f"got {self.t.shape} and {self.points.shape}"
            )
        if len(self.t) < 2:
            raise InvalidCurveError(f"a sampled splice needs 2 samples or more, got {len(self.t)}")
        if not (self.t[1:] > self.t[:-1]).all():
            raise InvalidCurveError("the parameters of a sampled splice must increase strictly")
        if not np.isfinite(self.points).all():
            raise InvalidCurveError("the points of a sampled splice must be finite")
        if self.bound < 0:
            raise InvalidCurveError(f"a bound is 0 or more, got {self.bound!r}")
        if self.chord_bounds is not None:
            self._check_chord_bounds(self.chord_bounds)

    @classmethod
    def unchecked(
        cls,
        t: Array,
        points: Array,
        bound: float = 0.0,
        breaks: tuple[float, ...] = (),
        chord_bounds: Array | None = None,
    ) -> SampledSplice:
        """Make one of arrays that are right by construction, and the maker's to give away.

        They are frozen, not copied; for makers in a hot path.
        """
        new = cls.__new__(cls)
        t.setflags(write=False)
        points.setflags(write=False)
        if chord_bounds is not None:
            chord_bounds.setflags(write=False)
        put = object.__setattr__
        put(new, "t", t)
        put(new, "points", points)
        put(new, "bound", bound)
        put(new, "breaks", breaks)
        put(new, "chord_bounds", chord_bounds)
        return new

    def _check_chord_bounds(self, bounds: Array) -> None:
        if bounds.shape != (len(self.t) - 1,):
            raise InvalidCurveError(
                f"a sampled splice with {len(self.t)} samples has {len(self.t) - 1} chords, "
                f"got chord bounds of shape {bounds.shape}"
            )
        if bounds.min() < 0 or bounds.max() > self.bound:
            raise InvalidCurveError(
                f"chord bounds are between 0 and the bound, which is {self.bound!r}; "
                f"got {float(bounds.min())!r} to {float(bounds.max())!r}"
            )

    @property
    def interval(self) -> Interval:
        """The stretch [a, b]."""
        return Interval(float(self.t[0]), float(self.t[-1]))

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[1])

    def __call__(self, t: ArrayLike) -> Array:
        """L at parameters in [a, b]: scalar -> (d,), (k,) -> (k, d)."""
        at: Array = np.asarray(t, dtype=np.float64)
        return interpolate(self.t, self.points, at)

    def allowance(self, tolerance: float) -> Array:
        """How far a fit may be from L on each chord, (m,).

        What the sampler certifiably left unused of its share, the fit may use.
        """
        if self.chord_bounds is None:
            return np.full(len(self.t) - 1, tolerance)
        return tolerance + (self.bound - self.chord_bounds)

    def cut(self, first: int, last: int) -> SampledSplice:
        """Return the chords between samples ``first`` and ``last``, which both stay."""
        start, stop = float(self.t[first]), float(self.t[last])
        bounds = None if self.chord_bounds is None else self.chord_bounds[first:last]
        return SampledSplice.unchecked(
            self.t[first : last + 1],
            self.points[first : last + 1],
            bound=self.bound if bounds is None else float(bounds.max()),
            breaks=tuple(t for t in self.breaks if start <= t <= stop),
            chord_bounds=bounds,
        )


def join(pieces: list[SampledSplice]) -> SampledSplice:
    """Join sampled splices that follow each other; L passes through the middle of each seam.

    The certificate of the two chords at a seam grows by half the gap there, so ``bound`` stays a
    certificate.
    """
    if len(pieces) == 1:
        return pieces[0]
    chords = sum([len(piece.t) - 1 for piece in pieces])
    t, points = np.empty(chords + 1), np.empty((chords + 1, pieces[0].points.shape[1]))
    bounds = np.empty(chords)
    if compiled.active and len(pieces) <= FEW:
        given = tuple([(part.t, part.points, part.chord_bounds, part.bound) for part in pieces])
        bound = compiled.core.join(given, t, points, bounds)
    else:
        bound = _filled(pieces, t, points, bounds)
    breaks = {t for piece in pieces if piece.breaks for t in piece.breaks}
    return SampledSplice.unchecked(t, points, bound, tuple(sorted(breaks)), bounds)


def _filled(pieces: list[SampledSplice], t: Array, points: Array, bounds: Array) -> float:
    """Put pieces together in arrays with room for them; return the largest bound."""
    np.concatenate([pieces[0].t, *[piece.t[1:] for piece in pieces[1:]]], out=t)
    np.concatenate([pieces[0].points, *[piece.points[1:] for piece in pieces[1:]]], out=points)
    np.concatenate([chord_bounds(piece) for piece in pieces], out=bounds)
    seam = 0
    for before, after in pairwise(pieces):
        seam += len(before.t) - 1
        left, right = before.points[-1], after.points[0]
        if (left != right).any():
            points[seam] = 0.5 * (left + right)
            bounds[seam - 1 : seam + 1] += 0.5 * np.sqrt(
                np.einsum("i,i", left - right, left - right)
            )
    return float(bounds.max())


def chord_bounds(sampled: SampledSplice) -> Array:
    """Return the certificate chord by chord, (m,), whether or not the maker gave it so."""
    if sampled.chord_bounds is not None:
        return sampled.chord_bounds
    return np.full(len(sampled.t) - 1, sampled.bound)


def interpolate(t: Array, points: Array, at: Array) -> Array:
    """Evaluate the polyline through ``points`` (m, d) at ``t`` (m,) for parameters ``at``.

    The result has the shape ``at.shape + (d,)``.
    At a vertex the vertex itself comes out, bit by bit.
    """
    if compiled.active:
        at = np.asarray(at, dtype=np.float64)
        found = np.empty((*at.shape, points.shape[1]))
        compiled.core.interpolate(t, points, at, found)
        return found
    # not np.clip, which spends 8 us on finding out its types
    k = np.minimum(np.maximum(t.searchsorted(at, side="right") - 1, 0), len(t) - 2)
    start = t[k]
    u = ((at - start) / (t[k + 1] - start))[..., None]
    values: Array = np.where(u == 1.0, points[k + 1], points[k] + u * (points[k + 1] - points[k]))
    return values
