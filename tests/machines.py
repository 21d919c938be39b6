"""Random sessions: state machines of Hypothesis are run, and seen to have taken their steps."""

from __future__ import annotations

from typing import Any

from hypothesis import settings
from hypothesis.stateful import RuleBasedStateMachine, run_state_machine_as_test


def check_machine(machine: type[RuleBasedStateMachine], *, sessions: int, steps: int) -> None:
    """Run random sessions; their rules and invariants assert what must hold after each step.

    A machine whose rules can hardly ever run would pass whatever it asserts, so steps are counted.
    """
    taken = 0

    class Counted(machine):  # type: ignore[misc,valid-type]  # a class that is given
        def check_invariants(self, *state: Any) -> None:
            nonlocal taken
            super().check_invariants(*state)
            taken += 1

    # examples that once failed are kept under the name of the machine
    Counted.__name__ = Counted.__qualname__ = machine.__qualname__
    run_state_machine_as_test(
        Counted, settings=settings(max_examples=sessions, stateful_step_count=steps)
    )
    assert taken >= sessions * steps / 2, "most sessions ended before they had begun"
