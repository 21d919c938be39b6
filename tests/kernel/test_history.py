"""Undo and redo over many steps: bits, sharing, and what a step keeps."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Iterator
from contextlib import suppress
from itertools import product
from typing import Any
from weakref import ref

import attrs
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep import history, moments, patches
from multirep.authors import AuthorMap
from multirep.constraints import Freeze
from multirep.errors import MultirepError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.state import State
from multirep.testing.loopback import LoopbackRepresentation
from multirep.tools import MoveControlPoint, MoveVertex, Oversketch, Sweep

KINDS = (Polyline, Nurbs, WaveletBSpline)


def wave(n: int = 60) -> mr.MultiRepresentation:
    x = np.linspace(0.0, 6.0, n)
    return mr.MultiRepresentation.from_points(
        np.column_stack([x, np.sin(2 * x)]), tolerance=1e-3, kinds=KINDS
    )


def session_of(curve: mr.MultiRepresentation) -> mr.Session:
    session = mr.Session()
    session.add("wave", curve)
    return session


def bits(curve: mr.MultiRepresentation) -> dict[str, Any]:
    """Everything that a state says, as values that compare bit by bit and keep nothing alive."""
    state = curve.snapshot()
    held = {}
    for name, one in state.held.items():
        value = one.value
        arrays: tuple[Any, ...] = ()
        if isinstance(value, Polyline):
            arrays = value.t, value.points
        elif isinstance(value, Nurbs):
            arrays = value.knots, value.points, value.weights, np.array(value.magnitude)
        elif isinstance(value, WaveletBSpline):
            graded = value._graded
            arrays = graded.u, graded.points, np.array(graded.magnitude), graded.counts
        held[name] = [np.asarray(array).tobytes() for array in arrays], one.stale
    looks = [(look.kind, look.where) for look in state.looks]
    return {
        "held": held,
        "looks": looks,
        "authors": (state.authors.starts, state.authors.names),
        "rest": (state.tolerance, dict(state.claims), state.frozen, dict(state.added)),
    }


def step(session: mr.Session, k: int, job: int) -> None:
    """Make one step of some kind, and look at some of the views."""
    curve = session.curve("wave")
    if job == 0:
        index = 5 + 7 * k % 40
        session.apply("wave", MoveVertex(index=index, to=(0.1 * index, 0.1 * (k % 7))))
    elif job == 1:
        index = 2 + k % (curve.view(Nurbs).size - 4)
        point = curve.view(Nurbs).points[index]
        session.apply("wave", MoveControlPoint(index=index, to=point + np.array([0, 0.05])))
    elif job == 2:
        session.apply("wave", Sweep(t=0.1 + 0.08 * (k % 10), to=(0.6 * (k % 10), 0.5), level=4))
    elif job == 3:
        session.set_tolerance("wave", 1e-3 if curve.tolerance < 1e-3 else 5e-4)
    elif "ice" in curve.claims:
        session.release("wave", "ice")
    else:
        session.constrain("wave", Freeze(interval=(0.4, 0.45)), name="ice")
    for kind in KINDS[: 1 + k % 3]:
        curve.view(kind)


@pytest.fixture(autouse=True, scope="module")
def early() -> Iterator[None]:
    """All moments but the nearest are kept as differences."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(history, "NEAR", 1)
        yield


@given(data=st.data())
def test_any_way_through_the_history_gives_the_same_bits(data: st.DataObject) -> None:
    """Whatever is done, undone, redone and looked at in any order: each state comes back with its
    bits, whoever holds it.
    """
    curve = wave()
    session = session_of(curve)
    seen, at = [bits(curve)], 0
    held: dict[int, State] = {}
    moves = ["step", "step", "step", "undo", "redo", "hold"]
    for k in range(data.draw(st.integers(3, 12))):
        move = data.draw(st.sampled_from(moves))
        if move == "step":
            if (job := data.draw(st.integers(0, 4))) == 1:
                curve.view(Nurbs)  # a look, no step: it belongs to the moment before
                seen[at] = bits(curve)
                held.pop(at, None)
            with suppress(MultirepError):
                step(session, k, job)
            if session.undoable == at:
                continue
            at += 1
            seen[at:] = [bits(curve)]
            held = {where: state for where, state in held.items() if where < at}
        elif move == "undo" and at:
            count = data.draw(st.integers(1, at))
            session.undo(count)
            at -= count
        elif move == "redo" and at + 1 < len(seen):
            count = data.draw(st.integers(1, len(seen) - 1 - at))
            session.redo(count)
            at += count
        elif move == "hold":
            held[at] = curve.snapshot()
        assert (session.undoable, session.redoable) == (at, len(seen) - 1 - at)
        assert bits(curve) == seen[at]
        for name, one in curve.snapshot().held.items():
            assert at not in held or one.value is held[at].held[name].value
    for where, state in held.items():
        curve.restore(state)
        assert bits(curve) == seen[where]


