"""Nearest places in a tree of capsules: never farther than the true one, and local to renew."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import multirep.capsules
import multirep.nearest_tree
import multirep.spline_tree
from multirep.arrays import Array
from multirep.capsules import FAN, Leaf, Tree, capsule_around, capsules, distances
from multirep.errors import InvalidCurveError
from multirep.interval import Interval
from multirep.nearest import nearest_by_sampling
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.splines.closest import least_on_piece, squared

RATIONAL = pytest.mark.parametrize("rational", [False, True])


@pytest.fixture
def tiny_leaves() -> Iterator[None]:
    """Leaves of four spans and groups of two, so that small curves have every level."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(multirep.capsules, "FAN", 2)
        patch.setattr(multirep.nearest_tree, "FAN", 2)
        patch.setattr(multirep.nearest_tree, "_CHILDREN", np.arange(2))
        yield


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many spans each leaf has that is made anew."""
    counts: list[int] = []
    leaf = multirep.spline_tree.spline_leaf

    def counted(knots: Array, coefficients: Array, degree: int, *rest: object, **more: object):  # type: ignore[no-untyped-def]
        counts.append(len(coefficients) - degree)
        return leaf(knots, coefficients, degree, *rest, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(multirep.spline_tree, "spline_leaf", counted)
    return counts


def wild_curve(seed: int, *, degree: int, rational: bool, count: int = 40) -> Nurbs:
    """Clustered and multiple knots, weights from 1e-3 to 1e3."""
    rng = np.random.default_rng(seed)
    inner = np.sort(rng.random(count) ** rng.choice([1.0, 4.0]))
    for k in rng.permutation(np.arange(0, count - degree, degree))[:3]:
        inner[k : k + degree] = inner[k]
    knots = np.concatenate([[0.0] * (degree + 1), np.sort(inner), [1.0] * (degree + 1)])
    n = len(knots) - degree - 1
    points = rng.normal(size=(n, 2)).cumsum(axis=0)
    points /= np.ptp(points, axis=0).max()
    weights = 10.0 ** rng.uniform(-3, 3, n) if rational else None
    return Nurbs(degree=degree, knots=knots, points=points, weights=weights)


def queries(curve: Representation, rng: np.random.Generator, count: int) -> Array:
    """Points on the curve, beside it, at its ends, and far away."""
    on = curve(rng.uniform(*curve.domain, count))
    ends = curve(np.array([*curve.domain]))
    beside = on + rng.normal(size=on.shape) * 10.0 ** rng.uniform(-8, 0, (count, 1))
    far = rng.normal(size=(4, curve.dimension)) * np.array([[1e1], [1e3], [1e5], [1e6]])
    return np.concatenate([on, ends, ends + 1e-3, beside, far])


def least_seen(curve: Representation, points: Array, *, looks: int = 40) -> Array:
    """Distances to the nearest of many points of the curve, looked for again around the best."""
    arrays = getattr(curve, "knots", None)
    breaks = np.unique(np.asarray(curve.t if arrays is None else arrays))  # type: ignore[attr-defined]
    breaks = breaks[(breaks >= curve.domain.start) & (breaks <= curve.domain.stop)]
    share = np.linspace(0, 1, looks)
    t = np.unique((breaks[:-1, None] * (1 - share) + breaks[1:, None] * share).ravel())
    found = np.empty(len(points))
    rows = curve(t)
    for i, point in enumerate(points):
        away = np.linalg.norm(rows - point, axis=1)
        found[i] = away.min()
        for k in np.argsort(away)[:3]:
            low, high = t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)]
            for _ in range(6):
                finer = np.linspace(low, high, 41)
                there = np.linalg.norm(curve(finer) - point, axis=1)
                found[i] = min(found[i], there.min())
                j = int(there.argmin())
                low, high = finer[max(j - 1, 0)], finer[min(j + 1, 40)]
    return found


def check_never_farther(curve: Representation, points: Array) -> None:
    """One by one and all at once, no place that brute force sees is nearer."""
    seen = least_seen(curve, points)
    rounding = 1e-9 + 1e-13 * np.abs(points).max(axis=1)
    together = curve.nearest(points)
    assert (together.distance <= seen + rounding).all()
    assert (together.point == curve(together.t)).all()
    for point, least, slack in zip(points, seen, rounding, strict=True):
        found = curve.nearest(point)
        assert found.distance <= least + slack
        assert curve.domain.contains(found.t)
        assert (found.point == curve(found.t)).all()


@RATIONAL
@pytest.mark.parametrize("degree", range(1, 8))
def test_no_place_of_a_nurbs_is_nearer(degree: int, rational: bool) -> None:
    """Degrees 1 to 7, corners, clustered knots, weights from 1e-3 to 1e3; far points and ends."""
    curve = wild_curve(degree, degree=degree, rational=rational)
    check_never_farther(curve, queries(curve, np.random.default_rng(degree), 12))


@pytest.mark.usefixtures("tiny_leaves")
@RATIONAL
def test_no_place_is_nearer_whatever_the_levels_of_the_tree(rational: bool) -> None:
    """The same with all levels of the tree at work on a small curve."""
    curve = wild_curve(11, degree=3, rational=rational, count=150)
    check_never_farther(curve, queries(curve, np.random.default_rng(0), 20))


@pytest.mark.usefixtures("tiny_leaves")
def test_no_place_of_a_polyline_or_a_wavelet_is_nearer() -> None:
    """Segments are their own capsules; graded knots on a domain of any length."""
    rng = np.random.default_rng(5)
    polyline = Polyline(np.arange(200) / 7, rng.normal(size=(200, 3)).cumsum(axis=0) / 20)
    check_never_farther(polyline, queries(polyline, rng, 20))
    points = rng.normal(size=(67, 2)).cumsum(axis=0) / 10
    wavelet = WaveletBSpline(points, Interval(-1.0, 3.0)).refine(Interval(0.25, 0.5)).value
    check_never_farther(wavelet, queries(wavelet, rng, 20))


@RATIONAL
def test_agrees_with_certified_sampling(rational: bool) -> None:
    """The search by certified samples, which knows nothing of capsules, finds the distance."""
    curve = wild_curve(3, degree=3, rational=False)
    if rational:
        weights = np.random.default_rng(1).uniform(0.5, 2, curve.size)
        curve = Nurbs(degree=3, knots=curve.knots, points=curve.points, weights=weights)
    for point in queries(curve, np.random.default_rng(2), 6)[:-2]:
        other = nearest_by_sampling(curve, point)
        assert curve.nearest(point).distance == pytest.approx(other.distance, abs=1e-8)


def test_equally_near_places() -> None:
    """All of an exact circle is equally near to its centre: any place, at exactly the radius."""
    half = 0.5**0.5
    corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]]
    circle = Nurbs(
        degree=2,
        knots=[0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1],
        points=corners,
        weights=[1, half, 1, half, 1, half, 1, half, 1],
    )
    inserted = circle.insert_knots(np.linspace(0.003, 0.997, 400)).value
    for curve in (circle, inserted):
        assert curve.nearest([0.0, 0.0]).distance == pytest.approx(1.0, abs=1e-9)
        many = curve.nearest(np.zeros((5, 2)))
        assert many.distance == pytest.approx(np.ones(5), abs=1e-9)
        assert curve.nearest([0.0, 1e-12]).distance <= 1.0


def test_equally_near_places_of_many_leaves() -> None:
    """A polygon around its centre, and beside it: no leaf can be left out, and none is needed."""
    turn = np.linspace(0, 2 * np.pi, 20_001)
    polygon = Polyline.from_points(np.stack([np.cos(turn), np.sin(turn)], axis=1))
    apothem = np.cos(np.pi / 20_000)
    offsets = np.array([[0.0, 0.0], [1e-12, 0], [0, 1e-7], [0.5, 0.5], [1e6, -1e6]])
    expected = np.abs(np.linalg.norm(offsets, axis=1) - 1.0)
    slack = 1e-9 + 1e-14 * np.abs(offsets).max(axis=1)
    alone = np.array([polygon.nearest(x).distance for x in offsets])
    for found in (polygon.nearest(offsets).distance, alone):
        assert (found <= expected + slack).all()
        assert (found >= expected - (1 - apothem) - slack).all()


def test_a_place_where_a_piece_crosses_itself() -> None:
    """One loop of one cubic: both branches pass the crossing; the nearer one is taken."""
    loop = Nurbs(degree=3, knots=[0] * 4 + [1] * 4, points=[[0, 0], [3, 2], [-2, 2], [1, 0]])
    crossing = loop.nearest([0.5, 0.7]).point
    for offset in ([0, 0], [1e-9, 0], [-1e-9, 1e-9], [1e-5, -1e-5]):
        check_never_farther(loop, (crossing + offset)[None])


@settings(max_examples=60)
@given(st.integers(0, 2**31), st.integers(1, 5))
def test_newton_in_the_wrong_valley_is_seen(seed: int, degree: int) -> None:
    """A single wild piece, from any start: no place of it is nearer than what is returned."""
    rng = np.random.default_rng(seed)
    hull, point = rng.normal(size=(degree + 1, 2, 1)), rng.normal(size=(2, 1))
    offsets, f, _ = squared(hull, point)
    found = least_on_piece(
        offsets[:, :, 0].tolist(), f[:, 0].tolist(), None, rng.random(), np.inf, 1e-10
    )
    assert found is not None
    t = np.linspace(0, 1, 2001)
    ends = [0.0] * (degree + 1) + [1.0] * (degree + 1)
    there = Nurbs(degree=degree, knots=ends, points=hull[:, :, 0])(t) - point[:, 0]
    assert found[0] <= np.linalg.norm(there, axis=1).min() + 1e-10


def test_a_place_nearer_than_the_given_distance_or_none() -> None:
    """Nothing comes back where the distance to be beaten is not."""
    offsets, f, g = squared(np.array([[[0.0], [1.0]], [[2.0], [1.0]]]), np.zeros((2, 1)))
    column = offsets[:, :, 0].tolist(), f[:, 0].tolist(), g
    assert least_on_piece(*column, 0.7, 0.99, 1e-10) is None
    assert least_on_piece(*column, 0.7, 5.0, 1e-10) == (1.0, 0.0)


def test_capsules_hold_their_stretch_and_are_held_by_it() -> None:
    """Points of a stretch are within the radius of the chord, and the chord within it of them."""
    curve = wild_curve(8, degree=3, rational=True, count=600)
    curve.nearest([0.0, 0.0])
    tree: Tree = curve._known.tree
    assert len(tree.filled) > 1
    for leaf in tree.filled:
        pieces = leaf.pieces
        assert leaf.whole is not None
        rows = [(leaf.whole, 0, len(pieces.starts))]
        rows += [
            (leaf.groups[:, [k]], k * FAN, min((k + 1) * FAN, len(pieces.starts)))
            for k in range(leaf.groups.shape[1])
        ]
        rows += [(pieces.nodes[:, [k]], k, k + 1) for k in range(0, len(pieces.starts), 7)]
        for node, first, stop in rows:
            t = np.linspace(pieces.starts[first], pieces.stops[stop - 1], 400)
            there = curve(t).T
            assert (distances(node, there)[1] <= node[-1] + 1e-12).all()
            chord = node[:2] + np.linspace(0, 1, 30) * node[2:4]
            away = np.linalg.norm(chord.T[:, None] - there.T, axis=2).min(axis=1)
            step = np.linalg.norm(np.diff(there, axis=1), axis=0).max()
            assert (away <= node[-1] + step).all()


def test_points_and_far_chords_are_capsules() -> None:
    """A chord without length is a point; a chord too short to square is one with a radius."""
    starts, stops = np.zeros((2, 2)), np.array([[0.0, 1e-200], [0.0, 0.0]])
    nodes = capsules(starts, stops, 0.0)
    u, away = distances(nodes, np.array([[3.0], [4.0]]))
    assert (u == 0).all()
    assert (away == 5).all()
    assert nodes[-1, 1] >= 1e-200
    around = capsule_around(np.array([[0.0, 1.0, 2.0], [0.0, 1.0, 0.0]]), *np.eye(2) * 0)
    assert around[-1, 0] == pytest.approx(2.0)


EDITS = {
    "point": lambda c, k: c.move_control_point(k, c.points[k] + 0.01),
    "knot": lambda c, k: c.insert_knot(float(c.knots[k + 3]) + 1e-7),
    "weight": lambda c, k: c.set_weight(k, 2.0),
}


@pytest.mark.parametrize("what", EDITS)
def test_only_leaves_that_changed_are_made_anew(what: str, made: list[int]) -> None:
    """After an edit at one place a query makes the leaves there; undo makes them again."""
    n = 6000
    t = np.linspace(0, 1, n - 2)
    knots = np.concatenate([[0.0] * 3, t, [1.0] * 3])
    points = np.random.default_rng(0).normal(size=(n, 2)).cumsum(axis=0)
    weights = np.full(n, 3.0)
    weights[0] = 2.0
    curve = Nurbs(degree=3, knots=knots, points=points, weights=weights)
    curve.nearest(points[10])
    assert sum(made) == n - 3
    made.clear()
    edited = EDITS[what](curve, 3210).value
    fresh = Nurbs.from_dict(edited.to_dict())
    for point in (points[10] + 1e-3, points[3210] + 0.5):
        assert edited.nearest(point).distance == pytest.approx(
            fresh.nearest(point).distance, abs=1e-9
        )
    made[:] = made[: -len(fresh._known.tree.leaves)]
    assert 0 < sum(made) <= 4 * FAN**2
    made.clear()
    curve.nearest(points[3210])
    assert 0 < sum(made) <= 4 * FAN**2
    made.clear()
    curve.nearest(points[77])
    assert not made


@settings(max_examples=50)
@given(
    st.integers(1, 60),
    st.lists(st.tuples(st.integers(0, 60), st.integers(0, 20), st.integers(-10, 10)), max_size=5),
    st.sampled_from([0, 0, 3]),
)
@pytest.mark.usefixtures("tiny_leaves")
def test_what_a_tree_takes_over_is_what_it_would_find(
    count: int, edits: list[tuple[int, int, int]], empty: int
) -> None:
    """The capsules around all leaves and where they end; with empty leaves too."""

    def build(first: int, stop: int) -> Leaf:
        whole = None if empty and first % empty == 0 else np.random.default_rng(0).random((6, 1))
        return Leaf(stop - first, whole, lambda: pytest.fail("nobody looks at pieces"))

    tree = Tree.of(build, count)
    for first, length, shift in edits:
        first, stop = min(first, count), min(first + length, count)
        shift = max(shift, first - stop, 1 - count)
        renewed = tree.renewed(build, first, stop, shift)
        other, count = Tree(renewed.leaves), count + shift
        assert sum(leaf.spans for leaf in other.leaves) == count
        assert renewed.filled == other.filled
        assert renewed._ends.tolist() == other._ends.tolist()
        if other.filled:
            assert np.array_equal(renewed.tops, other.tops)
        tree = renewed


def test_pieces_far_away_are_not_made() -> None:
    """A query on a long curve cuts the few leaves that may hold the answer, and no others."""
    t = np.linspace(0, 1, 20_000)
    polyline = Polyline(t, np.stack([np.cos(5 * t), np.sin(3 * t)], axis=1))
    polyline.nearest(polyline(0.3) + 1e-4)
    made = [leaf for leaf in polyline._known.tree.leaves if "pieces" in vars(leaf)]
    assert len(made) <= 3


@settings(max_examples=25)
@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 10**6)), max_size=12))
@pytest.mark.usefixtures("tiny_leaves")
def test_answers_do_not_depend_on_the_history(steps: list[tuple[int, int]]) -> None:
    """After any edits, undone or not, the answer is that of a value made from nothing."""
    rng = np.random.default_rng(4)
    versions: list[Polyline] = [Polyline(np.arange(60.0), rng.normal(size=(60, 2)).cumsum(axis=0))]
    for what, number in steps:
        curve = versions[-1]
        k = 1 + number % (curve.size - 2)
        if what == 0 and len(versions) > 1:
            versions.pop()
        elif what <= 2:
            versions.append(curve.move_vertex(k, curve.points[k] + 1.0).value)
        elif what == 3 and curve.size > 8:
            versions.append(curve.delete_vertex(k).value)
        else:
            t = 0.5 * (float(curve.t[k]) + float(curve.t[k + 1]))
            versions.append(curve.insert_vertex(t, [0.5, number % 7]).value)
        curve = versions[-1]
        point = np.array([number % 13, number % 5], dtype=float)
        fresh = Polyline.from_dict(curve.to_dict())
        assert curve.nearest(point).distance == fresh.nearest(point).distance


def test_wavelets_share_their_tree_too(made: list[int]) -> None:
    """A sweep at a fine level makes a few leaves anew."""
    t = np.linspace(0, 1, 2**12 + 3)
    curve = WaveletBSpline(np.stack([np.cos(7 * t), np.sin(5 * t)], axis=1))
    curve.nearest([0.0, 0.0])
    made.clear()
    edited = curve.sweep(0.3, [0.0, 0.0], level=12).value
    assert edited.nearest([0.0, 0.0]).distance == pytest.approx(0.0, abs=1e-9)
    assert 0 < sum(made) <= 4 * FAN**2


def test_many_points_of_any_representation() -> None:
    """Arrays come back for (m, d) points, also none; other shapes are refused."""
    curve = wild_curve(2, degree=2, rational=False)
    none = curve.nearest(np.empty((0, 2)))
    assert (none.t.shape, none.point.shape, none.distance.shape) == ((0,), (0, 2), (0,))
    for wrong in (np.zeros((3, 3)), np.zeros((1, 1, 2)), [[0.0, np.inf]], 1.0):
        with pytest.raises(InvalidCurveError, match="2 coordinates"):
            curve.nearest(wrong)
