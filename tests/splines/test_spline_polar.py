"""Blossoms, refinement and Bernstein form."""

from fractions import Fraction
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline, insert

from multirep.splines import bernstein, blossom, evaluate, find_spans, refine
from multirep.testing.reference import bernstein_value, blossom_value, exact
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

EPS = np.finfo(np.float64).eps
FRACTIONS = st.integers(0, 64).map(lambda k: k / 64)
T = np.linspace(0, 1, 65)


@given(dyadic_splines(degrees=(1, 4), max_inner=4), FRACTIONS, st.data())
def test_blossoms_agree_with_the_recursion(
    spline: DyadicSpline, t: float, data: st.DataObject
) -> None:
    """Exact fractions are the oracle; arguments lie in the span."""
    knots, points, p, _ = spline
    span = find_spans(knots, p, [t])
    low, high = knots[span[0]], knots[span[0] + 1]
    shares = data.draw(st.lists(FRACTIONS, min_size=p, max_size=p))
    arguments = [float(low + share * (high - low)) for share in shares]
    true = blossom_value(
        exact(knots.tolist()),
        [exact(row) for row in points.tolist()],
        p,
        int(span[0]),
        exact(arguments),
    )
    value = blossom(knots, points, p, span, np.array([arguments]))[0]
    assert value == pytest.approx([float(x) for x in true], abs=16 * p * EPS * 4)


@given(dyadic_splines(degrees=(2, 3), max_inner=3))
def test_the_blossom_is_symmetric_and_the_curve_is_its_diagonal(spline: DyadicSpline) -> None:
    """Any order of the arguments, up to rounding."""
    knots, points, p, _ = spline
    spans = find_spans(knots, p, T)
    diagonal = blossom(knots, points, p, spans, np.repeat(T[:, None], p, axis=1))
    assert np.abs(diagonal - evaluate(knots, points, p, T)).max() <= 64 * EPS * 4
    low, high = knots[spans], knots[spans + 1]
    arguments = np.stack([low, high, (low + high) / 2][:p], axis=1)
    values = [
        blossom(knots, points, p, spans, arguments[:, list(order)])
        for order in permutations(range(p))
    ]
    assert max(np.abs(value - values[0]).max() for value in values) <= 64 * EPS * 4


@given(dyadic_splines(rational=None), st.lists(FRACTIONS, max_size=6))
def test_refinement_does_not_change_the_curve(spline: DyadicSpline, extra: list[float]) -> None:
    """Any further knots, multiple ones too, as long as none exceeds the degree."""
    knots, points, p, _ = spline
    new_knots = knots.tolist()
    for knot in extra:
        if 0 < knot < 1 and new_knots.count(knot) < p:
            new_knots.append(knot)
    finer = np.sort(np.array(new_knots))
    refined = refine(knots, points, p, finer)
    difference = evaluate(finer, refined, p, T) - evaluate(knots, points, p, T)
    assert np.abs(difference).max() <= 16 * p * EPS * np.abs(points).max(initial=1)
    # Control points with the same local knots are the same numbers.
    old = {tuple(knots[i + 1 : i + p + 1]): row for i, row in enumerate(points.tolist())}
    for i, row in enumerate(refined.tolist()):
        local = tuple(finer[i + 1 : i + p + 1])
        assert row == old.get(local, row)


def test_refinement_agrees_with_fitpack() -> None:
    """An independent implementation, knot by knot."""
    rng = np.random.default_rng(5)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(8)), [1.0] * 4))
    points = rng.standard_normal((12, 1))
    new = np.sort(rng.random(5))
    spline = BSpline(knots, points[:, 0], 3)
    for knot in new:
        spline = insert(knot, spline)
    refined = refine(knots, points, 3, np.sort(np.concatenate((knots, new))))
    assert refined[:, 0] == pytest.approx(spline.c[: len(refined)], abs=64 * EPS * 3)


