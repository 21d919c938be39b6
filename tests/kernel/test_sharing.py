"""What many vertices take, and what versions share."""

from __future__ import annotations

import gc
import tracemalloc

import numpy as np
import pytest

import multirep as mr
from multirep.blocks import BlockArray
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.representations import Nurbs, Polyline, WaveletBSpline

KINDS: list[type[Representation]] = [Polyline, Nurbs, WaveletBSpline]
#: All that is held, in terms of the flat arrays of the representations.
MOST = 6.0


def rough(n: int) -> np.ndarray:
    """A curve that needs about as many control points as it has vertices."""
    rng = np.random.default_rng(2)
    return np.column_stack([np.linspace(0, 1, n), 1e-3 * rng.normal(size=n).cumsum()])


def arrays(value: Representation) -> dict[str, BlockArray]:
    """The stored arrays of a value by name."""
    found = {name: getattr(value, name, None) for name in ("t", "knots", "points")}
    return {name: array for name, array in found.items() if isinstance(array, BlockArray)}


@pytest.fixture(scope="module")
def curve() -> mr.MultiRepresentation:
    made = mr.MultiRepresentation.from_points(rough(14_000), tolerance=1e-3, kinds=KINDS)
    for kind in KINDS:
        made.view(kind)
    return made


def test_versions_share_all_untouched_blocks(curve: mr.MultiRepresentation) -> None:
    """After an edit and all views, no array has more than a few blocks of its own."""
    before = curve.snapshot()
    polyline = curve.view(Polyline)
    for index in (7, 8_111, 13_990):
        edit = curve.view(Polyline).move_vertex(index, polyline.points[index] + 0.01)
        curve.commit(Polyline, edit)
        shown = {kind: curve.snapshot().held[kind.name].value for kind in KINDS}
        for kind in KINDS:
            old, new = shown[kind], curve.view(kind)
            assert old is not None
            for name, array in arrays(new).items():
                kept = {id(block) for block in arrays(old)[name].blocks}
                assert len(kept) >= 2
                own = [block for block in array.blocks if id(block) not in kept]
                assert len(own) <= 2, (kind.name, name)
    curve.restore(before)


def test_looking_at_a_window_shares_all_other_blocks(curve: mr.MultiRepresentation) -> None:
    """However much else is stale."""
    before = curve.snapshot()
    polyline = curve.view(Polyline)
    moved = Polyline(np.asarray(polyline.t), polyline.points + np.array([0.0, 0.2]))
    everything = mr.SpliceList([curve.domain])
    curve.commit(Polyline, mr.Edit(moved, everything))
    for kind in KINDS[1:]:
        old = before.held[kind.name].value
        assert old is not None
        new = curve.view(kind, Interval(0.5, 0.51))
        for name, array in arrays(new).items():
            kept = {id(block) for block in arrays(old)[name].blocks}
            assert sum(id(block) not in kept for block in array.blocks) <= 2, (kind.name, name)
    curve.restore(before)


def test_a_curve_with_all_views_takes_little_more_than_its_arrays() -> None:
    """Nothing that helped to fit is kept."""
    points = rough(14_000)
    mr.MultiRepresentation.from_points(points[:100], tolerance=1e-3, kinds=KINDS).view(Nurbs)
    gc.collect()
    tracemalloc.start()
    curve = mr.MultiRepresentation.from_points(points, tolerance=1e-3, kinds=KINDS)
    flat = sum(a.nbytes for kind in KINDS for a in arrays(curve.view(kind)).values())
    gc.collect()
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert held <= MOST * flat
