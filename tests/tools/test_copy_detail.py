"""Copying detail: which coefficients, in which frame, and what stays."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep import SampledSplice
from multirep.arrays import Array
from multirep.constraints import Freeze
from multirep.errors import EditError, EditRejectedError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.representations.wavelet.character import detailed
from multirep.representations.wavelet.frames import frames
from multirep.testing import check_certificate, check_edit
from multirep.tools import CopyDetail

FRAMES = ("curve", "axes")
each_frame = pytest.mark.parametrize("frame", FRAMES)
level_sets = st.sets(st.integers(0, 6), min_size=1).map(sorted)


@cache
def bent(finest: int = 6, dimension: int = 2) -> WaveletBSpline:
    """A curve that turns a good deal, with small details of all levels."""
    s = np.linspace(0, 1, 2**finest + 3)
    course = np.column_stack([np.cos(4 * s), np.sin(5 * s), 0.5 * s + np.sin(3 * s)])
    noise = np.random.default_rng(finest).normal(size=(len(s), dimension))
    return WaveletBSpline(5 * course[:, :dimension] + 0.05 * noise)


@cache
def rough(finest: int = 7, dimension: int = 2) -> WaveletBSpline:
    s = np.linspace(0, 1, 2**finest + 3)
    course = np.column_stack([4 * s, np.sin(3 * s), s**2])
    noise = np.random.default_rng(finest + 50).normal(size=(len(s), dimension))
    return WaveletBSpline(course[:, :dimension] + 0.1 * noise)


@cache
def deep() -> WaveletBSpline:
    """Graded: two corners, where knots go down to level 20 and more."""
    t = np.array([0.0, 0.3, 0.7, 1.0])
    points = np.array([[0.0, 0], [1, 1], [2, 0], [3, 1]])
    return WaveletBSpline.fit(SampledSplice(t, points), tolerance=1e-6)


def turn(dimension: int, seed: int) -> Array:
    """A rotation about any axis by any angle."""
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(dimension, dimension)))
    matrix[:, 0] *= np.linalg.det(matrix)
    return matrix


def turned(curve: WaveletBSpline, by: Array) -> WaveletBSpline:
    return WaveletBSpline(np.asarray(curve.points) @ by.T)


@given(levels=level_sets)
def test_along_the_axes_the_named_coefficients_are_those_of_the_source(levels):
    """The pyramid afterwards: the source's details at the named levels, all else as before."""
    curve, source = bent(), rough()
    after = detailed(curve, source, levels, "axes").value.pyramid(7)
    mine, theirs = curve.pyramid(7), source.pyramid(7)
    assert np.abs(after.base - mine.base).max() <= 1e-13
    for level in range(7):
        wanted = (theirs if level in levels else mine).details[level]
        assert np.abs(after.details[level] - wanted).max() <= 1e-13


@settings(max_examples=8)
@given(levels=level_sets)
def test_along_the_curve_it_is_the_definition(levels):
    """Level by level upwards: in the frame [T N] of the curve without the level, of the new curve.

    The reference recomposes level by level, with frames by hand from difference quotients.
    """
    curve, source = bent(), rough()
    mine, theirs = curve.pyramid(7), source.pyramid(7)
    new, pattern = WaveletBSpline(mine.base), WaveletBSpline(theirs.base)
    for level in range(7):
        details = mine.details[level].copy()
        for k in range(2**level):
            if level in levels:
                t, h = (k + 0.5) / 2**level, 1e-6
                frame = []
                for value in (new, pattern):
                    x, y = value(t + h) - value(t - h)
                    frame.append(np.array([[x, -y], [y, x]]) / np.hypot(x, y))
                details[k] = frame[0] @ frame[1].T @ theirs.details[level][k]
        for k, detail in enumerate(details):
            new = new.add_detail(level, k, detail).value
        pattern = source.at_level(level + 1)
    t = np.linspace(0, 1, 300)
    assert np.abs(detailed(curve, source, levels).value(t) - new(t)).max() <= 1e-8


@each_frame
@pytest.mark.parametrize("dimension", [2, 3])
@given(levels=level_sets)
def test_copying_its_own_details_changes_nothing(frame, dimension, levels):
    """Not by rounding either."""
    edit = detailed(bent(6, dimension), bent(6, dimension), levels, frame)
    assert not edit.splices
    assert edit.value.points is bent(6, dimension).points


@pytest.mark.parametrize("dimension", [2, 3])
@given(seed=st.integers(0, 10_000), levels=level_sets)
def test_turning_before_is_turning_after(dimension, seed, levels):
    """In the frame of the curve: a turned curve gets turned details; how the source lies is one."""
    curve, source, by = bent(6, dimension), rough(7, dimension), turn(dimension, seed)
    t = np.linspace(0, 1, 200)
    plain = detailed(curve, source, levels).value(t)
    assert (
        np.abs(detailed(turned(curve, by), source, levels).value(t) - plain @ by.T).max() <= 1e-12
    )
    assert np.abs(detailed(curve, turned(source, by), levels).value(t) - plain).max() <= 1e-12


