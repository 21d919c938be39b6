"""What was measured, as values and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import attrs
import numpy as np
from attrs import frozen

from benchmarks.workload import Case

PATH = Path(__file__).parent / "results.json"
#: Significant digits that are kept: more are noise.
DIGITS = 4


@frozen
class Entry:
    """One contestant's number in one case: a median with quartiles, or why there is none."""

    name: str
    ours: bool = False
    unit: str = "s"
    median: float | None = None
    low: float | None = None
    high: float | None = None
    samples: int = 1
    why: str = ""
    #: The median at n = 10^3 in the same turns, where this is a large case.
    small: float | None = None

    @classmethod
    def of(
        cls,
        name: str,
        samples: list[float],
        *,
        ours: bool,
        unit: str = "s",
        small: list[float] | None = None,
    ) -> Entry:
        """Summarise samples."""
        low, median, high = (_rounded(x) for x in np.quantile(samples, [0.25, 0.5, 0.75]))
        reference = None if small is None else _rounded(float(np.median(small)))
        return cls(name, ours, unit, median, low, high, len(samples), small=reference)

    @property
    def growth(self) -> float | None:
        """t(this size) : t(10^3)."""
        return self.median / self.small if self.median and self.small else None


@frozen
class Cell:
    """All contestants of one case of a workload."""

    workload: str
    curve: str
    size: int
    tolerance: float
    entries: tuple[Entry, ...]

    @property
    def case(self) -> Case:
        """The case."""
        return Case(self.size, self.curve, self.tolerance)

    @property
    def ours(self) -> tuple[Entry, ...]:
        """Our entries that have a number."""
        return tuple(e for e in self.entries if e.ours and e.median is not None)

    @property
    def peers(self) -> tuple[Entry, ...]:
        """The peers' entries that have a number."""
        return tuple(e for e in self.entries if not e.ours and e.median is not None)

    def ratio(self, ours: Entry, peer: Entry) -> float | None:
        """Peer : ours, larger is better; None where they cannot be compared."""
        if ours.unit != peer.unit or not ours.median or peer.median is None:
            return None
        return peer.median / ours.median


@frozen
class Results:
    """A run."""

    machine: dict[str, str | float]
    cells: tuple[Cell, ...]

    def of(self, workload: str) -> Iterator[Cell]:
        """Cells of one workload."""
        return (cell for cell in self.cells if cell.workload == workload)

    def find(self, workload: str, case: Case) -> Cell | None:
        """Return the cell of a case, if it was measured."""
        for cell in self.of(workload):
            if (cell.size, cell.curve, cell.tolerance) == (case.size, case.curve, case.tolerance):
                return cell
        return None

    def to_json(self) -> str:
        """One line an entry, so that changes can be read."""
        cells = []
        for cell in self.cells:
            head = {k: v for k, v in attrs.asdict(cell).items() if k != "entries"}
            rows = ",\n   ".join(json.dumps(_brief(e), ensure_ascii=False) for e in cell.entries)
            cells.append(f'{json.dumps(head)[:-1]}, "entries": [\n   {rows}]}}')
        machine = json.dumps(self.machine, ensure_ascii=False, indent=1)
        listed = ",\n  ".join(cells)
        return f'{{"machine": {machine},\n "cells": [\n  {listed}]}}\n'

    @classmethod
    def from_json(cls, text: str) -> Results:
        """Read what `to_json` wrote."""
        data = json.loads(text)
        cells = (
            Cell(**{**cell, "entries": tuple(Entry(**entry) for entry in cell["entries"])})
            for cell in data["cells"]
        )
        return cls(data["machine"], tuple(cells))


def _brief(entry: Entry) -> dict[str, object]:
    plain = attrs.fields_dict(Entry)
    return {
        key: value
        for key, value in attrs.asdict(entry).items()
        if key == "name" or value != plain[key].default
    }


def _rounded(number: float) -> float:
    return float(f"{number:.{DIGITS - 1}e}")
