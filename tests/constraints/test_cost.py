"""What constraints cost: a few times the move alone, and nothing that grows with the curve."""

from __future__ import annotations

from statistics import median
from time import process_time
from typing import Any

import numpy as np
import pytest

import multirep as mr
from multirep import splines
from multirep.constraints import DerivativeConstraint, PointConstraint
from multirep.representations import Nurbs
from multirep.splines import factored
from multirep.tool import Tool
from multirep.tools import DirectManipulation, Spatula, Sweep

MOVES = 12


def session(periods: int, *, constrained: bool) -> mr.Session:
    """A sine with 17 vertices a period; three constraints around its middle, half a period wide."""
    x = np.linspace(0, periods, 17 * periods + 1)
    points = np.column_stack([3 * x, np.sin(2 * np.pi * x)])
    curve = mr.MultiRepresentation.from_points(points, t=x / periods, tolerance=1e-3)
    made = mr.Session()
    made.add("c", curve)
    nurbs, step = curve.view(Nurbs), 1 / periods
    if constrained:
        for k in (0.02, -0.2):
            t = 0.5 + k * step
            made.constrain("c", PointConstraint(t=t, point=tuple(nurbs(t).tolist())))
        t = 0.5 + 0.3 * step
        slope = tuple(nurbs.derivative(t).tolist())
        made.constrain("c", DerivativeConstraint(t=t, left=slope, right=slope))
    for kind in curve.kinds:
        curve.view(kind)
    return made


def drag(made: mr.Session, tool: str) -> tuple[float, float]:
    """Samples and seconds of one move, all representations brought up to date; the medians."""
    curve = made.curve("c")
    place = curve.view(Nurbs)(0.5)
    level = 2 + np.log2(len(curve.view("polyline").points) / 17)  # type: ignore[attr-defined]
    samples, seconds = [], []
    with made.gesture("c") as gesture:
        for k in range(MOVES):
            to = tuple((place + np.array([0.0, 0.01 * np.sin(k + 1)])).tolist())
            begin = process_time()
            with curve.listening() as events:
                if tool == "direct manipulation":
                    outcome = gesture.apply(DirectManipulation(t=0.5, to=to))
                elif tool == "sweep":
                    outcome = gesture.apply(Sweep(t=0.5, to=to, level=level))
                else:
                    deeper = np.array([[0.0, 0.32 - 0.01 * k], [0.0, 0.31 - 0.01 * k]])
                    outcome = gesture.apply(Spatula(radius=0.3, path=place + deeper))
                for kind in curve.kinds:
                    curve.view(kind)
            seconds.append(process_time() - begin)
            assert outcome.rounds == bool(made.framework.constraints("c"))
            samples.append(sum(getattr(event, "samples", 0) for event in events))
    return median(samples), median(seconds)


TOOLS = ("direct manipulation", "sweep", "spatula")


@pytest.mark.parametrize("tool", TOOLS)
def test_the_work_with_constraints_does_not_grow_with_the_curve(tool: str) -> None:
    """As many samples on 17 000 vertices as on 500, give or take the fits that differ."""
    small, large = (drag(session(n, constrained=True), tool)[0] for n in (32, 1024))
    assert large <= 2 * small


def test_constraints_apart_cost_no_fit() -> None:
    """An edit that touches none of them samples what it would without."""
    made = session(32, constrained=True)
    t = 0.9
    place = tuple((made.curve("c").view(Nurbs)(t) + np.array([0, 0.01])).tolist())
    outcome = made.apply("c", DirectManipulation(t=t, to=place))
    assert (outcome.rounds, outcome.work.sampled, outcome.constraints) == (0, 0, ())


@pytest.mark.parametrize("kind", ["direct manipulation", "sweep", "sweep of two"])
def test_the_moves_of_a_gesture_factor_nothing_twice(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A system is factored once in a gesture, and knots seldom move so that there is a new one.

    The results are those of moves one by one.
    """
    calls = []

    def counted(*arguments: Any) -> splines.Factored:
        calls.append(arguments)
        return factored(*arguments)

    monkeypatch.setattr(splines, "factored", counted)

    def move(made: mr.Session, k: int) -> Tool[Any]:
        to = (1.5 * 32, 0.01 * np.sin(k + 1))
        if kind == "direct manipulation":
            return DirectManipulation(t=0.5, to=to)
        hold = [0.502] if kind == "sweep of two" else None
        return Sweep(t=0.5, to=to, level=7, hold=hold)

    dragged, moved = (session(32, constrained=True) for _ in range(2))
    counts = []
    with dragged.gesture("c") as gesture:
        for k in range(6):
            before = len(calls)
            gesture.apply(move(dragged, k))
            counts.append(len(calls) - before)
    systems = {tuple(np.asarray(argument).tobytes() for argument in call) for call in calls}
    assert len(systems) == len(calls)
    assert counts[0] > 0
    assert counts.count(0) >= 3
    calls.clear()
    for k in range(6):
        moved.apply("c", move(moved, k))
    assert len(calls) >= 6 * counts[0]
    for name in dragged.curve("c").kinds:
        values = [made.curve("c").view(name).to_dict() for made in (dragged, moved)]
        assert values[0] == values[1]


@pytest.mark.slow
@pytest.mark.parametrize("n", [32, 1024])
@pytest.mark.parametrize("tool", TOOLS)
def test_a_move_with_three_constraints_costs_at_most_four_times_one_without(
    tool: str, n: int
) -> None:
    """All three representations brought up to date; the best of three measurements."""
    ratios = []
    for _ in range(3):
        free, bound = (drag(session(n, constrained=c), tool)[1] for c in (False, True))
        ratios.append(bound / free)
    assert min(ratios) <= 4
