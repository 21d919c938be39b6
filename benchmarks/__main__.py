"""The command line of the benchmarks: ``python -m benchmarks --help``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks.checking import check
from benchmarks.page import write
from benchmarks.results import PATH, Results
from benchmarks.running import LIMIT, run
from benchmarks.tables import machine_line, table
from benchmarks.workload import Case, Workload
from benchmarks.workloads import WORKLOADS

#: What one step may take in the guard, and what a contestant of a case may take, in seconds.
QUICK_LIMIT, QUICK_BUDGET = 0.6, 0.3


def main(arguments: Sequence[str] | None = None) -> int:
    """Run, show, make the page, or check; return the exit code."""
    options = _parser().parse_args(arguments)
    return int(options.do(options))


def _run(options: argparse.Namespace) -> int:
    plan = [(w, _chosen(w, full=options.full)) for w in WORKLOADS.values()]
    results = run(plan)
    PATH.write_text(results.to_json(), encoding="utf-8")
    return _table(options)


def _show(options: argparse.Namespace) -> int:
    plan = []
    for name in options.workload or WORKLOADS:
        workload = WORKLOADS[name]
        cases = [
            Case(size, curve, tolerance)
            for curve in options.curve or dict.fromkeys(case.curve for case in workload.cases)
            for tolerance in options.tolerance or (workload.cases[0].tolerance,)
            for size in options.size
        ]
        plan.append((workload, cases or _chosen(workload, full=False)))
    results = run(plan, limit=options.limit)
    print(f"\n{machine_line(results)}")
    for workload, _ in plan:
        print(f"\n{workload.title} ({workload.name})\n")
        print(table(list(results.of(workload.name))))
    return 0


def _table(options: argparse.Namespace) -> int:
    for path in write(Results.from_json(PATH.read_text(encoding="utf-8"))):
        print(f"wrote {path}")
    return 0


def _check(options: argparse.Namespace) -> int:
    before = Results.from_json(PATH.read_text(encoding="utf-8"))

    def measure(names: frozenset[str] | None) -> Results:
        chosen = [w for w in WORKLOADS.values() if names is None or w.name in names]
        plan = [(workload, workload.checked) for workload in chosen]
        return run(plan, limit=QUICK_LIMIT, budget=QUICK_BUDGET, known=before)

    return check(before, measure)


def _chosen(workload: Workload, *, full: bool) -> list[Case]:
    return [case for case in workload.cases if full or not case.full]


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("run", help="measure everything, write results, page, picture")
    command.add_argument("--full", action="store_true", help="up to a million vertices")
    command.set_defaults(do=_run)
    command = commands.add_parser("show", help="measure some workloads and print their tables")
    command.add_argument("workload", nargs="*", metavar="WORKLOAD", help=", ".join(WORKLOADS))
    command.add_argument("--curve", action="append", choices=["smooth", "coast"])
    command.add_argument("--size", type=int, nargs="+", default=[])
    command.add_argument("--tolerance", type=float, nargs="+")
    command.add_argument(
        "--limit", type=float, default=LIMIT, help="seconds a peer's step may take"
    )
    command.set_defaults(do=_show)
    command = commands.add_parser("table", help="write the page and the picture from the results")
    command.set_defaults(do=_table)
    command = commands.add_parser("check", help="compare a quick run with the committed results")
    command.set_defaults(do=_check)
    return parser


if __name__ == "__main__":
    sys.exit(main())