def test_what_comes_back_can_be_edited_as_before() -> None:
    """The same steps again give the same bits, and share what they do not touch."""
    curve = wave(3000)
    session = session_of(curve)
    for k in range(12):
        step(session, k, k % 3)
    seen = bits(curve)
    for _ in range(2):
        session.undo(12)
        for k in range(12):
            step(session, k, k % 3)
        assert bits(curve) == seen
    now = curve.view(Polyline).points.blocks
    session.undo(12)
    before = {id(block) for block in curve.view(Polyline).points.blocks}
    assert sum(id(block) not in before for block in now) <= 3


def test_values_that_nobody_else_holds_are_let_go() -> None:
    """The history keeps what makes them of their neighbours, no block of theirs."""
    curve = wave()
    session = session_of(curve)
    for kind in KINDS:
        curve.view(kind)
    values = []
    for k in range(20):
        step(session, k, 0)
        values.append(ref(curve.view(Polyline)))
        nurbs = curve.snapshot().held["nurbs"].value  # looked at now and then
        assert nurbs is not None
        values.append(ref(nurbs))
        del nurbs
    gc.collect()
    assert not any(value() for value in values[:20]), "the last few may be remembered as sampled"


def test_a_value_that_somebody_holds_comes_back_itself() -> None:
    """However far away its moment is."""
    curve = wave()
    session = session_of(curve)
    held = curve.view(Polyline)
    for k in range(6):
        step(session, k, 0)
    session.undo(6)
    assert curve.view(Polyline) is held


def test_what_was_passed_is_not_compared_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """What makes one moment of its neighbour is turned around, and gives the same bits both ways;
    only at the turns of the way, where moments are whole, is anything compared.
    """
    curve = wave()
    session = session_of(curve)
    seen = []
    for k in range(12):
        for kind in KINDS:
            curve.view(kind)
        seen.append(bits(curve))
        step(session, k, k % 3)
    seen.append(bits(curve))
    compared: list[int] = []
    between = history.between

    def counted(*moments: Any) -> Any:
        compared.append(session.undoable)
        return between(*moments)

    monkeypatch.setattr(history, "between", counted)
    for travel in (session.undo, session.redo, session.undo, session.redo):
        compared.clear()
        for _ in range(12):
            travel()
            assert bits(curve) == seen[session.undoable]
        assert len(compared) <= history.NEAR + 1
    session.undo(6)
    step(session, 1, 0)
    compared.clear()
    session.undo(7)
    assert len(compared) <= history.NEAR + 1


def test_a_look_at_an_earlier_moment_belongs_to_it() -> None:
    """What it brought up to date is there on the way back, from either side."""
    curve = wave()
    session = session_of(curve)
    for k in range(5):
        session.apply("wave", MoveVertex(index=10 + 9 * k, to=(1.0 + k, 0.5)))
    session.undo(3)
    curve.view(Nurbs)
    seen = bits(curve)
    for there, back in ((session.redo, session.undo), (session.undo, session.redo)):
        steps = 3 if there == session.redo else 2
        there(steps)
        assert bits(curve) != seen
        back(steps)
        assert bits(curve) == seen


def test_every_field_of_a_state_is_compared() -> None:
    """What is held, the authors, and the others."""
    assert {"held", "authors", *moments._OTHERS} == {field.name for field in attrs.fields(State)}


def test_curves_of_other_kinds_and_other_curves_come_back() -> None:
    """A kind without patches is kept as it is, and so are moments with other curves."""
    points = [[0.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 1.0]]
    kinds = (Polyline, LoopbackRepresentation)
    curve = mr.MultiRepresentation.from_points(points, tolerance=1e-2, kinds=kinds)
    session = session_of(curve)
    loops = [curve.view(LoopbackRepresentation)]
    for k in range(4):
        session.apply("wave", MoveVertex(index=1, to=(1, 2 + k)))
        loops.append(curve.view(LoopbackRepresentation))
        session.add(f"other {k}", wave(5))
    for k in reversed(range(4)):
        assert curve.view(LoopbackRepresentation) is loops[k + 1]
        session.undo()
        assert f"other {k}" not in session.curves
        session.undo()
    assert curve.view(LoopbackRepresentation) is loops[0]
    session.redo(8)
    assert curve.view(LoopbackRepresentation) is loops[4]
    assert set(session.curves) == {"wave", *(f"other {k}" for k in range(4))}


def test_a_step_keeps_what_it_changed_however_long_the_curve() -> None:
    """A few dozen numbers and objects, not a block: an eighth of the bytes of a block of points."""
    curve = wave(20_000)
    session = session_of(curve)
    kept = []
    tracemalloc.start()
    for k in range(120):
        if k % 60 == 0:
            kept.append(traced())
        step(session, 3 * k + 2, 0)
    kept.append(traced())
    tracemalloc.stop()
    assert kept[2] - kept[1] < 60 * 2048  # before, what is whole of the last steps fills up


def traced() -> int:
    """Bytes that are held and were taken since tracing began."""
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


