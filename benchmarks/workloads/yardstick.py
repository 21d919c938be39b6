"""The drag steps beside the copy of an array, the yardstick of the machine; up to a million."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.timing import copy_of
from benchmarks.workload import Case, Contestant, Timed, Workload, sweep
from benchmarks.workloads.drag import dragging

COPY = "copy 16 MB"
SIZES = (1000, 1_000_000)


def contestants(case: Case) -> Iterator[Contestant]:
    """Ours by the representation that is edited, and the copy."""
    yield from dragging(case)
    yield Timed(COPY, copy_of(megabytes=16))


YARDSTICK = Workload(
    "yardstick",
    "One drag step beside the copy of an array",
    sweep("smooth", "coast", sizes=SIZES, full=[]),
    contestants,
)
