"""The goals, each a number that results give and a limit: what is reached and what is not.

Where a goal speaks of several tools, curves or sizes the worst one counts.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Literal

from attrs import frozen

from benchmarks.results import Cell, Entry, Results
from benchmarks.tables import NOTHING, in_unit, markdown, number

#: Milliseconds in which the machine of the goals copies 16 MB.
COPY = 1.2

#: What was found, and where.
Found = tuple[float, str]
Reading = Callable[[Results], Iterator[Found]]


@frozen
class Goal:
    """One line of the table of goals.

    Parameters
    ----------
    job : str
    text : str
        The goal, for people; without the limit.
    limit : float
    reading : callable
        All numbers that must keep within the limit, each with where it was found.
    unit : str
        "s", "bytes", or "" for a ratio.
    sense : {"at most", "at least"}
    """

    job: str
    text: str
    limit: float
    reading: Reading
    unit: str = ""
    sense: Literal["at most", "at least"] = "at most"

    def extremes(self, results: Results) -> tuple[Found, Found] | None:
        """Return the worst and the best number; None when nothing was measured."""
        found = sorted(self.reading(results), reverse=self.sense == "at most")
        return (found[0], found[-1]) if found else None

    def reached(self, value: float) -> bool:
        """Whether a number keeps within the limit."""
        return value <= self.limit if self.sense == "at most" else value >= self.limit


def goal_table(results: Results) -> str:
    """Return all goals with what is measured here, as markdown."""
    rows = [["job", "goal", "at worst", "at best", "reached", "the worst is"]]
    for goal in GOALS:
        sign = "≤" if goal.sense == "at most" else "≥"
        text = f"{goal.text}: {sign} {in_unit(goal.limit, goal.unit)}"
        found = goal.extremes(results)
        if found is None:
            rows.append([goal.job, text, NOTHING, NOTHING, "not measured", NOTHING])
            continue
        (value, where), (best, _) = found
        reached = "yes" if goal.reached(value) else f"**no**, by {number(missed(goal, value))} ×"
        numbers = (in_unit(x, goal.unit) for x in (value, best))
        rows.append([goal.job, text, *numbers, reached, where])
    return markdown(rows)


def missed(goal: Goal, value: float) -> float:
    """Return the factor by which a number is on the wrong side of its limit."""
    if not goal.limit or not value:
        return float("inf")
    return value / goal.limit if goal.sense == "at most" else goal.limit / value


# -- readings --------------------------------------------------------------------------------------


def cells(results: Results, workload: str, *sizes: int, curve: str = "") -> Iterator[Cell]:
    """Yield cells of a workload, of some sizes or all, of a curve or all, at tolerance 1e-3."""
    for cell in results.of(workload):
        if cell.tolerance == 1e-3 and cell.curve.startswith(curve):
            if not sizes or cell.size in sizes:
                yield cell


def place(cell: Cell, entry: Entry) -> str:
    """Say where a number was found."""
    return f"{entry.name}, {cell.curve}, n = {number(cell.size)}"


def taking(workload: str, *sizes: int, names: str = "", scaled: bool = False) -> Reading:
    """Read medians of ours whose names contain ``names``; scaled to the machine of the goals."""

    def read(results: Results) -> Iterator[Found]:
        factor = COPY / float(results.machine["copy_16_MB_ms"]) if scaled else 1.0
        for cell in cells(results, workload, *sizes):
            for entry in cell.ours:
                if names in entry.name and entry.median is not None:
                    yield factor * entry.median, place(cell, entry)

    return read


def beside(
    workload: str,
    peer: str,
    *sizes: int,
    names: str = "",
    curve: str = "",
    tolerance: float | None = None,
    exactly: bool = False,
) -> Reading:
    """Read ours : peer, whose name contains ``peer`` or is it exactly."""

    def read(results: Results) -> Iterator[Found]:
        chosen = cells(results, workload, *sizes, curve=curve)
        if tolerance is not None:
            chosen = (cell for cell in results.of(workload) if cell.tolerance == tolerance)
        for cell in chosen:
            for other in cell.peers:
                if peer != other.name if exactly else peer not in other.name:
                    continue
                for entry in cell.ours:
                    ratio = cell.ratio(entry, other)
                    if names in entry.name and ratio:
                        yield 1 / ratio, place(cell, entry)

    return read


def times_faster(workload: str, peer: str, *sizes: int) -> Reading:
    """Read peer : ours."""

    def read(results: Results) -> Iterator[Found]:
        yield from ((1 / value, where) for value, where in beside(workload, peer, *sizes)(results))

    return read


def growth(workload: str, small: int, *large: int, names: str = "") -> Reading:
    """Read t(large) : t(small) of ours, for the largest of ``large`` that was measured."""

    def read(results: Results) -> Iterator[Found]:
        for cell in cells(results, workload, small):
            found = [c for c in cells(results, workload, *large) if c.curve == cell.curve]
            last = max(found, key=lambda c: c.size, default=cell)
            after = {entry.name: entry.median for entry in last.ours}
            for entry in cell.ours:
                later = after.get(entry.name)
                if last is not cell and names in entry.name and later and entry.median:
                    yield later / entry.median, place(last, entry)

    return read


def compared(one: str, two: str) -> Reading:
    """Read ours in one workload : ours of the same name and size in another."""

    def read(results: Results) -> Iterator[Found]:
        for cell in cells(results, one):
            other = results.find(two, cell.case)
            below = {} if other is None else {entry.name: entry.median for entry in other.ours}
            for entry in cell.ours:
                under = below.get(entry.name)
                if under and entry.median:
                    yield entry.median / under, place(cell, entry)

    return read


def linear(workload: str, *sizes: int) -> Reading:
    """Read the growth of ours from size to size, over that of n."""

    def read(results: Results) -> Iterator[Found]:
        found = sorted(cells(results, workload, *sizes), key=lambda c: (c.curve, c.size))
        for small, large in pairwise(found):
            after = {entry.name: entry.median for entry in large.ours}
            for entry in small.ours if small.curve == large.curve else ():
                later = after.get(entry.name)
                if later and entry.median:
                    share = later / entry.median / (large.size / small.size)
                    yield share, place(large, entry)

    return read


def bounds(results: Results) -> Iterator[Found]:
    """Read the proved bounds of samplings, in tolerances."""
    for workload in ("sample-vertices", "sample-vertices-rational"):
        for cell in results.of(workload):
            for entry in cell.ours:
                if entry.unit == "tolerances" and entry.median is not None:
                    yield entry.median, place(cell, entry)


def optimum(results: Results) -> Iterator[Found]:
    """Read vertices : optimum where a span has four chords or more, as the optimum supposes."""
    for workload in ("sample-vertices", "sample-vertices-rational"):
        for cell in results.of(workload):
            for best in cell.peers:
                enough = best.median is not None and best.median >= 4 * cell.size
                for entry in cell.ours if best.name == "optimum" and enough else ():
                    ratio = cell.ratio(entry, best)
                    if ratio:
                        yield 1 / ratio, place(cell, entry) + f", tolerance {cell.tolerance:g}"


ARCS = "spaced by arc length"
SCALED = f"scaled to a machine that copies 16 MB in {COPY} ms"
GOALS: tuple[Goal, ...] = (
    Goal("drag step", f"n = 10³, {SCALED}", 1e-3, taking("drag", 1000, scaled=True), "s"),
    Goal("drag step", "t(largest n) : t(10³)", 2, growth("drag", 1000, 100_000, 1_000_000)),
    *(
        Goal(
            "drag step",
            f"{program} : ours, {text}",
            limit,
            times_faster("drag", program, n),
            sense="at least",
        )
        for n, text, limit in ((1000, "10³", 25), (10_000, "10⁴", 100), (100_000, "10⁵", 1500))
        for program in ("eager, quick", "eager, frugal")
    ),
    Goal("drag step, nobody looks", "the commit", 20e-6, taking("unseen", names=": commit"), "s"),
    Goal("undo", "at any n", 50e-6, taking("undo", names="undo"), "s"),
    Goal(
        "first view, smooth",
        "ours : one splprep",
        0.5,
        beside("first-view", "splprep", 10_000, 100_000, curve="smooth"),
    ),
    Goal(
        "first view, rough",
        "ours : one splprep",
        0.25,
        beside("first-view", "splprep", 10_000, 100_000, curve="coast"),
    ),
    *(
        Goal(
            "first view",
            f"control points : searched splprep {text}",
            1.1,
            beside("control-points", name, names="nurbs", exactly=True),
        )
        for name, text in (
            ("splprep", "(within ε; a view is within ε/2)"),
            ("splprep, half the tolerance", "within ε/2, too"),
        )
    ),
    Goal(
        "first view",
        "proved distance from the polyline, tolerances",
        1,
        taking("first-view-error", names="proved"),
    ),
    Goal(
        "first view",
        "growth : growth of n",
        1.3,
        linear("first-view", 10_000, 100_000, 1_000_000),
    ),
    *(
        Goal(
            "evaluation in bulk, sorted",
            f"{name} : scipy",
            limit,
            beside("evaluate-sorted", "scipy", names=name),
        )
        for name, limit in (("polynomial", 1.2), ("rational", 1.4))
    ),
    Goal(
        "evaluation in bulk",
        "unsorted : sorted",
        4,
        compared("evaluate-unsorted", "evaluate-sorted"),
    ),
    Goal("evaluation of one point", "at any n", 10e-6, taking("evaluate-one"), "s"),
    Goal("evaluation of one point", "t(largest n) : t(100)", 1.3, growth("evaluate-one", 100)),
    Goal("insertion of a knot", "ours : scipy, 10³", 0.5, beside("insert-one", "scipy", 1000)),
    Goal("insertion of a knot", "ours : scipy, 10⁵", 0.05, beside("insert-one", "scipy", 100_000)),
    Goal("insertion of a knot", "t(largest n) : t(10³)", 1.5, growth("insert-one", 1000)),
    Goal("insertion of 100 knots", "ours : scipy loop", 0.125, beside("insert-100", "scipy")),
    Goal("sampling", "proved bound, in tolerances", 1, bounds),
    Goal("sampling", "vertices : optimum, ≥ 4 a span", 1.15, optimum),
    *(
        Goal(
            "sampling",
            f"vertices : arc-length rule, {tolerance:g}",
            limit,
            beside("sample-vertices", ARCS, tolerance=tolerance),
        )
        for tolerance, limit in ((1e-3, 1 / 4), (1e-4, 1 / 12), (1e-6, 1 / 150))
    ),
    Goal("wavelet analysis", "ours : PyWavelets", 6, beside("analysis", "PyWavelets")),
    Goal("wavelet analysis", "growth : growth of n", 1.3, linear("analysis")),
    Goal("nearest point, one", "at any n", 150e-6, taking("nearest-one", names="nurbs"), "s"),
    Goal("nearest point, one", "t(largest n) : t(10³)", 1.3, growth("nearest-one", 1000)),
    Goal("nearest point, 10³", "ours : splinepy", 1, beside("nearest-1000", "splinepy")),
    Goal("nearest point", "beyond the true distance", 1e-9, taking("nearest-error")),
    Goal(
        "memory",
        "all views : flat arrays",
        6,
        beside("memory", "flat arrays", 100_000, 1_000_000, names="all views"),
    ),
    Goal(
        "memory",
        "1 000 undo steps : all views",
        0.1,
        beside("history", "all views"),
    ),
    Goal("start", "import, --help", 0.25, taking("start"), "s"),
)
