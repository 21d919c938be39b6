"""Hypothesis strategies: intervals, splice lists, samples, curves with a known answer, strokes.

Grids are exactly representable (k/64), so that laws can be asserted with ``==``; near-coincidences
(equal, adjacent, one ulp apart) are generated on purpose, because they do not happen by chance.
"""

from __future__ import annotations

import math

import attrs
import numpy as np
from hypothesis import strategies as st

from multirep.arrays import Array, ArrayLike
from multirep.interval import Interval
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList

#: Cells of the grid on which splice lists are generated: end points are k/64.
CELLS = 64


def dyadic_numbers(
    denominator: int = CELLS, low: float = 0.0, high: float = 1.0
) -> st.SearchStrategy[float]:
    """Generate multiples of 1/``denominator`` (a power of two) in [low, high]; sums are exact."""
    first, last = math.ceil(low * denominator), math.floor(high * denominator)
    return st.integers(first, last).map(lambda k: k / denominator)


def dyadic_intervals(
    denominator: int = CELLS, within: Interval | None = None
) -> st.SearchStrategy[Interval]:
    """Intervals of positive length in ``within`` (default [0, 1]), with ends k/``denominator``."""
    a, b = (0.0, 1.0) if within is None else within
    ends = st.lists(dyadic_numbers(denominator, a, b), min_size=2, max_size=2, unique=True)
    return ends.map(lambda pair: Interval(*sorted(pair)))


def splice_lists(denominator: int = CELLS, max_splices: int = 6) -> st.SearchStrategy[SpliceList]:
    """Splice lists in [0, 1] with ends k/``denominator``, the empty one included."""
    return st.lists(dyadic_intervals(denominator), max_size=max_splices).map(SpliceList)


@st.composite
def touching_intervals(draw: st.DrawFn) -> tuple[Interval, Interval]:
    """Generate two intervals that are equal, share an end, or end one ulp from each other."""
    first = draw(dyadic_intervals())
    other = draw(dyadic_intervals())
    how = draw(
        st.sampled_from(["equal", "adjacent", "ulp gap", "ulp overlap", "same start", "same stop"])
    )
    if how == "equal":
        return first, first
    if how == "same start":
        return first, Interval(first.start, first.start + other.length)
    if how == "same stop":
        return first, Interval(first.stop - other.length, first.stop)
    start = first.stop
    if how == "ulp gap":
        start = math.nextafter(start, math.inf)
    elif how == "ulp overlap":
        start = math.nextafter(start, -math.inf)
    return first, Interval(start, start + other.length)


def coordinates(scale: float = 1.0) -> st.SearchStrategy[float]:
    """Coordinates k/64 in [-4, 4], times ``scale``."""
    return st.integers(-4 * CELLS, 4 * CELLS).map(lambda k: k / CELLS * scale)


@st.composite
def parameters(
    draw: st.DrawFn, *, min_size: int = 2, max_size: int = 12, domain: Interval | None = None
) -> Array:
    """Generate strictly increasing parameters from end to end of ``domain`` (default [0, 1])."""
    a, b = (0.0, 1.0) if domain is None else domain
    count = draw(st.integers(min_size, max_size)) - 2
    inner = draw(
        st.lists(st.integers(1, 4 * CELLS - 1), min_size=count, max_size=count, unique=True)
    )
    t = [a + (b - a) * k / (4 * CELLS) for k in sorted(inner)]
    return np.array([a, *t, b])


@st.composite
def polylines(
    draw: st.DrawFn, *, dimension: int = 2, min_size: int = 2, max_size: int = 12
) -> tuple[Array, Array]:
    """Generate a polyline over [0, 1]: strictly increasing t (n,) and points (n, d) on a grid.

    Neighbouring points may coincide; at least two points are distinct.
    """
    t = draw(parameters(min_size=min_size, max_size=max_size))
    row = st.tuples(*[coordinates()] * dimension)
    points = draw(
        st.lists(row, min_size=len(t), max_size=len(t)).filter(lambda rows: len(set(rows)) > 1)
    )
    return t, np.array(points)


@st.composite
def sampled_splices(
    draw: st.DrawFn, *, dimension: int = 2, interval: Interval | None = None, max_size: int = 12
) -> SampledSplice:
    """Generate sampled splices with a bound, often chord by chord, and some corners."""
    where = draw(dyadic_intervals()) if interval is None else interval
    t = draw(parameters(max_size=max_size, domain=where))
    row = st.tuples(*[coordinates()] * dimension)
    points = draw(st.lists(row, min_size=len(t), max_size=len(t)))
    bound = draw(dyadic_numbers())
    per_chord = draw(st.booleans())
    shares = draw(st.lists(dyadic_numbers(), min_size=len(t) - 1, max_size=len(t) - 1))
    breaks = [s for s in t[1:-1].tolist() if draw(st.booleans())]
    return SampledSplice(
        t, points, bound, tuple(breaks), np.array(shares) * bound if per_chord else None
    )


