"""Sessions: undo over everything, and scripts that give the same values bit for bit."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import attrs
import numpy as np
import pytest

import multirep as mr
from multirep.constraints import CornerConstraint, DerivativeConstraint, Freeze, PointConstraint
from multirep.errors import (
    ConflictError,
    EditError,
    HistoryError,
    MultirepError,
    ScriptError,
    UnknownNameError,
)
from multirep.journal import Looked, Travelled
from multirep.registry import Registry
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.script.model import ToolStep
from multirep.script.reading import read_script
from multirep.script.running import run
from multirep.script.step_reading import StepReader
from multirep.script.writing import fields
from multirep.tools import (
    CopyDetail,
    Corner,
    DirectManipulation,
    InsertVertex,
    Mark,
    MoveVertex,
    Oversketch,
    Smooth,
    Spatula,
    Sweep,
)

KINDS = ("polyline", "nurbs", "wavelet")


def wave(n: int = 40, tolerance: float = 1e-3) -> mr.MultiRepresentation:
    x = np.linspace(0, 6, n)
    return mr.MultiRepresentation.from_points(np.c_[x, np.sin(x)], tolerance=tolerance)


@pytest.fixture
def session() -> mr.Session:
    session = mr.Session()
    session.add("wave", wave())
    return session


def bits(value: Any) -> Any:
    """Return every number of a representation."""
    return value.to_dict()


def geometry(session: mr.Session) -> dict[str, Any]:
    """Every number of every representation of every curve; brings all of them up to date."""
    return {
        name: {kind: bits(curve.view(kind)) for kind in KINDS}
        for name, curve in session.curves.items()
    }


def replayed(text: str, folder: Path) -> dict[str, Any]:
    """Run a script and return every number of what it gives."""
    path = folder / "replay.toml"
    path.write_text(text)
    registry = Registry.discover()
    result = run(read_script(path, registry), registry)
    return {
        curve.name: {kind: bits(value) for kind, value in curve.representations.items()}
        for curve in result.curves
    }


def check_replay(session: mr.Session, folder: Path) -> str:
    text = session.script()
    assert replayed(text, folder) == geometry(session)
    return text


# -- undo and redo over everything -----------------------------------------------------------------


def _constrain(session: mr.Session) -> None:
    session.constrain("wave", PointConstraint(t=0.5, point=(3, 1)))


def _freeze_and_release(session: mr.Session) -> None:
    name = session.constrain("wave", Freeze(interval=(0.2, 0.4)))
    session.release("wave", name)


STEPS: dict[str, tuple[int, Callable[[mr.Session], object]]] = {
    "an edit": (1, lambda s: s.apply("wave", MoveVertex(index=3, to=(0.5, 1)))),
    "a constraint": (1, _constrain),
    "a frozen stretch and its release": (2, _freeze_and_release),
    "the tolerance": (1, lambda s: s.set_tolerance("wave", 1e-4)),
    "a new parameter": (1, lambda s: s.reparameterize("wave")),
    "a map of parameters": (1, lambda s: s.reparameterize("wave", ([0, 0.5, 1], [0, 0.25, 1]))),
    "another curve": (1, lambda s: s.add("other", wave(9))),
}


@pytest.mark.parametrize("what", STEPS)
def test_everything_is_undone_and_redone(what: str, session: mr.Session) -> None:
    """Back: the same objects as before. Forth: the same as after. Constraints and curves too."""
    session.apply("wave", Sweep(t=0.5, to=(3, 0.5), level=3))
    count, step = STEPS[what]
    states = [session.framework.snapshot()]
    step(session)
    states.append(session.framework.snapshot())
    assert session.undoable == 1 + count
    for _ in range(2):
        for move, state in ((session.undo, states[0]), (session.redo, states[1])):
            move(count)
            now = session.framework.snapshot()
            assert now.keys() == state.keys()
            for name in now:
                assert now[name].state is state[name].state
                assert now[name].constraints == state[name].constraints


def test_what_a_session_starts_from_stays(session: mr.Session) -> None:
    """Curves from before the first step cannot be undone away."""
    session.add("second", wave(9))
    assert session.undoable == 0
    session.apply("second", MoveVertex(index=0, to=(0, 1)))
    session.undo()
    with pytest.raises(HistoryError):
        session.undo()
    assert set(session.curves) == {"wave", "second"}


def test_an_undone_curve_is_gone(session: mr.Session) -> None:
    """And comes back with redo, the same object."""
    session.set_tolerance("wave", 1e-2)
    other = wave(9)
    session.add("other", other)
    session.undo()
    with pytest.raises(UnknownNameError):
        session.apply("other", MoveVertex(index=0, to=(0, 1)))
    session.redo()
    assert session.curve("other") is other


def test_a_constraint_comes_with_its_outcome(session: mr.Session) -> None:
    """The name is a string; the outcome says what it did and how well it holds."""
    name = session.constrain("wave", PointConstraint(t=0.5, point=(3, 1)), name="peak")
    assert name == "peak"
    assert name.outcome.changed
    assert [held.name for held in name.outcome.constraints] == ["peak"]
    assert name.outcome.constraints[0].residual < 1e-9
    session.release("wave", name)
    assert not session.framework.constraints("wave")


def test_failed_steps_leave_no_trace(session: mr.Session) -> None:
    """Neither in the history nor in the journal."""
    session.constrain("wave", PointConstraint(t=0.5, point=(3, 1)))
    entries, undoable = session.journal.entries, session.undoable
    with pytest.raises(ConflictError):
        session.constrain("wave", PointConstraint(t=0.5, point=(3, 2)))
    with pytest.raises(MultirepError):
        session.apply("wave", MoveVertex(index=999, to=(0, 0)))
    with pytest.raises(MultirepError), session.gesture("wave") as gesture:  # noqa: PT012  # a block
        gesture.apply(MoveVertex(index=3, to=(0.5, 1)))
        gesture.apply(MoveVertex(index=999, to=(0, 0)))
    assert session.journal.entries == entries
    assert session.undoable == undoable


def test_a_gesture_is_the_only_thing_while_it_lasts(session: mr.Session) -> None:
    """Steps beside it would be undone in the wrong order."""
    with session.gesture("wave") as gesture:
        for attempt in (
            lambda: session.apply("wave", MoveVertex(index=3, to=(0.5, 1))),
            session.undo,
            lambda: session.set_tolerance("wave", 1),
        ):
            with pytest.raises(HistoryError, match="open gesture"):
                attempt()  # type: ignore[operator]
        gesture.apply(MoveVertex(index=3, to=(0.5, 1)))
    assert session.undoable == 1
    session.undo()


# -- scripts ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("what", STEPS)
def test_every_kind_of_step_is_replayed(what: str, session: mr.Session, tmp_path: Path) -> None:
    """And undone and redone there as well."""
    session.apply("wave", Sweep(t=0.5, to=(3, 0.5), level=3.3))
    count, step = STEPS[what]
    step(session)
    session.undo(count)
    session.redo(count)
    check_replay(session, tmp_path)


def test_a_gesture_is_replayed_as_one_step(session: mr.Session, tmp_path: Path) -> None:
    """With the looks between its moves."""
    with session.gesture("wave") as gesture:
        for height in np.linspace(0, 1, 5):
            gesture.apply(DirectManipulation(t=0.3, to=(1.8, height)))
            session.curve("wave").view("wavelet")
    session.curve("wave").view("polyline")
    session.apply("wave", Sweep(t=0.3, to=(1.8, 0.2), level=4))
    text = check_replay(session, tmp_path)
    assert text.count("[[step.gesture]]") == 9, "the last look is after it"
    registry = Registry.discover()
    path = tmp_path / "replay.toml"
    result = run(read_script(path, registry), registry)
    assert [step.what for step in result.steps] == [
        "gesture direct-manipulation",
        "view",
        "view",
        "sweep",
    ]
    path.write_text(text + "\n[[step]]\nundo = 2\n")
    [curve] = run(read_script(path, registry), registry).curves
    session.undo(2)
    assert bits(curve.representations["polyline"]) == geometry(session)["wave"]["polyline"]


def test_looks_are_replayed_for_they_decide_the_last_bits(tmp_path: Path) -> None:
    """A NURBS that followed each edit is another one than that which followed all at once."""
    sessions = []
    for looks in (False, True):
        session = mr.Session()
        session.add("wave", wave())
        session.curve("wave").view("nurbs")
        for index in range(5, 15):
            session.apply("wave", MoveVertex(index=index, to=(0.15 * index, 0.3 * (index % 3))))
            if looks:
                session.curve("wave").view("nurbs")
        check_replay(session, tmp_path)
        sessions.append(geometry(session))
    assert sessions[0]["wave"]["polyline"] == sessions[1]["wave"]["polyline"]
    assert sessions[0]["wave"]["nurbs"] != sessions[1]["wave"]["nurbs"], "the test tests nothing"


def test_a_look_is_written_once(session: mr.Session) -> None:
    """However often the script is asked for; looks that find nothing to do are not written."""
    for _ in range(2):
        session.curve("wave").view("nurbs")
        text = session.script()
        assert text.count("view = ") == 1
    assert session.script() == text


def test_looks_at_a_part_are_replayed(session: mr.Session, tmp_path: Path) -> None:
    """With where."""
    session.curve("wave").view("nurbs")
    for index in (5, 30):
        session.apply("wave", MoveVertex(index=index, to=(0.15 * index, 0.5)))
    session.curve("wave").view("nurbs", mr.SpliceList([(0.0, 0.3)]))
    session.set_tolerance("wave", 2e-3)
    text = check_replay(session, tmp_path)
    assert "where = [[" in text
    assert sum(isinstance(entry, Looked) for entry in session.journal.entries) == 2


def test_windows_are_replayed_in_order(tmp_path: Path) -> None:
    """Neighbouring windows are not one: which came first decides the last bits."""
    t = np.arange(600.0)
    rough = np.column_stack([t, np.sin(t) + np.cos(0.3 * t * t)])
    session = mr.Session()
    session.add("rough", mr.MultiRepresentation.from_points(rough, tolerance=1e-2))
    for start in (0.3, 0.4, 0.1):
        session.curve("rough").view("nurbs", mr.SpliceList([(start, start + 0.1)]))
    session.curve("rough").view("nurbs")
    session.set_tolerance("rough", 2e-2)
    check_replay(session, tmp_path)
    looks = [entry.where for entry in session.journal.entries if isinstance(entry, Looked)]
    assert len(looks) == 4
    assert looks[-1] is None


def test_curves_of_every_kind_start_a_script(tmp_path: Path) -> None:
    """Polylines with their parameters, rational NURBS, graded wavelets; looked at before or not."""
    session = mr.Session()
    polyline = wave(9)
    nurbs = Nurbs(
        degree=2, knots=[0, 0, 0, 1 / 3, 2, 2, 2], points=[[0, 0], [1, 2], [3, 2], [4, 0.1]],
        weights=[1, 0.7, 1, 1],
    )  # fmt: skip
    wavelet = wave().view(WaveletBSpline)
    session.add("polyline", polyline)
    session.add("nurbs", mr.MultiRepresentation(nurbs, tolerance=1e-3))
    looked = mr.MultiRepresentation(
        wavelet, tolerance=1e-3, kinds=[WaveletBSpline, Nurbs, Polyline]
    )
    looked.view("polyline")
    session.add('wavelet "3"\\', looked)
    text = check_replay(session, tmp_path)
    assert "view = " in text


def test_a_curve_with_an_unknown_past_is_refused(session: mr.Session) -> None:
    """What cannot be done again is not written down as if it could; the message says what can."""
    curve = wave(9)
    curve.view("nurbs")
    curve.commit("polyline", curve.view(Polyline).move_vertex(3, [1, 1]))
    curve.view("nurbs")
    session.add("edited", curve)
    with pytest.raises(ScriptError, match=r"'edited' had been edited before.*made of one"):
        session.script()


def test_a_change_past_the_session_is_refused(session: mr.Session) -> None:
    """A commit, say: the journal does not know it."""
    curve = session.curve("wave")
    session.script()
    curve.commit("polyline", curve.view(Polyline).move_vertex(3, [1, 1]))
    with pytest.raises(ScriptError, match="'wave' was changed past the session") as caught:
        session.script()
    assert "a new session with a curve made of a representation of this one" in str(caught.value)
    fresh = mr.Session()
    fresh.add("wave", mr.MultiRepresentation(curve.view("polyline"), tolerance=curve.tolerance))
    assert "[[curve]]" in fresh.script()


def test_what_toml_cannot_say_is_refused(session: mr.Session) -> None:
    """The message names tool and field."""

    @attrs.frozen
    class Odd(mr.Tool[Polyline]):
        """Does nothing, with an odd parameter."""

        name = "odd"
        edits = Polyline

        thing: object

        def edit(self, polyline: Polyline, scene: mr.Scene) -> mr.Edit[Polyline]:
            return mr.Edit(polyline, mr.SpliceList.EMPTY)

    session.apply("wave", Odd(object()))
    with pytest.raises(ScriptError, match=r"'thing' of 'odd' cannot be written"):
        session.script()


STROKE = [[0.1 * k, 0.3 + 0.01 * (k % 2)] for k in range(20)]
TOOLS = [
    MoveVertex(index=3, to=(0.1, 1 / 3)),
    InsertVertex(t=0.123),
    DirectManipulation(at=(1, 1), to=(1, 2), hold_ends=False, control_points=2),
    Sweep(t=0.5, to=(1e-17, 1e22), level=2.5, hold=(0.1,), targets=((0.9, 1, 2),)),
    Spatula(radius=0.1, path=STROKE),
    Oversketch(stroke=STROKE, join="C2", parameters="keep", apron=0.5),
    Corner(t=0.5, left=(1, 0), right=(0, 1)),
    Corner(at=(0.5, 1), remove=True),
    Mark(left=0.25, label='a "label"\n\x7f\\'),
    Smooth(level=3, interval=(0.1, 0.9)),
    CopyDetail(source="wave", levels=(1, 2), frame="axes"),
]


@pytest.mark.parametrize("tool", TOOLS, ids=lambda tool: tool.name)
def test_parameters_survive_the_round_trip(tool: mr.Tool[Any]) -> None:
    """What is written of a tool is read as an equal one."""
    import tomllib

    from multirep.script.writing import _table

    text = _table("step", {"curve": "c", "tool": tool.name, **fields(tool)})
    [table] = tomllib.loads(text)["step"]
    curves = read_script_curves()
    step = StepReader(Registry.discover(), curves).read(0, table)
    assert isinstance(step, ToolStep)
    assert step.tool == tool


def read_script_curves() -> Any:
    from multirep.script.model import CurveSpec, Points, PointsSource

    return (CurveSpec("c", 0.1, PointsSource(Points(((0.0, 0.0), (1.0, 1.0))))),)


def test_a_script_is_saved_whole(session: mr.Session, tmp_path: Path) -> None:
    """And can be read from there."""
    session.apply("wave", MoveVertex(index=3, to=(0.5, 1)))
    session.save_script(tmp_path / "new" / "wave.toml")
    assert (tmp_path / "new" / "wave.toml").read_text() == session.script()


# -- random sessions -------------------------------------------------------------------------------


def _random_tool(rng: np.random.Generator) -> mr.Tool[Any]:
    t = float(rng.uniform(0.05, 0.95))
    to = (6 * t + rng.normal(0, 0.1), np.sin(6 * t) + rng.normal(0, 0.3))
    match rng.integers(9):
        case 0:
            return MoveVertex(index=int(rng.integers(20)), to=to)
        case 1:
            return DirectManipulation(t=t, to=to)
        case 2:
            return Sweep(t=t, to=to, level=float(rng.uniform(1, 5)))
        case 3:
            return Spatula(radius=0.2, path=[(to[0], to[1] + 0.3), to])
        case 4:
            return Smooth(level=float(rng.uniform(3, 6)), interval=(t / 2, t / 2 + 0.4))
        case 5:
            return Corner(t=t, left=(6, 6 * rng.normal()), right=(6, 6 * rng.normal()))
        case 6:
            x = np.linspace(6 * t - 0.8, 6 * t, 15)
            return Oversketch(stroke=np.c_[x, np.sin(x) + 0.2 * np.sin(4 * x)])  # type: ignore[arg-type]
        case 7:
            return InsertVertex(t=t)
        case _:
            return Mark(left=t / 3) if rng.random() < 0.5 else Mark(remove=True)


def _random_step(session: mr.Session, rng: np.random.Generator) -> None:
    name = str(rng.choice(sorted(session.curves)))
    curve, t = session.curve(name), float(rng.uniform(0.1, 0.9))
    match rng.integers(14):
        case 0:
            session.undo(int(rng.integers(1, 3)))
        case 1:
            session.redo()
        case 2:
            session.set_tolerance(name, float(rng.choice([5e-4, 1e-3, 2e-3])))
        case 3:
            session.reparameterize(name)
        case 4:
            point = PointConstraint(t=t, point=(6 * t, rng.normal()))
            slope = DerivativeConstraint(t=t, right=(6, rng.normal()))
            corner = CornerConstraint(t=t, point=(6 * t, rng.normal()))
            freeze = Freeze(interval=(t, t + 0.05))
            session.constrain(name, [point, slope, corner, freeze][rng.integers(4)])
        case 5 if held := session.framework.constraints(name):
            session.release(name, str(rng.choice(sorted(held))))
        case 6:
            with session.gesture(name) as gesture:
                for k in range(3):
                    gesture.apply(DirectManipulation(t=t, to=(6 * t, 0.1 * k)))
                    if rng.random() < 0.5:
                        curve.view(str(rng.choice(KINDS)))
        case 7 if len(session.curves) < 3:
            session.add(f"curve {len(session.journal.entries)}", wave(15, 2e-3))
        case 8:
            curve.view(str(rng.choice(KINDS)))
        case _:
            session.apply(name, _random_tool(rng))


SEEDS = [*range(6), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(6, 40))]


@pytest.mark.parametrize("seed", SEEDS)
def test_random_sessions_are_replayed_bit_by_bit(seed: int, tmp_path: Path) -> None:
    """Steps of every kind, failures among them, in random order, with random looks."""
    rng = np.random.default_rng(seed)
    session = mr.Session()
    session.add("wave", wave(30))
    for _ in range(25):
        try:
            _random_step(session, rng)
        except (MultirepError, EditError):
            continue
    assert len(session.journal.entries) > 5
    assert any(isinstance(entry, Travelled) for entry in session.journal.entries) or seed
    check_replay(session, tmp_path)
