"""The nearest places of a NURBS: in the tree of capsules around its pieces."""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.capsules import Tree
from multirep.spline_tree import spline_tree

if TYPE_CHECKING:
    from multirep.representations.nurbs.value import NurbsValue


def tree(curve: NurbsValue) -> Tree:
    """Return the tree of ``curve``; O(n) for the first version that is asked, then O(changes)."""
    arrays = curve._knots, curve._points, curve._weights
    return spline_tree(curve._known, curve.degree, *arrays)
