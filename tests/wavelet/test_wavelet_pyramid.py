from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from multirep.errors import EditError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet import uniform
from multirep.representations.wavelet.analysis import MAX_LEVEL, analyse
from multirep.representations.wavelet.elimination import eliminated
from multirep.representations.wavelet.filters import (
    add_details,
    refine_uniform,
)
from multirep.representations.wavelet.graded import clamped
from multirep.representations.wavelet.pyramid import Pyramid
from multirep.splines.polar import refine
from multirep.testing import reference_wavelets as reference

FACTS = json.loads((Path(__file__).parent / "wavelets.json").read_text())
WORKED = FACTS["worked_decomposition"]

control_points = st.integers(1, 5).flatmap(
    lambda level: arrays(float, ((1 << level) + 3, 2), elements=st.integers(-640, 640))
)


@given(control_points)
def test_one_step_agrees_with_a_dense_solve(points):
    """Coarse points and the part that the details add are those of the matrices by definition."""
    coarse, details = analyse(points)
    expected, slow = reference.decompose(points)
    added = points - refine_uniform(coarse)
    level = (len(points) - 3).bit_length() - 1
    q = reference.floats(reference.wavelet_matrix(level))
    scale = max(1.0, np.abs(points).max())
    assert np.abs(coarse - expected).max() <= 1e-12 * scale
    assert np.abs(added - q @ slow).max() <= 1e-12 * scale
    assert len(details) == len(slow)


def test_worked_decomposition_is_reproduced():
    """Five levels of the worked example: control points, added parts and unit details."""
    pyramid = Pyramid.of(WORKED["input"])
    limit = WORKED["tolerances"]["coarse_control_points_abs"]
    for level, facts in WORKED["levels"].items():
        level = int(level)
        points = pyramid.control_points(level)
        assert np.abs(points - facts["c"]).max() <= limit
        added = np.zeros((2 ** (level + 1) + 3, 2))
        add_details(added, pyramid.details[level])
        assert (
            np.abs(added - facts["Q_d (normalisation-free: c^(j) - P^(j) c^(j-1))"]).max() <= limit
        )
        unit = pyramid.unit_details(level)
        assert np.abs(unit - facts["d_for_unit_L2_on_0_1_columns"]).max() <= limit
    recomposed = pyramid.control_points()
    assert np.abs(recomposed - WORKED["input"]).max() <= WORKED["tolerances"]["recompose_abs"]


def test_fractional_level_of_the_worked_curve_is_reproduced():
    """Half way between levels 2 and 3 the control points are the published ones."""
    facts = FACTS["fractional_level_2.5_of_worked_curve"]
    points = Pyramid.of(WORKED["input"]).control_points(2.5)
    assert np.abs(points - facts["C"]).max() <= 5e-14


@pytest.mark.parametrize("kind", ["noise", "smooth", "far", "tiny", "huge"])
def test_sixteen_levels_come_back_within_rounding(kind):
    """Decomposing and recomposing 65 539 points is exact to 1e-13 of their size."""
    t = np.linspace(0, 6, 2**16 + 3)
    points = {
        "noise": np.random.default_rng(1).normal(size=(len(t), 2)),
        "smooth": np.stack([np.cos(t), np.sin(t), t], axis=1),
        "far": np.stack([np.cos(t), np.sin(t)], axis=1) + 1e6,
        "tiny": 1e-12 * np.stack([np.cos(t), np.sin(t)], axis=1),
        "huge": 1e12 * np.stack([np.cos(t), t % 1], axis=1),
    }[kind]
    pyramid = Pyramid.of(points)
    assert pyramid.level == 16
    assert np.abs(pyramid.control_points() - points).max() <= 1e-13 * np.abs(points).max()


@pytest.mark.parametrize("level", [8, 9, 11])
def test_elimination_is_the_banded_solve(level):
    """Without a stored factor the same coarse points and details come out, up to rounding.

    The banded solve is that of numpy or of the compiled core, whichever is active.
    """
    points = np.random.default_rng(level).normal(size=(2**level + 3, 3)).cumsum(axis=0)
    size = np.abs(points).max()
    for one, two in zip(analyse(points), eliminated(points), strict=True):
        assert np.abs(one - two).max() <= 1e-14 * size


def test_uniform_curves_are_analysed_as_they_are(monkeypatch):
    """No knot is inserted one by one: the points are there, or halving all spans gives them."""

    def refused(*_):
        raise AssertionError("a knot was to be inserted")

    points = np.random.default_rng(5).normal(size=(2**6 + 3, 2))
    curve = WaveletBSpline(points)
    monkeypatch.setattr(uniform, "refine", refused)
    assert (np.asarray(uniform.uniform_points(curve._graded, 6)) == points).all()
    assert np.abs(curve.pyramid().control_points() - points).max() <= 1e-14
    assert np.abs(curve.pyramid(8).control_points(6) - points).max() <= 1e-14
    with pytest.raises(AssertionError, match="knot"):
        curve.refine((0.25, 0.5)).value.pyramid()


