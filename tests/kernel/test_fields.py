"""Points as parameters: arrays and lists alike, many at once, the offender by its number."""

from __future__ import annotations

from typing import Any

import attrs
import numpy as np
import pytest

from multirep.fields import as_points, finite_points


@attrs.frozen
class Path:
    points: Any = attrs.field(converter=as_points, validator=finite_points)


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int64, np.uint8])
def test_arrays_and_lists_mean_the_same(dtype: Any) -> None:
    """Tuples of tuples of Python floats, bit for bit."""
    rows = np.random.default_rng(0).uniform(0, 9, (40, 3)).astype(dtype)
    made = Path(rows)
    assert made == Path(rows.tolist()) == Path([tuple(row) for row in rows])
    assert {type(x) for row in made.points for x in row} == {float}


@pytest.mark.parametrize(
    ("points", "told"),
    [
        ([[0.0, 0.0], [1.0, np.nan]], "point 1 is: (1.0, nan)"),
        (np.array([[0.0, 0.0], [1.0, -np.inf]]), "point 1 is: (1.0, -inf)"),
        ([[0.0, 0.0], [1.0]], "point 1 is: (1.0,)"),
        ([[0.0, 0.0], [1.0, None]], "point 1 is: [1.0, None]"),
        ([[0.0, 0.0], "ab"], "point 1 is: 'ab'"),
        ([[], []], "point 0 is: ()"),
        ([], "one point or more: ()"),
        (np.zeros((0, 2)), "one point or more: ()"),
        (np.zeros(3), "point 0 is: "),
        (np.zeros((2, 2, 2)), "point 0 is: "),
        (7, "one point or more: 7"),
    ],
)
def test_what_are_no_points_is_refused(points: Any, told: str) -> None:
    """The message has the number of the first offender."""
    with pytest.raises(ValueError, match="'points' must") as caught:
        Path(points)
    assert told in str(caught.value)
