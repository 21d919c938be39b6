"""What a benchmark is made of: workloads, their cases, and the contestants of a case."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from time import process_time
from typing import TypeAlias

from attrs import evolve, frozen

#: Sizes of a run, and those that only a full one adds.
SIZES, FULL_SIZES = (100, 1000, 10_000, 100_000), (1_000_000,)
#: From the large size on, ours at the small size takes turns with the others: so the growth is a
#: ratio of one moment, too.
SMALL, LARGE = 1000, 100_000


@frozen
class Case:
    """One set-up of a workload: a curve of ``size`` vertices or control points, a tolerance."""

    size: int
    curve: str = "smooth"
    tolerance: float = 1e-3
    #: Only in a full run.
    full: bool = False


@frozen
class Timed:
    """Something whose CPU time is measured.

    Parameters
    ----------
    name : str
    step : callable
        ``step(k)``, k = 0, 1, ..: what is timed, again and again.
    ours : bool
        Or a peer.
    before : callable, optional
        ``before(k)``, not timed, precedes each step, which is then timed one by one.
    clock : callable, optional
        Seconds; by default the CPU time of this process.
    """

    name: str
    step: Callable[[int], object]
    ours: bool = False
    before: Callable[[int], object] | None = None
    clock: Callable[[], float] = process_time


@frozen
class Counted:
    """A number that needs no repetition: vertices, bytes, control points, a median of its own."""

    name: str
    number: float
    unit: str
    ours: bool = False


@frozen
class Absent:
    """A contestant that does not take part, and why."""

    name: str
    why: str


Contestant: TypeAlias = Timed | Counted | Absent


@frozen
class Workload:
    """A named job.

    Parameters
    ----------
    name : str
        For the command line and the results.
    title : str
        For people.
    cases : sequence of Case
    contestants : callable
        Sets up a case: its contestants, ours and peers.
    checked : sequence of Case
        What the guard measures again.
    """

    name: str
    title: str
    cases: Sequence[Case]
    contestants: Callable[[Case], Iterable[Contestant]]
    checked: Sequence[Case] = ()

    def references(self, case: Case) -> list[Timed]:
        """Return ours at the small size, to take turns with a large case; else none."""
        small = evolve(case, size=SMALL, full=False)
        if case.size < LARGE or small not in self.cases:
            return []
        return [c for c in self.contestants(small) if isinstance(c, Timed) and c.ours]


def sweep(
    *curves: str,
    sizes: Sequence[int] = SIZES,
    full: Sequence[int] = FULL_SIZES,
    tolerances: Sequence[float] = (1e-3,),
) -> tuple[Case, ...]:
    """List the cases of curves by tolerances by sizes; ``full`` sizes for full runs only."""
    cases = [
        Case(size, curve, tolerance)
        for curve in curves or ("smooth",)
        for tolerance in tolerances
        for size in (*sizes, *full)
    ]
    return tuple(evolve(case, full=case.size in full) for case in cases)
