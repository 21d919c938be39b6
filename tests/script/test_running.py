"""Running scripts: steps, history, constraints, and what is reported of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from attrs import field, frozen

import multirep as mr
from multirep.constraints import Freeze
from multirep.errors import ScriptError, StepFailedError
from multirep.registry import Registry
from multirep.representations import Nurbs, Polyline
from multirep.script.reading import read_script
from multirep.script.report import geometry, report, to_json
from multirep.script.running import Result, run
from multirep.tools import MoveVertex, Spatula

HEAD = """
multirep = 1
[[curve]]
name = "a"
tolerance = 0.01
points = [[0, 0], [1, 2], [2, 0], [3, 1]]
[[curve]]
name = "b"
tolerance = 0.05
points = [[0, 0], [1, 1], [2, 0]]
t = [0, 1, 3]
"""


@frozen
class Pin(mr.Constraint[Polyline]):
    """Hold a vertex at a point (a test double)."""

    name = "pin"
    needs = Polyline

    index: int
    to: tuple[float, ...] = field()

    def region(self, polyline: Polyline) -> mr.Interval:
        t = polyline.t
        last = len(t) - 1
        return mr.Interval(t[max(self.index - 1, 0)], t[min(self.index + 1, last)])

    def residual(self, polyline: Polyline) -> float:
        return float(np.linalg.norm(polyline.points[self.index] - np.array(self.to)))

    def enforce(
        self, polyline: Polyline, change: mr.SpliceList, scene: mr.Scene
    ) -> mr.Edit[Polyline]:
        return polyline.move_vertex(self.index, self.to)


REGISTRY = Registry.of(Polyline, Nurbs, MoveVertex, Pin)


def do(folder: Path, *steps: str, registry: Registry = REGISTRY) -> Result:
    path = folder / "script.toml"
    path.write_text(HEAD + "".join(f"[[step]]\n{step}\n" for step in steps))
    return run(read_script(path, registry), registry)


def move(curve: str, index: int, y: float) -> str:
    return f'curve = "{curve}"\ntool = "move-vertex"\nindex = {index}\nto = [{index}, {y}]'


def heights(result: Result, curve: str) -> list[float]:
    points: list[list[float]] = geometry(result)["curves"][curve]["polyline"]["points"]
    return [y for _, y in points]


def test_undo_and_redo_walk_through_the_steps_of_all_curves(tmp_path: Path) -> None:
    """The history is that of the session; an undo says which curve it changed back, and where."""
    steps = [move("a", 1, 5), move("b", 1, 6), move("a", 2, 7), "undo = 2", "redo = 1"]
    result = do(tmp_path, *steps)
    assert heights(result, "a") == [0, 5, 0, 1]
    assert heights(result, "b") == [0, 6, 0]
    first, second, _, undo, redo = result.steps
    assert (undo.curve, redo.curve) == (None, "b"), "two steps of two curves were undone"
    assert redo.changed == second.changed
    a, b = result.curves
    assert (a.edits, b.edits) == (1, 1)
    assert a.changed == first.changed
    assert b.changed == second.changed


def test_a_new_edit_drops_what_could_be_redone(tmp_path: Path) -> None:
    """As in editors; the message says how many steps there are."""
    with pytest.raises(ScriptError, match=r"step 3: redo: .* 1 .* 0"):
        do(tmp_path, move("a", 1, 5), "undo = 1", move("a", 1, 6), "redo = 1")


def test_constraints_answer_and_are_reported(tmp_path: Path) -> None:
    """A step says which constraints it touched, and how far each is from holding."""
    pin = 'curve = "a"\nconstrain = "pin"\nname = "foot"\nindex = 2\nto = [2, 0.5]'
    result = do(tmp_path, pin, move("a", 1, 3), 'curve = "a"\nrelease = "foot"', move("a", 2, 8))
    assert heights(result, "a") == [0, 3, 8, 1]
    held, moved, released, free = report(result)["steps"]
    assert held["what"] == "constrain pin"
    assert len(held["changed"]) == 1, "the vertex was pulled to its pin"
    assert moved["constraints"] == [{"name": "foot", "residual": 0.0}]
    assert released["what"] == "release"
    assert free["constraints"] == []


def test_constraints_that_contradict_are_a_failure_not_a_mistake(tmp_path: Path) -> None:
    """The conflict names both; the script is right, its work cannot be done."""
    low, high = (
        f'curve = "a"\nconstrain = "pin"\nname = "{name}"\nindex = 2\nto = [2, {y}]'
        for name, y in (("low", -1), ("high", 1))
    )
    with pytest.raises(StepFailedError, match=r"step 1: .*'high'.*'low'|step 1: .*'low'.*'high'"):
        do(tmp_path, low, high)


def test_a_conflict_that_may_be_is_reported_and_changes_nothing(tmp_path: Path) -> None:
    """Who, where, off by how much, the way out; no step of the history; the run goes on."""
    pin = 'curve = "a"\nconstrain = "pin"\nname = "{}"\nindex = 2\nto = [2, {}]'
    again = pin.format("high", 1) + "\nmay_conflict = true"
    harmless = move("a", 1, 3) + "\nmay_conflict = true"
    result = do(tmp_path, pin.format("low", -1), again, harmless, "undo = 1")
    assert heights(result, "a") == [0, 2, -1, 1]
    low, high, moved, _ = json.loads(to_json(report(result)))["steps"]
    assert (low["rounds"], low["faded"], high["changed"]) == (1, [], [])
    assert "conflict" not in {**low, **moved}
    found = high["conflict"]
    assert {item["name"] for item in found["constraints"]} == {"low", "high"}
    assert all(item["where"] and item["residual"] > 0 for item in found["constraints"])
    assert set(found["cycle"]) == {"low", "high"}
    assert found["release"] == ["low"]
    assert found["message"].endswith("releasing 'low' lets it through")


def test_every_kind_of_step_that_can_conflict_may(tmp_path: Path) -> None:
    """Gestures and parameters too; not undo, which never does."""
    pin = 'curve = "a"\nconstrain = "pin"\nname = "low"\nindex = 2\nto = [2, -1]'
    even = 'curve = "a"\nreparameterize = "even"\nmay_conflict = true'
    parts = 'curve = "a"\nmay_conflict = true\n[[step.gesture]]\ntool = "move-vertex"\nindex = 2\n'
    drag = parts + "to = [2, 5]"
    result = do(tmp_path, pin, even, drag)
    assert [step.conflict is None for step in result.steps] == [True, False, False]
    assert heights(result, "a") == [0, 2, -1, 1]
    with pytest.raises(ScriptError, match="may_conflict"):
        do(tmp_path, pin, "undo = 1\nmay_conflict = true")


def test_what_was_faded_is_reported(tmp_path: Path) -> None:
    """The frozen part of what the edit would have changed."""
    freeze = 'curve = "a"\nconstrain = "freeze"\ninterval = [0, 0.125]'
    spatula = 'curve = "a"\ntool = "spatula"\nradius = 1\npath = [[0, 2], [0.5, 1]]'
    registry = Registry.of(Polyline, Spatula, Freeze)
    _, pushed = report(do(tmp_path, freeze, spatula, registry=registry))["steps"]
    [faded] = pushed["faded"]
    assert 0 <= faded[0] < faded[1] == 0.125
    assert pushed["changed"][0][0] >= 0.125


def test_the_domain_and_the_tolerance_are_those_of_the_script(tmp_path: Path) -> None:
    """Parameters that were given are kept; each curve has its own tolerance."""
    result = do(tmp_path)
    data = geometry(result)["curves"]
    assert data["b"]["domain"] == [0, 3]
    assert data["b"]["polyline"]["t"] == [0, 1, 3]
    assert [curve.tolerance for curve in result.curves] == [0.01, 0.05]
    assert all(d.upper <= 0.05 for curve in result.curves for d in curve.deviations.values())


def test_progress_counts_every_piece_of_work(tmp_path: Path) -> None:
    """Curves, steps and the bounds at the end, each told once before it is done."""
    path = tmp_path / "script.toml"
    path.write_text(HEAD + "[[step]]\n" + move("a", 1, 5))
    told: list[tuple[int, int, str]] = []
    run(read_script(path, REGISTRY), REGISTRY, lambda *news: told.append(news))
    assert [done for done, _, _ in told] == [0, 1, 2, 3, 4]
    assert {total for _, total, _ in told} == {5}
    assert told[2][2] == "move-vertex"


def test_the_line_of_a_step_is_told(tmp_path: Path) -> None:
    """Where the TOML is plain, a message has the line of the table."""
    with pytest.raises(ScriptError) as caught:
        do(tmp_path, move("a", 1, 5), move("a", 7, 5))
    assert caught.value.step == 1
    assert caught.value.key == "tool"
    text = (tmp_path / "script.toml").read_text().splitlines()
    assert caught.value.line is not None
    assert text[caught.value.line - 1] == "[[step]]"
    assert text[caught.value.line + 2] == "index = 7"


def test_inline_tables_have_no_line(tmp_path: Path) -> None:
    """Where tables are written another way, the step's number must do."""
    path = tmp_path / "script.toml"
    inline = 'step = [{curve = "a", tool = "move-vertex", index = 9, to = [0, 0]}]\n'
    path.write_text(inline + HEAD)
    with pytest.raises(ScriptError, match=r"script\.toml: step 0: tool: "):
        run(read_script(path, REGISTRY), REGISTRY)
