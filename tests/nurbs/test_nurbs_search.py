"""The parts of the search for knots, each against its definition."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nurbs_cases import SMOOTH, course

from multirep.arrays import Array
from multirep.representations.nurbs import Nurbs
from multirep.representations.nurbs.equalizing import HELPERS, equalized, relieved
from multirep.representations.nurbs.fitting import OpenEnds
from multirep.representations.nurbs.problem import Breakpoints, Course, Problem
from multirep.representations.nurbs.refinement import kinks, merged_breakpoints, refined
from multirep.representations.nurbs.search import evened
from multirep.sampled import SampledSplice
from multirep.splines import simplified
from multirep.testing.strategies import polylines


def even(count: int, degree: int) -> Breakpoints:
    times = np.ones(count + 1, dtype=np.intp)
    times[[0, -1]] = degree + 1
    return Breakpoints(np.linspace(0, 1, count + 1), times)


def problem(name: str, tolerance: float, degree: int = 3) -> Problem:
    made = Course.from_sampled(course(name, 1001), tolerance)
    return Problem(degree, made, OpenEnds(degree, made.points[0], made.points[-1]))


@given(polylines(max_size=40), st.sampled_from([0.01, 0.3, 2.0]), st.booleans())
def test_simplification_knows_its_deviation(
    line: tuple[Array, Array], share: float, uneven: bool
) -> None:
    """On each new chord it is the largest distance of the old vertices, within the share."""
    t, points = line
    allowance = np.ones(len(t) - 1)
    if uneven:
        allowance[::2] = 0.25
    kept, deviation = simplified(t, points, share * allowance)
    assert kept[0] == 0
    assert kept[-1] == len(t) - 1
    assert (np.diff(kept) > 0).all()
    coarse = SampledSplice(t[kept], points[kept])
    off = np.linalg.norm(coarse(t) - points, axis=1)
    for (a, b), found in zip(pairwise(kept), deviation, strict=True):
        largest = off[a : b + 1].max()
        assert largest <= found <= largest + 1e-12 * (1 + np.abs(points).max())
        for i in range(a + 1, b):
            assert off[i] <= share * min(allowance[i - 1], allowance[i]) * (1 + 1e-9)


def test_simplification_leaves_few_vertices() -> None:
    """At most 1.7 times as many as the best polyline of that sagitta."""
    for name in SMOOTH:
        sampled = course(name, 20_001)
        kept, deviation = simplified(sampled.t, sampled.points, np.full(20_000, 0.05e-3))
        slopes = np.diff(sampled.points, axis=0) / np.diff(sampled.t)[:, None]
        bend = np.linalg.norm(np.diff(slopes, axis=0), axis=1)
        best = np.sqrt(bend * np.diff(sampled.t)[1:] / (8 * 0.05e-3)).sum()
        assert len(kept) <= 1.7 * best + 4
        assert deviation.max() <= 0.05e-3 * (1 + 1e-9)


@pytest.mark.parametrize("name", SMOOTH)
def test_equalizing_makes_the_largest_residual_smaller(name: str) -> None:
    """With about as many spans, the largest residual falls to a fraction."""
    asked = problem(name, 1.0)
    before = asked.tried(even(160, 3))
    trial = before
    smallest = float(before.worst.max())
    for _ in range(10):
        trial = asked.tried(equalized(3, trial, target=float(trial.worst.mean())))
        if len(trial.worst) <= 176:
            smallest = min(smallest, float(trial.worst.max()))
    assert smallest <= 0.4 * before.worst.max()


def test_equalizing_leaves_corners_where_they_are() -> None:
    """Between knots of full multiplicity each stretch is laid out by itself."""
    asked = problem("zigzag", 1e-3)
    corners = np.array([0.25, 0.5])
    begin = merged_breakpoints(even(40, 3), corners, [corners], 3)
    after = equalized(3, asked.tried(begin))
    at, times = after
    assert times[np.isin(at, corners)].tolist() == [3, 3]
    assert (times[1:-1][~np.isin(at[1:-1], corners)] == 1).all()
    assert times[[0, -1]].tolist() == [4, 4]


@pytest.mark.parametrize("name", ["zigzag", "spiral"])
def test_relieving_moves_nothing_but_failing_spans_and_their_neighbours(name: str) -> None:
    """Each stretch of them gets one span at least, far fewer than one for each that fails."""
    asked = problem(name, 1.0)
    begin = merged_breakpoints(even(40, 3), np.array([0.5]), [np.array([0.5])], 3)
    level = float(np.sort(asked.tried(begin).worst)[-8])
    asked = problem(name, level)  # so that seven fail
    trial = asked.tried(begin)
    at, failing = trial.breakpoints.at, np.flatnonzero(trial.worst > 1.0)
    assert len(failing) == 7
    after, times = relieved(3, trial)
    near = np.abs(np.arange(40)[:, None] - failing).min(axis=1) <= HELPERS
    beside = np.concatenate(([False], near)) & np.concatenate((near, [False]))
    assert np.isin(at[~beside], after).all()
    assert 0 < len(after) - len(at) <= 7
    assert times[after == 0.5].tolist() == [3]
    assert times[[0, -1]].tolist() == [4, 4]
    assert asked.tried(Breakpoints(after, times)).worst.max() < trial.worst.max()


def test_only_what_stands_out_beside_its_neighbours_may_become_a_corner() -> None:
    """The tip of a roof may, the vertices of a line that is jagged all along may not."""
    t = np.linspace(0, 1, 41)
    roof = np.stack([t, 0.1 * np.minimum(t, 1 - t)], axis=1)
    jagged = np.stack([t, 1e-3 * (-1.0) ** np.arange(41)], axis=1)
    allowance = np.full(40, 1e-3)
    assert np.flatnonzero(kinks(Course.of(t, roof, allowance))).tolist() == [20]
    assert not kinks(Course.of(t, jagged, allowance)).any()
    assert kinks(Course.of(t, 100 * jagged, allowance))[1:-1].all()


def test_a_line_jagged_within_a_few_allowances_takes_no_corners() -> None:
    """A knot at each vertex serves all kinks; a corner each would cost three."""
    rng = np.random.default_rng(3)
    points = np.stack([np.linspace(0, 1, 301), 3e-3 * rng.normal(size=301)], axis=1)
    sampled = SampledSplice(np.linspace(0, 1, 301), points)
    curve = Nurbs.fit(sampled, tolerance=2e-3)
    inner = np.asarray(curve.knots)[4:-4]
    assert np.unique(inner, return_counts=True)[1].max() == 1
    assert curve.size <= 1.1 * 301


@pytest.mark.parametrize("name", SMOOTH)
def test_evening_lowers_the_largest_residual(name: str) -> None:
    """A trial slightly above its allowance passes on the same knots."""
    asked = problem(name, 1.0)
    worst = float(asked.tried(even(60, 3)).worst.max())
    asked = problem(name, worst / 1.05)
    trial = asked.tried(even(60, 3))
    assert trial.worst.max() == pytest.approx(1.05)
    better = evened(asked, trial)
    assert better is not None
    assert better.worst.max() <= 1.0
    assert (better.breakpoints.at == trial.breakpoints.at).all()


def test_residuals_are_what_they_say() -> None:
    """Over the allowance at the rows, and the largest of each span's rows."""
    sampled = course("spiral", 301)
    bounds = np.linspace(0, 1e-3, 300)
    uneven = SampledSplice(sampled.t, sampled.points, 1e-3, (), bounds)
    made = Course.from_sampled(uneven, 1e-3)
    asked = Problem(3, made, OpenEnds(3, made.points[0], made.points[-1]))
    trial = asked.tried(even(20, 3))
    from scipy.interpolate import BSpline

    off = BSpline(trial.knots, trial.points, 3)(trial.rows) - sampled(trial.rows)
    chord = np.clip(sampled.t.searchsorted(trial.rows, "right") - 1, 0, 299)
    beside = np.clip(sampled.t.searchsorted(trial.rows, "left") - 1, 0, 299)
    allowed = np.minimum(uneven.allowance(1e-3)[chord], uneven.allowance(1e-3)[beside])
    assert trial.ratios == pytest.approx(np.linalg.norm(off, axis=1) / allowed)
    at = trial.breakpoints.at
    for k, worst in enumerate(trial.worst):
        inside = (trial.rows >= at[k]) & (trial.rows <= at[k + 1])
        assert worst == trial.ratios[inside].max()


def test_cuts_fall_on_vertices_and_corners_on_kinks() -> None:
    """A failing span of many vertices is cut at vertices; one of few kinks gets a corner."""
    t = np.linspace(0, 1, 9)
    tent = np.stack([t, np.where(np.arange(9) == 4, 1.0, 0.0)], axis=1)
    made = Course.of(t, tent, np.full(8, 1e-3))
    asked = Problem(3, made, OpenEnds(3, tent[0], tent[-1]))
    trial = asked.tried(even(1, 3))
    cut = refined(3, made, trial, np.array([0]))
    assert np.isin(cut.at, t).all()
    assert len(cut.at) > 2
    few = asked.tried(Breakpoints(t[[0, 3, 5, 8]], np.array([4, 1, 1, 4])))
    corner = refined(3, made, few, np.array([1]))
    assert corner.times[corner.at == 0.5].tolist() == [3]
