"""`insert-knot`: the operation of the NURBS, as a tool."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.errors import EditError
from multirep.representations import Nurbs
from multirep.scene import Scene
from multirep.script.strict import structure
from multirep.testing.laws import check_edit
from multirep.tools import InsertKnot

WAVE = Nurbs(
    degree=3,
    knots=[0, 0, 0, 0, 1, 2, 3, 3, 3, 3],
    points=[[0, 0], [1, 2], [2, -2], [3, 2], [4, -2], [5, 0]],
)


def test_the_curve_stays() -> None:
    """As many control points more as knots, the same points to rounding."""
    edit = check_edit(WAVE, lambda value: InsertKnot(t=1.5, times=2).edit(value, Scene()))
    t = np.linspace(0, 3, 300)
    assert edit.value.size == WAVE.size + 2
    assert np.abs(edit.value(t) - WAVE(t)).max() <= 4e-15


def test_three_times_splits_a_cubic() -> None:
    """At full multiplicity a control point lies on the curve."""
    value = InsertKnot(t=1.0, times=2).edit(WAVE, Scene()).value
    at = np.asarray(value.knots).searchsorted(1.0)
    assert np.abs(value.points[at - 1] - WAVE(1.0)).max() <= 1e-15


def test_parameters_are_plain_and_checked() -> None:
    """t is finite, times a whole number from 1; the default is once."""
    assert InsertKnot(t=1) == structure({"t": 1.0, "times": 1}, InsertKnot)
    with pytest.raises(ValueError, match="'t' must be a finite number"):
        InsertKnot(t=np.nan)
    with pytest.raises(ValueError, match="'times' must be >= 1"):
        InsertKnot(t=0.5, times=0)
    with pytest.raises(TypeError, match="integer"):
        InsertKnot(t=0.5, times=1.5)  # type: ignore[arg-type]


def test_too_many_and_outside_are_refused() -> None:
    """The message says how often the knot is there and how often it may be."""
    with pytest.raises(EditError, match=r"1.0 is a knot 1 times already.*up to 3 times"):
        InsertKnot(t=1.0, times=3).edit(WAVE, Scene())
    for t in (0.0, 3.0, 4.0):
        with pytest.raises(EditError, match=r"inside \[0, 3\]"):
            InsertKnot(t=t).edit(WAVE, Scene())
