from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import Interval, SampledSplice
from multirep.errors import EditError, ParameterError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet.filters import refine_uniform
from multirep.scene import Scene
from multirep.testing import check_edit
from multirep.tools import Sweep


@cache
def curve(dimension: int = 2, domain: tuple[float, float] = (0.0, 1.0)) -> WaveletBSpline:
    """Detail in one place only, so that the knots are graded."""
    t = np.linspace(*domain, 600)
    s = np.linspace(0, 1, 600)
    wiggle = 0.05 * np.sin(200 * s) * np.exp(-((s - 0.6) ** 2) / 0.001)
    points = np.stack([np.cos((3 + k) * s) + wiggle for k in range(dimension)], axis=1)
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-3)


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("domain", [(0.0, 1.0), (-3.0, 4.0), (1e6, 1e6 + 1.0)])
@given(place=st.integers(0, 64), level=st.integers(0, 48))
def test_sweeps_land_on_their_target(dimension, domain, place, level):
    """At any place and any level, whole or not, the curve passes through the target."""
    value = curve(dimension, domain)
    t = domain[0] + place / 64 * (domain[1] - domain[0])
    to = value(t) + 0.3
    edit = check_edit(value, value.sweep(t, to, level / 4))
    assert np.abs(edit.value(t) - to).max() <= 1e-13


@given(place=st.integers(0, 256), level=st.integers(0, 5))
def test_a_sweep_is_the_smallest_change_of_its_level_refined(place, level):
    """On a uniform curve it is P .. P B (to - f) / |B|**2, control point by control point."""
    rows = np.random.default_rng(place).normal(size=(67, 2))
    value = WaveletBSpline(rows)
    t = place / 256
    span = min(int(t * 2**level), 2**level - 1)
    to = np.array([3.0, -1.0])
    basis = WaveletBSpline(np.eye(2**level + 3))(t)
    assert np.count_nonzero(basis) <= 4
    assert basis[span : span + 4].sum() == pytest.approx(1.0)
    change = basis[:, None] * (to - value(t)) / (basis @ basis)
    for _ in range(6 - level):
        change = refine_uniform(change)
    swept = value.sweep(t, to, level).value
    assert np.abs(np.asarray(swept.points) - (rows + change)).max() <= 1e-13
    untouched = (change == 0.0).all(axis=1)
    assert (np.asarray(swept.points)[untouched] == rows[untouched]).all()


@pytest.mark.parametrize("level", [3, 5, 9])
def test_a_sweep_leaves_finer_details_and_everything_outside_alone(level):
    """Seven spans change at most; the details above the level stay within rounding."""
    value = curve()
    t, h = 0.3, 2.0**-level
    edit = value.sweep(t, value(t) + np.array([0.1, 0.2]), level)
    first = np.floor(t / h)
    far = np.r_[np.linspace(0, (first - 3) * h, 200), np.linspace((first + 4) * h, 1, 200)]
    far = far[(far >= 0) & (far <= 1)]
    assert np.abs(edit.value(far) - value(far)).max() <= 1e-14
    outside = np.array([not edit.splices.contains(float(s)) for s in far])
    assert (edit.value(far[outside]) == value(far[outside])).all()
    finest = max(level, value.level)
    before, after = value.pyramid(finest), edit.value.pyramid(finest)
    for a, b in zip(before.details[level:], after.details[level:], strict=True):
        assert np.abs(a - b).max() <= 1e-13


def test_the_width_shrinks_smoothly_from_level_to_level():
    """The width at a tenth of the height is the published one between levels 4 and 5."""
    flat = WaveletBSpline(np.zeros((4, 1)))
    t = np.linspace(0, 1, 20001)
    widths = []
    for share in (0.0, 0.3, 0.7, 1.0):
        height = flat.sweep(0.5, [1.0], 4 + share).value(t)[:, 0]
        assert height.min() >= -1e-15
        assert height.max() <= 1 + 1.6e-5
        widths.append(np.mean(height > 0.1))
    assert widths == pytest.approx([0.223, 0.204, 0.153, 0.111], abs=2e-3)


def test_a_sweep_refines_only_where_the_curve_is_coarser():
    """On a curve that has the knots of the level, no knot is inserted."""
    value = WaveletBSpline(np.random.default_rng(0).normal(size=(67, 2)))
    assert value.sweep(0.4, [1.0, 1.0], 5).value.size == value.size
    assert value.sweep(0.4, [1.0, 1.0], 8).value.size > value.size


def test_a_place_is_needed_and_levels_have_limits():
    """Neither, both, a level below 0 or beyond the finest: refused with the numbers."""
    value = curve()
    with pytest.raises(EditError, match="neither"):
        Sweep(to=(0.0, 0.0), level=1).edit(value, Scene())
    with pytest.raises(EditError, match="0 to 46"):
        value.sweep(0.5, [0.0, 0.0], 46.5)
    with pytest.raises(EditError, match="2 coordinates"):
        Sweep(t=0.5, to=(0.0,), level=1).edit(value, Scene())
    with pytest.raises(ParameterError):
        value.sweep(1.5, [0.0, 0.0], 1)
    assert Interval(0.0, 1.0) == value.domain
