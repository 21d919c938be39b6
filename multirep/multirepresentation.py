"""One conceptual curve in several representations, kept within a tolerance of each other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TypeVar, overload

import numpy as np

from multirep.arrays import ArrayLike
from multirep.authors import AuthorMap
from multirep.deviation import Deviation, deviation
from multirep.edit import Edit
from multirep.errors import RegistrationError, StaleEditError, UnknownNameError
from multirep.events import Committed, Event, Skipped
from multirep.freezing import check_still, frozen_error, with_claim, without_claim
from multirep.interval import Interval
from multirep.registry import Registry
from multirep.reparameterization import ParameterMap, with_parameters
from multirep.representation import Representation, starter
from multirep.samples import RecentSamples
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.synchronization import bring_up_to_date, check_edit, check_tolerance, evolve_stale
from multirep.tightening import with_tolerance

R = TypeVar("R", bound=Representation)


class MultiRepresentation:
    """One conceptual curve, held in every registered representation (Grimm-Ayers 4, 4.2).

    The only mutable object of the kernel; its state is one frozen value: :meth:`snapshot` is O(1).

    Parameters
    ----------
    curve : Representation
        The first author, of all of T.
    tolerance : float, keyword
        epsilon, in the units of the points: any two up-to-date representations are within it, for
        all t, proved.
    kinds : iterable of Representation classes, optional
        Which representations to keep; by default all registered ones.

    Raises
    ------
    ToleranceError
        When the tolerance is not positive, or below what rounding allows for coordinates of this
        size.

    Examples
    --------
    >>> import multirep as mr
    >>> from multirep.representations import Nurbs, Polyline
    >>> curve = mr.MultiRepresentation.from_points([[0, 0], [1, 2], [2, 0]], tolerance=1e-2)
    >>> polyline = curve.view(Polyline)
    >>> edit = polyline.move_vertex(1, [1.0, 3.0])
    >>> curve.commit(Polyline, edit)
    >>> print(curve.stale(Polyline), curve.deviation(Polyline, Nurbs).upper <= 1e-2)
     True
    """

    def __init__(
        self,
        curve: Representation,
        *,
        tolerance: float,
        kinds: Iterable[type[Representation]] | None = None,
    ) -> None:
        classes = list(Registry.discover().representations.values() if kinds is None else kinds)
        if type(curve) not in classes:
            classes.append(type(curve))
        self._kinds: dict[str, type[Representation]] = {}
        for kind in classes:
            if kind.name in self._kinds:
                raise RegistrationError(
                    f"two representations are named {kind.name!r}: "
                    f"{self._kinds[kind.name].__qualname__} and {kind.__qualname__}",
                    kind,
                )
            self._kinds[kind.name] = kind
        check_tolerance(curve.magnitude, tolerance=tolerance)
        held = {name: Held(None, SpliceList([curve.domain])) for name in self._kinds}
        held[curve.name] = Held(curve, SpliceList.EMPTY)
        self._state = State(float(tolerance), held, AuthorMap.of(curve.domain, curve.name))
        self._listeners: tuple[Callable[[Event], None], ...] = ()
        self._sample = RecentSamples()
        self.merged = 0

    @classmethod
    def from_points(
        cls,
        points: ArrayLike,
        *,
        tolerance: float,
        t: ArrayLike | None = None,
        kinds: Iterable[type[Representation]] | None = None,
    ) -> MultiRepresentation:
        """Start from points, (n, d), joined by straight lines.

        Parameters
        ----------
        points : (n, d) array_like
            Two distinct ones or more. Consecutive repeated points are merged; ``merged`` says how
            many.
        tolerance : float, keyword
        t : (n,) array_like, optional
            Strictly increasing parameters; by default the chord length, scaled to [0, 1].
        kinds : iterable of Representation classes, optional
            One of them must be able to start from points (the polyline is).
        """
        kinds = list(Registry.discover().representations.values() if kinds is None else kinds)
        start = starter(kinds)
        if start is None:
            names = [kind.name for kind in kinds]
            raise RegistrationError(f"no representation offers from_points; given: {names}")
        author = start(points, t=t)
        curve = cls(author, tolerance=tolerance, kinds=kinds)
        curve.merged = len(np.asarray(points)) - author.size
        return curve

    # -- asking ------------------------------------------------------------------------------------

    @property
    def domain(self) -> Interval:
        """The parameter interval T."""
        return self._state.authors.domain

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self._state.author_value(self._state.authors.names[0]).dimension

    @property
    def kinds(self) -> tuple[str, ...]:
        """The names of the representations that it keeps."""
        return tuple(self._kinds)

    @property
    def frozen(self) -> SpliceList:
        """Where nothing may change, in any representation; see :meth:`freeze`."""
        return self._state.frozen

    @property
    def claims(self) -> Mapping[str, SpliceList]:
        """What each freeze, by name, asked for."""
        return dict(self._state.claims)

    @property
    def authors(self) -> tuple[tuple[Interval, str], ...]:
        """Who last changed the curve by a tool or a constraint, stretch by stretch."""
        return tuple(self._state.authors)

    def stale(self, kind: type[Representation] | str) -> SpliceList:
        """Where ``kind`` has not yet taken over what the authors say."""
        return self._state.held[self._name(kind)].stale

    @overload
    def view(self, kind: type[R], where: SpliceList | Interval | None = None) -> R: ...
    @overload
    def view(self, kind: str, where: SpliceList | Interval | None = None) -> Representation: ...
    def view(
        self, kind: type[R] | str, where: SpliceList | Interval | None = None
    ) -> R | Representation:
        """Return ``kind``, brought up to date on all of T, or on ``where``.

        Parameters
        ----------
        kind : class or str
        where : SpliceList or Interval, optional
            Only that is worked on, and a little beside it (:mod:`multirep.windows`); elsewhere the
            value may be stale.

        Raises
        ------
        ToleranceError
            When the representation cannot prove the tolerance; the curve stays as it was, as it
            does on a KeyboardInterrupt or whatever a listener raises.
        """
        name = self._name(kind)
        state = self._state
        held = state.held[name]
        region = _region(where, self.domain) if held.stale else SpliceList.EMPTY
        if held.value is not None and not held.stale.intersects(region):
            self._emit(Skipped(name, "up to date"))
            return held.value
        kept = self._kinds[name]
        held = bring_up_to_date(state, kept, region, self._emit, self._sample)
        self._state = state.looked(name, None if where is None else region, held)
        assert held.value is not None
        return held.value

    def deviation(
        self,
        one: type[Representation] | str,
        two: type[Representation] | str,
        where: SpliceList | Interval | None = None,
    ) -> Deviation:
        """Bound the largest distance between two representations at equal t.

        Both are brought up to date first. ``lower`` was seen at some t; ``upper`` is proved for all
        t.
        """
        first, second = self.view(one, where), self.view(two, where)
        tolerance = self.tolerance
        found = deviation(first, second, _region(where, self.domain), scale=tolerance)
        # both are certified within half the tolerance of the author
        return Deviation(found.lower, max(found.lower, min(found.upper, tolerance)))

    # -- changing ----------------------------------------------------------------------------------

    def commit(
        self, kind: type[Representation] | str, edit: Edit[Representation], *, by: str | None = None
    ) -> None:
        """Make ``kind`` the author of the edit's splices; the others become stale there.

        Parameters
        ----------
        kind : class or str
        edit : Edit
            Of the present value of ``kind``, which must be up to date where the edit changes it.
        by : str, optional
            Who made the edit, for messages.

        Raises
        ------
        StaleEditError, PluginError, UnreportedChangeError, ToleranceError, FrozenError
            Nothing is changed then.
        """
        name = self._name(kind)
        held = self._state.held[name]
        if held.value is None:
            raise StaleEditError(f"{name!r} has no value yet: view it before editing it")
        magnitude = check_edit(held.value, edit, by or name)
        if not edit.splices:
            return
        if held.stale.intersects(edit.splices):
            raise StaleEditError(
                f"{name!r} is not up to date on {held.stale & edit.splices}: "
                "view it before editing it"
            )
        if edit.splices.intersects(self._state.frozen):
            raise frozen_error(self._state, edit.splices, by or name)
        check_tolerance(magnitude, tolerance=self.tolerance)
        changed = Held(edit.value, held.stale)
        self._state = evolve_stale(self._state, name, changed, edit.splices)
        self._sample.edited(held.value, edit)
        self._emit(Committed(name, edit.splices))

    def reparameterize(self, mapping: ParameterMap = "even") -> SpliceList:
        """Map the parameters of the whole curve: the same place in space, at another t.

        The authors are sampled as for a fit; that polyline at the mapped parameters becomes the
        only author, and every other representation follows when it is viewed.

        Parameters
        ----------
        mapping : "even" or pair of (k,) array_like
            Even speed; or the knots of a piecewise linear map, old t and new t, both increasing
            strictly over T.

        Returns
        -------
        SpliceList
            Where the curve changed: all of T, or nothing when its parameters are so already.

        Raises
        ------
        EditError, RegistrationError, FrozenError
            When the map is not monotone or does not map T to itself; when no representation is kept
            that can be made of points; when a stretch is frozen. Nothing is changed then.

        Examples
        --------
        >>> import multirep as mr
        >>> curve = mr.MultiRepresentation.from_points(
        ...     [[0, 0], [1, 0], [4, 0]], t=[0, 0.5, 1], tolerance=1e-2
        ... )
        >>> print(curve.reparameterize())
        [0,1]
        >>> float(curve.view("polyline").t[1])
        0.25
        """
        after = with_parameters(self._state, self._kinds.values(), mapping, self._emit)
        if after is self._state:
            return SpliceList.EMPTY
        self._state = after
        return SpliceList.of(self.domain)

    @property
    def tolerance(self) -> float:
        """Epsilon, settable; tightening makes stale what cannot be proved to meet it."""
        return self._state.tolerance

    @tolerance.setter
    def tolerance(self, tolerance: float) -> None:
        for held in self._state.held.values():
            if held.value is not None:
                check_tolerance(held.value.magnitude, tolerance=tolerance)
        after = with_tolerance(self._state, float(tolerance), self._emit)
        check_still(self._state, after)
        self._state = after

    def freeze(self, name: str, where: SpliceList | Interval) -> None:
        """Keep a stretch bit-identical in every representation until :meth:`thaw`.

        All representations are brought up to date and prepared first; see
        :mod:`multirep.freezing`. ``frozen`` may be a sliver more than was asked for.

        Raises
        ------
        EditError
            When the stretch is empty or not in T, or the name is in use.
        """
        for kind in self._kinds:
            self.view(kind)
        self._state = with_claim(self._state, name, _region(where, self.domain), self._emit)

    def thaw(self, name: str, *, tidy: bool = True) -> None:
        """Release what was frozen under ``name``; stretches that others froze stay so.

        With ``tidy``, representations take the controls back that the freeze cost them.
        """
        if name not in self._state.claims:
            raise UnknownNameError("frozen stretch", name, self._state.claims)
        if len(self._state.claims) > 1:
            for kind in self._kinds:
                self.view(kind)
        self._state = without_claim(self._state, name, self._emit, tidy=tidy)

    def snapshot(self) -> State:
        """Return the whole state, O(1); nothing is copied."""
        return self._state

    def restore(self, state: State) -> None:
        """Go back (or forth) to a snapshot of this curve, O(1)."""
        self._state = state

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Everything or nothing: an exception in the block restores the state from before it."""
        before = self._state
        try:
            yield
        except BaseException:
            self._state = before
            raise

    # -- listening ---------------------------------------------------------------------------------

    @contextmanager
    def listening(self, listener: Callable[[Event], None] | None = None) -> Iterator[list[Event]]:
        """Collect the events of the block, and tell ``listener`` each as it happens.

        Examples
        --------
        >>> import multirep as mr
        >>> curve = mr.MultiRepresentation.from_points([[0, 0], [1, 1]], tolerance=1e-2)
        >>> with curve.listening() as events:
        ...     _ = curve.view("polyline")
        >>> events
        [Skipped(kind='polyline', reason='up to date')]
        """
        events: list[Event] = []
        before = self._listeners
        self._listeners = (*before, events.append, *([listener] if listener else []))
        try:
            yield events
        finally:
            self._listeners = before

    def _emit(self, event: Event) -> None:
        for listener in self._listeners:
            listener(event)

    def _name(self, kind: type[Representation] | str) -> str:
        name = kind if isinstance(kind, str) else kind.name
        if name not in self._kinds:
            raise UnknownNameError("representation", name, self._kinds)
        return name

    def __repr__(self) -> str:
        sizes = ", ".join(
            f"{name}: {held.value.size if held.value is not None else 'not viewed'}"
            for name, held in self._state.held.items()
        )
        return f"MultiRepresentation(tolerance={self.tolerance:g}, {sizes})"


def _region(where: SpliceList | Interval | None, domain: Interval) -> SpliceList:
    if where is None:
        return SpliceList.of(domain)
    return SpliceList.of(where) if isinstance(where, Interval) else where
