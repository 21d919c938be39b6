"""The guard: ratios of a quick run beside those that are kept, and what was lost."""

from __future__ import annotations

from collections.abc import Callable

from attrs import frozen

from benchmarks.results import Results
from benchmarks.tables import markdown, number

#: A ratio may become this much smaller: a loss of a third.
KEPT = 2 / 3


@frozen
class Loss:
    """A ratio that has become smaller than allowed."""

    what: str
    before: float
    now: float


def ratios(results: Results) -> dict[tuple[str, ...], float]:
    """Return all ratios, larger is better: peer : ours, and time at 10^3 : time at 10^5.

    The keys begin with the workload.
    """
    found: dict[tuple[str, ...], float] = {}
    for cell in results.cells:
        where = f"{cell.curve}, n = {cell.size}, tolerance {cell.tolerance:g}"
        for ours in cell.ours:
            for peer in cell.peers:
                ratio = cell.ratio(ours, peer)
                if ratio is not None:
                    found[cell.workload, where, f"{peer.name} : {ours.name}"] = ratio
            if ours.growth:
                found[cell.workload, where, f"{ours.name}, 10³ : here"] = 1 / ours.growth
    return found


def losses(before: Results, now: Results) -> list[Loss]:
    """List the ratios of both runs that fell by more than a third, worst first."""
    old, new = ratios(before), ratios(now)
    lost = [
        Loss(": ".join(key), old[key], new[key])
        for key in old.keys() & new.keys()
        if new[key] < KEPT * old[key]
    ]
    return sorted(lost, key=lambda loss: loss.now / loss.before)


def check(
    before: Results,
    measure: Callable[[frozenset[str] | None], Results],
    say: Callable[[str], None] = print,
) -> int:
    """Measure, compare, and what was lost measure once more; return the exit code.

    Parameters
    ----------
    before : Results
        The committed ones.
    measure : callable
        ``measure(names)`` runs the quick part of these workloads; None: of all.
    """
    now = measure(None)
    lost = losses(before, now)
    if lost:
        names = frozenset(loss.what.partition(":")[0] for loss in lost)
        say(f"\nless than before in {', '.join(sorted(names))}; measuring once more\n")
        again = losses(before, measure(names))
        twice = {loss.what for loss in again}
        lost = [loss for loss in lost if loss.what in twice]
    compared = len(ratios(before).keys() & ratios(now).keys())
    if not lost:
        say(f"\n{compared} ratios, none lost more than a third")
        return 0
    rows = [["ratio (larger is better)", "committed", "now", "now : committed"]]
    rows += [
        [loss.what, number(loss.before), number(loss.now), number(loss.now / loss.before)]
        for loss in lost
    ]
    say(f"\n{len(lost)} of {compared} ratios lost more than a third, twice in a row:\n")
    say(markdown(rows))
    return 1
