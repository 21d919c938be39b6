"""The compiled core's points and nearest places against the numpy functions that it stands for."""

from __future__ import annotations

import datetime
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_compiled import Spline, both, core, parameters, same, seeds, splines

from multirep.arrays import Array
from multirep.capsules import capsule_around, capsules, merged_capsules
from multirep.representations import Nurbs, Polyline
from multirep.sampled import interpolate
from multirep.splines import compiled, evaluate
from multirep.splines.rational import curve_point, curve_points

pytestmark = pytest.mark.skipif(compiled.core is None, reason="the core was not built")


def arrays(spline: Spline) -> tuple[Array, Array, Array | None]:
    """Knots, control points and weights; some weights are 1, whole spans of them too."""
    if not spline.rational:
        return spline.knots, spline.coefficients, None
    weights = spline.coefficients[:, -1].copy()
    points = np.ascontiguousarray(spline.coefficients[:, :-1] / weights[:, None])
    weights[: len(weights) // 2] = 1.0
    return spline.knots, points, weights


def blocks(array: Array | None, rng: np.random.Generator) -> tuple[Array, ...] | None:
    """Cut an array anywhere, into pieces of one row too."""
    if array is None:
        return None
    marks = np.flatnonzero(rng.random(len(array) - 1) < rng.choice([0.1, 0.5, 1.0])) + 1
    return tuple(part.copy() for part in np.split(array, marks))


@given(splines(), seeds, st.booleans(), st.sampled_from(["right", "left"]))
def test_derivatives_of_all_orders_have_the_same_bits(
    spline: Spline, seed: int, shuffled: bool, side: Any
) -> None:
    """From either side, in order or not, few and many; beyond the domain as well."""
    t = np.concatenate((parameters(spline, seed, count=100), [-1.0, 1e3][: seed % 3]))
    if shuffled:
        np.random.default_rng(seed).shuffle(t)
    for order in range(spline.degree + 2):
        fast, pure = both(
            lambda order=order: evaluate(
                spline.knots, spline.coefficients, spline.degree, t, order=order, side=side
            )
        )
        assert same(fast, pure) or np.array_equal(fast, pure)


@given(splines(), seeds, st.booleans())
def test_points_have_the_same_bits_with_and_without_weights(
    spline: Spline, seed: int, shuffled: bool
) -> None:
    """At corners too, and one by one."""
    t = parameters(spline, seed, count=100)
    if shuffled:
        np.random.default_rng(seed).shuffle(t)
    knots, points, weights = arrays(spline)
    fast, pure = both(lambda: curve_points(knots, points, weights, spline.degree, t))
    assert np.array_equal(fast, pure)


def rope(parts: tuple[Array, ...] | None, rng: np.random.Generator) -> Any:
    """Join blocks, some of them in ropes before."""
    if parts is None:
        return None
    cut = int(rng.integers(0, len(parts) + 1))
    ends = [compiled.core.rope(some) for some in (parts[:cut], parts[cut:]) if some]
    return compiled.core.rope(tuple(ends))


@given(splines(), seeds, st.booleans())
def test_blocks_give_what_flat_arrays_give(spline: Spline, seed: int, shuffled: bool) -> None:
    """Wherever the knots, control points and weights are cut, each on its own."""
    rng = np.random.default_rng(seed)
    t = parameters(spline, seed, count=100)
    if shuffled:
        rng.shuffle(t)
    flat = arrays(spline)
    expected = np.empty((len(t), flat[1].shape[1]))
    found = np.empty_like(expected)
    rest = (spline.degree, t, 0, False, True)
    compiled.core.points(*flat, *rest, expected)
    cut = [blocks(array, rng) for array in flat]
    compiled.core.points(*cut, *rest, found)  # type: ignore[arg-type, call-arg]
    assert same(found, expected)
    ropes = [rope(parts, rng) for parts in cut]
    compiled.core.points(*ropes, *rest, found)  # type: ignore[arg-type, call-arg]
    assert same(found, expected)
    for at, row in zip(t.tolist(), expected, strict=True):
        compiled.core.points(*ropes, spline.degree, at, 0, False, True, found[0])  # type: ignore[call-arg, arg-type]
        assert same(found[0], row)


@given(seeds, st.integers(2, 60), st.integers(1, 3), st.booleans())
def test_ropes_of_polylines_give_what_flat_arrays_give(
    seed: int, count: int, dimension: int, shuffled: bool
) -> None:
    """At vertices, between and at both ends; vertices crowd together in some places."""
    rng = np.random.default_rng(seed)
    t, points = (rng.random(count) ** 8 + 1e-9).cumsum(), rng.normal(size=(count, dimension))
    at = np.concatenate((t, rng.uniform(t[0], t[-1], 100)))
    if not shuffled:
        at.sort()
    flat, pure = both(lambda: interpolate(t, points, at))
    assert same(flat, pure)
    ropes = [rope(blocks(array, rng), rng) for array in (t, points)]
    found = np.empty_like(flat)
    compiled.core.interpolate(*ropes, at, found)  # type: ignore[arg-type]
    assert same(found, flat)
    for here, row in zip(at.tolist(), flat, strict=True):
        compiled.core.interpolate(*ropes, here, found[0])  # type: ignore[arg-type]
        assert same(found[0], row)


def test_a_rope_outlives_its_arrays() -> None:
    """It keeps the blocks, and a rope of ropes those of all."""
    made = compiled.core.rope(
        tuple(compiled.core.rope((np.arange(k, k + 500.0),)) for k in range(0, 50_000, 500))
    )
    found = np.empty((1, 1))
    values = compiled.core.rope((np.arange(50_000.0)[:, None],))
    compiled.core.interpolate(made, values, 41_234.5, found)
    assert found == 41_234.5


@pytest.mark.parametrize(
    ("parts", "error", "message"),
    [
        ((), ValueError, "a block or more"),
        ([np.zeros(2)], ValueError, "a block or more"),
        ((np.zeros(0),), ValueError, "must have rows"),
        ((np.zeros(4)[::2],), ValueError, "row after row"),
        ((np.zeros(2), np.zeros((2, 2))), ValueError, "all of one length"),
        ((np.zeros(2, dtype=np.float32),), TypeError, "format"),
        ((np.zeros(2), "rope"), TypeError, "buffer|bytes-like"),
    ],
)
def test_what_is_no_rope_is_refused(parts: Any, error: type[Exception], message: str) -> None:
    """As parts of ropes too, and in the place of one; another capsule is none."""
    with pytest.raises(error, match=message):
        compiled.core.rope(parts)
    whole, other = (compiled.core.rope((np.zeros(shape),)) for shape in (2, (2, 2)))
    with pytest.raises(ValueError, match="all of one length"):
        compiled.core.rope((whole, other))
    with pytest.raises(ValueError, match="PyCapsule"):
        compiled.core.rope((datetime.datetime_CAPI,))  # type: ignore[attr-defined]


@given(splines(), seeds)
def test_one_point_has_the_same_bits(spline: Spline, seed: int) -> None:
    """Of a window of one span, at both its ends and between."""
    knots, points, weights = arrays(spline)
    p, rng = spline.degree, np.random.default_rng(seed)
    filled = np.flatnonzero(knots[p : len(points)] < knots[p + 1 : len(points) + 1]) + p
    k = int(rng.choice(filled))
    own = None if weights is None else weights[k - p : k + 1]
    for t in (float(knots[k]), float(rng.uniform(knots[k], knots[k + 1])), float(knots[k + 1])):
        fast, pure = both(
            lambda t=t: curve_point(knots[k - p : k + p + 2], points[k - p : k + 1], own, p, t)
        )
        assert np.array_equal(fast, pure)


@pytest.mark.parametrize("weights", [None, np.array([3.0, 7, 11, 0.3, 0.7])])
def test_corners_and_ends_are_their_control_points(weights: Array | None) -> None:
    """Though 49 * (1 / 49) is less than 1, as the basis function there would be."""
    knots = np.array([0, 0, 0, 49, 49, 98, 98, 98.0])
    points = np.random.default_rng(1).normal(size=(5, 2))
    assert 49 * (1 / 49) < 1
    for found in both(lambda: curve_points(knots, points, weights, 2, np.array([0.0, 49, 98]))):
        assert same(found, points[::2])
    own = None if weights is None else weights[2:]
    for found in both(lambda: curve_point(knots[2:], points[2:], own, 2, 49.0)):
        assert same(found, points[2])
    for found in both(lambda: curve_point(knots[2:], points[2:], own, 2, 98.0)):
        assert same(found, points[4])


def test_many_points_in_no_order_have_the_bits_of_those_in_order() -> None:
    """More than are put in order at once, clustered ones too."""
    rng = np.random.default_rng(5)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(3000) ** 4), [1.0] * 4))
    points = rng.normal(size=(3004, 2))
    t = np.concatenate((rng.random(600_000), rng.random(1000) * 1e-9, [0.0, 1.0]))
    rng.shuffle(t)
    order = t.argsort()
    found = evaluate(knots, points, 3, t)
    assert same(found[order], evaluate(knots, points, 3, t[order]))


