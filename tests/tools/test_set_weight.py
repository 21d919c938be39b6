"""`set-weight`: the operation of the NURBS, as a tool."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.errors import EditError
from multirep.representations import Nurbs
from multirep.scene import Scene
from multirep.script.strict import structure
from multirep.testing.laws import check_edit
from multirep.tools import SetWeight

ARCH = Nurbs(degree=2, knots=[0, 0, 0, 1, 1, 1], points=[[1, 0], [1, 1], [0, 1]])


def test_one_weight_makes_a_circle() -> None:
    """A parabola becomes a quarter of a circle."""
    edit = check_edit(ARCH, lambda value: SetWeight(1, 0.5**0.5).edit(value, Scene()))
    assert np.abs(np.hypot(*edit.value(np.linspace(0, 1, 99)).T) - 1).max() <= 4e-16


def test_larger_weights_pull_the_curve() -> None:
    """Towards the control point, without ever passing it."""
    distances = []
    for weight in (0.01, 1.0, 10.0, 1e6):
        value = SetWeight(index=1, weight=weight).edit(ARCH, Scene()).value
        distances.append(value.nearest([1, 1]).distance)
    assert distances == sorted(distances, reverse=True)
    assert distances[-1] < 1e-5


def test_parameters_are_plain_and_checked() -> None:
    """Weights are positive and finite."""
    assert SetWeight(index=1, weight=2) == structure({"index": 1, "weight": 2.0}, SetWeight)
    for weight in (0, -1.0):
        with pytest.raises(ValueError, match="'weight' must be > 0"):
            SetWeight(index=1, weight=weight)
    for weight in (np.nan, np.inf):
        with pytest.raises(ValueError, match="'weight' must be a finite number"):
            SetWeight(index=1, weight=weight)
    with pytest.raises(ValueError, match="'index' must be >= 0"):
        SetWeight(index=-1, weight=1.0)


def test_what_is_not_there_is_refused() -> None:
    """The message says how many control points there are."""
    with pytest.raises(EditError, match="no control point 3; there are 3"):
        SetWeight(index=3, weight=2.0).edit(ARCH, Scene())
