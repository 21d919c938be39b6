"""A session under random use with constraints that come and go at random.

Everything of the state machine of sessions still holds. On top of that, after each accepted step:
point, derivative and corner constraints hold to a billionth of the size on the NURBS and to the
tolerance elsewhere; frozen stretches are what they were, bit by bit; and a conflict names
constraints that are there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import strategies as st
from hypothesis.stateful import initialize, invariant, precondition, rule
from machines import check_machine
from test_state_machine import (
    STARTS,
    TOLERANCES,
    SessionMachine,
    beside,
    check_step,
    check_up_to_date_pairs,
    offsets,
    place,
    places,
)

import multirep as mr
from multirep.constraint import Constraint
from multirep.constraints import (
    CornerConstraint,
    DerivativeConstraint,
    Freeze,
    LinearConstraint,
    Mark,
    PointConstraint,
)
from multirep.errors import ConflictError, EditError, EditRejectedError, ToleranceError
from multirep.interval import Interval
from multirep.representations import Nurbs
from multirep.state import State

#: What may go wrong for a good reason.
REFUSALS = (EditRejectedError, ToleranceError, ConflictError, EditError)


def extent(value: Any) -> float:
    t = np.linspace(value.domain.start, value.domain.stop, 65)
    return float(np.ptp(value(t), axis=0).max())


class ConstrainedMachine(SessionMachine):
    """The same, with constraints."""

    @initialize(start=st.sampled_from(STARTS), tolerance=st.sampled_from(TOLERANCES[:3]))
    def begin(self, start: Callable[[], mr.MultiRepresentation], tolerance: float) -> None:
        self.count = 0
        self.ice: dict[str, tuple[list[Interval], dict[str, bytes], dict[str, Any]]] = {}
        super().begin(start, tolerance)

    def step(self, action: Callable[[], object]) -> None:
        before, held = self.curve.snapshot(), self.session.framework.constraints("curve")
        with self.curve.listening() as events:
            try:
                action()
            except REFUSALS as error:
                assert self.curve.snapshot().held is before.held
                assert self.session.framework.constraints("curve") == held
                self.check_conflict(error, set(held))
                return
        check_step(before, self.curve.snapshot(), events)
        self.past.append(before)
        self.future.clear()

    def check_conflict(self, error: Exception, held: set[str]) -> None:
        if isinstance(error, ConflictError):
            known = held | {f"k{self.count}"}
            assert error.constraints
            assert set(error.constraints) <= known
            assert set(error.release) <= held
            assert set(error.where) <= known
            assert all(np.isfinite(residual) for residual in error.residuals.values())

    def add(self, constraint: Constraint[Any]) -> None:
        self.count += 1
        name = f"k{self.count}"
        self.step(lambda: self.session.constrain("curve", constraint, name=name))

    # -- constraints come ----------------------------------------------------------------------

    def near(self, u: float, offset: tuple[float, ...]) -> tuple[float, tuple[float, ...]]:
        t = place(self.curve, u)
        return t, beside(self.curve.view(Nurbs)(t), tuple(x / 4 for x in offset))

    @rule(u=places, offset=offsets)
    def add_point(self, u: float, offset: tuple[float, ...]) -> None:
        t, point = self.near(u, offset)
        self.add(PointConstraint(t=t, point=point))

    @rule(u=places, left=offsets, right=offsets, smooth=st.booleans())
    def add_derivative(
        self, u: float, left: tuple[float, ...], right: tuple[float, ...], smooth: bool
    ) -> None:
        t = place(self.curve, 0.1 + 0.8 * u)
        one, other = self.slopes(left, right)
        self.add(DerivativeConstraint(t=t, left=one, right=one if smooth else other))

    @rule(u=places, offset=offsets, left=offsets, right=offsets)
    def add_corner(
        self,
        u: float,
        offset: tuple[float, ...],
        left: tuple[float, ...],
        right: tuple[float, ...],
    ) -> None:
        t, point = self.near(0.1 + 0.8 * u, offset)
        one, other = self.slopes(left, right)
        self.add(CornerConstraint(t=t, point=point, left=one, right=other))

    def slopes(self, *vectors: tuple[float, ...]) -> list[tuple[float, ...]]:
        rows = [np.resize(vector, self.curve.dimension) * 8 for vector in vectors]
        return [tuple(row.tolist()) for row in rows]

    @rule(u=places, width=st.integers(1, 20).map(lambda k: k / 64))
    def add_freeze(self, u: float, width: float) -> None:
        start = place(self.curve, u * (1 - width))
        self.add(Freeze(interval=(start, start + width * self.curve.domain.length)))

    @precondition(lambda self: len(self.ice) < 2)
    @rule(u=places, width=st.integers(16, 56).map(lambda k: k / 64))
    def add_mark(self, u: float, width: float) -> None:
        start = place(self.curve, u * (1 - width))
        self.add(Mark(interval=(start, start + width * self.curve.domain.length)))

    # -- and go --------------------------------------------------------------------------------

    @precondition(lambda self: self.session.framework.constraints("curve"))
    @rule(data=st.data())
    def release(self, data: st.DataObject) -> None:
        names = sorted(self.session.framework.constraints("curve"))
        name = data.draw(st.sampled_from(names))
        self.step(lambda: self.session.release("curve", name))

    # -- what must hold ------------------------------------------------------------------------

    @invariant()
    def certificate(self) -> None:
        """As without constraints, but everything is brought up to date every fourth time only."""
        self.checks = getattr(self, "checks", 0) + 1
        if self.checks % 4 == 0:
            super().certificate()
        else:
            check_up_to_date_pairs(self.curve.snapshot())

    def check_is(self, state: State) -> None:
        super().check_is(state)
        now = self.curve.snapshot()
        assert now.claims == state.claims
        assert now.frozen == state.frozen

    @invariant()
    def constraints_hold(self) -> None:
        """On the NURBS to a billionth of the size, elsewhere to the tolerance."""
        before = self.curve.snapshot()
        linear = {
            name: constraint
            for name, constraint in self.session.framework.constraints("curve").items()
            if isinstance(constraint, LinearConstraint)
        }
        if linear:
            nurbs = self.curve.view(Nurbs)
            size = extent(nurbs)
            for name, constraint in linear.items():
                assert constraint.residual(nurbs) <= 1e-9 * size + 1e-13 * nurbs.magnitude, name
                for condition in constraint.conditions(nurbs):
                    if condition.order == 0:
                        for kind in self.curve.kinds:
                            value = self.curve.view(kind)
                            apart = np.linalg.norm(value(condition.t) - condition.target)
                            assert apart <= self.curve.tolerance * (1 + 1e-9), (name, kind)
        self.curve.restore(before)

    @invariant()
    def the_ice_stays(self) -> None:
        """Each stretch is what it was when it was first seen frozen, in every representation.

        So are all stored numbers on which it depends, from one step to the next.
        """
        held = self.curve.snapshot().held
        claims = self.curve.claims
        for name in set(self.ice) - set(claims):
            del self.ice[name]
        for name, claim in claims.items():
            stretches = list(claim)
            bits = {}
            for kind, item in held.items():
                assert item.value is not None
                assert not item.stale.intersects(claim)
                bits[kind] = b"".join(
                    item.value(np.linspace(stretch.start, stretch.stop, 65)).tobytes()
                    for stretch in stretches
                )
            values = {kind: item.value for kind, item in held.items()}
            if name in self.ice:
                *before, stored = self.ice[name]
                assert before == [stretches, bits], name
                for kind, value in stored.items():
                    assert not value.changes(values[kind]).intersects(claim), (name, kind)
            self.ice[name] = (stretches, bits, values)


@pytest.mark.parametrize(
    ("sessions", "steps"), [(10, 20), pytest.param(40, 50, marks=pytest.mark.slow)]
)
def test_a_session_keeps_its_promises_with_constraints(sessions: int, steps: int) -> None:
    """What is committed holds all constraints; what is frozen keeps every bit."""
    check_machine(ConstrainedMachine, sessions=sessions, steps=steps)
