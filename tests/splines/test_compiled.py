"""The compiled core against the numpy functions that it stands for."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import attrs
import numpy as np
import pytest
from cores import both, core
from hypothesis import assume, given
from hypothesis import strategies as st

from multirep.bitwise import common_ends
from multirep.blocks import BlockArray
from multirep.errors import ToleranceError
from multirep.interval import Interval
from multirep.representations.nurbs import boehm
from multirep.representations.nurbs.changes import difference
from multirep.representations.nurbs.fitting import Breakpoints
from multirep.representations.nurbs.problem import KINK_HEIGHT, Course, Problem
from multirep.representations.nurbs.refinement import window_breakpoints
from multirep.representations.polyline.differences import _between_common
from multirep.representations.polyline.sampling import sample_stretch
from multirep.representations.polyline.simplification import simplify
from multirep.representations.wavelet import attempt, beginning, prediction
from multirep.representations.wavelet.analysis import analyse
from multirep.representations.wavelet.details import plus
from multirep.representations.wavelet.dyadic import halves, level_counts, recounted
from multirep.representations.wavelet.filters import (
    add_details,
    column_table,
    end_rows,
    refine_uniform,
)
from multirep.representations.wavelet.fitting import thinned
from multirep.representations.wavelet.graded import Graded, clamped
from multirep.representations.wavelet.target import Target
from multirep.sampled import SampledSplice, interpolate, join
from multirep.splines import compiled, evaluate, sampling
from multirep.splines.arrays import Array
from multirep.splines.basis import basis_functions, find_spans
from multirep.splines.deviation import spline_chord_deviation
from multirep.splines.least_squares import polyline_rows, solve_window
from multirep.splines.pieces import cut_stretch, rounding
from multirep.splines.polar import blossom
from multirep.splines.simplification import simplified

ROOT = Path(__file__).resolve().parents[2]
EPS = float(np.finfo(float).eps)

pytestmark = pytest.mark.skipif(compiled.core is None, reason="the core was not built")


def same(one: Any, two: Any) -> bool:
    """Whether two arrays have the same shape and bits."""
    return one.shape == two.shape and one.tobytes() == np.ascontiguousarray(two).tobytes()


class Spline(NamedTuple):
    knots: Array
    coefficients: Array
    degree: int
    rational: bool
    scale: float


@st.composite
def splines(draw: st.DrawFn, degrees: tuple[int, int] = (1, 7)) -> Spline:
    """Draw any degree, dimension and spacing: clustered and full knots, far coordinates."""
    p, d = draw(st.integers(*degrees)), draw(st.integers(1, 4))
    gaps = draw(st.lists(st.sampled_from([1.0, 0.5, 2.0**-20, 2.0**-40]), min_size=1, max_size=6))
    breaks = np.concatenate(([0.0], np.cumsum(gaps)))
    times = draw(st.lists(st.integers(1, p), min_size=len(breaks) - 2, max_size=len(breaks) - 2))
    inner = breaks[1:-1].repeat(np.array(times, dtype=int))
    knots = np.concatenate((np.repeat(breaks[0], p + 1), inner, np.repeat(breaks[-1], p + 1)))
    count = len(knots) - p - 1
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    scale = draw(st.sampled_from([1.0, 1e-9, 1e12]))
    offset = draw(st.sampled_from([0.0, 1.0, 1e6]))
    points = (rng.integers(-64, 65, (count, d)) / 64 + offset) * scale
    rational = draw(st.booleans())
    if rational:
        weights = rng.integers(1, 65, (count, 1)) / 16
        points = np.concatenate((points * weights, weights), axis=1)
    return Spline(knots, points, p, rational, scale * (1 + offset))


def parameters(spline: Spline, seed: int, count: int = 40) -> Array:
    """Parameters in the domain, the knots and their neighbours among them."""
    rng = np.random.default_rng(seed)
    near = np.concatenate((spline.knots, np.nextafter(spline.knots, np.inf)))
    stop = spline.knots[-1]
    return np.sort(np.concatenate((rng.random(count) * stop, np.minimum(near, stop))))


seeds = st.integers(0, 2**32 - 1)


@given(splines(), seeds, st.booleans())
def test_spans_and_basis_functions_have_the_same_bits(
    spline: Spline, seed: int, shuffled: bool
) -> None:
    """In order or not, inside the domain or beyond."""
    t = np.concatenate(([-1.0], parameters(spline, seed), [1e3]))
    if shuffled:
        np.random.default_rng(seed).shuffle(t)
    fast, pure = both(lambda: find_spans(spline.knots, spline.degree, t))
    assert same(fast, pure)
    fast, pure = both(lambda: basis_functions(spline.knots, spline.degree, t, fast))
    assert same(fast, np.ascontiguousarray(pure))


@given(splines(), seeds)
def test_polar_forms_have_the_same_bits(spline: Spline, seed: int) -> None:
    """Any arguments, near the span and far from it."""
    rng = np.random.default_rng(seed)
    t = parameters(spline, seed)
    spans = find_spans(spline.knots, spline.degree, t)
    arguments = rng.choice(t, (len(t), spline.degree))
    fast, pure = both(
        lambda: blossom(spline.knots, spline.coefficients, spline.degree, spans, arguments)
    )
    assert same(fast, pure)


class Line(NamedTuple):
    t: Array
    points: Array


def polyline(spline: Spline, seed: int, count: int) -> Line:
    """A polyline over the domain of a spline, rough, in as many coordinates as its points."""
    rng = np.random.default_rng(seed)
    inner = np.unique(rng.integers(1, 2**20, count)) * 2.0**-20
    t = np.concatenate(([0.0], inner * spline.knots[-1], spline.knots[-1:]))
    d = spline.coefficients.shape[1] - spline.rational
    points = rng.integers(-64, 65, (len(t), d)) / 64 * spline.scale
    return Line(t, points)


@given(splines(), seeds, st.integers(0, 30), st.sampled_from([None, 1, 7]))
def test_the_same_rows_are_chosen(
    spline: Spline, seed: int, count: int, per_span: int | None
) -> None:
    """Rows and weights to the bit, the polyline there to the last place."""
    line = polyline(spline, seed, count)
    fast, pure = both(lambda: polyline_rows(spline.knots, spline.degree, *line, per_span=per_span))
    assert same(fast[0], pure[0])
    assert np.abs(fast[1] - pure[1]).max() <= 4 * EPS * spline.scale
    assert same(fast[2], pure[2])


@given(splines((1, 5)), seeds, st.integers(0, 30), st.integers(0, 3), st.integers(0, 3))
def test_the_same_control_points_are_found(
    spline: Spline, seed: int, count: int, left: int, right: int
) -> None:
    """Whatever is held; to the condition of the normal equations. Errors are the same, too."""
    line = polyline(spline, seed, count)
    with core(False):
        rows = polyline_rows(spline.knots, spline.degree, *line)
    n = len(spline.coefficients)
    free = slice(min(left, n), max(n - right, min(left, n)))
    points, weights = spline.coefficients, None
    if spline.rational:
        weights = points[:, -1]
        points = points[:, :-1] / points[:, -1:]
    fast, pure = both(
        lambda: solve_window(spline.knots, spline.degree, points, free, *rows, weights)
    )
    assert np.abs(fast - pure).max() <= 1e-6 * spline.scale
    held = np.ones(n, dtype=bool)
    held[free] = False
    assert same(fast[held], points[held])

    def error() -> str:
        """No row beyond the first: not determined."""
        with pytest.raises(np.linalg.LinAlgError) as raised:
            solve_window(spline.knots, spline.degree, points, slice(0, n), *(x[:1] for x in rows))
        return str(raised.value)

    if n > 1:
        assert len(set(both(error))) == 1


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_rows_that_hardly_differ_determine_nothing(degree: int) -> None:
    """A small pivot counts as none, with the core and without."""
    knots = np.repeat([0.0, 1.0], degree + 1)
    t = 0.5 + 1e-6 * np.linspace(-1, 1, 20)

    def solved() -> Array:
        free, points = slice(0, degree + 1), np.zeros((degree + 1, 1))
        return solve_window(knots, degree, points, free, t, t[:, None], np.ones(20))

    for active in (True, False):
        with core(active), pytest.raises(np.linalg.LinAlgError, match="20 rows do not determine"):
            solved()


class Free(NamedTuple):
    """Ends at which nothing stands fixed; weights if the basis is rational."""

    degree: int
    weights: Array | None

    def knots(self, breakpoints: Breakpoints) -> Array:
        return breakpoints.at.repeat(breakpoints.times)

    def fixed(self, knots: Array, breakpoints: Breakpoints) -> tuple[Array, slice, Array | None]:
        n = len(knots) - self.degree - 1
        return np.zeros((n, 2)), slice(0, n), self.weights

    def roomy(self, breakpoints: Breakpoints) -> Breakpoints:
        return breakpoints


@given(splines((1, 4)), seeds, st.integers(1, 30), st.booleans(), st.booleans())
def test_a_trial_is_the_same(
    spline: Spline, seed: int, count: int, uniform: bool, emphasised: bool
) -> None:
    """Control points, rows, residuals and what they come to, in one call or in many."""
    rng = np.random.default_rng(seed)
    at, times = np.unique(spline.knots, return_counts=True)
    assume(np.diff(at).min() > 1e-3)
    t, _ = polyline(spline, seed, count)
    points = rng.integers(-64, 65, (len(t), 2)) / 64
    allowance = np.full(len(t) - 1, 0.5) if uniform else rng.integers(1, 9, len(t) - 1) / 8
    weights = spline.coefficients[:, -1].copy() if spline.rational else None
    course = Course.of(t, points, allowance)
    problem = Problem(spline.degree, course, Free(spline.degree, weights))
    breakpoints = Breakpoints(at, times)
    emphasis = None
    if emphasised:
        emphasis = 1 + rng.random(len(problem.tried(breakpoints).rows))
    fast, pure = both(lambda: problem.tried(breakpoints, emphasis))
    assert same(fast.knots, pure.knots)
    assert same(fast.rows, pure.rows)
    assert same(fast.firsts, pure.firsts)
    assert np.abs(fast.points - pure.points).max() <= 1e-7 * max(1.0, np.abs(pure.points).max())
    assert np.abs(fast.ratios - pure.ratios).max() <= 1e-7
    assert np.abs(fast.worst - pure.worst).max() <= 1e-7


@given(
    st.one_of(splines(), splines((1, 3))),
    seeds,
    st.integers(0, 12),
    st.integers(0, 3),
    st.sampled_from([None, 0.0, 0.5, 1e9]),
)
def test_deviations_are_proved_alike(
    spline: Spline, seed: int, count: int, splits: int, allowance: float | None
) -> None:
    """Never below what is seen; as sharp as without the core."""
    t, points = polyline(spline, seed, count)
    arguments = (spline.knots, spline.coefficients, spline.degree, t, points)
    limit = None if allowance is None else allowance * spline.scale
    fast, pure = both(
        lambda: spline_chord_deviation(
            *arguments, rational=spline.rational, splits=splits, allowance=limit
        )
    )
    assert np.abs(fast - pure).max() <= 1e-9 * pure.max()
    shares = np.linspace(0, 1, 50)[:-1, None]
    at = t[:-1] + shares * np.diff(t)
    line = points[:-1] + shares[..., None] * np.diff(points, axis=0)
    seen = evaluate(spline.knots, spline.coefficients, spline.degree, at.ravel())
    if spline.rational:
        seen = seen[:, :-1] / seen[:, -1:]
    off = np.linalg.norm(seen.reshape(line.shape) - line, axis=2)
    assert (off <= fast).all()


@given(seeds, st.integers(2, 40), st.integers(1, 4), st.sampled_from([1e-3, 1.0, 1e6]))
def test_courses_are_alike(seed: int, size: int, dimension: int, allowed: float) -> None:
    """Heights to rounding; the same vertices and middles, however close vertices stand."""
    rng = np.random.default_rng(seed)
    t = np.unique(np.concatenate((rng.random(size), [0.5, np.nextafter(0.5, 1)])))
    points = rng.integers(-64, 65, (len(t), dimension)) / 64
    allowance = allowed * rng.integers(1, 9, len(t) - 1) / 8
    fast, pure = both(lambda: Course.of(t, points, allowance))
    assert np.abs(fast.heights - pure.heights).max() <= 1e-12 * pure.heights.max()
    assume(same(fast.heights > KINK_HEIGHT, pure.heights > KINK_HEIGHT))
    assert same(fast.row_t, pure.row_t)
    assert same(fast.row_points, pure.row_points)
    assert set(t) <= set(fast.row_t)


@given(splines(), st.sampled_from([1e-1, 1e-2, 1e-4]), st.integers(0, 6), st.integers(1, 8))
def test_samples_are_alike(spline: Spline, tolerance: float, begin: int, length: int) -> None:
    """As many chords, where the first layout passed at the same places; all points the curve's."""
    last = float(spline.knots[-1])
    start, stop = begin / 8 * last, min(begin + length, 8) / 8 * last
    tolerance *= spline.scale
    fast, pure = both(
        lambda: sampling.sample_spline(
            *spline[:3], start, stop, tolerance=tolerance, rational=spline.rational
        )
    )
    t, points, bounds = fast
    assert t[0] == start
    assert t[-1] == stop
    assert (np.diff(t) > 0).all()
    assert points.shape == (len(t), pure[1].shape[1])
    assert (bounds <= tolerance).all()
    there = evaluate(spline.knots, spline.coefficients, spline.degree, t)
    assert same(points, there[:, :-1] / there[:, -1:] if spline.rational else there)
    # a share that is a whole number but for rounding may be rounded up or not
    assert abs(len(t) - len(pure[0])) <= 2 + 0.03 * len(pure[0])


