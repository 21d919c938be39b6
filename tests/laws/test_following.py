"""Any input that people have is followed by every representation, within the tolerance, proved."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep.arrays import Array
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.sampled import SampledSplice
from multirep.testing import check_certificate, check_fit, check_same
from multirep.testing.curves import size_of
from multirep.testing.strategies import (
    PlantedNurbs,
    planted_nurbs,
    polylines,
    sampled_splices,
    strokes,
)

KINDS = [Polyline, Nurbs, WaveletBSpline]
tolerances = st.sampled_from([1e-1, 1e-2, 1e-3, 1e-4])
laws = settings(max_examples=40)


@laws
@given(stroke=strokes(), relative=tolerances)
def test_any_stroke_is_followed(stroke: Array, relative: float) -> None:
    """Pauses, turns on the spot, crossings and uneven speed: every pair is within the tolerance."""
    size = float(np.ptp(stroke, axis=0).max())
    curve = mr.MultiRepresentation.from_points(stroke, tolerance=relative * size, kinds=KINDS)
    repeated = int((np.diff(stroke, axis=0) == 0).all(axis=1).sum())
    assert curve.merged == repeated
    check_certificate(curve)


@laws
@given(data=polylines(dimension=3), relative=tolerances)
def test_any_polyline_is_followed(data: tuple[Array, Array], relative: float) -> None:
    """Any parameters and any corners, points that stay where they are, in space."""
    t, points = data
    size = float(np.ptp(points, axis=0).max())
    curve = mr.MultiRepresentation(Polyline(t, points), tolerance=relative * size, kinds=KINDS)
    check_certificate(curve)


@laws
@given(planted=planted_nurbs(), relative=tolerances)
def test_any_nurbs_is_followed(planted: PlantedNurbs, relative: float) -> None:
    """Any degree, repeated knots and weights from 1/4 to 4; the library agrees with scipy on it."""
    nurbs = Nurbs(
        degree=planted.degree,
        knots=planted.knots,
        points=planted.points,
        weights=planted.weights,
    )
    t = np.linspace(0, 1, 101)
    np.testing.assert_allclose(nurbs(t), planted(t), rtol=0, atol=1e-12 * nurbs.magnitude)
    size = size_of(nurbs)
    assume(size > 1e-3 * nurbs.magnitude)
    curve = mr.MultiRepresentation(nurbs, tolerance=relative * size, kinds=KINDS)
    check_certificate(curve)


@laws
@given(planted=planted_nurbs(degrees=(3,), rational=False), relative=tolerances)
def test_a_planted_curve_is_found_again(planted: PlantedNurbs, relative: float) -> None:
    """From samples alone, corners marked, within the tolerance and with frugal control points."""
    sampled = planted.sampled()
    size = float(np.ptp(sampled.points, axis=0).max())
    for kind in KINDS:
        check_fit(kind, sampled, tolerance=relative * size)
    fitted = check_fit(Nurbs, sampled, tolerance=max(relative, 1e-3) * size)
    assert fitted.size <= 8 * len(planted.points) + 64


@laws
@given(sampled=sampled_splices(dimension=1), relative=tolerances)
def test_any_samples_are_fitted(sampled: SampledSplice, relative: float) -> None:
    """Samples with any bounds, any breaks and over any stretch, of one coordinate."""
    size = float(np.ptp(sampled.points, axis=0).max())
    assume(size > 0)
    for kind in KINDS:
        check_fit(kind, sampled, tolerance=relative * size)


@pytest.mark.parametrize("kind", KINDS)
def test_order_of_convergence(kind: type[mr.Representation]) -> None:
    """Controls grow with the root of the accuracy (polyline) or its fourth root (cubic splines)."""
    t = np.linspace(0, 1, 20_001)
    points = np.column_stack([np.cos(5 * t), np.sin(7 * t)])
    sampled = SampledSplice(t, points, bound=1e-8)
    sizes = [kind.fit(sampled, tolerance=tolerance).size for tolerance in (1e-3, 1e-5, 1e-7)]
    order = {"polyline": 2}.get(kind.name, 4)
    for coarse, fine in pairwise(sizes):
        growth = fine / coarse
        assert 0.6 * 100 ** (1 / order) <= growth <= 1.5 * 100 ** (1 / order), sizes


@laws
@given(stroke=strokes(max_size=20))
def test_following_is_deterministic(stroke: Array) -> None:
    """The same points give the same bits in every representation."""
    size = float(np.ptp(stroke, axis=0).max())
    one, two = (
        mr.MultiRepresentation.from_points(stroke, tolerance=1e-2 * size, kinds=KINDS)
        for _ in range(2)
    )
    for kind in KINDS:
        check_same(one.view(kind), two.view(kind))