KNOTS, POINTS = np.array([0, 0, 0, 1, 1, 1.0]), np.zeros((3, 2))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"knots": KNOTS[:-1]}, "n \\+ p \\+ 1 knots"),
        ({"knots": ()}, "a block or more"),
        ({"knots": (KNOTS, np.empty(0))}, "must have rows"),
        ({"knots": (KNOTS[::2], KNOTS[::2])}, "row after row"),
        ({"points": (POINTS[:1], np.zeros((2, 3)))}, "all of one length"),
        ({"weights": np.ones(2)}, "a weight for each"),
        ({"weights": np.ones(3), "order": 1}, "has points only"),
        ({"degree": 0}, "degree of 1"),
        ({"order": 3}, "degree of 1"),
        ({"order": -1}, "degree of 1"),
        ({"found": np.empty((3, 2))}, "room for a point"),
    ],
)
def test_what_is_no_spline_is_refused(change: dict[str, Any], message: str) -> None:
    """Never read beyond an array."""
    call = {
        "knots": KNOTS,
        "points": POINTS,
        "weights": None,
        "degree": 2,
        "t": np.array([0.5, 0.25]),
        "order": 0,
        "left": False,
        "settled": True,
        "found": np.empty((2, 2)),
    }
    compiled.core.points(*call.values())  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=message):
        compiled.core.points(*(call | change).values())  # type: ignore[arg-type]