@given(splines(degrees=(2, 5)), st.sampled_from([1e-2, 1e-4]))
def test_samples_come_out_the_same_when_nothing_is_rounded_otherwise(
    spline: Spline, tolerance: float
) -> None:
    """The same number of chords means the same chords."""
    stop = float(spline.knots[-1])
    fast, pure = both(
        lambda: sampling.sample_spline(
            *spline[:3], 0.0, stop, tolerance=tolerance * spline.scale, rational=spline.rational
        )
    )
    assume(len(fast[0]) == len(pure[0]))
    assume((pure[2] < 0.99 * tolerance * spline.scale).all())
    assert np.abs(fast[0] - pure[0]).max() <= 1e-6 * stop
    assert np.abs(fast[2] - pure[2]).max() <= 1e-5 * tolerance * spline.scale


def test_out_of_reach_is_said_as_without_the_core() -> None:
    """The core gives up; numpy says why."""
    knots, points = np.array([0, 0, 0, 0, 1, 1, 1, 1.0]), np.eye(4)[:, :2] + 1e6
    said = []
    for active in (True, False):
        with core(active), pytest.raises(ValueError, match="out of reach") as caught:
            sampling.sample_spline(knots, points, 3, 0.0, 1.0, tolerance=1e-12)
        said.append(str(caught.value))
    assert said[0] == said[1]


