"""Conflicts reject the edit, change nothing, say who, where, how far off, and the way out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import attrs
import numpy as np
import pytest

import multirep as mr
from multirep.constraint import Constraint
from multirep.constraints import (
    CornerConstraint,
    DerivativeConstraint,
    Freeze,
    Mark,
    PointConstraint,
)
from multirep.edit import Edit
from multirep.errors import ConflictError
from multirep.interval import Interval
from multirep.representations import Nurbs
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.tools import Corner, DirectManipulation, InsertKnot, MoveControlPoint, MoveVertex


@attrs.frozen
class Above(Constraint[Nurbs]):
    """The curve at ``t`` is ``height`` above the curve at ``base``; moves control points at t."""

    name = "above"
    needs = Nurbs

    t: float
    base: float
    height: float = 1.0

    def region(self, value: Nurbs) -> Interval:
        return Interval(min(self.t, self.base), max(self.t, self.base))

    def residual(self, value: Nurbs) -> float:
        return float(abs(value(self.t)[1] - value(self.base)[1] - self.height))

    def enforce(self, value: Nurbs, change: SpliceList, scene: Scene) -> Edit[Nurbs]:
        target = float(value(self.t)[0]), float(value(self.base)[1]) + self.height
        return PointConstraint(t=self.t, point=target).enforce(value, change, scene)


def curve() -> mr.MultiRepresentation:
    n = 40
    knots = np.r_[[0.0] * 3, np.linspace(0, 1, n - 2), [1.0] * 3]
    x = np.linspace(0, 4, n)
    nurbs = Nurbs(degree=3, knots=knots, points=np.column_stack([x, np.sin(2 * x)]))
    return mr.MultiRepresentation(nurbs, tolerance=1e-3)


Act = Callable[[mr.Session], object]


def adds(constraint: Constraint[Any], name: str) -> Act:
    return lambda session: session.constrain("c", constraint, name=name)


def applies(tool: Any) -> Act:
    return lambda session: session.apply("c", tool)


POINT = PointConstraint(t=0.5, point=(2.0, -0.5))
EARS = Freeze(interval=(0.4, 0.6))

CASES: dict[str, tuple[dict[str, Constraint[Any]], Act, set[str], set[str]]] = {
    # what there is, what is done, the culprits, the sets of one whose release helps
    "two points at one t": (
        {"a": POINT, "far": PointConstraint(t=0.9, point=(3.6, 1.0))},
        adds(PointConstraint(t=0.5, point=(2.0, 1.0)), "b"),
        {"a", "b"},
        {"a"},
    ),
    "two points at nearly one t": (
        {"a": POINT},
        adds(PointConstraint(t=0.5 + 1e-12, point=(2.0, 1.0)), "b"),
        {"a", "b"},
        {"a"},
    ),
    "a tool that pulls a pinned point": (
        {"a": POINT, "far": PointConstraint(t=0.9, point=(3.6, 1.0))},
        applies(DirectManipulation(t=0.5, to=(2.0, 1.0))),
        {"a"},
        {"a"},
    ),
    "a target in a frozen stretch": (
        {"ears": EARS},
        applies(DirectManipulation(t=0.5, to=(2.0, 1.0))),
        {"ears"},
        {"ears"},
    ),
    "a knot in a frozen stretch": ({"ears": EARS}, applies(InsertKnot(t=0.5)), {"ears"}, {"ears"}),
    "a target outside the marks": (
        {"marks": Mark(interval=(0.7, 0.9))},
        applies(DirectManipulation(t=0.5, to=(2.0, 1.0))),
        {"marks"},
        {"marks"},
    ),
    "a point in a frozen stretch": (
        {"ears": EARS},
        adds(PointConstraint(t=0.5, point=(2.0, 1.0)), "b"),
        {"ears", "b"},
        {"ears"},
    ),
    "a corner against a derivative": (
        {"ear": CornerConstraint(t=0.5, point=(2, 0), left=(1, 5), right=(1, -5))},
        adds(DerivativeConstraint(t=0.5, left=(1, 0)), "d"),
        {"ear", "d"},
        {"ear"},
    ),
    "a corner tool against a corner": (
        {"ear": CornerConstraint(t=0.5, point=(2, 0), left=(1, 5), right=(1, -5))},
        applies(Corner(t=0.5, left=(5.0, 1.0))),
        {"ear"},
        {"ear"},
    ),
    "three on a cycle": (
        {"a": Above(0.2, 0.8), "b": Above(0.5, 0.2)},
        adds(Above(0.8, 0.5), "c"),
        {"a", "b", "c"},
        {"a", "b"},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_conflict_names_its_culprits_and_changes_nothing(case: str) -> None:
    """Names, claims, residuals, the smallest release; no bit, no constraint, no undo step."""
    present, act, culprits, releases = CASES[case]
    session = mr.Session()
    session.add("c", curve())
    for name, constraint in present.items():
        session.constrain("c", constraint, name=name)
    target, before = session.curve("c"), session.curve("c").snapshot()
    held, undoable = session.framework.constraints("c"), session.undoable
    with pytest.raises(ConflictError) as caught:
        act(session)
    error = caught.value
    assert set(error.constraints) == culprits
    assert len(error.release) == 1
    assert set(error.release) <= releases
    assert f"releasing {error.release[0]!r}" in str(error)
    assert set(error.residuals) == set(error.where) == culprits
    assert all(np.isfinite(residual) for residual in error.residuals.values())
    domain = SpliceList([target.domain])
    assert all(claim and domain.contains(claim) for claim in error.where.values())
    assert target.snapshot() is before
    assert session.framework.constraints("c") == held
    assert session.undoable == undoable
    session.release("c", error.release[0])
    act(session)


def test_more_conditions_than_control_points() -> None:
    """However many knots are added, as many points at almost one place cannot all be passed."""
    session = mr.Session()
    session.add("c", curve())
    points = {
        f"p{k}": PointConstraint(t=0.5 + 1e-9 * k, point=(2.0, (-1.0) ** k)) for k in range(9)
    }

    def add_all() -> None:
        with session.gesture("c"):
            for name, point in points.items():
                session.framework.constrain("c", point, name=name)

    before = session.curve("c").snapshot()
    with pytest.raises(ConflictError) as caught:
        add_all()
    error = caught.value
    assert len(error.constraints) >= 2
    assert set(error.where) == set(error.residuals) == set(error.constraints) <= set(points)
    assert max(error.residuals.values()) == pytest.approx(2.0)
    assert all(claim.contains(0.5) for claim in error.where.values())
    assert set(error.release) <= set(points)
    assert "ask for more than the control points around t = 0.5" in str(error)
    assert session.curve("c").snapshot() is before
    assert not session.framework.constraints("c")


def test_what_is_off_is_told_in_the_units_of_the_points() -> None:
    """A derivative by t times the span beside, as residuals are; a tool's by its part."""
    session = mr.Session()
    session.add("c", curve())
    ear = CornerConstraint(t=0.5, point=(2, 0), left=(1, 5), right=(1, -5))
    session.constrain("c", ear, name="ear")
    turned = DerivativeConstraint(t=0.5, left=(1, 0))
    with pytest.raises(
        ConflictError, match=r"different derivatives at t = 0\.5, 5 apart"
    ) as caught:
        session.constrain("c", turned, name="d")
    assert caught.value.residuals["d"] == pytest.approx(
        turned.residual(session.curve("c").view(Nurbs))
    )
    with pytest.raises(ConflictError, match=r"its derivatives differ by .* %; releasing 'ear'"):
        session.apply("c", Corner(t=0.5, left=(5.0, 1.0)))