def test_parameters_that_are_no_numbers_do_no_harm() -> None:
    """NaN gives NaN; infinity gives what there is."""
    for t in ([np.nan], [np.inf, 0.5], [np.nan, -np.inf] * 50):
        with np.errstate(invalid="ignore"):
            values = evaluate(KNOTS, POINTS + 1.0, 2, t)
        assert values.shape == (len(t), 2)
        assert np.isnan(values[np.isnan(t)]).all()


# -- nearest places --------------------------------------------------------------------------------


@given(seeds, st.integers(1, 3), st.integers(1, 30))
def test_capsules_are_as_numpy_makes_them(seed: int, dimension: int, count: int) -> None:
    """The same but for the last bits of the radius; stretches of no length too."""
    rng = np.random.default_rng(seed)
    points = rng.integers(-64, 65, (count, dimension)) / 64
    start, stop = rng.integers(-64, 65, (2, dimension)) / 64 * (seed % 2)
    fast, pure = both(lambda: capsule_around(points.T, start, stop))
    np.testing.assert_allclose(fast, pure, rtol=4e-15, atol=0)


def curve(kind: str, seed: int, count: int) -> Nurbs | Polyline:
    """A walk, as a curve of any kind and of some degree."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 2)).cumsum(axis=0)
    if kind == "polyline":
        return Polyline.from_points(points)
    p = 1 + seed % 4
    inner = np.sort(rng.random(count - p - 1))
    knots = np.concatenate(([0.0] * (p + 1), inner, [1.0] * (p + 1)))
    weights = 10.0 ** rng.uniform(-2, 2, count) if kind == "rational" else None
    return Nurbs(degree=p, knots=knots, points=points, weights=weights)


@pytest.mark.parametrize("kind", ["polynomial", "rational", "polyline"])
@pytest.mark.parametrize("count", [6, 400, 20_000])
def test_nearest_places_are_as_near_as_numpy_finds_them(kind: str, count: int) -> None:
    """One leaf, several, and so many that they are grouped; asked one by one and together."""
    value = curve(kind, count + len(kind), count)
    rng = np.random.default_rng(count)
    size = float(np.ptp(np.asarray(value.points), axis=0).max())
    on = value(rng.random(20))
    points = np.concatenate((on, on + rng.normal(size=on.shape) * size / 50, on * 1e4))
    fast, pure = both(lambda: value.nearest(points))
    allowed = 1e-9 * size + 1e-13 * np.abs(points).max(axis=1)
    assert (np.abs(fast.distance - pure.distance) <= allowed).all()
    with core(True):
        alone = [value.nearest(point) for point in points]
    assert [place.t for place in alone] == fast.t.tolist()  # type: ignore[union-attr]


@given(seeds, st.integers(1, 3), st.integers(1, 40))
def test_capsules_are_merged_as_numpy_does(seed: int, dimension: int, count: int) -> None:
    """The same but for the last bits of the radius; those of no length too."""
    rng = np.random.default_rng(seed)
    starts, stops = rng.integers(-2, 3, (2, dimension, count)) / 2
    nodes = capsules(starts, stops, rng.random(count))
    fast, pure = both(lambda: merged_capsules(nodes))
    np.testing.assert_allclose(fast, pure, rtol=4e-15, atol=0)


def test_what_are_no_capsules_is_refused() -> None:
    """Never read beyond an array."""
    for nodes, fan, found in (
        (np.zeros((5, 4)), 2, np.zeros((6, 2))),
        (np.zeros((6, 4)), 2, np.zeros((8, 2))),
        (np.zeros((6, 4)), 2, np.zeros((6, 3))),
        (np.zeros((6, 4)), 0, np.zeros((6, 2))),
        (np.zeros((2, 4)), 2, np.zeros((2, 2))),
    ):
        with pytest.raises(ValueError, match="capsule"):
            compiled.core.merged_capsules(nodes, fan, 0.0, found)


NODES, GROUPS, HULLS = np.zeros((6, 3)), np.zeros((6, 2)), np.zeros((3, 2, 3))


def leaf(**changes: Any) -> Any:
    """Three pieces, two of them in a group."""
    usual = {"starts": np.zeros(3), "stops": np.ones(3), "nodes": NODES, "groups": GROUPS}
    return compiled.core.leaf(*(usual | {"hulls": HULLS, "fan": 2} | changes).values())  # type: ignore[call-arg, arg-type]


@pytest.mark.parametrize(
    "change",
    [
        {"starts": np.zeros(2)},
        {"stops": np.ones(4)},
        {"starts": np.zeros(0), "stops": np.zeros(0), "nodes": NODES[:, :0]},
        {"starts": np.zeros(6)[::2]},
        {"nodes": NODES[:5]},
        {"nodes": NODES[:, :2]},
        {"nodes": np.zeros((2, 3))},
        {"groups": np.zeros((6, 3))},
        {"groups": np.zeros((8, 2))},
        {"hulls": HULLS[:, :, :2]},
        {"hulls": HULLS[:1]},
        {"hulls": np.zeros((3, 4, 3))},
        {"fan": 0},
        {"fan": 3},
    ],
)
def test_pieces_that_are_no_leaf_are_refused(change: dict[str, Any]) -> None:
    """Never read beyond an array."""
    leaf()
    with pytest.raises(ValueError, match=r"wanted|leaf|hulls|columns"):
        leaf(**change)


@pytest.mark.parametrize(
    "change",
    [
        {"levels": ()},
        {"levels": [np.zeros((6, 3))]},
        {"levels": (np.zeros((6, 1)), np.zeros((6, 3)))},
        {"levels": (np.zeros((6, 2)), np.zeros((8, 3)))},
        {"levels": (np.zeros((6, 2)),)},
        {"leaves": (None, None, None)},
        {"leaves": [None]},
        {"leaves": [leaf(), leaf(hulls=None), leaf()]},
        {"leaves": [leaf(hulls=np.zeros((3, 3, 3))), leaf(), leaf()]},
        {"leaves": [leaf(hulls=np.zeros((4, 2, 3))), leaf(), leaf()]},
        {"leaves": [leaf(nodes=np.zeros((4, 3)), groups=np.zeros((4, 2)), hulls=None)] * 3},
        {"leaves": [datetime.datetime_CAPI] * 3},  # type: ignore[attr-defined]
        {"leaves": [0] * 3},
        {"fan": 0},
        {"fan": 3},
        {"points": np.zeros((2, 2))},
        {"points": np.zeros(3)},
        {"found": np.zeros(2)},
    ]
    if compiled.core is not None
    else [],
)
def test_what_is_no_tree_is_refused(change: dict[str, Any]) -> None:
    """Never read beyond an array."""
    call = {
        "levels": (np.zeros((6, 2)), np.zeros((6, 3))),
        "leaves": [leaf(), leaf(), leaf()],
        "fan": 2,
        "points": np.zeros(2),
        "slack": 0.0,
        "unit": 0.0,
        "found": np.empty(1),
    }
    assert compiled.core.nearest(*call.values()) == []  # type: ignore[arg-type]
    assert compiled.core.nearest(*(call | {"leaves": [None] * 3}).values()) == [0, 1, 2]  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"wanted|holds|columns|PyCapsule"):
        compiled.core.nearest(*(call | change).values())  # type: ignore[arg-type]