@st.composite
def targets(draw: st.DrawFn) -> tuple[Target, attempt.Problem, Array]:
    """Draw a polyline, the fit of it with or without pins, and dyadic knots."""
    rng = np.random.default_rng(draw(seeds))
    inner = draw(st.lists(st.integers(1, 255), min_size=2, max_size=20, unique=True))
    u = np.array([0, *sorted(inner), 256]) / 256
    t = np.concatenate(([0.0], np.unique(rng.integers(1, 2**12, 30)) * 2.0**-12, [1.0]))
    d = draw(st.integers(1, 4))
    scale = draw(st.sampled_from([1.0, 1e-9, 1e9]))
    points = rng.integers(-64, 65, (len(t), d)) / 64 * scale
    points += draw(st.sampled_from([0.0, 1e6])) * scale
    sampled = SampledSplice(t, points)
    target = Target.of(sampled, draw(st.sampled_from([1.0, 1e-3])) * scale)
    knots, local = np.arange(-2.0, 4.0) / 8, rng.integers(-64, 65, (2, 4, d)) / 64 * scale
    left, right = draw(st.tuples(st.booleans(), st.booleans()))
    frame = attempt.Frame(
        np.array([-3, -2, -1]) / 8 if left else np.zeros(3),
        np.array([9, 10, 11]) / 8 if right else np.ones(3),
        attempt.Piece(knots, local[0]) if left else None,
        attempt.Piece(knots + 0.9, local[1]) if right else None,
    )
    problem = attempt.Problem.of(target, Interval(0.0, 1.0), frame, scale)
    return target, problem, u


@given(targets())
def test_a_wavelet_fit_is_the_same(drawn: tuple[Target, attempt.Problem, Array]) -> None:
    """Control points, nets, proved ratios and bound."""
    target, problem, u = drawn
    fast, pure = both(lambda: problem.attempt(u))
    scale = max(np.abs(pure.points).max(), np.abs(target.points).max())
    assert np.abs(fast.points - pure.points).max() <= 1e-9 * scale
    assert np.abs(fast.nets - pure.nets).max() <= 1e-9 * scale
    rounded = 1e-9 * scale / problem.limits.min()
    assert np.abs(fast.ratios - pure.ratios).max() <= rounded
    assert abs(fast.bound - pure.bound) <= 1e-9 * scale


@given(
    targets(),
    st.tuples(st.integers(0, 2), st.integers(0, 2)),
    st.sampled_from([1, 3, 12]),
    st.sampled_from([1.1, 1.5, 3.0]),
)
def test_fits_are_thinned_alike(
    drawn: tuple[Target, attempt.Problem, Array], kept: tuple[int, int], rounds: int, more: float
) -> None:
    """The same knots are spared but for ties, within the limits, and those that are kept stay."""
    target, problem, u = drawn
    bends = target.points[:, :-1] * np.diff(target.t)
    slopes = np.cumsum(bends - bends.mean(axis=1, keepdims=True), axis=1)
    points = np.zeros_like(target.points)
    np.cumsum(slopes * np.diff(target.t), axis=1, out=points[:, 1:])
    problem = attrs.evolve(problem, target=target._replace(points=points, slopes=slopes))
    room = more * problem.attempt(u).bound + np.abs(points).max() / 1024
    problem = attrs.evolve(problem, limits=np.full(len(problem.limits), room))
    found = problem.attempt(u)
    fast, pure = both(lambda: thinned(problem, found, kept=kept, rounds=rounds))
    for thin in (fast, pure):
        assert thin.ratios.max() <= 1.0
        assert thin.bound <= room + problem.slack
        assert set(thin.u) <= set(u)
        assert same(thin.u[: 1 + kept[0]], u[: 1 + kept[0]])
        assert same(thin.u[len(thin.u) - 1 - kept[1] :], u[len(u) - 1 - kept[1] :])
    assert same(fast.u, pure.u)
    scale = max(np.abs(pure.points).max(), np.abs(points).max())
    again = problem.attempt(fast.u)
    for thin in (pure, again):
        assert np.abs(fast.points - thin.points).max() <= 1e-9 * scale
        assert np.abs(fast.nets - thin.nets).max() <= 1e-9 * scale
        assert abs(fast.bound - thin.bound) <= 1e-9 * scale
        assert same(fast.x, thin.x)


