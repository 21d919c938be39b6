"""What an application of a tool or a constraint did, and what it cost."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import attrs

from multirep.events import Event, Fitted, Sampled
from multirep.multirepresentation import MultiRepresentation
from multirep.settling import Settled
from multirep.splices import SpliceList


@attrs.frozen
class Work:
    """What an application cost: samplings, samples taken, fits, seconds."""

    sampled: int
    samples: int
    fitted: int
    seconds: float


@attrs.frozen
class Outcome:
    """What an application of a tool did.

    Parameters
    ----------
    changed : SpliceList
        Where the curve changed, by the tool and by the constraints that answered.
    work : Work
    constraints : tuple of Settled
        The touched constraints with their residuals, in the units of the points.
    rounds : int
        Rounds of re-establishing.
    faded : SpliceList
        Frozen stretches before which the edit was faded out; see :mod:`multirep.blending`.
    """

    changed: SpliceList
    work: Work
    constraints: tuple[Settled, ...] = ()
    rounds: int = 0
    faded: SpliceList = SpliceList.EMPTY


class Measured:
    """What :func:`measured_work` fills in when its block ends."""

    work: Work


@contextmanager
def measured_work(curve: MultiRepresentation) -> Iterator[Measured]:
    """Count what the block makes a curve do."""
    measured = Measured()
    begin = perf_counter()
    with curve.listening() as events:
        yield measured
    measured.work = work_of(events, perf_counter() - begin)


def work_of(events: list[Event], seconds: float) -> Work:
    """Sum up events."""
    sampled = [event for event in events if isinstance(event, Sampled)]
    fitted = [event for event in events if isinstance(event, Fitted)]
    return Work(len(sampled), sum(event.samples for event in sampled), len(fitted), seconds)
