"""First views of long curves: in pieces, bounded in memory, told about, and interruptible."""

from __future__ import annotations

import tracemalloc
from typing import Any

import numpy as np
import pytest

import multirep as mr
from multirep.arrays import Array
from multirep.bulk import LONG, PIECE, composed_in_pieces
from multirep.composition import SHORT_FIRST_CHORDS
from multirep.events import Event, Fitting, Sampled
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.samples import RecentSamples
from multirep.thinning import PART, thinned

FOLLOWERS = [Nurbs, WaveletBSpline]
KINDS: list[type[Representation]] = [Polyline, *FOLLOWERS]
TOLERANCE = 1e-3
PIECES = 4


def wavy(n: int) -> Array:
    t = np.linspace(0, 2 * np.pi, n)
    return np.column_stack([np.cos(t) + 0.05 * np.cos(20 * t), np.sin(t) + 0.05 * np.sin(17 * t)])


@pytest.fixture(scope="module")
def curve() -> mr.MultiRepresentation:
    points = wavy(PIECES * PIECE - 5)
    return mr.MultiRepresentation.from_points(points, tolerance=TOLERANCE, kinds=KINDS)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_a_long_curve_is_followed_in_pieces(
    curve: mr.MultiRepresentation, kind: type[Representation]
) -> None:
    """Listeners hear of each piece; the result is as close and as frugal as of few vertices."""
    before = curve.snapshot()
    with curve.listening() as events:
        value = curve.view(kind)
    steps = [event for event in events if isinstance(event, Fitting)]
    assert steps == [Fitting(kind.name, k + 1, PIECES + 1) for k in range(PIECES)]
    sampled = [event.interval for event in events if isinstance(event, Sampled)]
    assert len(sampled) == PIECES
    assert curve.deviation(Polyline, kind).upper <= TOLERANCE
    few = mr.MultiRepresentation.from_points(wavy(10_000), tolerance=TOLERANCE, kinds=KINDS)
    assert value.size <= 1.1 * few.view(kind).size
    curve.restore(before)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_memory_is_that_of_a_piece(
    curve: mr.MultiRepresentation, kind: type[Representation]
) -> None:
    """Besides the curve itself, a piece's worth of samples and their sifting."""
    before = curve.snapshot()
    tracemalloc.start()
    curve.view(kind)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    curve.restore(before)
    assert peak <= 200 * PIECE


@pytest.mark.parametrize("raised", [KeyboardInterrupt, RuntimeError, mr.errors.EditError])
def test_an_interrupted_view_leaves_the_curve(
    curve: mr.MultiRepresentation, raised: type[BaseException]
) -> None:
    """Whatever a listener raises ends the view, comes out as it is, and changes nothing."""
    before = curve.snapshot()
    told: list[Event] = []

    def listener(event: Event) -> None:
        told.append(event)
        if isinstance(event, Fitting) and event.done == 2:
            raise raised("enough")

    with curve.listening(listener) as events, pytest.raises(raised, match=r"^enough") as caught:
        curve.view(Nurbs)
    assert caught.type is raised
    assert curve.snapshot() is before
    assert told == events
    assert sum(isinstance(event, Sampled) for event in events) == 2
    assert curve.stale(Nurbs).contains(curve.domain)


def test_thinned_pieces_are_certified(curve: mr.MultiRepresentation) -> None:
    """The polyline is within its own bounds of the author, chord by chord, and far shorter."""
    limit = TOLERANCE / 64
    state = curve.snapshot()
    sampled = composed_in_pieces(
        state, curve.domain, "nurbs", tolerance=limit, limit=limit, emit=lambda _: None
    )
    assert sampled.interval == curve.domain
    assert len(sampled.t) < 2000 * PIECES
    polyline = curve.view(Polyline)
    t = np.asarray(polyline.t)
    off = np.linalg.norm(polyline.points - sampled(t), axis=1)
    chords = np.minimum(sampled.t.searchsorted(t, "right") - 1, len(sampled.t) - 2)
    assert sampled.chord_bounds is not None
    assert (off <= sampled.chord_bounds[chords] + 1e-15).all()
    assert sampled.bound == sampled.chord_bounds.max() <= limit * (1 + 1e-9)