@given(targets())
def test_predictions_are_the_same(drawn: tuple[Target, attempt.Problem, Array]) -> None:
    """The polyline at any parameters, and what no polynomial explains on any spans."""
    target, _, u = drawn
    for t in (u, u[::-1], u[:, None] * np.array([0.0, 0.5, 1.0])):
        fast, pure = both(lambda t=t: target.at(t))
        assert same(fast[0], pure[0])
        assert same(fast[1], pure[1])
    for domain in (Interval(0.0, 1.0), Interval(0.125, 0.75)):
        fast, pure = both(
            lambda domain=domain: prediction.predict(target, u[:-1], u[1:], 2.0**-14, domain)
        )
        assert (np.sort(fast) == np.sort(pure)).all()


@given(
    st.lists(st.sampled_from([0.0, -0.0, 1.0]), max_size=12),
    st.lists(st.sampled_from([0.0, -0.0, 1.0]), max_size=12),
    st.integers(1, 2),
)
def test_common_rows_are_the_same(a: list[float], b: list[float], width: int) -> None:
    """Prefix and suffix, bit by bit; any lengths."""
    rows = [np.repeat(np.array(x), width).reshape(-1, width) for x in (a, b)]
    fast, pure = both(lambda: common_ends(*rows))
    assert fast == pure


@given(splines(), splines(), st.integers(0, 20), st.booleans())
def test_differences_are_the_same(spline: Spline, other: Spline, at: int, weighted: bool) -> None:
    """A knot more, another control point, or a different curve altogether."""
    p, knots, points = spline.degree, spline.knots, spline.coefficients
    changed = points.copy()
    changed[at % len(points)] += 1.0
    finer = np.sort(np.append(knots, knots[p] + (knots[-1] - knots[0]) / 3))
    longer = np.concatenate((points[: at % len(points)], points[:1], points[at % len(points) :]))
    domain = Interval(float(knots[0]), float(knots[-1]))
    for new_knots, new_points in ((knots, changed), (finer, longer), (knots, points)):
        pairs = [(BlockArray.of(points), BlockArray.of(new_points))]
        if weighted:
            pairs.append((BlockArray.of(points[:, 0]), BlockArray.of(new_points[:, 0])))
        both_knots = (BlockArray.of(knots), BlockArray.of(new_knots))
        fast, pure = both(lambda k=both_knots, r=tuple(pairs): difference(p, domain, k, r))
        assert fast == pure


@given(
    st.one_of(splines(), splines((1, 3))),
    st.lists(st.tuples(st.floats(0, 1), st.integers(1, 4)), min_size=1, max_size=6),
    st.booleans(),
)
def test_knots_are_inserted_alike(
    spline: Spline, places: list[tuple[float, int]], at_knots: bool
) -> None:
    """To the bit: one knot and many, often repeated ones, weights that differ here and there."""
    p, knots, points = spline.degree, spline.knots, spline.coefficients
    weights = None
    if spline.rational:
        weights = points[:, -1].copy()
        points = points[:, :-1] / points[:, -1:]
        weights[:-1] = 1 / 3
    domain = knots[p], knots[len(points)]
    breaks = np.unique(knots[(knots > domain[0]) & (knots < domain[1])])
    new = np.repeat([share * domain[1] for share, _ in places], [times for _, times in places])
    if at_knots and len(breaks):
        new = np.concatenate((new, breaks[::2], np.nextafter(breaks[1::2], 0.0)))
    new = np.sort(new[(new > domain[0]) & (new < domain[1])])
    assume(len(new))
    for added in (new, new[:1]):
        fast, pure = both(lambda new=added: boehm.inserted(knots, points, weights, p, new))
        assert (fast is None) == (pure is None)
        if fast is not None and pure is not None:
            assert same(fast.knots, pure.knots)
            assert same(fast.points, pure.points)
            assert weights is None or same(fast.weights, pure.weights)
            assert fast.splices == pure.splices


@given(st.lists(st.integers(0, 2**20), max_size=30))
def test_levels_are_counted_alike(numerators: list[int]) -> None:
    """Coarse dyadic numbers and the finest."""
    u = np.concatenate((np.array(numerators, dtype=float) / 2**20, [2.0**-46, 0.0, 1.0]))
    fast, pure = both(lambda: level_counts(u))
    assert same(fast, pure)
    fast, pure = both(lambda: recounted(pure, u[::2], u[1::3]))
    assert same(fast, pure)


@given(
    st.lists(
        st.tuples(st.integers(0, 2**10), st.integers(1, 2**12)).map(lambda k: k[0] / k[1] % 1.0),
        min_size=1,
        max_size=20,
    )
)
def test_spans_are_halved_alike(ends: list[float]) -> None:
    """Dyadic spans or not, to the bit."""
    u = np.unique([0.0, *ends, 1.0])
    fast, pure = both(lambda: halves(u[:-1], u[1:]))
    assert same(fast, pure)


@st.composite
def polylines(draw: st.DrawFn) -> Line:
    """Draw straight and rough stretches, short segments and long ones."""
    rng = np.random.default_rng(draw(seeds))
    count, d = draw(st.integers(2, 40)), draw(st.integers(1, 3))
    steps = rng.choice([1.0, 2.0**-10, 2.0**-30], count)
    moves = rng.integers(-1, 2, (count, d)) * (rng.random((count, 1)) < draw(st.floats(0, 1)))
    t = np.cumsum(steps)
    return Line(t, np.cumsum(moves, axis=0) + t[:, None])


@given(polylines(), seeds)
def test_polylines_are_looked_at_alike(line: Line, seed: int) -> None:
    """Points at parameters in any order, at vertices and beyond the ends."""
    rng = np.random.default_rng(seed)
    at = np.concatenate((line.t, rng.uniform(line.t[0] - 1, line.t[-1] + 1, 30)))
    rng.shuffle(at)
    for parameters_ in (at, at.reshape(2, -1) if len(at) % 2 == 0 else at, at[0]):
        fast, pure = both(lambda at=parameters_: interpolate(*line, at))
        assert same(fast, pure)


