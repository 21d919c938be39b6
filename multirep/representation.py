"""The contract of a representation: what a plugin must, may and must not override."""

from __future__ import annotations

import abc
from collections.abc import Callable, Iterable
from typing import Any, ClassVar, Self

import attrs
import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.edit import Edit
from multirep.errors import ParameterError, UnknownNameError
from multirep.interval import Interval
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList


@attrs.frozen(eq=False)
class Nearest:
    """The place on a curve that is nearest to a given point, or the places for many points."""

    #: A float; (m,) for m points.
    t: Any
    #: (d,); (m, d) for m points.
    point: Array
    #: A float; (m,) for m points.
    distance: Any


class Representation(abc.ABC):
    """One mathematical form of a curve over T, an immutable value.

    You must set ``name``, ``domain`` and ``dimension`` and override :meth:`__call__`,
    :meth:`sample`, :meth:`splice` and :meth:`fit`. You may override the methods below the second
    line. Nothing else.

    The accuracy contract (DESIGN section 3, Grimm-Ayers 4.2 with the errata): what :meth:`sample`
    and :meth:`splice` promise must be *proved* for all t, with :mod:`multirep.bounds` or otherwise;
    what cannot be proved raises :class:`~multirep.errors.ToleranceError`.
    """

    #: Unique in a registry, as in "polyline".
    name: ClassVar[str]
    #: One line for `multirep plugins`.
    summary: ClassVar[str] = ""
    #: The parameter interval T.
    domain: Interval
    #: Number of coordinates, any d >= 1.
    dimension: int

    # -- must override -----------------------------------------------------------------------------

    @abc.abstractmethod
    def __call__(self, t: ArrayLike) -> Array:
        """Points at parameters: scalar -> (d,), (m,) -> (m, d); ParameterError outside T."""

    @abc.abstractmethod
    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        """Return a polyline over ``interval``, certified within ``tolerance`` for all t.

        Its end points are points of the curve itself. Corners of the curve are ``breaks`` of the
        sample.
        """

    @abc.abstractmethod
    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Self]:
        """Follow ``sampled`` on its interval.

        Returns an edit whose value R' has ``||R'(t) - L(t)|| <= sampled.allowance(tolerance)`` on
        each chord of L, proved, and is bit-identical to this value outside the reported splices.
        The curve stays continuous: at an end inside T, R' meets what stands outside, which may be
        off L there by up to the allowance.

        Raises
        ------
        ToleranceError
            When that cannot be proved; the kernel then tries a larger interval.
        """

    @classmethod
    @abc.abstractmethod
    def fit(cls, sampled: SampledSplice, *, tolerance: float, **options: Any) -> Self:
        """Return a value from nothing over T = ``sampled.interval``, within the allowance.

        Raises
        ------
        ToleranceError
            When the allowance cannot be met or the proof fails.
        UnknownNameError
            For options that it does not have; see :meth:`check_options`.
        """

    # -- may override ------------------------------------------------------------------------------

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Return the ends that a splice covering ``interval`` would like, inside ``within``."""
        return interval

    def held(
        self, interval: Interval, keep: SpliceList = SpliceList.EMPTY
    ) -> tuple[Edit[Self], Interval]:
        """Prepare for ``interval`` to stay as it is bit by bit, whatever follows beside it.

        Parameters
        ----------
        interval : Interval
            What is going to be frozen.
        keep : SpliceList
            Where not a bit may change already.

        Returns
        -------
        edit : Edit
            The same curve up to rounding, bit-identical on ``keep``, with controls of its own at
            the ends of ``interval`` that lie inside T.
        guard : Interval
            What must not be touched so that ``interval`` stays: ``interval`` itself if the
            representation can stop there, else as little more as possible. Asked for the guard, it
            returns the guard. A splice that ends there, and any edit outside of it, leaves
            ``interval`` bit-identical.

        The default changes nothing and trusts :meth:`splice` to change nothing beyond its ends;
        the kernel checks what every splice reports.
        """
        return Edit(self, SpliceList.EMPTY), interval

    def released(self, t: float, count: int) -> Edit[Self]:
        """Take back controls that :meth:`held` put at ``t``, as far as nothing needs them now.

        ``t`` is an end of the guard that it gave, and is no end of a frozen stretch any more.
        Returns the same curve up to rounding without ``count`` controls, or fewer, or with all of
        them. The default changes nothing.
        """
        return Edit(self, SpliceList.EMPTY)

    def changes(self, other: Self) -> SpliceList:
        """Where this value and ``other`` may differ; must cover every difference.

        The default compares everything that it can see, which is both curves' samples: O(curve).
        Override it with something that costs what changed (see
        :meth:`multirep.BlockArray.difference`).
        """
        tolerance = 1e-3 * (self.magnitude + other.magnitude) + np.finfo(float).tiny
        t = np.union1d(
            self.sample(self.domain, tolerance=tolerance).t,
            other.sample(other.domain, tolerance=tolerance).t,
        )
        t = np.union1d(t, 0.5 * (t[1:] + t[:-1]))
        differs = (self(t) != other(t)).any(axis=1)
        chords = np.flatnonzero(differs[1:] | differs[:-1])
        return SpliceList(zip(t[chords], t[chords + 1], strict=True))

    def patch(self, other: Self) -> bytes | None:
        """Return what makes this value of ``other``, a neighbour in the history, or None.

        What only the history holds is kept so. The default, None, keeps the value itself; see
        :mod:`multirep.patches` for values that are made of block arrays.
        """
        return None

    def patched(self, patch: bytes) -> tuple[Self, bytes | None]:
        """Return the value that gave ``patch`` beside this one, bit for bit; and the patch back."""
        raise NotImplementedError(f"{self.name} makes no patches")

    def derivative(self, t: ArrayLike, order: int = 1, side: str = "right") -> Array:
        """Return the derivative by t, from the right or the left; shapes as for a call."""
        raise NotImplementedError(f"{self.name} offers no derivatives")

    def nearest(self, point: ArrayLike) -> Nearest:
        """Return the place nearest to ``point``, by certified branch and bound on samples.

        Parameters
        ----------
        point : (d,) or (m, d) array_like
            One point, or many at once.

        Returns
        -------
        Nearest
            Of floats and one point, or of arrays. No place of the curve is nearer by more than
            1e-10 of its size, and what rounding of the coordinates costs.

        Raises
        ------
        InvalidCurveError
            When a point is not finite or has another dimension.
        """
        from multirep.nearest import many_nearest, nearest_by_sampling

        points: Array = np.asarray(point, dtype=np.float64)
        if points.ndim == 2:
            return many_nearest(self, points)
        return nearest_by_sampling(self, points)

    @property
    def size(self) -> int:
        """Number of stored controls, for reports."""
        return 0

    @property
    def magnitude(self) -> float:
        """An upper bound of the largest |coordinate|; rounding errors are relative to it.

        Whoever overrides it vouches for all coordinates: it must be NaN or infinite if one of them
        is.
        """
        ends = np.asarray(self([self.domain.start, self.domain.stop]))
        return float(np.abs(ends).max())

    def to_dict(self) -> dict[str, Any]:
        """Return plain data from which :meth:`from_dict` makes an equal value."""
        raise NotImplementedError(f"{self.name} cannot be written as data")

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Read what :meth:`to_dict` wrote."""
        raise NotImplementedError(f"{cls.name} cannot be read from data")

    # -- don't override ----------------------------------------------------------------------------

    @classmethod
    def check_options(cls, options: Iterable[str], known: Iterable[str] = ()) -> None:
        """Raise UnknownNameError, with the nearest name, for an option that :meth:`fit` has not."""
        for option in options:
            if option not in known:
                raise UnknownNameError(f"option of a {cls.name} fit", option, known)

    def ends(self, interval: Interval) -> tuple[float, float]:
        """Return both ends of an interval inside T; else ParameterError with the offender."""
        domain = self.domain
        if not (domain.start <= interval.start and interval.stop <= domain.stop):
            self.parameters([interval.start, interval.stop])
        return interval.start, interval.stop

    def parameters(self, t: ArrayLike) -> Array:
        """Return ``t`` as a float array, each inside T; else ParameterError with the offender."""
        array: Array = np.asarray(t, dtype=np.float64)
        start, stop = self.domain.start, self.domain.stop
        if array.ndim == 0:
            if start <= array <= stop:
                return array
        elif array.size == 0 or (array.min() >= start and array.max() <= stop):
            return array
        outside = array[~((array >= start) & (array <= stop))].flat[0] if array.ndim else array[()]
        raise ParameterError(
            f"t = {float(outside)!r} lies outside the domain [{start!r}, {stop!r}]"
        )


def starter(kinds: Iterable[type[Representation]]) -> Callable[..., Representation] | None:
    """Return ``from_points`` of the first kind that has it: a curve can start there.

    Returns
    -------
    callable or None
        Takes points (n, d) and ``t`` (n,), joins them by straight lines; None if no kind can.

    Examples
    --------
    >>> from multirep.representations import Nurbs, Polyline
    >>> starter([Nurbs, Polyline])([[0, 0], [1, 1]], t=[0, 1]).name
    'polyline'
    """
    makers = (getattr(kind, "from_points", None) for kind in kinds)
    return next((maker for maker in makers if maker is not None), None)
