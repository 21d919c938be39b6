"""Measuring: CPU times (other work disturbs them least) of contestants in turns; a yardstick."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import ceil
from time import process_time

import numpy as np
from attrs import define, field

from benchmarks.workload import Timed

#: What a sample lasts at least, in seconds: short steps are repeated.
SAMPLE = 2e-3
#: Samples of a contestant, at most and (unless one takes a second) at least.
MOST, LEAST = 31, 3
#: CPU seconds that one contestant of one case may take, but for its least samples.
BUDGET = 0.5


@define
class Stopwatch:
    """The samples of one contestant, seconds a step."""

    contestant: Timed
    budget: float = BUDGET
    samples: list[float] = field(factory=list)
    #: Why there are no samples: what a peer raised.
    failure: str = ""
    _steps: int = 0
    _repeats: int = 1
    _spent: float = 0.0

    def warm_up(self) -> None:
        """Two steps that do not count; of a slow contestant none, but the first one counts."""
        try:
            first = self._sample(1)
        except Exception as error:
            if self.contestant.ours:
                raise
            self.failure = f"failed: {error}"
            return
        if first > 1.0:
            self.samples.append(first)
        elif self.contestant.before is None:
            again = first if first > 0.1 else self._sample(1)
            self._repeats = max(1, ceil(SAMPLE / max(again, 1e-7)))
        self._spent = sum(self.samples)

    @property
    def done(self) -> bool:
        """Whether there are enough samples, or the budget is used up."""
        if self.failure:
            return True
        count = len(self.samples)
        slow = count > 0 and self.samples[0] > 1.0
        enough = 1 if slow else LEAST
        return count >= MOST or (count >= enough and self._spent >= self.budget)

    def take(self) -> None:
        """Take one sample; of short steps the first one does not count.

        It would pay for the caches that a long step of another contestant has filled.
        """
        if self._repeats > 1:
            self._sample(1)
        seconds = self._sample(self._repeats)
        self.samples.append(seconds)
        self._spent += seconds * self._repeats

    def _sample(self, repeats: int) -> float:
        step, clock, k = self.contestant.step, self.contestant.clock, self._steps
        if self.contestant.before is not None:
            self.contestant.before(k)
        begin = clock()
        for turn in range(k, k + repeats):
            step(turn)
        seconds = clock() - begin
        self._steps += repeats
        return seconds / repeats


def in_turns(contestants: Sequence[Timed], *, budget: float = BUDGET) -> list[Stopwatch]:
    """Return the samples of each, taken in turns: what disturbs one disturbs all."""
    watches = [Stopwatch(contestant, budget) for contestant in contestants]
    with no_garbage_collection():
        for watch in watches:
            watch.warm_up()
        while running := [watch for watch in watches if not watch.done]:
            for watch in running:
                watch.take()
    return watches


@contextmanager
def no_garbage_collection() -> Iterator[None]:
    """Collect before and after, not during."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def copy_of(*, megabytes: int) -> Callable[[int], None]:
    """Return a step that copies an array of this size into another."""
    source = np.ones(megabytes * 2**20 // 8)
    target = np.empty_like(source)
    return lambda k: np.copyto(target, source)


def copying(megabytes: int = 16) -> float:
    """Median CPU seconds that copying an array takes."""
    step = copy_of(megabytes=megabytes)
    samples = []
    for k in range(14):
        begin = process_time()
        step(k)
        samples.append(process_time() - begin)
    return float(np.median(samples[3:]))