@given(polylines(), seeds, st.sampled_from([0.0, 1e-9, 1e-3, 1e-2]))
def test_stretches_of_polylines_are_the_same(line: Line, seed: int, tolerance: float) -> None:
    """From and to a vertex or a place between two: samples, rounding, corners."""
    rng = np.random.default_rng(seed)
    places = np.concatenate((line.t, rng.uniform(line.t[0], line.t[-1], len(line.t))))
    stretch = Interval(*np.sort(rng.choice(places, 2, replace=False)).tolist())
    assume(stretch.length > 0)
    t, points = map(BlockArray.of, line)
    fast, pure = both(lambda: sample_stretch(t, points, stretch, tolerance))
    assert same(fast.t, pure.t)
    assert same(fast.points, pure.points)
    assert (fast.bound, fast.breaks) == (pure.bound, pure.breaks)


@given(st.integers(2, 4), st.integers(1, 3), seeds)
def test_pieces_are_joined_alike(count: int, d: int, seed: int) -> None:
    """With a certificate for each chord or for all, with gaps at seams and without."""
    rng = np.random.default_rng(seed)
    pieces, start, end = [], 0.0, rng.random(d)
    for _ in range(count):
        m = int(rng.integers(2, 6))
        t = start + np.arange(m) / 8
        points = rng.random((m, d))
        points[0] = end + rng.integers(0, 2) * rng.integers(-1, 2, d) / 64
        start, end = t[-1], points[-1]
        bounds = rng.random(m - 1) if rng.integers(0, 2) else None
        breaks = (float(t[1]),) if rng.integers(0, 2) else ()
        pieces.append(SampledSplice(t, points, 1.0, breaks, bounds))
    fast, pure = both(lambda: join(pieces))
    assert fast.chord_bounds is not None
    assert same(fast.t, pure.t)
    assert same(fast.points, pure.points)
    assert same(fast.chord_bounds, pure.chord_bounds)
    assert (fast.bound, fast.breaks) == (pure.bound, pure.breaks)


def test_what_is_no_number_stays_in_a_joined_certificate() -> None:
    """Whatever follows it, the whole is not certified."""
    t = np.array([0.0, 1.0])
    pieces = [
        SampledSplice.unchecked(t + k, t[:, None], bound, (), np.array([bound]))
        for k, bound in enumerate((0.5, np.nan, 0.25))
    ]
    assert all(np.isnan(joined.bound) for joined in both(lambda: join(pieces)))


@given(polylines(), st.integers(1, 8))
def test_courses_and_targets_are_the_same(line: Line, eighths: int) -> None:
    """Heights of vertices, slopes of chords, corners and how near their knots must be."""
    allowance = np.full(len(line.t) - 1, 0.125)
    allowance[::3] *= eighths
    fast, pure = both(lambda: Course.of(*line, allowance))
    for one, two in zip(fast, pure, strict=True):
        assert np.abs(np.subtract(one, two, dtype=float)).max(initial=0.0) <= 1e-12
    sampled = SampledSplice(*line)
    for tolerance in (1e-9, 1.0):
        fast, pure = both(lambda tolerance=tolerance: Target.of(sampled, tolerance))
        for one, two in zip(fast[:5], pure[:5], strict=True):
            assert same(one, two)
        assert same(fast.corners, pure.corners)
        assert np.abs(fast.widths - pure.widths).max(initial=0.0) <= 1e-12


@given(polylines(), seeds, st.integers(1, 4))
def test_windows_begin_with_the_same_breakpoints(line: Line, seed: int, degree: int) -> None:
    """Knots on vertices and between, once or often, some an ulp apart, with corners and without."""
    rng = np.random.default_rng(seed)
    course = Course.of(*line, np.full(len(line.t) - 1, 2.0 ** rng.integers(-8, 2)))
    (start, stop), inner = line.t[[0, -1]], line.t[1:-1]
    knots = np.concatenate(
        (
            inner[rng.random(len(inner)) < 0.5],
            np.nextafter(inner[rng.random(len(inner)) < 0.2], stop),
            rng.uniform(start, stop, 5),
        )
    ).repeat(rng.integers(1, degree + 1))
    knots = np.sort(knots[(start < knots) & (knots < stop)])
    times = int(rng.integers(1, degree + 2)), int(rng.integers(1, degree + 2))
    fast, pure = both(lambda: window_breakpoints(knots, times, degree, course))
    assert same(fast.at, pure.at)
    assert fast.times.tolist() == pure.times.tolist()
    assert fast.times[[0, -1]].tolist() == [*times]


@pytest.mark.parametrize("level", [*range(1, 10), 13])
@pytest.mark.parametrize("scale", [1.0, 1e-12, 1e12])
def test_curves_are_analysed_alike(level: int, scale: float) -> None:
    """Coarse points and details of any dimension agree with the solves that pivot, or filter."""
    for d in (1, 2, 4):
        points = np.random.default_rng(level).normal(size=((1 << level) + 3, d)) * scale
        fast, pure = both(lambda points=points: analyse(points))
        for one, two in zip(fast, pure, strict=True):
            assert one.shape == two.shape
            assert np.abs(one - two).max() <= 1e-14 * np.abs(points).max()


@st.composite
def graded(draw: st.DrawFn) -> Graded:
    """Draw knots of many levels, control points of any dimension, any T."""
    inner = draw(st.lists(st.integers(1, 255), max_size=20, unique=True))
    u = clamped(np.array([0, *sorted(inner), 256]) / 256)
    rng = np.random.default_rng(draw(seeds))
    points = rng.integers(-640, 641, (len(u) - 4, draw(st.integers(1, 4)))) / 64
    domain = Interval(*draw(st.sampled_from([(0.0, 1.0), (-1.0, 2.0), (1e6, 1e6 + 1)])))
    return Graded.of(domain, u, points)


