"""Functions with the compiled core and without it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from multirep.splines import compiled

R = TypeVar("R")


@contextmanager
def core(active: bool) -> Iterator[None]:
    """Let functions use the core, or not."""
    before, compiled.active = compiled.active, active
    try:
        yield
    finally:
        compiled.active = before


def both(function: Callable[[], R]) -> tuple[R, R]:
    """Call with the core and without it."""
    with core(True):
        fast = function()
    with core(False):
        return fast, function()