def test_three_on_a_cycle_are_told_as_a_cycle() -> None:
    """In the order in which they break each other, each off by something."""
    session = mr.Session()
    session.add("c", curve())
    session.constrain("c", Above(0.2, 0.8), name="a")
    session.constrain("c", Above(0.5, 0.2), name="b")
    session.constrain("c", PointConstraint(t=0.35, point=(1.4, 0.0)), name="bystander")
    with pytest.raises(ConflictError, match="break each other in a cycle") as caught:
        session.constrain("c", Above(0.8, 0.5), name="c")
    cycle = caught.value.cycle
    assert set(cycle) == {"a", "b", "c"}
    at = cycle.index("a")
    assert [cycle[(at + k) % 3] for k in range(3)] == ["a", "b", "c"]
    assert max(caught.value.residuals.values()) > 0.5


def test_constraints_that_agree_are_no_conflict() -> None:
    """Close points, a corner with its derivative, a freeze over what holds: all go together."""
    session = mr.Session()
    session.add("c", curve())
    agreed: Mapping[str, Constraint[Any]] = {
        "ear": CornerConstraint(t=0.5, point=(2, 0), left=(1, 5)),
        "same": DerivativeConstraint(t=0.5, left=(1, 5)),
        "other side": DerivativeConstraint(t=0.5, right=(1, -5)),
        "near": PointConstraint(t=0.501, point=(2.0, -0.05)),
        "ears": Freeze(interval=(0.45, 0.55)),
        "inside": PointConstraint(t=0.5, point=(2.0, 0.0)),
    }
    for name, constraint in agreed.items():
        session.constrain("c", constraint, name=name)
    nurbs = session.curve("c").view(Nurbs)
    for constraint in agreed.values():
        if isinstance(constraint, CornerConstraint | DerivativeConstraint | PointConstraint):
            assert constraint.residual(nurbs) <= 1e-9


def test_an_edit_beside_constraints_keeps_what_it_asks_for() -> None:
    """The tool's point and the pinned one beside it are met in one solve."""
    session = mr.Session()
    session.add("c", curve())
    session.constrain("c", POINT, name="a")
    outcome = session.apply("c", DirectManipulation(t=0.52, to=(2.1, 0.3)))
    nurbs = session.curve("c").view(Nurbs)
    np.testing.assert_allclose(nurbs(0.52), [2.1, 0.3], atol=1e-12)
    np.testing.assert_allclose(nurbs(0.5), POINT.point, atol=1e-12)
    assert outcome.rounds == 1
    assert [item.name for item in outcome.constraints] == ["a"]
    assert outcome.constraints[0].residual <= 1e-12


def test_control_points_and_vertices_answer_to_constraints() -> None:
    """Tools that name no place are corrected around the constraint."""
    session = mr.Session()
    session.add("c", curve())
    session.constrain("c", POINT, name="a")
    nurbs = session.curve("c").view(Nurbs)
    k = nurbs.span(0.5) - 1
    session.apply("c", MoveControlPoint(index=k, to=tuple(nurbs.points[k] + [0, 0.5])))
    assert POINT.residual(session.curve("c").view(Nurbs)) <= 1e-12
    polyline = session.curve("c").view("polyline")
    index = int(polyline.t.searchsorted(0.5))  # type: ignore[attr-defined]
    session.apply("c", MoveVertex(index=index, to=(2.0, 0.5)))
    assert POINT.residual(session.curve("c").view(Nurbs)) <= 1e-12
