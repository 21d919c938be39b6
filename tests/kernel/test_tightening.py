"""Changing the tolerance: only what cannot be proved becomes stale; gaping seams are closed."""

import numpy as np
import pytest

import multirep as mr
from multirep.errors import ToleranceError
from multirep.representations import Nurbs, Polyline


class Shadow(Polyline):
    """A second polyline, so that a seam has a polyline on either side."""

    name = "shadow"


KINDS = (Polyline, Shadow, Nurbs)


def wave(n: int = 200) -> np.ndarray:
    x = np.linspace(0.0, 6.0, n)
    return np.c_[x, np.sin(x)]


def gap(curve: mr.MultiRepresentation, t: float) -> float:
    """How far all kinds are from each other at t at most."""
    values = [curve.view(kind)(t) for kind in KINDS]
    return max(float(np.linalg.norm(a - b)) for a in values for b in values)


def test_loosening_makes_nothing_stale() -> None:
    """A wider tolerance keeps every value as it is."""
    curve = mr.MultiRepresentation.from_points(wave(), tolerance=1e-3, kinds=KINDS)
    before = [curve.view(kind) for kind in KINDS]
    curve.tolerance = 1.0
    assert all(curve.view(kind) is value for kind, value in zip(KINDS, before, strict=True))


def test_tightening_leaves_what_meets_it_alone() -> None:
    """An exact follower stays up to date under any tolerance that it can be proved to meet."""
    curve = mr.MultiRepresentation.from_points(wave(50), tolerance=1e-1, kinds=KINDS)
    nurbs, _ = curve.view(Nurbs), curve.view(Shadow)
    curve.tolerance = 1e-4
    assert curve.stale(Nurbs)
    stale = curve.stale(Nurbs)
    t = np.linspace(0, 1, 4001)
    apart = np.linalg.norm(nurbs(t) - curve.view(Polyline)(t), axis=1)
    assert all(stale.contains(float(x)) for x in t[apart > 0.5e-4])
    curve.view(Nurbs)
    assert curve.deviation(Polyline, Nurbs).upper <= 1e-4


@pytest.mark.parametrize("factor", [0.5, 0.1, 1e-2, 1e-3])
def test_gaping_seams_are_closed(factor: float) -> None:
    """Authors that met under a loose tolerance can both be followed under a tight one."""
    curve = mr.MultiRepresentation.from_points(wave(), tolerance=0.2, kinds=KINDS)
    nurbs = curve.view(Nurbs)
    k = nurbs.size // 2
    curve.commit(Nurbs, nurbs.move_control_point(k, np.add(nurbs.points[k], (0.0, 0.3))))
    shadow = curve.view(Shadow)
    curve.commit(Shadow, shadow.move_vertex(1, np.add(shadow.points[1], (0.0, 0.4))))
    seams = [interval.start for interval, _ in curve.authors[1:]]
    assert max(gap(curve, t) for t in seams) > 0.05 * factor * 0.2
    curve.tolerance = factor * 0.2
    for one in KINDS:
        for two in KINDS:
            if one is not two:
                assert curve.deviation(one, two).upper <= factor * 0.2


def test_the_closing_author_moves_no_more_than_the_gap() -> None:
    """Closing seams changes authored stretches by no more than the tolerance that let them gape."""
    curve = mr.MultiRepresentation.from_points(wave(), tolerance=0.2, kinds=KINDS)
    nurbs = curve.view(Nurbs)
    k = nurbs.size // 2
    curve.commit(Nurbs, nurbs.move_control_point(k, np.add(nurbs.points[k], (0.0, 0.3))))
    authored = [interval for interval, name in curve.authors if name == "nurbs"]
    before = curve.view(Nurbs)
    curve.tolerance = 1e-3
    t = np.linspace(authored[0].start, authored[0].stop, 2001)
    assert np.linalg.norm(curve.view(Nurbs)(t) - before(t), axis=1).max() <= 0.2


@pytest.mark.parametrize("tolerance", [0.0, -1.0, np.nan, np.inf, 1e-14])
def test_impossible_tolerances_are_refused(tolerance: float) -> None:
    """Not positive, not finite or below rounding: refused, and the curve keeps its tolerance."""
    curve = mr.MultiRepresentation.from_points(wave(), tolerance=0.2, kinds=KINDS)
    with pytest.raises(ToleranceError):
        curve.tolerance = tolerance
    assert curve.tolerance == 0.2
