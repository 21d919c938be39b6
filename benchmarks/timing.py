"""Measuring: medians of CPU times (other work disturbs them least), and a yardstick."""

from __future__ import annotations

from collections.abc import Callable
from time import process_time

import numpy as np


def median(step: Callable[[int], object], *, count: int, warm_up: int = 0) -> float:
    """Median CPU seconds of ``step(k)``, k = 0, 1, ...; ``warm_up`` steps are not counted."""
    times = []
    for k in range(warm_up + count):
        begin = process_time()
        step(k)
        if k >= warm_up:
            times.append(process_time() - begin)
    return float(np.median(times))


def copying(megabytes: int = 16) -> float:
    """Median CPU seconds that copying an array takes."""
    source = np.ones(megabytes * 2**20 // 8)
    target = np.empty_like(source)
    return median(lambda k: np.copyto(target, source), count=25, warm_up=3)