# -- patches of arrays -----------------------------------------------------------------------------


@given(data=st.data(), columns=st.sampled_from([0, 2]), rows=st.integers(0, 60))
def test_a_patch_makes_one_version_of_another(data: st.DataObject, columns: int, rows: int) -> None:
    """Bit for bit, negative zeros and NaN too; equal arrays are the same object."""
    numbers = st.sampled_from([0.0, -0.0, 1.0, float("nan"), 2.5])
    shape = (columns,) if columns else ()

    def draw(count: int) -> np.ndarray:
        size = count * (columns or 1)
        some = data.draw(st.lists(numbers, min_size=size, max_size=size))
        return np.array(some).reshape(count, *shape)

    one = mr.BlockArray.of(draw(rows))
    low = data.draw(st.integers(0, rows))
    high = data.draw(st.integers(low, rows))
    two = one.replaced(low, high, draw(data.draw(st.integers(0, 20))))
    still = mr.BlockArray.of([1.0, 2.0])
    for mine, base in ((one, two), (two, one), (one, one)):
        patch = patches.patch_of((mine, still), (base, still))
        assert patch is not None
        made, back = base, patch
        for end in (mine, base):
            assert back is not None
            (made, same), back = patches.patched((made, still), back)
            assert np.asarray(made).tobytes() == np.asarray(end).tobytes()
            assert made.shape == end.shape
            assert same is still
        assert back == patch


@given(data=st.data())
def test_a_wavelet_is_made_again_with_all_that_it_counts(data: st.DataObject) -> None:
    """Knots of each level and the bound of its coordinates, too."""
    one = WaveletBSpline(np.arange(22.0).reshape(11, 2))
    for _ in range(data.draw(st.integers(0, 3))):
        start, length = data.draw(st.integers(0, 62)), data.draw(st.integers(1, 64))
        part = mr.Interval(start / 64, min(start + length, 64) / 64)
        one = one.refine(part).value
    two = one.refine(mr.Interval(0.25, 0.75)).value
    two = two.move_control_point(data.draw(st.integers(0, two.size - 1)), [1e3, 0]).value
    for mine, base in ((one, two), (two, one)):
        patch = mine.patch(base)
        assert patch is not None
        there, back = base.patched(patch)
        assert back is not None
        here, _ = there.patched(back)
        for made, graded in ((there._graded, mine._graded), (here._graded, base._graded)):
            assert made.magnitude == graded.magnitude
            np.testing.assert_array_equal(made.counts, graded.counts)
            np.testing.assert_array_equal(np.asarray(made.u), np.asarray(graded.u))
            np.testing.assert_array_equal(np.asarray(made.points), np.asarray(graded.points))


@given(data=st.data())
def test_authors_come_back(data: st.DataObject) -> None:
    """Any map is made again of any other of the domain."""
    maps = [AuthorMap.of(mr.Interval(0, 1), "a")]
    for _ in range(data.draw(st.integers(1, 6))):
        start = data.draw(st.integers(0, 15))
        part = (start / 16, data.draw(st.integers(start + 1, 16)) / 16)
        name = data.draw(st.sampled_from("abc"))
        maps.append(maps[-1].assigned(mr.SpliceList([part]), name))
    for one, two in product(maps, maps):
        apart = moments._authors_between(one, two)
        assert not isinstance(apart, tuple)
        assert moments._authors_together(apart, two, moments.EARLIER) == one
        assert moments._authors_together(apart, one, moments.LATER) == two


def test_versions_that_differ_in_much_or_in_kind_have_no_patch() -> None:
    """Whole blocks take less than a copy of all rows between two changes far apart."""
    one = mr.BlockArray.of(np.zeros(5000))
    two = one.replaced(5, 6, [1.0]).replaced(4000, 4001, [1.0])
    assert patches.patch_of((one,), (two,)) is None
    assert patches.patch_of((one,), (mr.BlockArray.of(np.zeros((3, 2))),)) is None
    few = one.replaced(5, 4000, [])
    patch = patches.patch_of((few,), (one,))
    assert patch is not None
    [made], back = patches.patched((one,), patch)
    assert len(made) == len(few)
    assert back is None


def test_much_that_comes_and_goes_in_a_step_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where many rows come, or go, values are kept themselves, and others as patches."""
    monkeypatch.setattr(patches, "_MOST", 12)
    curve = wave(300)
    session = session_of(curve)
    seen = []
    sketch = [[0.1 * k, 0.3] for k in range(60)]
    for k in range(9):
        for kind in KINDS:
            curve.view(kind)
        seen.append(bits(curve))
        if k % 3 == 1:
            session.apply("wave", Oversketch(stroke=sketch if k % 2 else sketch[10:50]))
        else:
            step(session, k, 0)
    seen.append(bits(curve))
    for travel in (session.undo, session.redo, session.undo, session.redo):
        for _ in range(9):
            travel()
            assert bits(curve) == seen[session.undoable]
