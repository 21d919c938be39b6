"""Banded least squares against dense solutions, and its rows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline, make_lsq_spline

from multirep.splines import evaluate, polyline_rows, solve_window
from multirep.splines.arrays import Array
from multirep.testing.spline_strategies import DyadicSpline, dyadic_splines

FRACTIONS = st.integers(0, 64).map(lambda k: k / 64)


def dense_solution(
    spline: DyadicSpline, free: slice, t: Array, targets: Array, row_weights: Array
) -> Array:
    """Solve the same problem with a full matrix."""
    knots, p = spline.knots, spline.degree
    matrix = BSpline(knots, np.eye(len(spline.points)), p)(t)
    matrix = matrix * spline.weights
    matrix /= matrix.sum(axis=1, keepdims=True)
    held = spline.points.copy()
    held[free] = 0
    root = np.sqrt(row_weights)[:, None]
    right = (targets - matrix @ held) * root
    held[free] = np.linalg.lstsq(matrix[:, free] * root, right, rcond=None)[0]
    return np.asarray(held)


def rough(count: int = 40) -> tuple[Array, Array]:
    """A polyline that no spline below fits."""
    rng = np.random.default_rng(11)
    t = np.sort(np.concatenate(([0.0, 1.0], rng.random(count - 2))))
    return t, np.cumsum(rng.standard_normal((count, 2)), axis=0)


@given(dyadic_splines(rational=None, max_multiplicity=2), st.data())
def test_the_solution_is_that_of_the_full_matrix(spline: DyadicSpline, data: st.DataObject) -> None:
    """Any stretch of free control points, weighted rows, rational bases too."""
    count = len(spline.points)
    ends = data.draw(st.lists(st.integers(0, count), min_size=2, max_size=2, unique=True))
    free = slice(min(ends), max(ends))
    t, vertices = rough()
    t, targets, weights = polyline_rows(spline.knots, spline.degree, t, vertices)
    targets = np.tile(targets[:, :1], (1, spline.points.shape[1]))
    held = spline.points.copy()
    held[free] = np.nan
    solved = solve_window(
        spline.knots,
        spline.degree,
        held,
        free,
        t,
        targets,
        weights,
        spline.weights if spline.rational else None,
    )
    true = dense_solution(spline, free, t, targets, weights)
    assert np.array_equal(solved[: free.start], spline.points[: free.start])
    assert np.array_equal(solved[free.stop :], spline.points[free.stop :])
    assert solved == pytest.approx(true, abs=1e-7 * (1 + np.abs(true).max()))


def test_a_spline_is_found_again() -> None:
    """Planted control points come back, wherever the data lies."""
    rng = np.random.default_rng(12)
    knots = np.concatenate(([0.0] * 4, np.sort(rng.random(20)), [1.0] * 4))
    points = rng.standard_normal((24, 2))
    t = np.sort(np.concatenate((np.linspace(0, 1, 200), knots[4:-4])))
    for offset in (0.0, 1e6, 1e12):
        moved = points + offset
        targets = evaluate(knots, moved, 3, t)
        held = moved.copy()
        held[3:-3] = 0
        solved = solve_window(knots, 3, held, slice(3, 21), t, targets, np.ones(len(t)))
        assert np.abs(solved - moved).max() <= 1e-11 + 1e-15 * offset


def test_the_whole_agrees_with_scipy() -> None:
    """Nothing held, rows of equal weight."""
    t, targets = rough(300)
    knots = np.concatenate(([0.0] * 4, np.linspace(0, 1, 20)[1:-1], [1.0] * 4))
    solved = solve_window(knots, 3, np.zeros((22, 2)), slice(0, 22), t, targets, np.ones(len(t)))
    assert solved == pytest.approx(make_lsq_spline(t, targets, knots, 3).c, abs=1e-9)


def test_nothing_free_is_nothing_to_solve() -> None:
    """The coefficients come back, as a copy."""
    points = np.array([[0.0], [1.0]])
    knots = np.array([0.0, 0, 1, 1])
    t = np.array([0.0, 1.0])
    solved = solve_window(knots, 1, points, slice(1, 1), t, points, np.ones(2))
    assert np.array_equal(solved, points)
    assert solved is not points


def test_rows_that_do_not_determine_the_points_are_refused() -> None:
    """Schoenberg-Whitney: a span without a row leaves a control point free."""
    knots = np.concatenate(([0.0] * 4, np.linspace(0, 1, 12)[1:-1], [1.0] * 4))
    t = np.linspace(0, 0.4, 100)
    for rows in (t, np.append(t, [1.0 - 1e-9, 1.0])):
        with pytest.raises(np.linalg.LinAlgError, match="do not determine the 14 free"):
            solve_window(
                knots, 3, np.zeros((14, 1)), slice(0, 14), rows, rows[:, None], np.ones(len(rows))
            )


@given(st.lists(st.integers(0, 8).map(lambda k: k / 8), min_size=3, max_size=3, unique=True))
def test_a_pivot_that_is_only_rounding_is_refused_too(places: list[float]) -> None:
    """Three distinct parameters do not determine four control points, whatever rounding says."""
    knots = np.repeat([0.0, 1.0], 4)
    t = np.repeat(sorted(places), 30)
    with pytest.raises(np.linalg.LinAlgError, match="do not determine"):
        solve_window(knots, 3, np.zeros((4, 1)), slice(0, 4), t, t[:, None], np.ones(len(t)))


@given(
    dyadic_splines(),
    st.lists(FRACTIONS, min_size=2, max_size=12, unique=True),
    st.booleans(),
)
def test_rows_of_a_polyline_always_suffice(
    spline: DyadicSpline, t: list[float], clustered: bool
) -> None:
    """However its vertices cluster, and on any interval that knots bound."""
    breaks = np.unique(spline.knots)
    vertices = np.unique(np.concatenate((t, breaks[[0, -1]])))
    if clustered:
        vertices = np.unique(np.concatenate((vertices, np.nextafter(vertices[1:-1], 1))))
    points = np.stack([np.cos(9 * vertices), np.sin(7 * vertices)], axis=1)
    rows, targets, weights = polyline_rows(spline.knots, spline.degree, vertices, points)
    count = len(spline.points)
    assert (np.diff(rows) > 0).all()
    assert len(rows) <= len(vertices) + (spline.degree + 3) * (len(breaks) - 1)
    assert weights.sum() == pytest.approx(1)
    at = rows.searchsorted(vertices)
    assert np.array_equal(rows[at], vertices)
    assert np.array_equal(targets[at], points)
    solved = solve_window(
        spline.knots, spline.degree, np.zeros((count, 2)), slice(0, count), rows, targets, weights
    )
    assert np.abs(solved).max() <= 1e3


def test_the_fit_judges_the_polyline_between_its_vertices() -> None:
    """A long chord counts as much as many short ones."""
    t = np.concatenate(([0.0], np.linspace(0.5, 1, 200)))
    points = np.where(t < 0.25, 0.0, 1.0)[:, None]
    knots = np.array([0.0, 0, 0.25, 0.5, 1, 1])
    rows, targets, weights = polyline_rows(knots, 1, t, points)
    solved = solve_window(knots, 1, np.zeros((4, 1)), slice(0, 4), rows, targets, weights)
    assert solved[:, 0] == pytest.approx([0, 0.5, 1, 1], abs=1e-9)


def test_cubics_converge_with_the_fourth_order() -> None:
    """Halving the spans leaves a sixteenth of the error."""
    errors = []
    t = np.linspace(0, 1, 4001)
    target = np.stack([np.cos(5 * t), np.sin(5 * t)], axis=1)
    for spans in (10, 20, 40):
        knots = np.concatenate(([0.0] * 4, np.linspace(0, 1, spans + 1)[1:-1], [1.0] * 4))
        count = spans + 3
        solved = solve_window(
            knots, 3, np.zeros((count, 2)), slice(0, count), t, target, np.ones(len(t))
        )
        errors.append(np.abs(evaluate(knots, solved, 3, t) - target).max())
    assert np.array(errors[:-1]) / errors[1:] == pytest.approx([16, 16], rel=0.15)
