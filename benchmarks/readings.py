"""What the goals read from results: numbers, each with where it was found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise

from benchmarks.results import Cell, Entry, Results
from benchmarks.tables import number

#: Milliseconds in which the machine of the goals copies 16 MB.
COPY = 1.2

#: What was found, and where.
Found = tuple[float, str]
Reading = Callable[[Results], Iterator[Found]]


def cells(results: Results, workload: str, *sizes: int, curve: str = "") -> Iterator[Cell]:
    """Yield cells of a workload, of some sizes or all, of a curve or all, at tolerance 1e-3."""
    for cell in results.of(workload):
        if cell.tolerance == 1e-3 and cell.curve.startswith(curve):
            if not sizes or cell.size in sizes:
                yield cell


def place(cell: Cell, entry: Entry) -> str:
    """Say where a number was found."""
    return f"{entry.name}, {cell.curve}, n = {number(cell.size)}"


def taking(workload: str, *sizes: int, names: str = "") -> Reading:
    """Read medians of ours whose names contain ``names``."""

    def read(results: Results) -> Iterator[Found]:
        for cell in cells(results, workload, *sizes):
            for entry in cell.ours:
                if names in entry.name and entry.median is not None:
                    yield entry.median, place(cell, entry)

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


def scaled(workload: str, copy: str, *sizes: int) -> Reading:
    """Read seconds of ours on a machine that takes `COPY` for the peer ``copy``."""

    def read(results: Results) -> Iterator[Found]:
        found = beside(workload, copy, *sizes)(results)
        yield from ((1e-3 * COPY * value, where) for value, where in found)

    return read


def times_faster(workload: str, peer: str, *sizes: int) -> Reading:
    """Read peer : ours."""

    def read(results: Results) -> Iterator[Found]:
        yield from ((1 / value, where) for value, where in beside(workload, peer, *sizes)(results))

    return read


def growth(workload: str, size: int | None = None) -> Reading:
    """Read t(n) : t(10^3) of ours at a size, or at the largest that was measured."""

    def read(results: Results) -> Iterator[Found]:
        largest = max((cell.size for cell in cells(results, workload)), default=0)
        for cell in cells(results, workload, size or largest):
            yield from ((e.growth, place(cell, e)) for e in cell.ours if e.growth)

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