@given(angle=st.floats(-4, 4))
def test_any_angle_in_the_plane(angle):
    """The same, by an angle."""
    by = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    t = np.linspace(0, 1, 200)
    plain = detailed(bent(), rough(), (3, 4, 5)).value(t)
    found = detailed(turned(bent(), by), turned(rough(), by), (3, 4, 5)).value(t)
    assert np.abs(found - plain @ by.T).max() <= 1e-12


@each_frame
@pytest.mark.parametrize(("mine", "theirs"), list(itertools.permutations((3, 5, 8), 2)))
def test_curves_of_different_finest_levels(frame, mine, theirs):
    """Missing levels of the source take details away; missing ones of the curve are made."""
    curve, source = bent(mine), rough(theirs)
    edit = check_edit(curve, lambda v: detailed(v, source, (4, 6), frame))
    after = edit.value.pyramid(9).details
    for level in (4, 6):
        size = np.linalg.norm(after[level], axis=1)
        wanted = np.linalg.norm(source.pyramid(9).details[level], axis=1)
        assert np.abs(size - wanted).max() <= 1e-12


def test_what_neither_curve_has_costs_nothing():
    """No knots are made for rounding errors, wherever the curves lie."""
    far = WaveletBSpline(np.asarray(bent(4).points) + 1e6)
    for curve in (bent(4), far):
        for levels in ((9, 11), (15,)):
            assert not detailed(curve, rough(3), levels).splices


@each_frame
def test_details_of_one_place_change_one_place(frame):
    """Where both curves are the same at these levels the curve keeps its bits."""
    curve = bent(10)
    source = curve.add_detail(9, 300, [0.1, 0.2]).value
    edit = check_edit(curve, lambda v: detailed(v, source, (9,), frame))
    assert edit.splices.length < 0.2
    peak = 300.5 / 512
    assert np.linalg.norm(edit.value(peak) - curve(peak)) == pytest.approx(
        np.hypot(0.1, 0.2), rel=0.1
    )


@each_frame
def test_deep_graded_curves(frame):
    """Levels up to 15 go over to and from curves with knots far below; nothing below changes."""
    curve, source = deep(), bent(9)
    assert curve.level > 16
    edit = check_edit(curve, lambda v: detailed(v, source, (5, 8), frame))
    after = edit.value.pyramid(9).details
    for level, wanted in ((5, source.pyramid(9)), (8, source.pyramid(9))):
        size = np.linalg.norm(wanted.details[level], axis=1)
        assert np.abs(np.linalg.norm(after[level], axis=1) - size).max() <= 1e-9
    assert edit.value.size < 2000
    back = detailed(source, curve, (5, 8), frame).value
    assert back.size < 2000


@pytest.mark.parametrize("levels", [(16,), (3, 40), (-1,), ()])
def test_levels_without_end_are_refused_with_the_reason(levels):
    """Details of level l are 2**l numbers all over T: 2**40 of them are never made."""
    with pytest.raises(EditError, match=r"between 0 and 15.*2\*\*l"):
        detailed(deep(), bent(), levels)


def test_places_where_a_curve_stands_still_have_the_frame_before():
    """A degenerate tangent has no direction; nowhere does one give NaN."""
    rows = np.asarray(bent(3).points).copy()
    rows[4:8] = rows[4]
    still = np.repeat(rows[4:5], 11, axis=0)
    assert np.isfinite(frames(rows)).all()
    np.testing.assert_array_equal(frames(still), np.tile(np.eye(2), (8, 1, 1)))
    waiting = frames(np.concatenate((rows[:3], np.repeat(rows[2:3], 8, axis=0))))
    np.testing.assert_array_equal(waiting[3:], np.tile(waiting[2], (5, 1, 1)))
    point = WaveletBSpline(still)
    after = detailed(point, rough(), (3, 4)).value
    assert np.isfinite(np.asarray(after.points)).all()


@pytest.mark.parametrize("dimension", [2, 3])
def test_frames_are_rotations(dimension):
    """Orthonormal and right-handed at every place and level."""
    coarser = None
    pyramid = bent(8, dimension).pyramid()
    for level in range(2, 9):
        coarser = found = frames(pyramid.control_points(level), coarser)
        assert np.abs(found.transpose(0, 2, 1) @ found - np.eye(dimension)).max() <= 1e-14
        assert np.abs(np.linalg.det(found) - 1).max() <= 1e-14
        t = (np.arange(2**level) + 0.5) / 2**level
        tangents = WaveletBSpline(pyramid.control_points(level)).derivative(t)
        tangents /= np.linalg.norm(tangents, axis=1)[:, None]
        assert np.abs(found[:, :, 0] - tangents).max() <= 1e-13


