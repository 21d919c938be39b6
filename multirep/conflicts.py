"""What to say when constraints cannot all hold: who, where, how far off, and the way out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from multirep.aim import TURNED, Aim
from multirep.errors import ConflictError, MultirepError
from multirep.splices import SpliceList

if TYPE_CHECKING:
    import networkx

#: The way out is sought among sets of up to so many constraints, ...
LARGEST_RELEASE = 3
#: ... and in at most so many trials, each of which costs what the edit itself costs.
MOST_TRIALS = 64


def conflict(
    how: str,
    where: Mapping[str, SpliceList],
    residuals: Mapping[str, float],
    cycle: Iterable[str] = (),
) -> ConflictError:
    """Return the error that names the constraints of ``where`` and what each is off by."""
    listed = ", ".join(
        f"{name!r} on {claim} (off by {residuals[name]:.3g})" for name, claim in where.items()
    )
    noun = "constraint" if len(where) == 1 else "constraints"
    return ConflictError(
        f"{noun} {listed} {how}",
        constraints=where,
        residuals=residuals,
        cycle=cycle,
        where=where,
    )


def details(error: ConflictError) -> list[str]:
    """Return a line for each constraint of a conflict: its name, where it is, what it is off by.

    Examples
    --------
    >>> claims = {"ear": SpliceList([(0.25, 0.5)])}
    >>> details(conflict("does not hold", claims, {"ear": 0.125}))
    ["'ear' on [1/4,1/2], off by 0.125"]
    """
    return [
        f"{name!r} on {error.where.get(name, 'the curve')}"
        + (f", off by {error.residuals[name]:.3g}" if error.residuals.get(name) else "")
        for name in error.constraints
    ]


def opposed(
    by: str,
    aim: Aim,
    missed: float,
    turned: float,
    where: Mapping[str, SpliceList],
    residuals: Mapping[str, float],
) -> ConflictError:
    """Return the error that says that constraints undid what a tool asked for."""
    listed = " and ".join(map(repr, where))
    asked = [
        f"{what} {wanted}"
        for what, wanted in (("", aim.point), ("left", aim.left), ("right", aim.right))
        if wanted is not None
    ] + ["smoothness"] * aim.smooth
    off = f"it passes at a distance of {missed:.3g}" if missed else ""
    if turned > TURNED:
        off = f"its derivatives differ by {100 * turned:.2g} %"
    return ConflictError(
        f"{by} asks for {', '.join(asked).strip()} at t = {aim.t:g}, but with {listed} "
        f"re-established the curve is not so: {off}",
        constraints=where,
        residuals=residuals,
        where=where,
    )


def shortest_cycle(broke: networkx.DiGraph[str], name: str) -> list[str]:
    """Return the shortest cycle through ``name``, beginning there; empty when there is none."""
    import networkx

    if name not in broke:
        return []
    if broke.has_edge(name, name):
        return [name]
    paths = [
        networkx.shortest_path(broke, follower, name)
        for follower in broke.successors(name)
        if networkx.has_path(broke, follower, name)
    ]
    if not paths:
        return []
    return [name, *min(paths, key=lambda path: (len(path), path))[:-1]]


def smallest_release(
    suspects: Sequence[str], others: Sequence[str], goes_through: Callable[[frozenset[str]], bool]
) -> tuple[str, ...]:
    """Return the smallest set of constraints without which an edit goes through.

    Parameters
    ----------
    suspects : sequence of str
        The names that the conflict gives; sets of these are tried first within each size.
    others : sequence of str
        The rest.
    goes_through : callable
        Tries the edit without a set of constraints, and takes it back.

    Returns
    -------
    tuple of str
        Empty when no set of up to three, within 64 trials, does.
    """
    names = [*suspects, *(name for name in others if name not in suspects)]
    trials = 0
    for size in range(1, min(LARGEST_RELEASE, len(names)) + 1):
        for chosen in combinations(names, size):
            if trials == MOST_TRIALS:
                return ()
            trials += 1
            try:
                if goes_through(frozenset(chosen)):
                    return chosen
            except MultirepError:
                continue
    return ()
