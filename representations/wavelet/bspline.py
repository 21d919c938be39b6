"""The multiresolution wavelet B-spline: the value, its face to the kernel."""

from __future__ import annotations

from functools import partial
from typing import Any, Self

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.blocks import BlockArray
from multirep.capsules import Known, Tree
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ToleranceError
from multirep.interval import Interval
from multirep.representations.wavelet import details, holding, levels, releasing, splicing
from multirep.representations.wavelet.data import read, written
from multirep.representations.wavelet.dyadic import parameters
from multirep.representations.wavelet.filters import level_of
from multirep.representations.wavelet.graded import Graded, clamped, differences
from multirep.representations.wavelet.pyramid import MAX_LEVEL, USUAL_LEVEL, Pyramid
from multirep.representations.wavelet.uniform import uniform_points
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.spline_curve import SplineCurve, Window
from multirep.spline_tree import spline_tree
from multirep.splines.rational import Side

__all__ = ["WaveletBSpline"]


class WaveletBSpline(SplineCurve):
    """A cubic B-spline with two faces: graded dyadic control points, and a pyramid of details.

    The stored truth is the control points. Its knots are A + (B - A) k / 2**l, of as high a level l
    in each place as the curve needs there, so fine detail in one place costs nothing elsewhere
    (Grimm-Ayers 6.3 with uniform levels cannot do that). The pyramid (Finkelstein-Salesin 1994) is
    analysed on demand, by :meth:`pyramid`.

    Parameters
    ----------
    points : (2**level + 3, d) array_like
        Control points of a uniform curve; :meth:`fit` and :meth:`from_dict` make graded ones.
    domain : Interval or pair, optional
        T, default [0, 1].

    Raises
    ------
    InvalidCurveError
        When no level has so many points, or they are not finite.

    Notes
    -----
    An edit costs what it changes, whatever the size of the curve. A polyline is followed by adding
    knots where the proof fails; corners are rounded within the tolerance, since all knots are
    simple.

    Examples
    --------
    >>> curve = WaveletBSpline([[0, 0], [1, 2], [2, 0], [3, 2], [4, 0]])
    >>> curve.level, curve.size, curve(0.5)
    (1, 5, array([2., 1.]))
    >>> edit = curve.sweep(0.5, [2, 2], level=1)
    >>> print(edit.value(0.5), edit.splices)
    [2. 2.] [0,1]
    """

    name = "wavelet"
    degree = 3
    summary = "multiresolution cubic B-spline: graded dyadic knots, wavelet details"
    _graded: Graded
    _pyramids: dict[int, Pyramid]
    _known: Known

    def __init__(
        self, points: ArrayLike, domain: Interval | tuple[float, float] = (0.0, 1.0)
    ) -> None:
        rows = np.array(points, dtype=np.float64)
        if rows.ndim != 2 or not rows.shape[1]:
            raise InvalidCurveError(f"control points need the shape (n, d), got {rows.shape}")
        if not np.isfinite(rows).all():
            raise InvalidCurveError("control points must be finite")
        try:
            level = level_of(len(rows))
        except ValueError as error:
            raise InvalidCurveError(str(error)) from None
        rows.setflags(write=False)
        u = clamped(np.arange((1 << level) + 1) / (1 << level))
        self._set(Graded.of(Interval.of(domain), u, rows))

    def _set(self, graded: Graded, known: Known | None = None) -> None:
        vars(self).update(domain=graded.domain, dimension=graded.points.shape[1])
        vars(self).update(_graded=graded, _pyramids={}, _known=known or Known())

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a WaveletBSpline is immutable; cannot set {name!r}")

    @classmethod
    def _of(cls, graded: Graded, known: Known | None = None) -> Self:
        new = cls.__new__(cls)
        new._set(graded, known)
        return new

    def _edit(self, graded: Graded) -> Edit[Self]:
        if graded is self._graded:
            return Edit(self, SpliceList.EMPTY)
        return Edit(self._of(graded, self._known), differences(self._graded, graded))

    # -- reading -----------------------------------------------------------------------------------

    @property
    def knots(self) -> BlockArray:
        """Knots (n + 4,) in T, fourfold at its ends; O(n) unless T is [0, 1]."""
        return self._graded.all_knots

    @property
    def points(self) -> BlockArray:
        """Control points, (n, d)."""
        return self._graded.points

    @property
    def level(self) -> int:
        """The finest level that occurs."""
        return self._graded.level

    @property
    def size(self) -> int:
        """Number of stored control points."""
        return self._graded.size

    @property
    def magnitude(self) -> float:
        """An upper bound of the largest absolute coordinate, of the control points too."""
        return self._graded.magnitude

    def span(self, t: float, side: Side = "right") -> int:
        """Return the knot span that a parameter lies in, one that is not empty; O(log n)."""
        return self._graded.span_at(t, side)

    def _window(self, first: int, last: int) -> Window:
        return (*self._graded.window(first, last), None)

    def _in_blocks(self) -> tuple[BlockArray, BlockArray, None] | None:
        return self._graded.stored

    def _tree(self) -> Tree:
        curve = self._graded
        mapped = partial(parameters, domain=curve.domain)
        return spline_tree(self._known, 3, curve.u, curve.points, None, mapped)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Return a polyline over ``interval``, certified (`multirep.splines.sample_spline`).

        Raises
        ------
        ToleranceError
            When the tolerance is below what rounding allows.
        """
        from multirep.splines import sample_spline

        start, stop = self.ends(interval)
        curve = self._graded
        window = curve.window(curve.span_at(start), curve.span_at(stop, "left"))
        try:
            t, points, bounds = sample_spline(*window, 3, start, stop, tolerance=tolerance)
        except ValueError as error:
            raise ToleranceError(str(error), tolerance=tolerance) from None
        return SampledSplice.unchecked(t, points, bound=float(bounds.max()), chord_bounds=bounds)

    def patch(self, other: Self) -> bytes | None:
        """Return what makes this value of ``other``; see `Representation.patch`."""
        return self._graded.patch(other._graded)

    def patched(self, patch: bytes) -> tuple[Self, bytes | None]:
        """Return the value that gave ``patch`` beside this one; O(control points in the patch)."""
        graded, back = self._graded.patched(patch)
        return self._of(graded, self._known), back

    # -- following a polyline ----------------------------------------------------------------------

    @classmethod
    def fit(cls, sampled: SampledSplice, *, tolerance: float, **options: Any) -> Self:
        """Return a curve over T = ``sampled.interval`` within the allowance; few control points.

        Linear in the samples; see `multirep.representations.wavelet.fitting`.

        Raises
        ------
        ToleranceError
            When that cannot be proved; it says what can.
        UnknownNameError
            For any option.
        """
        cls.check_options(options)
        return cls._of(splicing.fit(sampled, tolerance=tolerance)[0])

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Follow ``sampled`` on its interval and stay as it is elsewhere.

        The ends need not be knots. The knots inside are chosen from the data alone; where the two
        next to an end that is a knot can stay, not a bit changes outside. Otherwise the control
        points that act beyond the end are expressed anew (the curve there is the same up to
        rounding), and the edit reports their supports too.

        Raises
        ------
        ToleranceError
            When this curve is farther from the samples at an end than the allowance, or the
            tolerance cannot be proved with the finest knots.

        Notes
        -----
        See `multirep.representations.wavelet.splicing`. The cost depends on the samples and the
        knots needed, not on the size of the curve.
        """
        graded, changed, bound = splicing.splice(self._graded, sampled, tolerance=tolerance)
        return Edit(self._of(graded, self._known), SpliceList([changed]), bound)

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Prefer ends that are knots, two spans farther out if there is room.

        From such ends a splice leaves the control points outside as they are, bit by bit.
        """
        return holding.reached(self._graded, interval, within)

    def held(
        self, interval: Interval, keep: SpliceList = SpliceList.EMPTY
    ) -> tuple[Edit[Self], Interval]:
        """Prepare for ``interval`` to stay as it is bit by bit; see :meth:`Representation.held`.

        Its ends move outward to dyadic numbers; just outside of them two more knots are inserted,
        which splices that end there keep.
        """
        domain = self.domain
        left, before = holding.held(self._graded, Interval(interval.start, domain.stop), keep)
        graded, after = holding.held(left, Interval(domain.start, interval.stop), keep)
        edit = self._edit(graded)
        # One end at a time: what lies between them does not change.
        splices = differences(self._graded, left) | differences(left, graded)
        return Edit(edit.value, splices), Interval(before.start, after.stop)

    def released(self, t: float, count: int) -> Edit[Self]:
        """Remove knots that :meth:`held` inserted; see :meth:`Representation.released`."""
        return self._edit(releasing.released(self._graded, t, count))

    def changes(self, other: Self) -> SpliceList:
        """Where this value and ``other`` may differ; O(changed blocks)."""
        if self.domain != other.domain or self.dimension != other.dimension:
            return SpliceList([self.domain.hull(other.domain)])
        return differences(self._graded, other._graded)

    # -- editing control points and knots ----------------------------------------------------------

    def move_control_point(self, index: int, to: ArrayLike) -> Edit[Self]:
        """Move one graded control point; changes the four spans of its support.

        Raises
        ------
        EditError
            When there is no such control point, or the place is not a finite point.
        """
        if not 0 <= index < self.size:
            raise EditError(f"there are control points 0 to {self.size - 1}, got {index}")
        row = self._point(to)[None]
        return self._edit(self._graded.replaced((4, 4), np.empty(0), (index, index + 1), row))

    def refine(self, interval: Interval | None = None) -> Edit[Self]:
        """Halve every span that meets the interior of ``interval`` (default T); keep the curve.

        Spans of the finest level that there can be (46 on [0, 1]) stay. ParameterError when the
        interval leaves T.
        """
        where = self.domain if interval is None else Interval.of(interval)
        self.parameters([where.start, where.stop])
        return self._edit(details.halved(self._graded, where))

    # -- editing the pyramid -----------------------------------------------------------------------

    def pyramid(self, level: int | None = None) -> Pyramid:
        """Analyse the curve into base and details; O(size + 2**level), kept with the value.

        Parameters
        ----------
        level : int, optional
            Up to which level, 0 to 20; default the finest one that occurs, at most 16.

        Returns
        -------
        Pyramid
            Exact up to rounding if no knot is finer than ``level``; otherwise that of the best
            approximation of the level in the L2 norm, which is what the analysis of the finer
            levels would leave.

        Raises
        ------
        EditError
            For other levels.
        """
        wanted = min(self.level, USUAL_LEVEL) if level is None else level
        if not 0 <= wanted <= MAX_LEVEL:
            raise EditError(f"a pyramid has levels up to {MAX_LEVEL} at most, asked for {level}")
        if wanted not in self._pyramids:
            self._pyramids[wanted] = Pyramid.of(uniform_points(self._graded, wanted))
        return self._pyramids[wanted]

    def at_level(self, level: float) -> Self:
        """Return the curve of a level, also between two: what is left without finer details."""
        return self._of(levels.at_level(self._graded, level))

    def sweep(self, t: float, to: ArrayLike, level: float) -> Edit[Self]:
        """Move the curve at ``t`` to a point by the smallest change of points of a level.

        Parameters
        ----------
        t : float
            Where on the curve.
        to : (d,) array_like
            Where it shall be.
        level : float
            Wide changes for low levels, narrow ones for high levels; between two levels the change
            goes over from one to the other.

        Returns
        -------
        Edit
            Seven spans of the level wide. The details of finer levels ride along unchanged.

        Notes
        -----
        Minimum norm: ``dc = B (to - f(t)) / ||B||**2`` with B the four functions of the level at t
        (Bartels-Beatty 1989 on a level of Finkelstein-Salesin 1994). The control points outside of
        the support keep their bits.
        """
        at = float(self.parameters(t))
        offset = self._point(to) - self(at)
        return self._edit(details.swept(self._graded, at, offset, level))

    def add_detail(self, level: int, index: int, offset: ArrayLike) -> Edit[Self]:
        """Add to one detail, a displacement of the curve at the peak of its wavelet.

        Parameters
        ----------
        level : int
            The detail leads from ``level`` to ``level + 1``.
        index : int
            0 to 2**level - 1.
        offset : (d,) array_like

        Raises
        ------
        EditError
            When there is no such detail.
        """
        return self._edit(details.added(self._graded, level, index, self._point(offset)))

    def set_detail(self, level: int, index: int, value: ArrayLike) -> Edit[Self]:
        """Set one detail coefficient of the pyramid; see :meth:`add_detail`.

        Notes
        -----
        Needs the present value, hence the analysis up to ``level + 1``: linear, unless the pyramid
        is known already.
        """
        details.check_detail(self._graded, level, index)
        present = self.pyramid(level + 1).details[level][index]
        return self.add_detail(level, index, self._point(value) - present)

    # -- data --------------------------------------------------------------------------------------

    def to_dict(self) -> dict[str, Any]:
        """Plain data: level, knots in T, points."""
        return written(self._graded)

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Read what :meth:`to_dict` wrote; InvalidCurveError when it describes no such curve."""
        return cls._of(read(data))

    def _point(self, value: ArrayLike) -> Array:
        point: Array = np.asarray(value, dtype=np.float64)
        if point.shape != (self.dimension,) or not np.isfinite(point).all():
            raise EditError(
                f"expected a finite point of {self.dimension} coordinates, got {value!r}"
            )
        return point

    def __repr__(self) -> str:
        return f"WaveletBSpline(size={self.size}, level={self.level}, domain={self.domain})"
