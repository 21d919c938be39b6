"""Sweeping several points at once: all targets, the smallest change, what is frozen."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep import SampledSplice
from multirep.constraints import Freeze, PointConstraint
from multirep.errors import ConflictError, EditError, EditRejectedError, FrozenError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.representations.wavelet.filters import refine_uniform
from multirep.representations.wavelet.targets import swept_together
from multirep.scene import Scene
from multirep.testing import check_certificate, check_edit
from multirep.tools import Sweep

#: Places apart enough for level 6, as 64ths.
places = st.sets(st.integers(0, 16), min_size=1, max_size=8).map(
    lambda found: np.array(sorted(found)) / 16
)


@cache
def curve(dimension: int = 2, domain: tuple[float, float] = (0.0, 1.0)) -> WaveletBSpline:
    """Detail in one place only, so that the knots are graded."""
    t, s = np.linspace(*domain, 600), np.linspace(0, 1, 600)
    wiggle = 0.05 * np.sin(200 * s) * np.exp(-((s - 0.6) ** 2) / 0.001)
    points = np.stack([np.cos((3 + k) * s) + wiggle for k in range(dimension)], axis=1)
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-3)


@pytest.mark.parametrize(
    ("dimension", "domain"), [(1, (0.0, 1.0)), (2, (-3.0, 4.0)), (3, (1e6, 1e6 + 1.0))]
)
@settings(max_examples=15)
@given(places=places, level=st.integers(16, 80), seed=st.integers(0, 99))
def test_all_targets_are_hit(dimension, domain, places, level, seed):
    """Any places, any level that tells them apart, whole or not; in any order."""
    value, rng = curve(dimension, domain), np.random.default_rng(seed)
    t = rng.permutation(domain[0] + places * (domain[1] - domain[0]))
    to = value(t) + rng.normal(size=(len(t), dimension))
    edit = check_edit(value, lambda v: swept_together(v, t, to, level / 4))
    assert np.abs(edit.value(t) - to).max() <= 1e-11


@given(places=places, level=st.integers(4, 6), seed=st.integers(0, 99))
def test_it_is_the_smallest_change_of_its_level_refined(places, level, seed):
    """P .. P times the pseudo-inverse of the functions of the level at the places."""
    rng = np.random.default_rng(seed)
    value = WaveletBSpline(rng.normal(size=(67, 2)))
    offsets = rng.normal(size=(len(places), 2))
    functions = WaveletBSpline(np.eye(2**level + 3))(places)
    change = np.linalg.pinv(functions) @ offsets
    for _ in range(6 - level):
        change = refine_uniform(change)
    swept = swept_together(value, places, value(places) + offsets, level).value
    wanted = np.asarray(value.points) + change
    assert np.abs(np.asarray(swept.points) - wanted).max() <= 1e-11


@given(place=st.integers(0, 64), level=st.integers(0, 40))
def test_one_target_is_a_plain_sweep(place, level):
    """The same change, over no more than the same splices."""
    t, to = place / 64, (2.0, -1.0)
    one = curve().sweep(t, to, level / 4)
    all_at_once = swept_together(curve(), [t], [to], level / 4)
    assert one.splices.contains(all_at_once.splices)
    places = np.union1d(np.linspace(0, 1, 400), t)
    assert np.abs(all_at_once.value(places) - one.value(places)).max() <= 1e-13


def test_held_points_stay_and_the_details_ride_along():
    """The tool: the first target, those that stay, those that move too; details are unchanged."""
    value = WaveletBSpline(np.random.default_rng(0).normal(size=(131, 2)))
    tool = Sweep(t=0.5, to=(3, 3), level=4, hold=(0.3, 0.7), targets=((0.9, 1.0, 1.0),))
    after = check_edit(value, lambda v: tool.edit(v, Scene())).value
    wanted = [value(0.3), [3, 3], value(0.7), [1, 1]]
    assert np.abs(after([0.3, 0.5, 0.7, 0.9]) - wanted).max() <= 1e-13
    for level in (4, 5, 6):
        kept = after.pyramid().details[level] - value.pyramid().details[level]
        assert np.abs(kept).max() <= 1e-13


def test_many_targets_far_apart_and_deep():
    """Level 38 at two ends of T makes knots at the places only, not 2**38 numbers."""
    t = np.linspace(0.05, 0.95, 40)
    to = curve()(t) + 1e-3
    for level in (12.5, 38):
        edit = check_edit(curve(), swept_together(curve(), t, to, level))
        assert np.abs(edit.value(t) - to).max() <= 1e-13
        assert edit.value.size <= curve().size + 40 * 24


@pytest.mark.parametrize(
    ("t", "level"),
    [
        ([0.5, 0.5], 8),
        ([0.5, 0.5 + 1e-9], 8),
        (np.linspace(0, 1, 9), 1),
        (np.linspace(0.1, 0.5, 5), 0),
    ],
)
def test_targets_too_close_for_the_level_are_refused_with_their_places(t, level):
    """The message names the level and the parameters."""
    to = np.random.default_rng(0).normal(size=(len(t), 2))
    with pytest.raises(EditError, match=rf"level {level}: those at t = 0\D"):
        swept_together(curve(), t, to, level)


@pytest.mark.parametrize(
    ("t", "to", "level"),
    [
        ([0.5], [[1.0]], 2),
        ([0.5, 0.6], [[1.0, 2.0]], 2),
        ([0.5], [[1.0, np.nan]], 2),
        ([0.5], [[1.0, 2.0]], 50),
        ([0.5], [[1.0, 2.0]], -1),
        ([[0.5]], [[1.0, 2.0]], 2),
    ],
)
def test_nonsense_is_refused(t, to, level):
    """Shapes, NaN, levels that there are not."""
    with pytest.raises(EditError):
        swept_together(curve(), t, to, level)


def session() -> mr.Session:
    found = mr.Session()
    found.add("curve", mr.MultiRepresentation(curve(), tolerance=1e-2))
    return found


def test_beside_a_frozen_stretch_what_is_free_is_solved_again():
    """Frozen bits stay, targets are hit exactly, and nothing has to be faded out."""
    editing = session()
    editing.constrain("curve", Freeze(interval=(0.4, 0.6)))
    held, kinds = editing.curve("curve"), (Polyline, Nurbs, WaveletBSpline)
    t = np.linspace(0.4, 0.6, 100)
    before = [held.view(kind)(t) for kind in kinds]
    tool = Sweep(t=0.25, to=(0.0, 1.0), level=4, targets=((0.75, 0.0, 2.0),), hold=(0.5,))
    outcome = editing.apply("curve", tool)
    assert not outcome.faded
    found = held.view(WaveletBSpline)([0.25, 0.75])
    assert np.abs(found - [[0, 1], [0, 2]]).max() <= 1e-12
    for kind, values in zip(kinds, before, strict=True):
        assert (held.view(kind)(t) == values).all()
    check_certificate(held)


def test_a_wide_sweep_beside_ice_is_faded_out():
    """Where the free control points of the level cannot do it, the kernel fades the edit out."""
    editing = session()
    editing.constrain("curve", Freeze(interval=(0.4, 0.6)))
    # What is held on the ice stays anyway.
    outcome = editing.apply("curve", Sweep(t=0.25, to=(0.0, 1.0), level=1, hold=(0.5,)))
    assert outcome.faded
    found = editing.curve("curve").view(WaveletBSpline)(0.25)
    assert np.abs(found - [0, 1]).max() <= 1e-2
    with pytest.raises(FrozenError, match=r"0\.5"):
        editing.apply("curve", Sweep(t=0.25, to=(0.0, 1.0), level=1, targets=((0.5, 0, 0),)))


def test_held_places_are_aims_too():
    """A constraint that holds one of the targets elsewhere makes the edit fail as a whole."""
    tool = Sweep(t=0.5, to=(1.0, 1.0), level=3, hold=(0.2,), targets=((0.8, 0.0, 0.0),))
    assert [aim.t for aim in tool.aims(curve())] == [0.5, 0.2, 0.8]
    editing = session()
    editing.constrain("curve", PointConstraint(t=0.8, point=tuple(curve()(0.8))))
    before = editing.curve("curve").snapshot()
    with pytest.raises((EditRejectedError, ConflictError)):
        editing.apply("curve", tool)
    assert editing.curve("curve").snapshot() is before
