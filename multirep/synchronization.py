"""Bringing a representation up to date: which stretch to splice, from what, how closely.

One hop from the author to a representation has delta = epsilon/2 (DESIGN section 3). The author
is sampled within delta/8, because a sagitta is charged twice; the splice gets what the certificate
of the samples leaves. The first attempt asks for 7/8 of that, so that later splices find a little
room at its ends (a first view for 15/16); if it cannot be had, the second attempt asks for all of
it, and further ones take in more of the neighbourhood.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from time import perf_counter_ns

import numpy as np

from multirep.bulk import composed_in_pieces
from multirep.edit import Edit
from multirep.errors import (
    InvalidCurveError,
    InvariantError,
    MultirepError,
    PluginError,
    ToleranceError,
    UnreportedChangeError,
)
from multirep.events import Begun, Event, Fitted
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.samples import RecentSamples, Sampler
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.windows import Window, crude, faded, windows, worthwhile

#: Part of a hop that sampling may use. Larger leaves the fit less (it pays the sagitta again),
#: smaller costs samples with the root of it.
SAMPLING_SHARE = 1 / 8
#: Part of a hop by which long curves are thinned, a piece at a time, before they are fitted.
THINNING_SHARE = 1 / 32
#: Part of the rest that the first attempt asks for; what it leaves is room for the gaps of later
#: splices.
FIRST_SHARE = 7 / 8
#: The same for a first view. Larger saves control points (1 per cent of them on smooth curves, 6 on
#: rough ones), and few of its places ever become ends of splices. What it leaves is what a proof
#: from other samples may need, when the tolerance is changed and changed back.
VIEW_SHARE = 15 / 16
#: How far beyond a stale splice, in its lengths, each attempt may reach. Small first: a splice that
#: stays local costs little, but needs a place where the old curve is close to the author.
REACHES = (1.0, 1.0, 4.0, 32.0, 1024.0)
#: Smallest tolerance in terms of the largest coordinate: sampling ends at 1/1024 of it, where the
#: rounding terms of the certificates (about 64 ulp) must still vanish.
SMALLEST_TOLERANCE = 2.0**-36
#: Where in each splice a kind that does not bound its coordinates is looked at for finite ones.
LOOKS = (0.0, 0.25, 0.5, 0.75, 1.0)


def hop(tolerance: float) -> float:
    """How far a representation may be from the author when any two may differ by ``tolerance``."""
    return 0.5 * tolerance


def bring_up_to_date(
    state: State,
    kind: type[Representation],
    where: SpliceList,
    emit: Callable[[Event], None],
    sample: RecentSamples | None = None,
) -> Held:
    """Return what is held of ``kind`` when it follows the authors on ``where``.

    Cost: that of what is stale on ``where``, see :mod:`multirep.windows`; a first view of most of T
    fits all of it.

    Raises
    ------
    ToleranceError
        When the representation cannot prove the tolerance on some stretch.
    PluginError, UnreportedChangeError
        When a representation breaks its contract.
    """
    sample = sample or RecentSamples()
    heard: list[Exception] = []

    def told(event: Event) -> None:
        try:
            emit(event)
        except Exception as error:
            heard.append(error)
            raise

    held = state.held[kind.name]
    try:
        if held.value is None:
            begun = _begun(state, kind, where, told)
            if begun is None:
                return Held(_first_fit(state, kind, told, sample), SpliceList.EMPTY)
            held = begun
        for job in _jobs(state, kind.name, held.stale, where):
            held = _splice_in(state, kind, held, job, told, sample)
    except MultirepError:
        raise
    except Exception as error:
        if heard and error is heard[-1]:
            raise  # a listener's own
        raise PluginError(
            f"bringing {kind.name!r} up to date failed with {type(error).__name__}: {error}",
            kind.name,
        ) from error
    return held


def _begun(
    state: State, kind: type[Representation], where: SpliceList, emit: Callable[[Event], None]
) -> Held | None:
    """Return a crude value, stale everywhere; None when all of T had better be fitted."""
    domain = state.authors.domain
    everywhere = SpliceList.of(domain)
    delta = hop(state.tolerance)
    asked = list(windows(everywhere, where, domain))
    if any(worthwhile(state, window, delta=delta).fresh == domain for window in asked):
        return None
    value = crude(state, kind, delta=delta)
    if value is None:
        return None
    emit(Begun(kind.name, value.size))
    return Held(value, everywhere)


def _jobs(state: State, name: str, stale: SpliceList, where: SpliceList) -> Iterator[Window]:
    """Windows to work on; whole stale splices that are closer than they are long go together.

    Not across what is frozen or what ``name`` itself authored: that must not be fitted anew.
    """
    job: Window | None = None
    for asked in windows(stale, where, state.authors.domain):
        window = worthwhile(state, asked, delta=hop(state.tolerance)) if asked.cut else asked
        if job is not None:
            window = window.after(job.fresh.stop)
        if job is not None and job.is_near(window):
            gap = Interval(job.fresh.stop, window.fresh.start)
            mine = any(author == name for _, author in state.authors.segments(gap))
            if not (mine or state.frozen.intersects(SpliceList.of(gap))):
                job = job.hull(window)
                continue
        if job is not None:
            yield job
        job = window
    if job is not None:
        yield job


def _first_fit(
    state: State, kind: type[Representation], emit: Callable[[Event], None], sample: Sampler
) -> Representation:
    delta = hop(state.tolerance)
    sampled = composed_in_pieces(
        state,
        state.authors.domain,
        kind.name,
        tolerance=SAMPLING_SHARE * delta,
        limit=THINNING_SHARE * delta,
        emit=emit,
        sample=sample,
    )
    begin = perf_counter_ns()
    rest = delta - sampled.bound
    try:
        value = kind.fit(sampled, tolerance=VIEW_SHARE * rest)
    except ToleranceError:
        try:
            value = kind.fit(sampled, tolerance=rest)
        except ToleranceError as error:
            raise ToleranceError(
                f"{kind.name} cannot follow the curve within {state.tolerance:g}: {error}",
                tolerance=state.tolerance,
                reachable=error.reachable,
                where=error.where,
            ) from error
    if not isinstance(value, kind):
        raise PluginError(f"{kind.name!r}.fit returned a {type(value).__name__}", kind.name)
    domain = state.authors.domain
    if value.domain != domain or value.dimension != sampled.dimension:
        raise PluginError(
            f"{kind.name!r}.fit returned a curve over {value.domain} in {value.dimension} "
            f"coordinates, not over {domain} in {sampled.dimension}",
            kind.name,
        )
    elapsed = (perf_counter_ns() - begin) / 1000
    emit(Fitted(kind.name, domain, SpliceList.of(domain), value.size, rest, elapsed))
    return value


def _splice_in(
    state: State,
    kind: type[Representation],
    held: Held,
    job: Window,
    emit: Callable[[Event], None],
    sample: RecentSamples,
) -> Held:
    """Bring one window up to date, reaching out as far as it takes."""
    value = held.value
    assert value is not None
    delta = hop(state.tolerance)
    room = _room(state, kind.name, held.stale, job.stale)
    last: ToleranceError | None = None
    composed: SampledSplice | None = None
    for attempt, reach in enumerate(REACHES):
        within, least = job.within(reach, room), job.target()
        target = value.reach(least, within)
        if not (within.contains(target) and target.contains(least)):
            raise InvariantError(
                f"{kind.name}.reach left {within} or lost a part of {least}", target
            )
        if attempt > 1:
            if composed is not None and composed.interval == within:
                break  # nothing more to reach for
            target = within
        begin = perf_counter_ns()
        if composed is None or composed.interval != target:
            fixed = (
                value if target.start == room.start > value.domain.start else None,
                value if target.stop == room.stop < value.domain.stop else None,
            )
            composed = composed_in_pieces(
                state,
                target,
                kind.name,
                tolerance=SAMPLING_SHARE * delta,
                limit=THINNING_SHARE * delta,
                fixed=fixed,
                emit=emit,
                sample=sample,
            )
            sampled = faded(composed, value, job, delta=delta) if job.cut else composed
            begin = perf_counter_ns()
        rest = delta - composed.bound
        try:
            edit = value.splice(sampled, tolerance=rest if attempt else FIRST_SHARE * rest)
        except ToleranceError as error:
            last = error
            continue
        check_edit(value, edit, kind.name)
        _check_frozen(state, edit, kind.name)
        sample.edited(value, edit)
        elapsed = (perf_counter_ns() - begin) / 1000
        emit(Fitted(kind.name, target, edit.splices, edit.value.size, edit.bound, elapsed))
        return Held(edit.value, held.stale - SpliceList.of(job.refreshed(target)))
    assert last is not None
    if job.cut:
        return _splice_in(state, kind, held, Window(job.stale, job.stale), emit, sample)
    raise ToleranceError(
        f"{kind.name} cannot follow the curve on {job.stale} within {state.tolerance:g}: {last}",
        tolerance=state.tolerance,
        where=last.where,
    ) from last


def _room(state: State, name: str, stale: SpliceList, job: Interval) -> Interval:
    """How far a splice may reach: not into what ``name`` authored, another stale stretch or ice."""
    room = state.authors.room(job, name)
    if len(stale) == 1 and not state.frozen:
        return room
    others = (stale | state.frozen) - SpliceList.of(job)
    for other in others & SpliceList.of(room):
        if other.stop <= job.start:
            room = Interval(max(room.start, other.stop), room.stop)
        else:
            room = Interval(room.start, min(room.stop, other.start))
    return room


def _check_frozen(state: State, edit: Edit[Representation], kind: str) -> None:
    """Raise when a splice changed what is frozen; what merely guards it may be re-represented."""
    if not edit.splices.intersects(state.frozen):
        return
    for name, claim in state.claims.items():
        if claim.intersects(edit.splices):
            raise PluginError(
                f"{kind!r} changed {edit.splices & claim}, which {name!r} keeps frozen", kind
            )


def check_edit(before: Representation, edit: Edit[Representation], plugin: str) -> float:
    """Raise unless ``edit`` is a sound change of ``before``; ``plugin`` is who made it.

    Returns how large the coordinates are, :attr:`multirep.Representation.magnitude`.

    Checked: its types, domain and dimension; that it is finite; that its splices lie in T; and,
    locally (shared blocks are not looked into), that it reports all that it changed.

    Raises
    ------
    PluginError
    UnreportedChangeError
    """
    if not isinstance(edit, Edit) or not isinstance(edit.splices, SpliceList):
        raise PluginError(f"{plugin!r} must return an Edit, got {type(edit).__name__}", plugin)
    after = edit.value
    if type(after) is not type(before):
        raise PluginError(
            f"{plugin!r} returned a {type(after).__name__} "
            f"where a {type(before).__name__} was edited",
            plugin,
        )
    if after.domain != before.domain or after.dimension != before.dimension:
        raise PluginError(
            f"{plugin!r} changed the domain or the dimension: from {before.domain} in "
            f"{before.dimension} coordinates to {after.domain} in {after.dimension}",
            plugin,
        )
    if not edit.splices.lies_in(before.domain):
        raise PluginError(
            f"{plugin!r} reports splices {edit.splices} outside the domain {before.domain}", plugin
        )
    magnitude = after.magnitude
    finite = math.isfinite(magnitude)
    if finite and edit.splices and type(after).magnitude is Representation.magnitude:
        # nobody vouched for all coordinates
        looks = [min(a + look * (b - a), b) for a, b in edit.splices for look in LOOKS]
        finite = bool(np.isfinite(after(looks)).all())
    if not finite:
        raise PluginError(f"{plugin!r} returned a curve with NaN or infinite coordinates", plugin)
    changed = before.changes(after)
    if not isinstance(changed, SpliceList):
        raise PluginError(
            f"{before.name!r}.changes must return a SpliceList, got {type(changed).__name__}",
            before.name,
        )
    if not edit.splices.contains(changed):
        raise UnreportedChangeError(
            f"{plugin!r} changed {changed - edit.splices} without reporting it "
            f"(reported: {edit.splices or 'nothing'})"
        )
    return magnitude


def check_tolerance(magnitude: float, *, tolerance: float) -> None:
    """Raise unless the tolerance is positive and rounding allows it for coordinates so large."""
    if not (math.isfinite(tolerance) and tolerance > 0):
        raise ToleranceError(
            f"the tolerance must be positive and finite, got {tolerance!r}", tolerance=tolerance
        )
    if not math.isfinite(magnitude):
        raise InvalidCurveError("the curve has NaN or infinite coordinates")
    reachable = SMALLEST_TOLERANCE * magnitude
    if tolerance < reachable:
        raise ToleranceError(
            f"tolerance {tolerance:g} is below rounding for coordinates up to {magnitude:g}: "
            f"the smallest reachable is {reachable:.3g}",
            tolerance=tolerance,
            reachable=reachable,
        )


def evolve_stale(state: State, name: str, changed: Held, splices: SpliceList) -> State:
    """Return the state after ``name`` changed the curve: author there, the others stale."""
    held = {
        other: item if item.value is None else Held(item.value, item.stale | splices)
        for other, item in state.held.items()
    }
    held[name] = changed
    return state.with_author(held, state.authors.assigned(splices, name))
