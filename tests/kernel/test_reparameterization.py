"""Maps of T: the same place in space at another t, for all representations together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.arrays import Array
from multirep.errors import ConflictError, EditError, FrozenError, RegistrationError
from multirep.events import Committed
from multirep.nearest import distance_to_chords
from multirep.reparameterization import reparameterized
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.spacing import clearance, room, told_apart
from multirep.testing import check_certificate, check_same
from multirep.testing.strategies import parameters, polylines
from multirep.tools import MoveVertex

KINDS = (Polyline, Nurbs, WaveletBSpline)


def spiral(count: int = 200) -> tuple[Array, Array]:
    """A spiral whose speed by t grows fourteenfold."""
    t = np.linspace(0, 1, count)
    angle = 1 + 6 * t**2
    return t, np.stack([angle * np.cos(angle), angle * np.sin(angle)], axis=1)


def curve_of(tolerance: float = 0.02) -> mr.MultiRepresentation:
    t, points = spiral()
    return mr.MultiRepresentation(Polyline(t, points), tolerance=tolerance)


@st.composite
def maps(draw: st.DrawFn) -> tuple[Array, Array]:
    """Monotone maps of [0, 1] with knots on a grid."""
    old = draw(parameters())
    new = draw(parameters(min_size=len(old), max_size=len(old)))
    return old, new


@given(polylines(), maps())
def test_a_map_moves_parameters_and_nothing_else(
    curve: tuple[Array, Array], mapping: tuple[Array, Array]
) -> None:
    """What was at t is at the new t, for every t; ends stay ends."""
    t, points = curve
    new_t, new_points = reparameterized(SampledSplice(t, points), mapping)
    assert (new_t[0], new_t[-1]) == (t[0], t[-1])
    assert (np.diff(new_t) > 0).all()
    at = np.union1d(np.linspace(0, 1, 65), t)
    before = SampledSplice(t, points)(at)
    after = SampledSplice(new_t, new_points)(np.interp(at, *mapping))
    assert after == pytest.approx(before, abs=1e-9)


@given(polylines(), maps())
def test_a_map_and_its_inverse_cancel(
    curve: tuple[Array, Array], mapping: tuple[Array, Array]
) -> None:
    """There and back again is where it was, but for rounding and the knots as vertices."""
    t, points = curve
    there = reparameterized(SampledSplice(t, points), mapping)
    back = SampledSplice(*reparameterized(SampledSplice(*there), (mapping[1], mapping[0])))
    assert back(t) == pytest.approx(points, abs=1e-9)


@given(polylines())
def test_even_means_even_and_again_changes_nothing(curve: tuple[Array, Array]) -> None:
    """Parameters in proportion to length; places at which the curve rested are passed at once."""
    t, points = reparameterized(SampledSplice(*curve), "even")
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert np.diff(t) == pytest.approx(lengths / lengths.sum(), abs=1e-12)
    again, same = reparameterized(SampledSplice(t, points), "even")
    assert (same == points).all()
    assert again == pytest.approx(t, abs=1e-15)


@pytest.mark.parametrize(
    ("mapping", "message"),
    [
        ("uneven", "'even' or a pair of arrays.*got 'uneven'"),
        (([0, 0.5, 1],), "'even' or a pair of arrays"),
        (([0, 0.5, 1], [0, 1]), r"as many new parameters.*shapes \(3,\) and \(2,\)"),
        (([0.5], [0.5]), "two knots or more"),
        (([0, 0.6, 0.6, 1], [0, 0.2, 0.5, 1]), "monotone: the old parameter .*0.6"),
        (([0, 0.2, 0.6, 1], [0, 0.5, 0.4, 1]), "monotone: the new parameter .*0.5.*0.4"),
        (([0, 0.2, 1], [0, np.nan, 1]), "the new parameters of a map must be finite"),
        (([0, 0.9], [0, 0.9]), r"\[0.0, 1.0\] to itself; the old parameters run from 0.0 to 0.9"),
        (([0, 1], [0, 2]), "the new parameters run from 0.0 to 2.0"),
        (([0, 0.5, 1], [0, 1e-14, 1]), "squeezes the curve around"),
    ],
)
def test_what_is_no_monotone_map_of_t_is_refused(mapping: Any, message: str) -> None:
    """With the offending parameters; the curve stays as it was."""
    curve = curve_of()
    before = curve.snapshot()
    with pytest.raises(EditError, match=message):
        curve.reparameterize(mapping)
    assert curve.snapshot() is before


@pytest.mark.parametrize("author", KINDS)
@pytest.mark.parametrize(
    "mapping", ["even", ([0, 0.3, 1], [0, 0.6, 1])], ids=["even", "two pieces"]
)
def test_all_representations_follow_and_the_shape_stays(author: Any, mapping: Any) -> None:
    """Whoever the author was: a certificate for each pair, and nobody leaves the old shape."""
    curve = mr.MultiRepresentation(curve_of().view(author), tolerance=0.02)
    old = {kind: curve.view(kind) for kind in KINDS}
    with curve.listening() as events:
        changed = curve.reparameterize(mapping)
    assert changed == mr.SpliceList([curve.domain])
    assert [event.splices for event in events if isinstance(event, Committed)] == [changed]
    assert curve.authors == ((curve.domain, "polyline"),)
    for kind in (Nurbs, WaveletBSpline):
        assert curve.stale(kind) == changed
    at = np.linspace(0, 1, 501)
    for kind in KINDS:
        new = curve.view(kind)
        shape = np.asarray(old[author].sample(curve.domain, tolerance=1e-5).points)
        off = [distance_to_chords(shape[:-1], shape[1:], point)[1].min() for point in new(at)]
        assert max(off) <= curve.tolerance
    check_certificate(curve)
    if mapping == "even":
        finer = curve.view(Polyline)(np.linspace(0, 1, 5001))  # chords of bends are shorter
        speed = np.linalg.norm(np.diff(finer, axis=0), axis=1).reshape(500, 10).sum(axis=1)
        assert speed.max() <= 1.03 * speed.min()


def test_even_speed_twice_is_once() -> None:
    """A curve that is even already is left alone: nobody becomes stale."""
    curve = curve_of()
    curve.reparameterize()
    views = [curve.view(kind) for kind in KINDS]
    before = curve.view(Polyline)
    curve.reparameterize()
    t = np.asarray(curve.view(Polyline).t)
    assert t == pytest.approx(np.asarray(before.t), abs=1e-15)
    even = mr.MultiRepresentation.from_points([[0, 0], [1, 0], [1, 1]], tolerance=1e-3)
    for kind in KINDS:
        even.view(kind)
    assert even.reparameterize() == mr.SpliceList.EMPTY
    assert even.stale(Nurbs).is_empty
    assert len(views) == 3


def test_it_never_drifts() -> None:
    """Forty maps there and back leave the polyline where it was, to rounding."""
    curve = curve_of()
    before = curve.view(Polyline)
    old, new = np.array([0, 0.2, 0.7, 1]), np.array([0, 0.5, 0.6, 1])
    for _ in range(20):
        curve.reparameterize((old, new))
        curve.view(Nurbs)
        curve.reparameterize((new, old))
    at = np.asarray(before.t)
    assert curve.view(Polyline)(at) == pytest.approx(before(at), abs=1e-12)
    assert curve.view(Polyline).size == before.size + 2


def test_one_undo_step_in_a_session() -> None:
    """Undo and redo restore every representation bit for bit; edits go on afterwards."""
    session = mr.Session()
    session.add("spiral", curve_of())
    curve = session.curve("spiral")
    before = [curve.view(kind) for kind in KINDS]
    outcome = session.reparameterize("spiral")
    assert outcome.changed == mr.SpliceList([(0, 1)])
    after = [curve.view(kind) for kind in KINDS]
    assert session.undoable == 1
    session.undo()
    for kind, value in zip(KINDS, before, strict=True):
        assert curve.view(kind) is value
    session.redo()
    for kind, value in zip(KINDS, after, strict=True):
        check_same(curve.view(kind), value)
    session.apply("spiral", MoveVertex(index=50, to=(0.0, 0.0)))
    check_certificate(curve)


def test_what_stands_at_parameters_forbids_it() -> None:
    """Under constraints, or with a frozen stretch, it is refused, with their names."""
    from multirep.constraints import PointConstraint

    session = mr.Session()
    session.add("spiral", curve_of())
    place = session.curve("spiral").view(Nurbs)(0.5)
    session.constrain("spiral", PointConstraint(t=0.5, point=place), name="pin")
    before = session.curve("spiral").snapshot()
    with pytest.raises(ConflictError, match="'pin'") as caught:
        session.reparameterize("spiral")
    assert caught.value.constraints == ("pin",)
    assert session.curve("spiral").snapshot() is before
    assert session.undoable == 1
    session.release("spiral", "pin")
    session.reparameterize("spiral")
    frozen = curve_of()
    for kind in KINDS:
        frozen.view(kind)
    frozen.freeze("ears", mr.SpliceList([(0.2, 0.4)]))
    with pytest.raises(FrozenError):
        frozen.reparameterize()


def test_it_needs_a_representation_made_of_points() -> None:
    """Without a polyline or its like there is no one to be the author; the message says who is."""
    curve = mr.MultiRepresentation(
        Nurbs(degree=1, knots=[0, 0, 1, 1], points=[[0, 0], [1, 1]]), tolerance=0.01, kinds=[Nurbs]
    )
    with pytest.raises(RegistrationError, match="as the polyline; this curve keeps nurbs"):
        curve.reparameterize()


@given(st.lists(st.floats(0, 1), min_size=2, max_size=60), st.integers(0, 40))
def test_parameters_told_apart_keep_their_distance(values: list[float], power: int) -> None:
    """Ends stay, neighbours keep their distance, and nobody is left far from a chosen one."""
    t = np.sort(np.array([0.0, 1.0, *np.array(values) * 2.0**-power]))
    chosen = told_apart(t)
    assert (chosen[0], chosen[-1]) == (0, len(t) - 1)
    assert (np.diff(t[chosen]) >= room(0.0, 1.0)).all()
    assert clearance(t, t[chosen]).max() <= 4 * room(0.0, 1.0)
