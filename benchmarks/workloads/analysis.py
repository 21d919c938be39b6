"""Wavelet analysis of all levels beside PyWavelets' biorthogonal one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from benchmarks.curves import vertices
from benchmarks.peers import optional
from benchmarks.workload import Absent, Case, Contestant, Timed, Workload, sweep
from multirep.errors import MultirepError
from multirep.representations import WaveletBSpline


def contestants(case: Case) -> Iterator[Contestant]:
    """``size`` spans; all levels."""
    level = case.size.bit_length() - 1
    points = vertices(case.curve, case.size + 3)
    made = [WaveletBSpline(points)]

    def renew(k: int) -> None:
        # a value keeps its pyramid
        made[0] = WaveletBSpline(points)

    try:
        found = made[0].pyramid(level).level
    except MultirepError as error:
        yield Absent("semi-orthogonal", str(error))
    else:
        assert found == level
        yield Timed("semi-orthogonal", lambda k: made[0].pyramid(level), True, before=renew)

    def pywavelets(pywt: Any) -> Callable[[int], object]:
        return lambda k: pywt.wavedec(points, "bior3.3", axis=0)

    yield optional("pywt", "PyWavelets bior3.3", pywavelets)


ANALYSIS = Workload(
    "analysis",
    "Wavelet analysis, all levels",
    sweep(sizes=[2**10, 2**13, 2**16], full=[2**20]),
    contestants,
    checked=sweep(sizes=[2**13, 2**16], full=[]),
)
