"""The workloads, by name."""

from __future__ import annotations

from benchmarks.workload import Workload
from benchmarks.workloads.alternating import ALTERNATING
from benchmarks.workloads.analysis import ANALYSIS
from benchmarks.workloads.drag import DRAG
from benchmarks.workloads.evaluation import ONE, SORTED, UNSORTED
from benchmarks.workloads.first_views import CONTROL_POINTS, DISTANCES, FIRST_VIEWS
from benchmarks.workloads.insertion import INSERT_MANY, INSERT_ONE
from benchmarks.workloads.memory import HISTORY, MEMORY
from benchmarks.workloads.nearest import NEAREST_MANY, NEAREST_ONE, NEAREST_WRONG
from benchmarks.workloads.parts import PARTS
from benchmarks.workloads.sampling import RATIONAL_VERTICES, SAMPLING, VERTICES
from benchmarks.workloads.starting import STARTING
from benchmarks.workloads.undo import UNDO
from benchmarks.workloads.unseen import UNSEEN
from benchmarks.workloads.windows import WINDOWS
from benchmarks.workloads.yardstick import YARDSTICK

WORKLOADS: dict[str, Workload] = {
    workload.name: workload
    for workload in (
        DRAG,
        YARDSTICK,
        UNSEEN,
        WINDOWS,
        UNDO,
        PARTS,
        ALTERNATING,
        FIRST_VIEWS,
        CONTROL_POINTS,
        DISTANCES,
        ONE,
        SORTED,
        UNSORTED,
        INSERT_ONE,
        INSERT_MANY,
        VERTICES,
        RATIONAL_VERTICES,
        SAMPLING,
        NEAREST_ONE,
        NEAREST_MANY,
        NEAREST_WRONG,
        ANALYSIS,
        MEMORY,
        HISTORY,
        STARTING,
    )
}
