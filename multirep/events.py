"""What a multi-representation did, as typed events: for logs, tests and the session report."""

from __future__ import annotations

from typing import TypeAlias

import attrs

from multirep.interval import Interval
from multirep.splices import SpliceList


@attrs.frozen
class Sampled:
    """An author was sampled on an interval so that another representation can follow it.

    Or its samples were at hand, because another representation followed the same stretch just now.
    """

    author: str
    interval: Interval
    samples: int
    bound: float
    microseconds: float


@attrs.frozen
class Fitted:
    """A representation took over what the authors say; ``splices`` is all that changed in it."""

    kind: str
    interval: Interval
    splices: SpliceList
    size: int
    bound: float
    microseconds: float


@attrs.frozen
class Fitting:
    """A view of a long stretch goes on: ``done`` of ``total`` steps of about equal length.

    What a listener raises ends the view and leaves the curve as it was.
    """

    kind: str
    done: int
    total: int


@attrs.frozen
class Begun:
    """A representation got its first value, a crude one that is stale everywhere."""

    kind: str
    size: int


@attrs.frozen
class Skipped:
    """A view found nothing to do."""

    kind: str
    reason: str


@attrs.frozen
class Committed:
    """A representation became the author of ``splices``."""

    kind: str
    splices: SpliceList


@attrs.frozen
class Prepared:
    """A representation was prepared for a stretch to be frozen, or took that back.

    The same curve up to rounding; ``splices`` is where it is expressed anew.
    """

    kind: str
    splices: SpliceList


Event: TypeAlias = Sampled | Fitting | Begun | Fitted | Skipped | Committed | Prepared
