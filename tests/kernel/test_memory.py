"""What a gesture remembers: by key, a bounded number of things, the least used goes first."""

from __future__ import annotations

from multirep.memory import MOST, Memory


def test_what_was_not_asked_for_longest_is_forgotten() -> None:
    """A drag in which no two moves have anything in common does not fill the memory."""
    memory = Memory()
    worked_out = []

    def result(key: int) -> int:
        worked_out.append(key)
        return -key

    for key in range(3 * MOST):
        assert memory.recall(0, lambda: result(0)) == 0
        assert memory.recall(key, lambda key=key: result(key)) == -key  # type: ignore[misc]
    assert worked_out == list(range(3 * MOST))
    assert memory.recall(3 * MOST - 1, lambda: 1) == 1 - 3 * MOST
    assert memory.recall(1, lambda: 1) == 1
