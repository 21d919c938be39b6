"""Strokes as they come: what is taken, what is merged, what is refused and how."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep.arrays import Array
from multirep.errors import EditError, InvalidCurveError
from multirep.strokes import clean_stroke, sketched
from multirep.strokes.reading import read_stroke
from multirep.testing.strategies import strokes

REFUSED: list[tuple[Any, str]] = [
    ([], "no samples"),
    ([[1.0, 2.0]], "1 sample"),
    ([[1.0, 2.0]] * 9, r"no length: all its 9 samples are at \[1.0, 2.0\]"),
    ([[0, 0], [np.nan, 1], [2, 2]], r"sample 1 of 3 is \[nan, 1.0\], 1 in all"),
    ([[0, 0], [np.inf, 1], [-np.inf, 2]], "sample 1 of 3.*2 in all"),
    ([1.0, 2.0, 3.0], r"shape \(n, d\)"),
    ([[[0, 0], [1, 1]]], r"shape \(n, d\)"),
    ([[0, 0], [1]], "rows of equal length"),
    ([["a", "b"], ["c", "d"]], "must be numbers"),
    ([[0, 0], [1e200, 0]], "below 1e"),
]


@pytest.mark.parametrize(("points", "message"), REFUSED)
def test_what_is_no_stroke_is_refused_with_what_was_found(points: Any, message: str) -> None:
    """Each kind of nonsense has a sentence that says where it is."""
    with pytest.raises(InvalidCurveError, match=message):
        clean_stroke(points)


def test_messages_name_the_stroke() -> None:
    """Of several strokes the wrong one is named."""
    with pytest.raises(InvalidCurveError, match="stroke 2 has 1 sample"):
        sketched([[[0, 0], [1, 1]], [[0, 0]]])
    with pytest.raises(EditError, match="at least one"):
        sketched([])


@given(strokes(), st.integers(1, 4))
def test_pauses_change_nothing(stroke: Array, times: int) -> None:
    """Repeating samples in place gives the same stroke and counts them."""
    once, merged = read_stroke(stroke)
    again, more = read_stroke(np.repeat(stroke, times, axis=0))
    assert (once == again).all()
    assert more == merged + (times - 1) * len(stroke)
    assert len(once) + merged == len(stroke)


@pytest.mark.parametrize(
    "options",
    [
        {"noise": -1.0},
        {"noise": np.nan},
        {"corner_angle": 0.0},
        {"corner_angle": 181.0},
        {"corner_window": 0.0},
        {"corner_window": np.inf},
    ],
)
def test_options_without_sense_are_refused(options: dict[str, Any]) -> None:
    """The message names the option and what it may be."""
    with pytest.raises(EditError, match=next(iter(options))):
        clean_stroke([[0, 0], [1, 1]], **options)