def test_chords_at_fixed_ends_leave_the_gap_its_room(curve: mr.MultiRepresentation) -> None:
    """Where a splice must meet what stands apart, next to nothing is left out."""
    state, polyline = curve.snapshot(), curve.view(Polyline)
    inside = mr.Interval(float(polyline.t[5]), float(polyline.t[polyline.size - 7]))
    limit = TOLERANCE / 64
    apart = Polyline(np.asarray(polyline.t), polyline.points + np.array([2 * limit, 0.0]))
    short = SHORT_FIRST_CHORDS * 2 * limit
    sizes = []
    for fixed in ((None, None), (polyline, polyline), (apart, None), (None, apart), (apart, apart)):
        sampled = composed_in_pieces(
            state,
            inside,
            "nurbs",
            tolerance=limit,
            limit=limit,
            fixed=fixed,
            emit=lambda _: None,
        )
        assert sampled.interval == inside
        assert sampled.chord_bounds is not None
        for end, at in zip(fixed, (0, -1), strict=True):
            assert (sampled.chord_bounds[at] <= short) == (end is apart)
        sizes.append(len(sampled.t))
    assert max(sizes) <= min(sizes) + 64


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_a_long_stale_stretch_is_followed_in_pieces(
    curve: mr.MultiRepresentation, kind: type[Representation]
) -> None:
    """After all of a long curve moved, too, in the memory of a piece."""
    before = curve.snapshot()
    curve.view(kind)
    polyline = curve.view(Polyline)
    moved = Polyline(np.asarray(polyline.t), polyline.points + np.array([0.3, 0.2]))
    curve.commit(Polyline, mr.Edit(moved, mr.SpliceList([curve.domain])))
    tracemalloc.start()
    with curve.listening() as events:
        curve.view(kind)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak <= 200 * PIECE
    assert sum(isinstance(event, Fitting) for event in events) == PIECES
    assert curve.deviation(Polyline, kind).upper <= TOLERANCE
    curve.restore(before)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_dense_vertices_cost_a_follower_nothing(
    kind: type[Representation], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A fit is tried against as many samples of a stretch however many vertices it has."""
    given: list[int] = []
    splice = kind.splice

    def counted(self: Any, sampled: SampledSplice, *, tolerance: float) -> Any:
        given.append(len(sampled.t))
        return splice(self, sampled, tolerance=tolerance)

    monkeypatch.setattr(kind, "splice", counted)
    for n in (32 * LONG, 8 * 32 * LONG):
        curve = mr.MultiRepresentation.from_points(wavy(n), tolerance=TOLERANCE, kinds=KINDS)
        curve.view(kind)
        polyline = curve.view(Polyline)
        low, high = (polyline.t.searchsorted(at) for at in (0.5, 0.55))
        t, rows = polyline.t[low:high], polyline.points[low:high]
        bump = np.sin(np.linspace(0, np.pi, high - low)) ** 2
        moved = polyline.replace(low, high, t, rows + 0.02 * bump[:, None])
        curve.commit(Polyline, moved)
        curve.view(kind)
    assert len(given) == 2
    assert max(given) <= min(1.25 * min(given), LONG / 4)


def test_samples_chosen_for_a_tolerance_are_left_alone(
    curve: mr.MultiRepresentation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of a spline are as few as need be: nobody looks for some to leave out."""
    sampled = curve.view(Nurbs).sample(curve.domain, tolerance=TOLERANCE)
    monkeypatch.setattr("multirep.thinning.simplified", None)
    assert thinned(sampled, TOLERANCE / 4) is sampled


def drag(curve: mr.MultiRepresentation, kind: type[Representation], k: int) -> None:
    """Move something to and fro, and look at everything."""
    value = curve.view(kind)
    if isinstance(value, Nurbs):
        control = int(value.knots.searchsorted(0.37)) - 2
        at = value.points[control]
        edit: Any = value.move_control_point(control, at + TOLERANCE * (-1) ** k)
    else:
        assert isinstance(value, WaveletBSpline)
        edit = value.sweep(0.37, value(0.37) + TOLERANCE * (-1) ** k, 6)
    curve.commit(kind, edit)
    for each in KINDS:
        curve.view(each)


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_dense_vertices_beside_a_drag_are_read_once(
    kind: type[Representation], monkeypatch: pytest.MonkeyPatch
) -> None:
    """While a place is dragged, a follower samples no more of the polyline than its ends move."""
    rows: list[int] = []
    sample = Polyline.sample

    def counted(self: Polyline, interval: mr.Interval, *, tolerance: float) -> SampledSplice:
        sampled = sample(self, interval, tolerance=tolerance)
        rows.append(len(sampled.t))
        return sampled

    curve = mr.MultiRepresentation.from_points(wavy(1024 * LONG), tolerance=TOLERANCE, kinds=KINDS)
    for each in KINDS:
        curve.view(each)
    monkeypatch.setattr(Polyline, "sample", counted)
    drag(curve, kind, 0)
    assert sum(rows) > 4 * PART
    rows.clear()
    for k in range(1, 9):
        drag(curve, kind, k)
    assert len(rows) <= 2 * 8
    assert max(rows, default=0) <= 2 * PART


@pytest.mark.parametrize("kind", FOLLOWERS)
def test_what_was_thinned_before_does_not_show(kind: type[Representation]) -> None:
    """The same bits come out of a drag when all is thinned anew at each step."""
    one, two = (
        mr.MultiRepresentation.from_points(wavy(256 * LONG), tolerance=TOLERANCE, kinds=KINDS)
        for _ in range(2)
    )
    for k in range(6):
        two._sample = RecentSamples()
        for curve in (one, two):
            drag(curve, kind, k)
        for each in KINDS:
            mine, theirs = one.view(each), two.view(each)
            assert not mine.changes(theirs)
            assert np.asarray(mine.points).tobytes() == np.asarray(theirs.points).tobytes()  # type: ignore[attr-defined]
