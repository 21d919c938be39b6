"""Results as markdown tables, ratios first; and the page that holds them."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Sequence

from benchmarks.results import Cell, Entry, Results

#: What stands for "was not measured".
NOTHING = "–"


def table(cells: Sequence[Cell]) -> str:
    """Return the tables of one workload, with notes about who is missing."""
    compared = {name for cell in cells for pair in _pairs(cell) for name in pair}
    parts = []
    if compared:
        parts.append(markdown(beside_peers(cells, compared)))
    alone = dict.fromkeys(e.name for cell in cells for e in cell.ours if e.name not in compared)
    if alone:
        parts.append(markdown(by_case(cells, list(alone))))
    return "\n\n".join([*parts, *notes(cells)])


def beside_peers(cells: Sequence[Cell], names: Container[str]) -> list[list[str]]:
    """One row a case and entry of ours: ratios to the peers, ours, the peers."""
    peers = dict.fromkeys(e.name for cell in cells for e in cell.peers if e.name in names)
    heads = headings(cells)
    ratios = [f"{name} : ours" for name in peers]
    grown = ["t : t(10³)"] if any(e.growth for cell in cells for e in cell.ours) else []
    rows = [[*heads, "what", *ratios, *grown, "ours", *peers]]
    for cell in cells:
        found = {entry.name: entry for entry in cell.peers}
        for ours in cell.ours:
            if ours.name not in names:
                continue
            pairs = _pairs(cell)
            here = [found[name] if (ours.name, name) in pairs else None for name in peers]
            rows.append(
                [
                    *(read(cell) for read in heads.values()),
                    ours.name,
                    *(NOTHING if e is None else number(pairs[ours.name, e.name]) for e in here),
                    *((number(ours.growth) if ours.growth else NOTHING) for _ in grown),
                    with_spread(ours),
                    *(NOTHING if e is None else quantity(e) for e in here),
                ]
            )
    return rows


def _pairs(cell: Cell) -> dict[tuple[str, str], float]:
    """Return the ratios of a cell by the names of ours and the peer."""
    found = {(a.name, b.name): cell.ratio(a, b) for a in cell.ours for b in cell.peers}
    return {names: ratio for names, ratio in found.items() if ratio is not None}


def by_case(cells: Sequence[Cell], names: Sequence[str]) -> list[list[str]]:
    """One row an entry and one column a case; the other way round where cases are more."""
    heads = headings(cells)
    rows = [["", *(", ".join(f"{h} {heads[h](cell)}" for h in heads) for cell in cells)]]
    for name in names:
        found = [next((e for e in cell.ours if e.name == name), None) for cell in cells]
        rows.append([name, *(NOTHING if e is None else with_growth(e) for e in found)])
    return [list(row) for row in zip(*rows, strict=True)] if len(cells) > len(names) else rows


def headings(cells: Sequence[Cell]) -> dict[str, Callable[[Cell], str]]:
    """Return what the cases of a workload differ in, and how to read it off a cell."""
    readers: dict[str, Callable[[Cell], str]] = {
        "curve": lambda cell: cell.curve,
        "n": lambda cell: number(cell.size),
        "tolerance": lambda cell: f"{cell.tolerance:g}",
    }
    return {head: read for head, read in readers.items() if len({read(cell) for cell in cells}) > 1}


def notes(cells: Sequence[Cell]) -> Iterable[str]:
    """Say who did not take part, and why."""
    missing: dict[str, list[str]] = {}
    for cell in cells:
        for entry in cell.entries:
            if entry.median is None:
                missing.setdefault(f"{entry.name}: {entry.why}", []).append(f"{cell.size}")
    for what, sizes in missing.items():
        yield f"Left out: {what} (n = {', '.join(dict.fromkeys(sizes))})."


def quantity(entry: Entry) -> str:
    """Return a number with its unit."""
    assert entry.median is not None
    return in_unit(entry.median, entry.unit)


def with_spread(entry: Entry) -> str:
    """Return a number, and its quartiles where there are several samples."""
    if entry.samples < 2 or entry.low is None or entry.high is None:
        return quantity(entry)
    return (
        f"{quantity(entry)} ({in_unit(entry.low, entry.unit)} – {in_unit(entry.high, entry.unit)})"
    )


def with_growth(entry: Entry) -> str:
    """Return a number with its spread, and how it grew from n = 10³ on, where that is known."""
    grown = f"; {number(entry.growth)} × t(10³)" if entry.growth else ""
    return with_spread(entry) + grown


def in_unit(value: float, unit: str) -> str:
    """Return seconds and bytes in units that suit them, anything else as it is.

    >>> in_unit(0.00234, "s"), in_unit(5e7, "bytes"), in_unit(211, "vertices")
    ('2.34 ms', '50 MB', '211')
    """
    if unit == "bytes":
        return f"{number(value / 1e6)} MB"
    if unit != "s":
        return number(value)
    for scale, name in ((1, "s"), (1e3, "ms"), (1e6, "µs")):
        if value * scale >= 1 or name == "µs":
            break
    return f"{number(value * scale)} {name}"


def number(value: float) -> str:
    """Return three digits, and all digits before the point.

    >>> number(12345.6), number(12.345), number(0.01234)
    ('12 346', '12.3', '0.0123')
    """
    return f"{value:,.0f}".replace(",", " ") if abs(value) >= 1000 else f"{value:.3g}"


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """Return a markdown table; the first row is its head, the columns are padded for reading."""
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    lines = [
        "| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) + " |"
        for row in rows
    ]
    rule = "|" + "|".join("-" * (width + 2) for width in widths) + "|"
    return "\n".join([lines[0], rule, *lines[1:]])


def machine_line(results: Results) -> str:
    """Say on what the numbers were measured."""
    facts = dict(results.machine)
    copy = facts.pop("copy_16_MB_ms")
    processor = facts.pop("processor")
    versions = ", ".join(f"{name} {version}" for name, version in facts.items())
    return f"Copying 16 MB takes {copy} ms here ({processor}); {versions}."


def filled(page: str, parts: dict[str, str]) -> str:
    """Put text between the marks ``<!-- name -->`` and ``<!-- /name -->`` of a page.

    Raises
    ------
    KeyError
        When the page has marks for a part that there is not.
    """

    def replaced(match: re.Match[str]) -> str:
        name = match["name"]
        return f"<!-- {name} -->\n{parts[name]}\n<!-- /{name} -->"

    return re.sub(r"<!-- (?P<name>[\w-]+) -->\n.*?<!-- /(?P=name) -->", replaced, page, flags=re.S)
