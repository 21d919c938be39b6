"""Starting: ``import multirep`` and the command line beside bare Python."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable, Iterator

from benchmarks.workload import Case, Contestant, Timed, Workload


def contestants(case: Case) -> Iterator[Contestant]:
    """CPU time of a new process, user and system."""
    yield Timed("import multirep", starting("-c", "import multirep"), True, clock=of_children)
    yield Timed("multirep --help", starting("-m", "multirep", "--help"), True, clock=of_children)
    for name, code in {
        "bare Python": "",
        "import numpy": "import numpy",
        "import scipy.interpolate": "import scipy.interpolate",
    }.items():
        yield Timed(name, starting("-c", code), clock=of_children)


def starting(*arguments: str) -> Callable[[int], object]:
    """Return the start of a process, until it ends."""
    command = [sys.executable, *arguments]
    return lambda k: subprocess.run(command, check=True, capture_output=True)


def of_children() -> float:
    """Return the CPU seconds of all processes that were started and have ended."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


CASE = Case(1, "none")
STARTING = Workload("start", "Starting", [CASE], contestants, checked=[CASE])