@given(graded(), st.integers(0, 10), st.floats(0, 1), st.integers(1, 8), seeds)
def test_changes_of_a_level_are_added_alike(
    curve: Graded, level: int, place: float, count: int, seed: int
) -> None:
    """One control point of a level or several, at the ends of T and inside, to the last bit."""
    first = int(place * ((1 << level) + 2))
    count = min(count, (1 << level) + 3 - first)
    rows = np.random.default_rng(seed).normal(size=(count, curve.points.shape[1]))
    fast, pure = both(lambda: plus(curve, level, first, rows))
    assert same(np.asarray(fast.u), np.asarray(pure.u))
    assert same(np.asarray(fast.points), np.asarray(pure.points))
    assert fast.magnitude == pure.magnitude


@given(
    st.integers(-6, 6),
    st.integers(1, 4),
    st.tuples(*[st.sampled_from([None, 0.0, 0.25, 0.95, 2.0])] * 2),
    st.tuples(*[st.tuples(st.integers(0, 2), st.integers(2, 12))] * 2),
    st.lists(st.tuples(st.integers(1, 63), st.integers(1, 64)), max_size=3),
    st.sampled_from([8, 12, 40]),
)
def test_fits_begin_with_the_same_knots(
    size: int,
    power: int,
    gaps: tuple[float | None, float | None],
    kept: tuple[tuple[int, int], tuple[int, int]],
    spikes: list[tuple[int, int]],
    level: int,
) -> None:
    """Old knots that stay, turns from old pieces, corners and predictions; the same refusals."""
    t = np.arange(65) / 64
    points = 2.0**size * (4 * t * (1 - t)) ** power
    for at, height in spikes:
        points[at] += height / 8
    target = Target.of(SampledSplice(t, points[:, None]), 1 / 64)
    pieces = [
        None if gap is None else attempt.Piece(np.arange(-2.0, 4.0) / 4 + end, np.full((4, 1), gap))
        for end, gap in zip((0.0, 0.75), (gap and gap / 64 for gap in gaps), strict=True)
    ]
    outside = np.array([-3.0, -2.0, -1.0]), np.array([2.0, 3.0, 4.0])
    frame = attempt.Frame(*outside, *pieces)
    inside = [np.arange(count + 1) * 2.0**-fine for count, fine in kept]
    ends = inside[0], 1 - inside[1][::-1]
    assume(ends[0][-1] < ends[1][0])
    domain, said = Interval(0.0, 1.0), []
    for active in (True, False):
        with core(active):
            try:
                u = beginning.beginning(target, ends, domain, frame, 2.0**-level)
                said.append(u.tolist())
            except ToleranceError as error:
                said.append(str(error))
    assert said[0] == said[1]


@given(st.integers(1, 40), st.integers(1, 4), seeds)
def test_uniform_curves_are_refined_alike(spans: int, d: int, seed: int) -> None:
    """Any number of spans; integers on a grid to the last bit."""
    points = np.random.default_rng(seed).integers(-640, 641, (spans + 3, d)) / 64
    fast, pure = both(lambda: refine_uniform(points))
    assert same(fast, pure)


@given(st.integers(0, 6), st.integers(1, 4), seeds, st.sampled_from([0.0, 0.25, 1.0]))
def test_details_are_added_alike(level: int, d: int, seed: int, share: float) -> None:
    """All of them or a share, on every level with columns of its own and above."""
    rng = np.random.default_rng(seed)
    details, points = rng.normal(size=(1 << level, d)), rng.normal(size=((2 << level) + 3, d))

    def added() -> Array:
        found = points.copy()
        add_details(found, details, share)
        return found

    fast, pure = both(added)
    assert np.abs(fast - pure).max() <= 32 * EPS * max(np.abs(points).max(), np.abs(details).max())


@given(polylines(), seeds)
def test_common_vertices_are_the_same(line: Line, seed: int) -> None:
    """Vertices moved, taken out, all of them others."""
    rng = np.random.default_rng(seed)
    for share in (0.0, 0.2, 1.0):
        t, points = line.t.copy(), line.points.copy()
        t += 2.0**-40 * (rng.random(len(t)) < share)
        points[rng.random(len(t)) < share] += 1.0
        left = rng.random(len(t)) >= share
        left[0] = True
        fast, pure = both(lambda t=t[left], points=points[left]: _between_common(*line, t, points))
        assert fast == pure


@given(splines(), st.floats(0, 1), st.floats(0, 1))
def test_stretches_are_cut_at_their_knots(spline: Spline, a: float, b: float) -> None:
    """The distinct knots around, the span that begins at each, and the rounding alike."""
    start, stop = min(a, b) * spline.knots[-1], max(a, b) * spline.knots[-1]
    assume(start < stop)
    pure = cut_stretch(*spline[:3], start, stop, spline.rational)
    knots = np.unique(spline.knots)
    around = knots[knots.searchsorted(start, "right") - 1 : knots.searchsorted(stop) + 1]
    assert same(pure.breaks, around)
    assert same(pure.knots[pure.spans], around[:-1])
    assert same(pure.knots[pure.spans + 1], around[1:])
    points = np.full((1, spline.coefficients.shape[1] - spline.rational), 0.5)
    found = both(lambda: rounding(pure, points))
    assert same(*map(np.asarray, found))


@given(polylines(), seeds, st.sampled_from([0.0, 1e-9, 0.1, 1.0, 10.0]))
def test_the_same_samples_are_dropped(line: Line, seed: int, allowed: float) -> None:
    """Round by round, with samples that must stay and ends that are pinned elsewhere."""
    rng = np.random.default_rng(seed)
    count = len(line.t)
    limits = allowed * rng.integers(0, 3, count - 1)
    keep = (rng.random(count) < 0.1).nonzero()[0]
    moved = line.points.copy()
    moved[[0, -1]] += 0.05
    fast, pure = both(lambda: simplify(line.t, moved, line.points, limits, keep))
    assert same(fast[0], pure[0])
    assert fast[1] == pure[1]


# -- the border between Python and C ---------------------------------------------------------------


@given(polylines(), st.sampled_from([1e-9, 1e-3, 0.1, 1.0]), st.booleans())
def test_the_same_vertices_are_kept(line: Line, limit: float, even: bool) -> None:
    """Thinning keeps the same vertices and knows the same deviations."""
    limits = limit if even else limit * (1 + np.arange(len(line.t) - 1) % 3)
    fast, pure = both(lambda: simplified(line.t, line.points, limits))
    assert same(fast[0], pure[0])
    assert same(fast[1], pure[1])