def test_a_frame_in_space_does_not_turn_about_the_curve():
    """Parallel transport on a circle, whose plane the normals keep; the same in any level."""
    s = np.linspace(0, 6, 131)
    circle = WaveletBSpline(np.column_stack([np.cos(s), np.sin(s), 0 * s])).pyramid()
    for level in (3, 5):
        normals = frames(circle.control_points(level))[:, :, 1]
        t = (np.arange(2**level) + 0.5) / 2**level
        inward = -WaveletBSpline(circle.control_points(level))(t)
        assert np.abs(normals[:, 2]).max() <= 1e-14
        assert ((normals * inward).sum(axis=1) > 0.9).all()
    finer = frames(circle.control_points(6), frames(circle.control_points(5)))
    assert np.abs(finer[:, 2, 1]).max() <= 1e-14


def test_a_curve_that_turns_back_in_space():
    """Opposite directions have no common plane; a half turn is taken and all stays finite."""
    rows = np.zeros((7, 3))
    rows[:, 0] = [0, 1, 2, 3, 2, 1, 0]
    rows[3, 1] = 1e-3
    found = frames(rows)
    assert np.abs(found.transpose(0, 2, 1) @ found - np.eye(3)).max() <= 1e-14


REFUSALS: dict[str, tuple[Callable[[], object], str]] = {
    "dimension": (lambda: detailed(bent(), bent(6, 3), (2,)), "2 coordinates.*3"),
    "frame": (lambda: detailed(bent(), rough(), (2,), "tilted"), "tilted"),  # type: ignore[arg-type]
    "one coordinate": (lambda: detailed(bent(6, 1), rough(6, 1), (2,)), "1 coordinate:.*'axes'"),
    "straight in space": (
        lambda: detailed(WaveletBSpline(np.arange(21.0).reshape(7, 3)), rough(6, 3), (2,)),
        "straight.*'axes'",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_refusals_name_the_numbers_and_the_way_out(case):
    """What cannot be done says why."""
    attempt, message = REFUSALS[case]
    with pytest.raises(EditError, match=message):
        attempt()


def test_one_coordinate_along_the_axes():
    """Without frames any number of coordinates will do."""
    curve, source = bent(6, 1), rough(7, 1)
    after = check_edit(curve, lambda v: detailed(v, source, (4,), "axes")).value
    assert np.abs(after.pyramid().details[4] - source.pyramid().details[4]).max() <= 1e-13


def session(**curves: WaveletBSpline) -> mr.Session:
    found = mr.Session()
    for name, curve in curves.items():
        found.add(name, mr.MultiRepresentation(curve, tolerance=1e-2))
    return found


@each_frame
def test_beside_a_frozen_stretch(frame):
    """Frozen bits stay in all representations; away from it the details are there."""
    editing = session(curve=bent(7), source=rough())
    editing.constrain("curve", Freeze(interval=(0.3, 0.4)))
    curve = editing.curve("curve")
    kinds, t = (Polyline, Nurbs, WaveletBSpline), np.linspace(0.3, 0.4, 100)
    before = [curve.view(kind)(t) for kind in kinds]
    source = np.asarray(editing.curve("source").view(WaveletBSpline).points)
    editing.apply("curve", CopyDetail(source="source", levels=(4, 5, 6), frame=frame))
    for kind, values in zip(kinds, before, strict=True):
        assert (curve.view(kind)(t) == values).all()
    away = np.linspace(0.75, 1, 100)
    wanted = detailed(bent(7), rough(), (4, 5, 6), frame).value(away)
    assert np.abs(curve.view(WaveletBSpline)(away) - wanted).max() <= 1e-10
    assert (np.asarray(editing.curve("source").view(WaveletBSpline).points) == source).all()
    check_certificate(curve)


def test_the_source_is_taken_as_it_is_then():
    """An edit of the source by another representation counts; the copy does not follow later."""
    editing = session(curve=bent(), source=rough())
    first = editing.curve("source").view(Polyline)
    editing.apply("curve", CopyDetail(source="source", levels=(3,)))
    once = editing.curve("curve").view(WaveletBSpline)
    moved = first.move_vertex(first.size // 2, first.points[first.size // 2] + 1.0)
    editing.curve("source").commit(Polyline, moved)
    assert editing.curve("curve").view(WaveletBSpline) is once
    editing.apply("curve", CopyDetail(source="source", levels=(3,)))
    assert editing.curve("curve").view(WaveletBSpline) is not once


def test_an_unknown_source_is_refused_by_name():
    """With the names that there are."""
    editing = session(curve=bent(), source=rough())
    with pytest.raises(EditRejectedError, match=r"'sauce'.*'source'"):
        editing.apply("curve", CopyDetail(source="sauce", levels=(3,)))
