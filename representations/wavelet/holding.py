"""Prepare a stretch to stay as it is, bit by bit, whatever splices end beside it."""

from __future__ import annotations

from multirep.interval import Interval
from multirep.representations.wavelet.graded import Graded
from multirep.splices import SpliceList

__all__ = ["held"]


def held(curve: Graded, interval: Interval, keep: SpliceList) -> tuple[Graded, Interval]:
    return curve, interval
