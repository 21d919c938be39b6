"""The nearest places of a wavelet B-spline: in the tree of capsules around its pieces."""

from __future__ import annotations

from multirep.capsules import Known, Tree
from multirep.representations.wavelet.dyadic import parameters
from multirep.representations.wavelet.graded import Graded
from multirep.spline_tree import spline_tree

__all__ = ["tree"]


def tree(known: Known, curve: Graded) -> Tree:
    """Return the tree of ``curve``; O(n) for the first version that is asked, then O(changes)."""
    return spline_tree(known, 3, curve.u, curve.points, None, lambda u: parameters(u, curve.domain))
