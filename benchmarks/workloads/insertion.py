"""Insertion of one knot and of a hundred."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.curves import spline
from benchmarks.peers import occ_array, occ_curve, optional, splinepy_curve
from benchmarks.workload import Absent, Case, Contestant, Timed, Workload, sweep
from multirep.arrays import Array


def contestants(case: Case, new: Array) -> Iterator[Contestant]:
    """Insert all of ``new``; the curve stays as it was for the next time."""
    curve = spline(case.curve, case.size)
    rational = spline(case.curve, case.size, rational=True)
    scipy, knots, points = curve.to_scipy(), np.asarray(curve.knots), np.asarray(curve.points)
    weights = np.asarray(rational.weights)
    homogeneous = type(scipy)(knots, np.column_stack((points * weights[:, None], weights)), 3)
    yield Timed("polynomial", lambda k: curve.insert_knots(new), ours=True)
    yield Timed("rational", lambda k: rational.insert_knots(new), ours=True)

    def insert_by_scipy(found: Any) -> object:
        for t in new.tolist():
            found = found.insert_knot(t)
        return found

    def insert_by_fitpack(k: int) -> object:
        from scipy.interpolate import insert

        found = (knots, points.T, 3)
        for t in new.tolist():
            found = insert(t, found)
        return found

    yield Timed("scipy", lambda k: insert_by_scipy(scipy))
    yield Timed("scipy, rational", lambda k: insert_by_scipy(homogeneous))
    yield Timed("FITPACK", insert_by_fitpack)
    yield _changed_in_place("splinepy", "splinepy", lambda m: _Splinepy(m, knots, points, new))
    yield _changed_in_place("OCP", "OpenCASCADE", lambda m: _Occ(knots, points, new))


class _Splinepy:
    """A curve that an insertion changes, and its copies."""

    def __init__(self, module: Any, knots: Array, points: Array, new: Array) -> None:
        self.make = lambda: splinepy_curve(module, knots, points)
        self.new = new.tolist()

    def renew(self, k: int) -> None:
        self.curve = self.make()

    def insert(self, k: int) -> None:
        self.curve.insert_knots(0, self.new)


class _Occ:
    """The same for OpenCASCADE."""

    def __init__(self, knots: Array, points: Array, new: Array) -> None:
        self.original = occ_curve(knots, points)
        self.knots = occ_array("double", new)
        self.times = occ_array("int", np.ones(len(new), dtype=int))

    def renew(self, k: int) -> None:
        self.curve = type(self.original)(self.original)

    def insert(self, k: int) -> None:
        self.curve.InsertKnots(self.knots, self.times)


def _changed_in_place(module: str, name: str, make: Callable[[Any], Any]) -> Contestant:
    """Return a peer that inserts into a fresh copy each time; making the copy is not timed."""
    made: list[Any] = []

    def step(found: Any) -> Callable[[int], object]:
        made.append(make(found))
        return made[0].insert  # type: ignore[no-any-return]

    contestant = optional(module, name, step)
    if isinstance(contestant, Absent):
        return contestant
    return Timed(name, contestant.step, before=made[0].renew)  # type: ignore[union-attr]


def spread(count: int) -> Array:
    """Return new knots, in order, beside the old ones."""
    return (np.arange(count) + 0.5123) / count


INSERT_ONE = Workload(
    "insert-one",
    "Insertion of one knot",
    sweep(),
    lambda case: contestants(case, spread(1)),
    checked=sweep(sizes=[1000, 100_000], full=[]),
)
INSERT_MANY = Workload(
    "insert-100",
    "Insertion of 100 knots, all over the curve",
    sweep(),
    lambda case: contestants(case, spread(100)),
    checked=sweep(sizes=[1000], full=[]),
)