def test_a_window_is_refined_like_the_whole() -> None:
    """Cut out p knots more on each side; what lies outside is copied bit by bit."""
    rng = np.random.default_rng(6)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(60)), [1.0] * 4))
    points = rng.standard_normal((64, 2))
    span = 30
    new = np.array([0.3, 0.3, 0.7]) * (knots[span + 1] - knots[span]) + knots[span]
    whole_knots = np.sort(np.concatenate((knots, new)))
    whole = refine(knots, points, 3, whole_knots)
    window = slice(span - 6, span + 9)
    part_knots = np.sort(np.concatenate((knots[window], new)))
    part = refine(knots[window], points[span - 6 : span + 5], 3, part_knots)
    assert np.array_equal(part, whole[span - 6 : span + 8])
    assert np.array_equal(part[:3], points[span - 6 : span - 3])


def test_refinement_beside_a_knot_one_ulp_away_is_stable() -> None:
    """Neighbouring floating-point knots divide by their tiny difference, but stay in the hull."""
    above = np.nextafter(0.5, 1)
    knots = np.array([0, 0, 0, 0, 0.5, 1, 1, 1, 1])
    points = np.array([[0.0, 1.0], [1.0, -1.0], [2.0, 4.0], [3.0, 0.0], [4.0, 2.0]])
    finer = np.sort(np.concatenate((knots, [above, above, above])))
    refined = refine(knots, points, 3, finer)
    difference = evaluate(finer, refined, 3, T) - evaluate(knots, points, 3, T)
    assert np.abs(difference).max() <= 64 * EPS * 4


@given(dyadic_splines(degrees=(1, 4), max_inner=3), FRACTIONS, st.integers(1, 8))
def test_bernstein_form_is_the_curve_on_the_piece(
    spline: DyadicSpline, t: float, eighths: int
) -> None:
    """Exact evaluation of the computed coefficients against the blossom in fractions."""
    knots, points, p, _ = spline
    spans = find_spans(knots, p, [t])
    low, high = knots[spans], knots[spans + 1]
    stops = low + (high - low) * (eighths / 8)
    rows = bernstein(knots, points, p, spans, low, stops)
    assert rows.shape == (1, p + 1, points.shape[1])
    for share in (Fraction(0), Fraction(1, 3), Fraction(1)):
        at = Fraction(float(low[0])) + share * (Fraction(float(stops[0])) - Fraction(float(low[0])))
        true = blossom_value(
            exact(knots.tolist()),
            [exact(row) for row in points.tolist()],
            p,
            int(spans[0]),
            [at] * p,
        )
        mine = [float(bernstein_value(exact(column), share)) for column in rows[0].T.tolist()]
        assert mine == pytest.approx([float(x) for x in true], abs=16 * p * EPS * 4)


def test_bernstein_form_of_a_piece_one_ulp_wide_stays_at_the_curve() -> None:
    """No division by the length of the piece."""
    knots = np.array([0, 0, 0, 0, 0.2, 1, 1, 1, 1])
    points = np.array([[0.0], [1.0], [-2.0], [4.0], [0.0]])
    start = np.array([0.2])
    rows = bernstein(knots, points, 3, np.array([4]), start, np.nextafter(start, 1))
    assert np.abs(rows - evaluate(knots, points, 3, start)).max() <= 16 * EPS * 4


def test_refining_beside_a_cluster_of_knots_is_exact_to_rounding():
    """Tiny spans among long ones are no place to continue a polynomial from."""
    tight = 0.45 + np.array([-(2.0**-22), 0.0, 2.0**-22])
    knots = np.concatenate((np.zeros(4), [0.2], tight, [0.8], np.ones(4)))
    points = np.random.default_rng(2).normal(size=(len(knots) - 4, 2))
    finer = np.sort(np.concatenate((knots, [0.25, 0.5, 0.75])))
    t = np.union1d(np.linspace(0, 1, 1001), tight)
    refined = refine(knots, points, 3, finer)
    assert np.abs(evaluate(finer, refined, 3, t) - evaluate(knots, points, 3, t)).max() <= 1e-14