@attrs.frozen(eq=False)
class PlantedNurbs:
    """A NURBS curve whose data are known: samples derive from it, a fit must find it again.

    Parameters
    ----------
    degree : int
    knots : (n + degree + 1,) array
        Clamped to [0, 1].
    points : (n, d) array
    weights : (n,) array
        All 1 when not rational.
    """

    degree: int
    knots: Array
    points: Array
    weights: Array

    def __call__(self, t: ArrayLike) -> Array:
        """Evaluate with scipy, independently of this library: (m,) -> (m, d)."""
        from scipy.interpolate import BSpline

        at = np.atleast_1d(np.asarray(t, dtype=np.float64))
        stop = self.knots[-1]
        at = np.where(at >= stop, np.nextafter(stop, -np.inf), at)
        homogeneous = np.column_stack([self.points * self.weights[:, None], self.weights])
        values = BSpline(self.knots, homogeneous, self.degree)(at)
        result: Array = values[:, :-1] / values[:, -1:]
        return result

    def sampled(self, count: int = 200) -> SampledSplice:
        """Sample at ``count`` even parameters and all knots, claiming the bound 0."""
        t = np.union1d(np.linspace(0.0, 1.0, count), self.knots)
        inner, times = np.unique(self.knots[self.degree + 1 : -self.degree - 1], return_counts=True)
        return SampledSplice(t, self(t), 0.0, tuple(inner[times >= self.degree].tolist()))


@st.composite
def planted_nurbs(
    draw: st.DrawFn,
    *,
    degrees: tuple[int, ...] = (1, 2, 3, 5),
    dimension: int = 2,
    rational: bool | None = None,
    max_points: int = 12,
) -> PlantedNurbs:
    """Generate NURBS data: random knots (some repeated), points on a grid, weights 1/4 to 4."""
    degree = draw(st.sampled_from(degrees))
    extra = draw(st.integers(0, max_points - degree - 1))
    inner: list[float] = []
    for k in draw(st.lists(st.integers(1, CELLS - 1), min_size=extra, max_size=extra)):
        if inner.count(k / CELLS) < degree:
            inner.append(k / CELLS)
    knots = np.array([*[0.0] * (degree + 1), *sorted(inner), *[1.0] * (degree + 1)])
    n = len(knots) - degree - 1
    row = st.tuples(*[coordinates()] * dimension)
    points = draw(st.lists(row, min_size=n, max_size=n).filter(lambda rows: len(set(rows)) > 1))
    if draw(st.booleans()) if rational is None else rational:
        weights = draw(
            st.lists(st.sampled_from([0.25, 0.5, 1.0, 2.0, 4.0]), min_size=n, max_size=n)
        )
    else:
        weights = [1.0] * n
    return PlantedNurbs(degree, knots, np.array(points), np.array(weights))


@st.composite
def strokes(draw: st.DrawFn, *, max_size: int = 60) -> Array:
    """Strokes as people draw them, (n, 2) on an integer grid.

    They wander with inertia, cross themselves, speed up and slow down by a factor of ten, pause
    (repeated points) and turn back sharply. At least two points are distinct.
    """
    count = draw(st.integers(2, max_size))
    heading, speed = draw(st.integers(0, 15)), draw(st.integers(1, 10))
    x, y = draw(st.integers(-100, 100)), draw(st.integers(-100, 100))
    points = [(x, y)]
    habits = st.sampled_from(["go", "go", "go", "turn", "faster", "slower", "pause", "back"])
    for habit in draw(st.lists(habits, min_size=count - 1, max_size=count - 1)):
        if habit == "pause" and len(points) > 1:
            points.append(points[-1])
            continue
        heading += {"turn": draw(st.integers(-4, 4)), "back": 8}.get(
            habit, draw(st.integers(-1, 1))
        )
        speed = min(max({"faster": 3 * speed, "slower": speed // 3}.get(habit, speed), 1), 30)
        angle = heading * math.pi / 8
        x, y = points[-1]
        points.append(
            (round(x + 2 * speed * math.cos(angle)), round(y + 2 * speed * math.sin(angle)))
        )
    if len(set(points)) == 1:
        points.append((points[0][0] + 1, points[0][1]))
    return np.array(points, dtype=np.float64)
