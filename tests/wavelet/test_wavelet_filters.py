from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from multirep.representations.wavelet.filters import (
    END_COLUMNS,
    INTERIOR,
    add_details,
    columns,
    level_of,
    point_count,
    refine_uniform,
    unit_scale,
)
from multirep.testing import reference_wavelets as reference

FACTS = json.loads((Path(__file__).parent / "wavelets.json").read_text())
LEVELS = [1, 2, 3, 4, 5]


def uniform_knots(spans: int) -> np.ndarray:
    return np.r_[0, 0, 0, np.linspace(0, 1, spans + 1), 1, 1, 1]


def fractions(rows: list[list[str]]) -> reference.Matrix:
    return [[Fraction(entry) for entry in row] for row in rows]


def wavelets(level: int) -> np.ndarray:
    """Q as the fast code applies it, one column a unit detail."""
    matrix = np.zeros((point_count(level), 1 << (level - 1)))
    add_details(matrix, np.eye(1 << (level - 1)))
    return matrix


@pytest.mark.parametrize("level", LEVELS)
def test_the_reference_reproduces_the_published_matrices_exactly(level):
    """P, Q and G by definition are the fractions in the facts."""
    facts = FACTS["levels"][str(level)]
    assert reference.refinement_matrix(level) == fractions(facts["P"])
    assert reference.wavelet_matrix(level) == fractions(facts["Q"])
    if level <= 3:
        assert reference.gram_matrix(level) == fractions(facts["gram_G_j"])


@pytest.mark.parametrize("level", LEVELS)
def test_refining_is_the_matrix_p_to_the_last_bit(level):
    """The stencil applied to unit vectors gives the dyadic entries of P exactly."""
    expected = reference.floats(reference.refinement_matrix(level))
    assert (refine_uniform(np.eye(point_count(level - 1))) == expected).all()


@given(spans=st.integers(1, 40))
def test_refining_any_number_of_spans_keeps_the_curve(spans):
    """The stencil also serves span counts that are no power of two; scipy evaluates both."""
    coarse = np.random.default_rng(spans).normal(size=(spans + 3, 2))
    t = np.linspace(0, 1, 101)
    before = BSpline(uniform_knots(spans), coarse, 3)(t)
    after = BSpline(uniform_knots(2 * spans), refine_uniform(coarse), 3)(t)
    assert np.abs(before - after).max() < 1e-13


@pytest.mark.parametrize("level", [*LEVELS, 6])
def test_columns_of_q_are_the_exact_integers_scaled(level):
    """Every column is its column of coprime integers divided by one number."""
    exact = reference.floats(reference.wavelet_matrix(level))
    fast = wavelets(level)
    ratio = np.abs(exact).max(axis=0) / np.abs(fast).max(axis=0)
    assert (np.abs(fast * ratio - exact) <= 4e-16 * np.abs(exact).max(axis=0)).all()


@pytest.mark.parametrize("level", [*LEVELS, 6])
def test_integer_columns_are_orthogonal_to_everything_coarser_exactly(level):
    """The transposed P times G times Q is zero in exact arithmetic."""
    p, g = reference.refinement_matrix(level), reference.gram_matrix(level)
    ends = END_COLUMNS[min(level, 4)]
    half = 1 << (level - 1)
    for k in range(half):
        place = min(k, half - 1 - k)
        column = list(ends[place]) if place < len(ends) else list(INTERIOR)
        first = 2 * k - 3 if place >= len(ends) else k
        vector = [0] * (2 * half + 3)
        if place < len(ends) and k != place:
            vector[2 * half + 3 - place - len(column) : 2 * half + 3 - place] = column[::-1]
        else:
            vector[first : first + len(column)] = column
        product = [sum(a * b for a, b in zip(row, vector, strict=True) if b) for row in g]
        assert all(
            sum(row[i] * product[r] for r, row in enumerate(p) if row[i]) == 0
            for i in range(half + 3)
        )


@pytest.mark.parametrize("level", [*LEVELS, 6])
def test_every_wavelet_has_peak_one(level):
    """The curve of one unit detail reaches 1 somewhere and never more."""
    curve = BSpline(uniform_knots(1 << level), wavelets(level), 3)
    t = np.linspace(0, 1, 64 * (1 << level) + 1)
    peaks = np.abs(curve(t)).max(axis=0)
    assert (peaks <= 1 + 1e-14).all()
    assert (peaks >= 1 - 1e-3).all()


@pytest.mark.parametrize("level", LEVELS)
def test_unit_scale_is_the_norm_on_the_unit_interval(level):
    """The square of each scale is the integral of the square of its wavelet."""
    fast = wavelets(level)
    gram = reference.floats(reference.gram_matrix(level)) / (1 << level)
    norms = np.sqrt(np.einsum("ik,ij,jk->k", fast, gram, fast))
    assert norms == pytest.approx(unit_scale(level), rel=1e-13)


def test_scaled_columns_agree_with_the_printed_primer():
    """The published decimals are our columns under the published factor, to the last digit."""
    published = FACTS["published_check"]
    factor = np.sqrt(5 * 2.0**4 / 675221664)
    for place, name in enumerate(("col0", "col1", "col2")):
        column = columns(4)[0][place] / (unit_scale(4)[place] * factor)
        assert np.abs(column - published[name]).max() <= 5.01e-7
    for place, name in enumerate(("Q3_col0_unit_L2", "Q3_col1_unit_L2")):
        column = columns(3)[0][place] / unit_scale(3)[place]
        assert np.abs(column - np.array(published[name])).max() <= 5.01e-7


def test_level_and_count_are_inverse():
    """A count that no level has is refused, and the message says which there are."""
    assert [level_of(point_count(level)) for level in range(20)] == list(range(20))
    with pytest.raises(ValueError, match=r"4, 5, 7, 11"):
        level_of(6)