def test_graded_curves_are_made_uniform_level_by_level():
    """Inserting all knots of a level at once gives the same points, up to rounding."""
    points = np.random.default_rng(6).normal(size=(2**4 + 3, 2))
    graded = WaveletBSpline(points).refine((0.25, 0.5)).value._graded
    u, rows = np.asarray(graded.u), np.asarray(graded.points)
    for level in (5, 6, 9):
        knots = clamped(np.arange(2**level + 1) / 2**level)
        expected = refine(u, rows, 3, knots)
        assert np.abs(uniform.uniform_points(graded, level) - expected).max() <= 1e-14


def test_levels_beyond_the_stored_factors():
    """Details of level 13 that are put in come out again, and nothing else does."""
    rng = np.random.default_rng(3)
    coarse, details = rng.normal(size=(2**13 + 3, 2)), rng.normal(size=(2**13, 2))
    points = refine_uniform(coarse)
    add_details(points, details)
    found = analyse(points)
    assert np.abs(found[0] - coarse).max() <= 1e-13
    assert np.abs(found[1] - details).max() <= 1e-13


def test_details_do_not_see_where_the_origin_is():
    """Moving a curve far away moves its base, and details by rounding alone."""
    points = np.array(WORKED["input"], dtype=float)
    near, far = Pyramid.of(points), Pyramid.of(points + 2.0**30)
    for a, b in zip(near.details, far.details, strict=True):
        assert np.abs(a - b).max() <= 1e-12
    assert np.abs(far.base - near.base - 2.0**30).max() <= 2.0**30 * 1e-15


def test_coarse_curves_have_no_details():
    """A refined curve has zero details above its own level."""
    points = np.random.default_rng(2).normal(size=(11, 3))
    pyramid = Pyramid.of(refine_uniform(refine_uniform(points)))
    assert max(np.abs(details).max() for details in pyramid.details[3:]) <= 1e-14
    assert np.abs(pyramid.control_points(3) - points).max() <= 1e-14


def test_levels_are_orthogonal():
    """Pythagoras: the energies of base and details sum to that of the curve."""
    energy = FACTS["worked_decomposition"]["energy_check"]
    points = np.array(WORKED["input"], dtype=float)
    gram = reference.floats(reference.gram_matrix(5)) / 32
    total = np.einsum("id,ij,jd->d", points, gram, points)
    parts = np.array(energy["|f^0|^2_xy"]) + sum(
        np.array(facts["detail_L2_norm_squared_xy"]) for facts in WORKED["levels"].values()
    )
    assert total == pytest.approx(energy["|f^5|^2_xy"], rel=1e-13)
    assert total == pytest.approx(parts, rel=1e-13)


def test_analysis_of_a_local_change_decays_as_published():
    """A unit move of one of 4099 points leaves the published number of details above 1e-15."""
    points = np.zeros((4099, 1))
    points[2050] = 1.0
    for level, moved, details in FACTS["locality_fixture"]["values"]:
        points, detail = analyse(points)
        assert len(points) == 2**level + 3
        for array, expected in ((points, moved), (detail, details)):
            found = int((np.abs(array) > 1e-15 * np.abs(array).max()).sum())
            assert abs(found - expected) <= 2


def test_fractional_levels_join_the_integer_ones():
    """The display curve is continuous in the level and meets the curve of every integer level."""
    pyramid = Pyramid.of(WORKED["input"])
    for level in range(5):
        coarse, fine = pyramid.control_points(level), pyramid.control_points(level + 1)
        assert np.abs(pyramid.control_points(level + 1e-12) - refine_uniform(coarse)).max() < 1e-9
        assert np.abs(pyramid.control_points(level + 1 - 1e-12) - fine).max() < 1e-9


def test_truncating_keeps_the_coarse_levels():
    """The truncated pyramid is the same curve up to its level, and ends there."""
    pyramid = Pyramid.of(WORKED["input"])
    short = pyramid.truncated(3)
    assert short.level == 3
    assert (short.control_points() == pyramid.control_points(3)).all()


def test_absent_levels_are_refused():
    """The message says which levels there are."""
    pyramid = Pyramid.of(WORKED["input"])
    for bad in (-0.5, 5.5, float("nan")):
        with pytest.raises(EditError, match="levels 0 to 5"):
            pyramid.control_points(bad)
    with pytest.raises(EditError, match="levels 0 to 5"):
        pyramid.truncated(6)
    with pytest.raises(ValueError, match="levels 1 to 20"):
        analyse(np.zeros((2 ** (MAX_LEVEL + 1) + 3, 1)))
