"""The shortest change that meets linear conditions, against the pseudo-inverse of the matrix."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.splines import basis_functions, find_spans, least_norm


def system(
    n: int, m: int, degree: int, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Rows of m well separated points of a spline with n control points, and the matrix itself."""
    rng = np.random.default_rng(seed)
    knots = np.r_[[0.0] * degree, np.linspace(0, 1, n - degree + 1), [1.0] * degree]
    t = (np.arange(m) + rng.uniform(0.3, 0.7, m)) / m
    spans = find_spans(knots, degree, t)
    rows = basis_functions(knots, degree, t, spans)
    matrix = np.zeros((m, n))
    np.put_along_axis(matrix, (spans - degree)[:, None] + np.arange(degree + 1), rows, axis=1)
    return spans - degree, rows, rng.normal(size=(m, 2)), matrix


@given(
    st.integers(1, 4),
    st.integers(1, 60),
    st.integers(2, 4),
    st.integers(0, 99),
    st.booleans(),
)
def test_it_is_the_pseudo_inverse(degree: int, m: int, spread: int, seed: int, held: bool) -> None:
    """Few rows (dense) and many (banded), all control points free or the two ends held."""
    n = spread * m + degree + 1
    starts, rows, wanted, matrix = system(n, m, degree, seed)
    free = np.ones(n, dtype=bool)
    if held:
        free[[0, -1]] = False
    found = least_norm(starts, rows, wanted, free)
    expected = np.linalg.pinv(matrix * free) @ wanted
    if found.quality > 1e-3:
        np.testing.assert_allclose(matrix @ found.change, wanted, atol=1e-11)
        np.testing.assert_allclose(found.change, expected, atol=1e-9 / found.quality)
    assert (found.change[~free] == 0).all()


@pytest.mark.parametrize("count", [2, 5, 40])
def test_rows_that_repeat_are_found(count: int) -> None:
    """The quality is 0, nothing moves, and the culprits hold both copies."""
    starts, rows, wanted, _ = system(4 * count, count, 3, 0)
    k = count // 2
    order = np.insert(np.arange(count), k, k)
    found = least_norm(starts[order], rows[order], wanted[order], np.ones(4 * count, dtype=bool))
    assert found.quality == 0
    assert not found.change.any()
    assert {k, k + 1} <= set(found.culprits.tolist())


def test_more_rows_than_free_control_points_have_no_solution() -> None:
    """However they lie."""
    starts, rows, wanted, _ = system(6, 3, 3, 0)
    free = np.zeros(6, dtype=bool)
    free[2:4] = True
    found = least_norm(starts, rows, wanted, free)
    assert found.quality == 0
    assert len(found.culprits) == 3


def test_a_row_without_free_control_points_has_no_quality() -> None:
    """It is its own culprit."""
    starts, rows, wanted, _ = system(12, 2, 3, 1)
    free = np.ones(12, dtype=bool)
    free[starts[1] : starts[1] + 4] = False
    found = least_norm(starts, rows, wanted, free)
    assert found.quality == 0
    assert 1 in found.culprits.tolist()
