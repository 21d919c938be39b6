"""The runner: sets up each case, measures its contestants in turns, skips what takes too long."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterable, Sequence
from importlib.metadata import PackageNotFoundError, version
from statistics import median
from time import perf_counter

from benchmarks.peers import PEERS
from benchmarks.results import Cell, Entry, Results
from benchmarks.timing import BUDGET, Stopwatch, copying, in_turns
from benchmarks.workload import Absent, Case, Contestant, Counted, Timed, Workload
from multirep.splines import compiled

#: Seconds that one step of a peer may be expected to take; slower ones are left out.
LIMIT = 45.0


def run(
    plan: Iterable[tuple[Workload, Sequence[Case]]],
    *,
    limit: float = LIMIT,
    budget: float = BUDGET,
    known: Results | None = None,
    say: Callable[[str], None] = print,
) -> Results:
    """Measure the cases of workloads.

    A contestant is left out of a case when the next smaller case of the same workload, or the
    results that are known, let expect that one step takes more than ``limit`` seconds.
    """
    cells: list[Cell] = []
    copies: list[float] = []
    for workload, cases in plan:
        for case in cases:
            begin = perf_counter()
            copies.append(copying())
            past = [*(known.of(workload.name) if known else ()), *cells]
            cells.append(measured(workload, case, past, limit=limit, budget=budget))
            say(
                f"{workload.name:18} {case.curve:6} n = {case.size:<8} "
                f"tolerance {case.tolerance:<6g} {perf_counter() - begin:6.1f} s"
            )
    return Results(machine(copies), tuple(cells))


def measured(
    workload: Workload,
    case: Case,
    past: Sequence[Cell] = (),
    *,
    limit: float = LIMIT,
    budget: float = BUDGET,
) -> Cell:
    """Measure one case; ``past`` cells say what to expect."""
    contestants = [
        _within(limit, contestant, expected(workload.name, case, contestant.name, past))
        for contestant in workload.contestants(case)
    ]
    timed = [c for c in contestants if isinstance(c, Timed)]
    references = workload.references(case)
    watches = in_turns([*timed, *references], budget=budget)
    small = {watch.contestant.name: watch.samples for watch in watches[len(timed) :]}
    turns = iter(watches)
    entries = tuple(
        _entry(next(turns) if isinstance(c, Timed) else c, small.get(c.name)) for c in contestants
    )
    return Cell(workload.name, case.curve, case.size, case.tolerance, entries)


def expected(workload: str, case: Case, name: str, past: Sequence[Cell]) -> float:
    """Return the seconds that a step should take: linear from the nearest case that is known.

    0 when none is: nothing is known against it. A contestant that was left out of a smaller case
    is expected to take for ever.
    """
    found = 0.0
    for cell in past:
        if cell.workload != workload or cell.curve != case.curve or cell.size > case.size:
            continue
        for entry in cell.entries:
            if entry.name != name or entry.unit != "s":
                continue
            if entry.median is None:
                found = float("inf") if TOO_SLOW in entry.why else found
            else:
                found = entry.median * case.size / cell.size
    return found


#: How a reason begins when it is about time.
TOO_SLOW = "too slow"


def _within(limit: float, contestant: Contestant, seconds: float) -> Contestant:
    if seconds <= limit or not isinstance(contestant, Timed) or contestant.ours:
        return contestant
    about = f", about {seconds:.0f} s a step" if seconds < float("inf") else ""
    return Absent(contestant.name, TOO_SLOW + about)


def _entry(contestant: Stopwatch | Counted | Absent, small: list[float] | None) -> Entry:
    match contestant:
        case Absent(name, why):
            return Entry(name, why=why)
        case Counted(name, number, unit, ours):
            return Entry.of(name, [float(number)], ours=ours, unit=unit)
        case Stopwatch(contestant=Timed(name=name, ours=ours)):
            if contestant.failure:
                return Entry(name, ours, why=contestant.failure)
            return Entry.of(name, contestant.samples, ours=ours, small=small if ours else None)


def machine(copies: Sequence[float]) -> dict[str, str | float]:
    """Return what the numbers depend on; the time of a copy is the median over the run."""
    found: dict[str, str | float] = {
        "copy_16_MB_ms": round(1e3 * median(copies), 3),
        "processor": _processor(),
        "python": platform.python_version(),
    }
    found["compiled core"] = "in use" if compiled.active else "left out"
    for name in ("numpy", "scipy", *PEERS.values()):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def _processor() -> str:
    try:
        with open("/proc/cpuinfo") as lines:
            names = [line.partition(":")[2].strip() for line in lines if "model name" in line]
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()
