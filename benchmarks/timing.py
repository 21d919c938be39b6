"""Measuring: medians of wall-clock times, and a yardstick for the machine."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np


def median(step: Callable[[int], object], *, count: int, warm_up: int = 0) -> float:
    """Median seconds of ``step(k)``, k = 0, 1, ...; the first ``warm_up`` steps are not counted."""
    times = []
    for k in range(warm_up + count):
        begin = perf_counter()
        step(k)
        if k >= warm_up:
            times.append(perf_counter() - begin)
    return float(np.median(times))


def copying(megabytes: int = 16) -> float:
    """Median seconds that copying an array takes."""
    source = np.ones(megabytes * 2**20 // 8)
    target = np.empty_like(source)
    return median(lambda k: np.copyto(target, source), count=25, warm_up=3)