def test_what_does_not_fit_is_refused() -> None:
    """Indices out of bounds, lengths that do not agree, other types: errors, not crashes."""
    knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.zeros((3, 2))
    t, spans = np.array([0.5]), np.array([2])
    call = compiled.core
    with pytest.raises(ValueError, match="out of bounds"):
        call.blossom(knots, points, 2, np.array([3]), np.zeros((1, 2)), np.empty((1, 2)))
    with pytest.raises(ValueError, match="out of bounds"):
        call.basis_functions(knots, 2, t, np.array([0]), np.empty((1, 3)))
    with pytest.raises(ValueError, match="2 p \\+ 2 knots"):
        call.find_spans(knots[:4], 2, t, spans)
    with pytest.raises(ValueError, match="for each parameter"):
        call.find_spans(knots, 2, np.zeros(3), spans)
    with pytest.raises(ValueError, match="different lengths"):
        call.common(points, knots)
    with pytest.raises(ValueError, match="n \\+ p \\+ 1 knots"):
        call.sample(knots, points[:2], 2, False, 0.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="each chord a limit"):
        call.thin(knots + np.arange(6), np.zeros((6, 2)), np.ones(4), 0.0, 40, 6, 0.97)
    with pytest.raises(ValueError, match="between two vertices"):
        call.stretch(knots, np.zeros((6, 2)), 0, 1, 0.0, 1.0, 1.0, EPS, None, None)
    with pytest.raises(ValueError, match="room for the stretch"):
        call.stretch(knots, np.zeros((6, 2)), 1, 2, 0.0, 1.0, 1.0, EPS, t, np.empty((3, 2)))
    for given_, room in (((t, points[:1]), 1), ((knots, points), 4), ((knots[:3], points), 3)):
        rows = np.empty(room + 1), np.empty((room + 1, 2)), np.empty(room)
        with pytest.raises(ValueError, match=r"each sample needs|the whole"):
            call.join(((*given_, None, 0.0),), *rows)
    with pytest.raises(ValueError, match="at most 64 rounds"):
        call.thin(knots + np.arange(6), np.zeros((6, 2)), None, 1.0, 65, 6, 0.97)
    with pytest.raises(ValueError, match="two vertices"):
        call.polyline_rows(knots, 2, t, points[:1], 3, np.empty(9), points, t)
    with pytest.raises(ValueError, match="become 2 m \\+ 3"):
        call.refine_uniform(np.zeros((4, 2)), end_rows(1), np.empty((7, 2)))
    with pytest.raises(ValueError, match="first rows"):
        call.refine_uniform(points, end_rows(1), np.empty((3, 2)))
    with pytest.raises(ValueError, match="columns of eleven"):
        call.add_details(np.zeros((4, 2)), column_table(1), 1.0, np.zeros((11, 2)))
    with pytest.raises(ValueError, match="take m details"):
        call.add_details(np.zeros((4, 2)), column_table(3), 1.0, np.zeros((13, 2)))
    with pytest.raises(ValueError, match="two of them to be repeated"):
        call.analyse(np.zeros((7, 1)), np.ones((5, 11)), 4, np.empty((5, 1)), np.empty((2, 1)))
    with pytest.raises(ValueError, match="m \\+ 3 and m details"):
        call.analyse(np.zeros((7, 1)), np.ones((5, 11)), 0, np.empty((5, 1)), np.empty((3, 1)))
    room = np.empty(7), np.empty((4, 2)), None
    for new in ([0.0], [1.0], [np.nan], [2.0], [-1.0], [0.5, -1.0]):
        more = np.empty(6 + len(new)), np.empty((3 + len(new), 2)), None
        with pytest.raises(ValueError, match="inside the domain"):
            call.insert_knots(knots, points, None, 2, np.array(new), *more)
    with pytest.raises(ValueError, match="room for all"):
        call.insert_knots(knots, points, None, 2, np.array([0.2, 0.5]), *room)
    with pytest.raises(ValueError, match="room for all"):
        call.insert_knots(knots, points, np.ones(3), 2, t, *room)
    with pytest.raises(ValueError, match="n \\+ p \\+ 1 knots"):
        call.insert_knots(knots, points, None, 1, t, *room)
    with pytest.raises(TypeError, match="array of format d"):
        call.find_spans(knots.astype(np.float32), 2, t, spans)
    with pytest.raises(TypeError, match="expected 2 arguments"):
        call.common(points)  # type: ignore[call-arg]
    with pytest.raises((BufferError, ValueError)):
        call.recount(t, t, np.zeros(106, dtype=np.intp)[::2])
    spans.setflags(write=False)
    with pytest.raises((BufferError, ValueError)):
        call.find_spans(knots, 2, t, spans)


