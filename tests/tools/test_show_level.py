"""Showing a level: the curve of a level of another, kept as a curve of its own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import multirep as mr
from multirep.constraints import Freeze
from multirep.errors import EditError, EditRejectedError
from multirep.representations import Nurbs, Polyline, WaveletBSpline
from multirep.representations.wavelet.smoothing import shown
from multirep.testing import check_certificate, check_edit
from multirep.tools import ShowLevel, Smooth


def rough(dimension: int = 2) -> WaveletBSpline:
    steps = np.random.default_rng(dimension).normal(size=(131, dimension))
    return WaveletBSpline(steps.cumsum(axis=0))


def line(domain: tuple[float, float] = (0.0, 1.0)) -> WaveletBSpline:
    return WaveletBSpline([[0, 0], [1, 0], [2, 0], [3, 0]], domain=domain)


def session(**curves: WaveletBSpline) -> mr.Session:
    found = mr.Session()
    for name, curve in curves.items():
        found.add(name, mr.MultiRepresentation(curve, tolerance=1e-2))
    return found


@given(level=st.integers(0, 32))
def test_it_is_the_level_of_the_other_curve(level):
    """With 2**level + 3 control points, 2**ceil(level) + 3 between two levels."""
    source, level = rough(), level / 4
    edit = check_edit(line(), lambda v: shown(v, source, level))
    assert edit.value.size == 2 ** int(np.ceil(min(level, 7))) + 3
    t = np.linspace(0, 1, 200)
    assert (edit.value(t) == source.at_level(level)(t)).all()


def test_over_its_own_domain():
    """Places correspond as parts of T."""
    shifted = check_edit(line((10, 14)), lambda v: shown(v, rough(), 3.5)).value
    t = np.linspace(0, 1, 100)
    assert np.abs(shifted(10 + 4 * t) - rough().at_level(3.5)(t)).max() <= 1e-13


def test_the_source_stays_and_all_representations_follow():
    """It is a copy: within the tolerance in every representation, until it is shown again."""
    editing = session(cat=rough(), sweep=line())
    before = editing.curve("cat").snapshot()
    editing.apply("sweep", ShowLevel(source="cat", level=2))
    assert editing.curve("cat").snapshot() is before
    check_certificate(editing.curve("sweep"))
    once = editing.curve("sweep").view(WaveletBSpline)
    editing.apply("cat", Smooth(level=1))
    assert editing.curve("sweep").view(WaveletBSpline) is once
    editing.apply("sweep", ShowLevel(source="cat", level=2))
    t = np.linspace(0, 1, 100)
    wanted = rough().at_level(1)(t)
    assert np.abs(editing.curve("sweep").view(WaveletBSpline)(t) - wanted).max() <= 1e-12
    editing.undo()
    assert editing.curve("sweep").view(WaveletBSpline) is once


def test_of_itself_it_smooths():
    """The scene holds the curve itself too."""
    editing = session(cat=rough())
    editing.apply("cat", ShowLevel(source="cat", level=3))
    t = np.linspace(0, 1, 100)
    assert (editing.curve("cat").view(WaveletBSpline)(t) == rough().at_level(3)(t)).all()


def test_what_is_frozen_stays():
    """The curve goes over from the frozen stretch to the level, in all representations."""
    editing = session(cat=rough(), sweep=line())
    editing.constrain("sweep", Freeze(interval=(0.25, 0.5)))
    curve, t = editing.curve("sweep"), np.linspace(0.25, 0.5, 100)
    before = [curve.view(kind)(t) for kind in (Polyline, Nurbs, WaveletBSpline)]
    editing.apply("sweep", ShowLevel(source="cat", level=2.5))
    for kind, values in zip((Polyline, Nurbs, WaveletBSpline), before, strict=True):
        assert (curve.view(kind)(t) == values).all()
    away = np.linspace(0.9, 1, 50)
    assert np.abs(curve.view(WaveletBSpline)(away) - rough().at_level(2.5)(away)).max() <= 1e-12
    check_certificate(curve)


@pytest.mark.parametrize(
    ("curve", "source", "level", "message"),
    [
        (line(), rough(3), 2, "2 coordinates.*3"),
        (line(), rough(), -0.5, "begin at 0"),
        (line((1e15, 1e15 + 16)), rough(), 6, "level 6.*of level [01]"),
    ],
)
def test_refusals_say_what_is_wrong(curve, source, level, message):
    """The message holds the numbers."""
    with pytest.raises(EditError, match=message):
        shown(curve, source, level)


def test_an_unknown_curve_is_refused_by_name():
    """With the names that there are."""
    with pytest.raises(EditRejectedError, match=r"'dog'.*'cat'"):
        session(cat=rough(), sweep=line()).apply("sweep", ShowLevel(source="dog", level=2))
