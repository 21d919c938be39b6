"""A tree of capsules around the pieces of a curve, to find nearest places with proof.

A capsule holds a stretch of the curve: every point of the stretch is within ``radius`` of the chord
between its ends. As the stretch is connected, every point of the chord is also within the radius of
the stretch (look at the plane through it across the chord). So for a point at distance D from the
chord, the nearest place of the stretch is between ``D - radius`` and ``D + radius`` away. The
radius shrinks with the *square* of the length of a smooth stretch, as that of a box does not: few
capsules remain after each level, however many pieces there are.

The tree is levels of arrays; the lowest two are cut into leaves of about `FAN`**2 pieces. An edited
curve takes over all leaves but those that it changed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from operator import is_
from typing import TYPE_CHECKING

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.blocks import BlockArray
from multirep.splines import compiled

if TYPE_CHECKING:
    from multirep.splines._core import Leaf as CoreLeaf

__all__ = ["ACCURACY", "FAN", "Known", "Leaf", "Pieces", "Tree", "capsule_around", "capsules"]

#: The nearest place that is found is within this part of the curve's size of the true distance (or
#: as near as rounding lets it).
ACCURACY = 1e-10
#: An answer may also be farther than the true one by this part of the coordinates: rounding.
UNIT = 64 * float(np.finfo(np.float64).eps)
#: How many capsules one of the next level holds.
FAN = 16
#: Rounding of coordinates, chords and radii, in units in the last place of the coordinates.
_ULPS = 16
_EPS = float(np.finfo(np.float64).eps)


def capsules(starts: Array, stops: Array, radius: Array | float) -> Array:
    """Lay out capsules as columns: start (d), chord (d), 1 / length**2, radius.

    Parameters
    ----------
    starts, stops : (d, m) arrays
    radius : (m,) array or float

    Returns
    -------
    (2 d + 2, m) array
    """
    dimension, count = starts.shape
    nodes = np.empty((2 * dimension + 2, count))
    nodes[:dimension] = starts
    chords = nodes[dimension : 2 * dimension]
    np.subtract(stops, starts, out=chords)
    squares = np.einsum("ij,ij->j", chords, chords)
    with np.errstate(divide="ignore", over="ignore"):
        inverse = 1.0 / squares
    # a chord so short that its square vanishes is the point where it starts
    short = ~np.isfinite(inverse)
    if short.any():
        inverse[short] = 0.0
        radius = radius + np.where(short, np.abs(chords).sum(axis=0), 0.0)
    nodes[-2] = inverse
    nodes[-1] = radius
    return nodes


def distances(nodes: Array, points: Array) -> tuple[Array, Array]:
    """Nearest places of chords, as (u, distance): ``points`` (d, m), or (d, m, 1) for all pairs."""
    dimension = len(points)
    offsets = points - nodes[:dimension]
    chords = nodes[dimension:-2]
    u = np.einsum("i...,i...->...", offsets, chords)
    u *= nodes[-2]
    np.maximum(u, 0.0, out=u)
    np.minimum(u, 1.0, out=u)
    offsets -= u * chords
    return u, np.sqrt(np.einsum("i...,i...->...", offsets, offsets))


def merged_capsules(nodes: Array) -> Array:
    """Return the capsules around `FAN` neighbouring ones each."""
    dimension, firsts = len(nodes) // 2 - 1, np.arange(0, nodes.shape[1], FAN)
    if compiled.active:
        around = np.empty((len(nodes), len(firsts)))
        compiled.core.merged_capsules(nodes, FAN, _ULPS * _EPS, around)
        return around
    starts = nodes[:dimension]
    stops = starts + nodes[dimension:-2]
    counts = np.append(firsts[1:], nodes.shape[1]) - firsts
    around = capsules(starts[:, firsts], stops[:, firsts + counts - 1], 0.0)
    spread = around.repeat(counts, axis=1)
    far = np.maximum(distances(spread, starts)[1], distances(spread, stops)[1]) + nodes[-1]
    # The distance to a chord is convex: within a capsule it is largest at an end.
    around[-1] += np.maximum.reduceat(far, firsts)
    around[-1] += _ULPS * _EPS * np.abs(around[: 2 * dimension]).max(axis=0)
    return around


def capsule_around(points: Array, start: Array, stop: Array) -> Array:
    """Return the capsule of a stretch, (2 d + 2, 1), that lies in the convex hull of ``points``.

    Parameters
    ----------
    points : (d, k) array
    start, stop : (d,) arrays
        The ends of the stretch.
    """
    if compiled.active:
        around = np.empty((2 * len(start) + 2, 1))
        compiled.core.capsule(points.T, np.array((start, stop)), _ULPS * _EPS, around)
        return around
    around = capsules(start[:, None], stop[:, None], 0.0)
    # The distance to a chord is convex: in the hull of points it is largest at one of them.
    around[-1] += distances(around, points)[1].max()
    around[-1] += _ULPS * _EPS * np.abs(points).max()
    return around


@attrs.frozen(eq=False)
class Pieces:
    """Some neighbouring pieces of a curve.

    Parameters
    ----------
    starts, stops : (k,) arrays
        The parameters of each.
    nodes : (2 d + 2, k) array
        Their capsules.
    hulls : (p + 1, D, k) array, optional
        Their Bernstein coefficients, homogeneous ones (D = d + 1) for rational pieces; None where
        the pieces are their chords.
    """

    starts: Array
    stops: Array
    nodes: Array
    hulls: Array | None = None


@attrs.frozen(eq=False, slots=False)
class Leaf:
    """A few hundred neighbouring spans of a curve; their pieces are made when first looked at.

    Parameters
    ----------
    spans : int
        How many.
    whole : (2 d + 2, 1) array, or None
        The capsule around all of them; None if all are empty.
    make : callable
        Makes the pieces.
    """

    spans: int
    whole: Array | None
    make: Callable[[], Pieces]

    @cached_property
    def pieces(self) -> Pieces:
        """The pieces."""
        return self.make()

    @cached_property
    def groups(self) -> Array:
        """The capsules around `FAN` pieces each."""
        return merged_capsules(self.pieces.nodes)

    @cached_property
    def read(self) -> CoreLeaf:
        """All of it, as the core reads it."""
        some = self.pieces
        return compiled.core.leaf(some.starts, some.stops, some.nodes, self.groups, some.hulls, FAN)


@attrs.frozen(eq=False, slots=False)
class Tree:
    """The leaves of a curve, in order.

    Make one with :meth:`of` and that of the next version with :meth:`renewed`.

    Examples
    --------
    >>> vertices = np.array([[0.0, 1.0, 2.0], [0.0, 1.0, 0.0]])
    >>> def build(first, stop):
    ...     low, high = vertices[:, first:stop], vertices[:, first + 1 : stop + 1]
    ...     t = np.arange(first, stop + 1.0)
    ...     whole = capsule_around(vertices[:, first : stop + 1], low[:, 0], high[:, -1])
    ...     make = lambda: Pieces(t[:-1], t[1:], capsules(low, high, 0.0))
    ...     return Leaf(stop - first, whole, make)
    >>> Tree.of(build, 2).tops.shape
    (6, 1)
    """

    leaves: tuple[Leaf, ...]

    @classmethod
    def of(cls, build: Callable[[int, int], Leaf], count: int) -> Tree:
        """Build all leaves of a curve of ``count`` spans; ``build(first, stop)`` makes one."""
        return cls(tuple(_built(build, 0, count)))

    def renewed(self, build: Callable[[int, int], Leaf], first: int, stop: int, shift: int) -> Tree:
        """Return the tree of another version of the curve.

        Parameters
        ----------
        build : callable
            Makes a leaf of the other version.
        first, stop : int
            Spans of this version before ``first`` and from ``stop`` on are spans of the other too.
        shift : int
            How many spans the other has more.

        Notes
        -----
        O(spans that changed), and a copy of the capsules around the leaves.
        """
        if first >= stop and not shift:
            return self
        stop = max(stop, first, first - shift)  # the two ranges may overlap: what is kept must not
        ends = self._ends
        head = int(ends.searchsorted(first, "right"))
        begins = np.append(0, ends[:-1])
        tail = max(int(begins.searchsorted(stop)), head)
        low = int(ends[head - 1]) if head else 0
        high = (int(begins[tail]) if tail < len(ends) else int(ends[-1])) + shift
        fresh = _built(build, low, high)
        new = Tree((*self.leaves[:head], *fresh, *self.leaves[tail:]))
        wholes = [leaf.whole for leaf in fresh if leaf.whole is not None]
        if len(wholes) == len(fresh) and len(self.filled) == len(self.leaves):
            # all are filled, as nearly always: what is known of those that stay is taken over
            made = low + np.cumsum([leaf.spans for leaf in fresh], dtype=np.intp)
            vars(new).update(
                filled=new.leaves,
                tops=np.concatenate((self.tops[:, :head], *wholes, self.tops[:, tail:]), axis=1),
                _ends=np.concatenate((ends[:head], made, ends[tail:] + shift)),
            )
        return new

    @cached_property
    def _ends(self) -> Indices:
        """The span after the last of each leaf."""
        ends: Indices = np.cumsum([leaf.spans for leaf in self.leaves])
        return ends

    @cached_property
    def filled(self) -> tuple[Leaf, ...]:
        """The leaves that have pieces."""
        return tuple(leaf for leaf in self.leaves if leaf.whole is not None)

    @cached_property
    def tops(self) -> Array:
        """The capsules around the filled leaves, (2 d + 2, leaves)."""
        wholes = [leaf.whole for leaf in self.leaves if leaf.whole is not None]
        return np.concatenate(wholes, axis=1)

    @cached_property
    def levels(self) -> tuple[Array, ...]:
        """The capsules from above: each around `FAN` of the next level, the last around leaves."""
        levels = [self.tops]
        while levels[0].shape[1] > FAN * FAN // 4:  # fewer are looked at as soon
            levels.insert(0, merged_capsules(levels[0]))
        return tuple(levels)

    @cached_property
    def read(self) -> list[CoreLeaf | None]:
        """The filled leaves as the core reads them; None for those that it has not asked for."""
        return [None] * len(self.filled)

    @cached_property
    def slack(self) -> float:
        """How much nearer than the answer a place may be to a point at the origin."""
        return ACCURACY * self.extent + UNIT * self.magnitude

    @cached_property
    def extent(self) -> float:
        """About the size of the curve: what an accuracy is relative to."""
        dimension = len(self.tops) // 2 - 1
        starts, radius = self.tops[:dimension], self.tops[-1]
        stops = starts + self.tops[dimension:-2]
        low, high = np.minimum(starts, stops) - radius, np.maximum(starts, stops) + radius
        return float((high.max(axis=1) - low.min(axis=1)).max())

    @cached_property
    def magnitude(self) -> float:
        """An upper bound of the largest |coordinate|."""
        dimension = len(self.tops) // 2 - 1
        starts = np.abs(self.tops[:dimension]) + np.abs(self.tops[dimension:-2]) + self.tops[-1]
        return float(starts.max())


class Known:
    """What the versions of a curve share: the tree of the one that was asked last.

    A cache. It belongs to no value: each version that needs a tree makes it of the one that is
    here, by what differs, and leaves its own.
    """

    def __init__(self) -> None:
        #: The arrays that the tree is of, none in the beginning.
        self.arrays: tuple[BlockArray, ...] = ()
        self.tree: Tree = Tree(())
        self.degree = 1
        #: The size of the curve when it was first asked.
        self.size = 0.0

    def __reduce__(self) -> tuple[object, ...]:
        return Known, ()  # whoever gets a copy of a curve can make a tree of it

    def is_of(self, arrays: tuple[BlockArray, ...]) -> bool:
        """Whether the tree is that of exactly these arrays."""
        return len(arrays) == len(self.arrays) and all(map(is_, arrays, self.arrays))

    def learn(self, arrays: tuple[BlockArray, ...], tree: Tree, degree: int = 1) -> None:
        """Keep another tree."""
        self.arrays, self.tree, self.degree = arrays, tree, degree


def _built(build: Callable[[int, int], Leaf], low: int, high: int) -> list[Leaf]:
    """Build leaves of at most `FAN`**2 spans, about equally many each."""
    count = -(-(high - low) // FAN**2)
    marks = [low + (high - low) * k // count for k in range(count)] + [high] if count else []
    return [build(i, j) for i, j in pairwise(marks)]