def test_what_could_be_read_beyond_its_end_is_refused() -> None:
    """Rows without columns, absurd degrees, ends and knots in the wrong order, empty intervals."""
    knots, t = np.array([0, 0, 0, 1, 1, 1.0]), np.array([0.5])
    call = compiled.core
    with pytest.raises(ValueError, match="without columns"):
        call.halves(t, t + 1.0, np.empty((1, 0)))
    for degree in (-1, 2**62, 2**63 - 1):
        with pytest.raises(ValueError, match="2 p \\+ 2 knots"):
            call.find_spans(knots, degree, t, np.array([2]))
    with pytest.raises(OverflowError):
        call.find_spans(knots, 2**63, t, np.array([2]))
    for start, stop in ((1.0, 0.0), (float("nan"), 1.0)):
        with pytest.raises(ValueError, match="interval"):
            call.sample(knots, np.zeros((3, 2)), 2, False, start, stop, 1.0)
    with pytest.raises(ValueError, match="interval"):
        call.sample(knots, np.zeros((3, 2)), 2, False, 0.0, float("inf"), 1.0)
    for place, bad in ((5, np.inf), (0, -np.inf), (2, np.nan), (2, -1.0), (3, -1.0)):
        broken = knots.copy()
        broken[place] = bad
        with pytest.raises(ValueError, match="finite and not descend"):
            call.sample(broken, np.eye(3), 2, False, 0.0, 1.0, 1e-3)
    rows, level = np.ones((1, 1)), np.arange(-6.0, 5.0)
    for first in (-9, 9):
        with pytest.raises(ValueError, match="beyond the changes"):
            call.plus(np.arange(5.0), np.arange(5.0), 1.0, first, level, rows, np.zeros((1, 1)))
    around, limits, nets = np.arange(3.0), np.ones(1), np.empty((4, 1, 2))
    line = np.array([0.0, 0.5]), np.zeros((1, 2)), np.zeros((1, 1))
    ends = np.empty(0), np.empty(0), np.zeros(1), np.ones(1)
    tables = 1, 0.0, 1.0, 1e-9, 0.25, np.ones((2, 1)), np.zeros(1)
    for old, rows in ((5, 4), (6, 3)):
        piece = np.arange(float(old)), np.zeros((rows, 1))
        with pytest.raises(ValueError, match="six knots and four"):
            call.beginning(*line, limits, *ends, *piece, None, None, *tables)
    with pytest.raises(ValueError, match="a width for each corner"):
        call.beginning(*line, limits, np.zeros(1), *ends[1:], None, None, None, None, *tables)
    for last in (0.0, np.nan, -1.0):
        ends = *ends[:3], np.array([last])
        with pytest.raises(ValueError, match="a stretch"):
            call.beginning(*line, limits, *ends, None, None, None, None, *tables)
    far = np.array([0.0, 0.5]), np.ones((1, 2)), np.zeros((1, 1)), limits * 0.0, np.empty(0)
    spans = np.array([0.0]), np.array([np.inf]), 1e-9, 0.0, 1.0, 0.25
    with pytest.raises(ValueError, match="without end"):
        call.predict(*far, *spans, np.ones((2, 1)), np.zeros(1))
    for x in ([0.0, 9.0, 0.5], [0.0, np.nan, 0.5], [0.0, 0.5, np.nan]):
        bare = (*line, limits, around, around, *[None] * 4, np.array(x))
        with pytest.raises(ValueError, match="ascend"):
            call.attempt(*bare, np.zeros((1, 5)), nets, np.empty(2))
        with pytest.raises(ValueError, match="ascend"):
            call.spare(*bare, nets, np.empty(2), 0, 0, 1)
    with pytest.raises(ValueError, match="do not fit the knots"):
        call.spare(*bare, nets, np.empty(3), 0, 0, 1)


@pytest.mark.parametrize("degree", [1, 3])
@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("allowance", [None, 1.0])
def test_what_is_no_number_is_never_proved(
    degree: int, rational: bool, allowance: float | None
) -> None:
    """A chord whose first piece has no bound has none, however good the next pieces are."""
    knots = np.array([0.0] * degree + [0, 1, 2, 3, 4, 5] + [5.0] * degree)
    coefficients = np.zeros((degree + 5, 1 + rational))
    coefficients[:, -1] = 1.0
    coefficients[0, 0] = np.nan
    line = np.array([0.0, 4.5, 5.0]), np.ones((3, 1))
    with np.errstate(invalid="ignore"):
        fast, pure = both(
            lambda: spline_chord_deviation(
                knots, coefficients, degree, *line, rational=rational, splits=1, allowance=allowance
            )
        )
    assert np.isnan(fast[0])
    assert np.isnan(pure[0])


def test_a_fit_that_is_no_number_proves_nothing() -> None:
    """A control point that is none spoils the bound and the ratio of every span that it reaches."""
    t, zero = np.array([0.0, 1.0]), np.zeros(1)
    points, nets, ratios = np.empty((1, 6)), np.empty((4, 1, 3)), np.empty(3)
    x, old = np.array([0.0, 0.25, 0.5, 1.0]), np.zeros((4, 1))
    spoilt = np.array([[np.nan], [0.0], [0.0], [0.0]])
    bound = compiled.core.attempt(
        *(t, np.zeros((1, 2)), zero[:, None], zero + 1.0, np.array([-3.0, -2.0, -1.0])),
        *(np.array([2.0, 3.0, 4.0]), np.array([-2.0, -1.0, 0.0, 0.25, 0.5, 1.0]), spoilt),
        *(np.array([0.0, 0.25, 0.5, 1.0, 2.0, 3.0]), old, x, points, nets, ratios),
    )
    assert bound is not None
    assert np.isnan(bound)
    assert np.isnan(ratios).all()


def test_a_far_parameter_is_found_from_anywhere() -> None:
    """To and fro between the ends of long knots and polylines, by bisection."""
    knots = np.concatenate(([0.0] * 3, np.arange(1001.0), [1000.0] * 3))
    t = np.array([999.5, 0.5, 1000.0, 3.0, 500.0, 8.0, 16.5, 0.0])
    fast, pure = both(lambda: find_spans(knots, 3, t))
    assert same(fast, pure)
    line = np.arange(1001.0), np.arange(1001.0)[:, None]
    fast, pure = both(lambda: interpolate(*line, t))
    assert same(fast, pure)


def test_arrays_may_lie_anywhere() -> None:
    """Strided, reversed, read-only, at odd addresses: what is read need not lie row after row."""
    knots = np.array([0, 0, 0, 1, 2, 2, 2.0])
    wide = np.arange(24.0).reshape(4, 6)
    spans, arguments = np.array([2, 3]), np.array([[0.5, 0.25], [1.5, 1.25]])
    with core(True):
        there = blossom(knots, wide[:, ::-2], 2, spans, arguments.T.copy().T)
        plain = blossom(knots, wide[:, ::-2].copy(), 2, spans, arguments)
        odd = np.ndarray(knots.shape, np.float64, b"odd" + knots.tobytes(), 3)
        beside = blossom(odd, wide[:, ::-2], 2, spans, arguments)
    assert same(there, plain)
    assert same(beside, plain)
    with pytest.raises(TypeError, match="array of format d, got =d"):
        compiled.core.halves(knots, knots, np.ndarray((7,), np.float64, bytearray(64), 3))


def test_everything_works_without_the_core() -> None:
    """`MULTIREP_PURE` in the environment: numpy alone does the work."""
    said = subprocess.run(
        [sys.executable, "-c", "from multirep.splines import compiled; print(compiled.active)"],
        cwd=ROOT,
        env=os.environ | {"MULTIREP_PURE": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert said.stdout.strip() == "False"
    suite = (
        "test_spline_least_squares.py",
        "test_spline_deviation.py",
        "test_spline_sampling.py",
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
        + [f"tests/splines/{name}" for name in suite],
        cwd=ROOT,
        env=os.environ | {"MULTIREP_PURE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
