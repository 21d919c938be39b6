"""How a stroke joins what stands: orders of contact, measured."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.strokes.blending import Join, Rim, blended, smoothstep


@pytest.mark.parametrize("order", [1, 2])
def test_the_step_is_flat_at_both_ends(order: int) -> None:
    """It leaves 0 and reaches 1 with error of the next power, and is constant beyond."""
    h = np.array([1e-2, 1e-3])
    for values in (smoothstep(h, order), 1 - smoothstep(1 - h, order)):
        assert values[1] / values[0] == pytest.approx(10.0 ** -(order + 1), rel=0.1)
    assert smoothstep(np.array([-3.0, 0.0, 1.0, 7.0]), order).tolist() == [0, 0, 1, 1]


@pytest.mark.parametrize("at_start", [True, False])
@pytest.mark.parametrize(("join", "power"), [("C0", 1), ("G1", 2), ("C2", 3)])
def test_the_stroke_meets_its_rim_to_the_order_asked_for(
    join: Join, power: int, at_start: bool
) -> None:
    """Distance from the standing curve falls with the power; beyond the apron nothing moves."""
    rim = Rim(0.0, np.array([1.0, 2.0]), np.array([3.0, 1.0]), np.array([0.5, -4.0]))
    sign = 1.0 if at_start else -1.0
    t = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 400)])
    s = 2.0 * t
    stroke = np.stack([1.1 + sign * t, 2.2 + sign * 5 * t + t * t], axis=1)
    t = sign * t
    order = slice(None) if at_start else slice(None, None, -1)
    bent = blended(
        t[order],
        s[order],
        stroke[order],
        rim,
        0.5,
        join,
        at_start=at_start,
    )[order]
    if join == "G1":
        line = rim.point + sign * s[:, None] * rim.direction
        off = np.abs((bent - line) @ [-rim.direction[1], rim.direction[0]])
    else:
        curve = rim.point + t[:, None] * rim.first + t[:, None] ** 2 / 2 * rim.second
        off = np.linalg.norm(bent - curve, axis=1)
    near = (np.abs(t) > 1e-4) & (np.abs(t) < 1e-2)
    measured = np.polyfit(np.log(np.abs(t[near])), np.log(off[near]), 1)[0]
    assert measured == pytest.approx(power, abs=0.1)
    beyond = np.abs(t) >= 0.5
    assert (bent[beyond] == stroke[beyond]).all()


def test_a_rim_reads_two_derivatives_of_what_stands() -> None:
    """From the last two segments of a smooth curve: first to second order, second to first."""
    errors = []
    for h in (1e-2, 1e-3):
        t = 1.0 + h * np.array([-2.0, -1.0, 0.0])
        points = np.stack([np.sin(t), t**3], axis=1)
        rim = Rim.of(1.0, points[-1], t, points)
        errors.append(
            (
                np.abs(rim.first - [np.cos(1.0), 3.0]).max(),
                np.abs(rim.second - [-np.sin(1.0), 6.0]).max(),
            )
        )
    assert errors[1][0] <= 0.02 * errors[0][0]
    assert errors[1][1] <= 0.15 * errors[0][1]


def test_a_corner_has_no_second_derivative() -> None:
    """Where the last two segments make a corner, only the last one counts."""
    rim = Rim.of(2.0, np.array([1.0, 1.0]), np.arange(3.0), np.array([[0.0, 0], [1, 0], [1, 1]]))
    assert rim.first.tolist() == [0, 1]
    assert rim.second.tolist() == [0, 0]
