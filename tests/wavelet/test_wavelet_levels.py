"""The curve of a level: the best approximation, computed only where the curve is finer."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import Interval, SampledSplice
from multirep.errors import EditError
from multirep.representations import WaveletBSpline
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.representations.wavelet.levels import at_level
from multirep.testing.spline_strategies import dyadic_splines


def graded(seed: int, count: int, domain: tuple[float, float] = (0, 1)) -> WaveletBSpline:
    """Random control points on random dyadic knots, in clusters down to level 20."""
    rng = np.random.default_rng(seed)
    u = rng.integers(1, 64, count) / 64
    cluster = rng.integers(1, 64) / 64 + rng.integers(-8, 9, 6) / 2.0 ** rng.integers(8, 21, 6)
    u = np.unique(np.concatenate((u, cluster[(cluster > 0) & (cluster < 1)])))
    knots = clamped(np.concatenate(([0.0], u, [1.0])))
    points = rng.normal(size=(len(knots) - 4, 2))
    return WaveletBSpline._of(Graded.of(Interval(*domain), knots, points))


def products(curve: WaveletBSpline, level: int) -> np.ndarray:
    """Integrals of the curve times each function of a level: Gauss nodes between all knots."""
    functions = WaveletBSpline(np.eye(2**level + 3))
    breaks = np.union1d(np.asarray(curve.knots), np.arange(2**level + 1) / 2**level)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    half = np.diff(breaks)[:, None] / 2
    t = (breaks[:-1, None] + half + half * nodes).ravel()
    return functions(t).T @ (curve(t) * (half * weights).reshape(-1, 1))


@given(seed=st.integers(0, 1000), count=st.integers(1, 60), level=st.integers(0, 5))
def test_what_a_level_leaves_out_is_orthogonal_to_it(seed, count, level):
    """The curve of level j is the one for which <f - f_j, N_i> = 0, i over the functions of j."""
    curve = graded(seed, count)
    coarse = curve.at_level(level)
    assert coarse.level <= level
    assert np.abs(products(curve, level) - products(coarse, level)).max() <= 1e-11 / 2**level


@pytest.mark.parametrize("finest", [1, 2, 3, 6, 9])
@given(fourths=st.integers(0, 36))
def test_levels_of_a_uniform_curve_are_those_of_its_pyramid(finest, fourths):
    """P c(j) + u Q d(j), and the curve itself from its finest level on."""
    rows = np.random.default_rng(finest).normal(size=(2**finest + 3, 2))
    curve, level = WaveletBSpline(rows), fourths / 4
    found = curve.at_level(level)
    if level >= finest:
        assert found.points is curve.points
        return
    wanted = curve.pyramid().control_points(level)
    assert found.size == len(wanted)
    assert np.abs(np.asarray(found.points) - wanted).max() <= 1e-12


@given(seed=st.integers(0, 1000), level=st.integers(8, 80))
def test_where_the_curve_is_coarse_it_keeps_its_bits(seed, level):
    """Beyond 40 spans of the level, and the three of the curve that they touch, no bit changes."""
    curve, level = graded(seed, 30), level / 4
    found = curve.at_level(level)
    u, scale = np.asarray(curve.knots), 2.0 ** int(level)
    t = np.linspace(0, 1, 500)
    away = np.ones(500, dtype=bool)
    for knot in u[(u * scale) % 1 != 0] * scale:
        first = u.searchsorted((np.floor(knot) - 40) / scale, "right") - 1
        last = u.searchsorted((np.ceil(knot) + 40) / scale)
        away &= (t < u[max(first - 3, 0)]) | (t > u[min(last + 3, len(u) - 1)])
    assert (found(t[away]) == curve(t[away])).all()


@given(seed=st.integers(0, 1000), level=st.integers(0, 10), cut=st.integers(0, 60))
def test_a_part_is_computed_alone(seed, level, cut):
    """Near a stretch the curve of a level does not need what lies far away."""
    curve = graded(seed, 50)
    low, high = cut / 64, (cut + 4) / 64
    part = at_level(curve._graded, level / 2, (low, high))
    t = np.linspace(low, high, 200)
    assert np.abs(part.evaluate(t) - curve.at_level(level / 2)(t)).max() <= 1e-9


@given(
    spline=dyadic_splines(degrees=(3, 3), max_inner=20, max_multiplicity=1),
    level=st.integers(0, 6),
)
def test_a_level_is_a_projection(spline, level):
    """Taking the same whole level twice takes nothing more away."""
    curve = WaveletBSpline._of(Graded.of(Interval(0, 1), spline.knots, spline.coefficients))
    once = curve.at_level(level)
    twice = once.at_level(level)
    t = np.linspace(0, 1, 300)
    assert np.abs(twice(t) - once(t)).max() <= 1e-13 * curve.magnitude


@given(seed=st.integers(0, 1000), level=st.integers(0, 60))
def test_levels_change_gradually(seed, level):
    """Between two levels the curve goes straight from one to the other, without a jump."""
    curve, t = graded(seed, 40), np.linspace(0, 1, 300)
    level, share = divmod(level, 4)
    one, two = curve.at_level(level)(t), curve.at_level(level + 1)(t)
    between = curve.at_level(level + share / 4)(t)
    assert np.abs(between - (one + share / 4 * (two - one))).max() <= 1e-12
    for near in (np.nextafter(level + 1, 0), level + 1 - 1e-9):
        assert np.abs(curve.at_level(near)(t) - two).max() <= 1e-8


def test_deep_curves_cost_what_they_hold():
    """A corner down to level 35 has any level in moments, without 2**35 numbers."""
    t = np.linspace(0, 1, 9)
    curve = WaveletBSpline.fit(SampledSplice(t, np.abs(t - 0.375)[:, None]), tolerance=1e-10)
    curve = curve.move_control_point(curve.size // 2, [1.0]).value
    assert curve.level > 30
    begin = time.perf_counter()
    sizes = [curve.at_level(level).size for level in (29.5, 20.25, 12)]
    assert time.perf_counter() - begin < 1.0
    assert max(sizes) < 1000


def test_levels_do_not_depend_on_the_domain():
    """T is only a name for the parameters."""
    one, two = graded(3, 40), graded(3, 40, (-3, 5))
    t = np.linspace(0, 1, 300)
    assert np.abs(one.at_level(3.5)(t) - two.at_level(3.5)(8 * t - 3)).max() <= 1e-13


@pytest.mark.parametrize("level", [-1, -0.001, float("nan")])
def test_negative_levels_are_refused(level):
    """There is nothing below the base curve."""
    with pytest.raises(EditError, match="levels begin at 0"):
        graded(1, 5).at_level(level)
