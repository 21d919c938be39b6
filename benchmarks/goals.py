"""The goals, each a number that results give and a limit: what is reached and what is not.

Where a goal speaks of several tools, curves or sizes the worst one counts.
"""

from __future__ import annotations

from typing import Literal

from attrs import frozen

from benchmarks.readings import (
    COPY,
    Found,
    Reading,
    beside,
    bounds,
    compared,
    growth,
    linear,
    optimum,
    scaled,
    taking,
    times_faster,
)
from benchmarks.results import Results
from benchmarks.tables import NOTHING, in_unit, markdown, number


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


ARCS = "spaced by arc length"
SCALED = f"scaled to a machine that copies 16 MB in {COPY} ms"
GOALS: tuple[Goal, ...] = (
    Goal("drag step", f"n = 10³, {SCALED}", 1e-3, scaled("yardstick", "copy", 1000), "s"),
    *(
        Goal("drag step", f"t({text}) : t(10³)", 2, growth(workload, n))
        for workload, n, text in (("drag", 100_000, "10⁵"), ("yardstick", 1_000_000, "10⁶"))
    ),
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
    Goal(
        "drag step, nobody looks",
        "synchronisation",
        20e-6,
        taking("unseen", names=": synchronisation"),
        "s",
    ),
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
            f"control points of a {what} : splprep, searched{text}",
            1.1,
            beside("control-points", peer, names=f"nurbs {what}", exactly=True),
        )
        for what, peer, text in (
            ("fit", "splprep", ""),
            ("view", "splprep, half the tolerance", " within ε/2, as a view is"),
            ("view", "splprep", ""),
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
    Goal("evaluation of one point", "t(largest n) : t(10³)", 1.3, growth("evaluate-one")),
    *(
        Goal(
            "insertion of a knot",
            f"{name} : {peer}, {text}",
            limit,
            beside("insert-one", peer, n, names=name, exactly=True),
        )
        for name, peer in (("polynomial", "scipy"), ("rational", "scipy, rational"))
        for n, text, limit in ((1000, "10³", 0.5), (100_000, "10⁵", 0.05))
    ),
    Goal("insertion of a knot", "t(largest n) : t(10³)", 1.5, growth("insert-one")),
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
    Goal("nearest point, one", "t(largest n) : t(10³)", 1.3, growth("nearest-one")),
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
        "1 000 undo steps : all views, n = 10⁶",
        0.1,
        beside("history", "all views"),
    ),
    Goal("start", "import, --help", 0.25, taking("start"), "s"),
)
