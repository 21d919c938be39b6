"""One linear condition on the control points of a NURBS: a point or a derivative at a parameter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import attrs
import numpy as np

from multirep.arrays import Array, Indices
from multirep.errors import EditError
from multirep.representations.nurbs import Nurbs
from multirep.splines import basis_functions, find_spans


@attrs.frozen
class Condition:
    """What a curve shall do at one parameter.

    Parameters
    ----------
    t : float
    order : int
        0: it passes ``target``; 1: its derivative by t is ``target``.
    target : tuple of float
    side : {"right", "left"}
        From which side the derivative is meant.
    breaks : bool
        Whether the derivatives on both sides must be free of each other: a corner.
    """

    t: float
    order: int
    target: tuple[float, ...]
    side: Literal["right", "left"] = "right"
    breaks: bool = False


@attrs.frozen(eq=False)
class Rows:
    """Conditions as rows over the control points of a window of a NURBS.

    Parameters
    ----------
    first : int
        The control point in column 0.
    starts : (m,) indices
        First column of each row.
    rows : (m, p + 1) array
        Factors of the control points from there on.
    points : (n, d) array
        The control points of the window.
    wanted : (m, d) array
        What each condition still misses, target minus present value.
    lengths : (m,) array
        Turns what is missed into the units of the points: 1 for a point, the length of the span
        beside t for a derivative (about p times what its control point is off by).
    """

    first: int
    starts: Indices
    rows: Array
    points: Array
    wanted: Array
    lengths: Array

    @classmethod
    def of(cls, curve: Nurbs, conditions: Sequence[Condition]) -> Rows:
        """Express conditions, in the order of t, on a curve; rational bases by (11.65), (11.66)."""
        p = curve.degree
        t = np.array([condition.t for condition in conditions])
        curve.parameters(t)
        left = np.array([condition.side == "left" for condition in conditions])
        order = np.array([condition.order for condition in conditions])
        low = curve.span(float(t[0]), "left") - p
        high = curve.span(float(t[-1])) + 1
        knots = curve.knots.window(low, high + p + 1)
        spans = find_spans(knots, p, t)
        if left.any():
            spans = np.where(left, find_spans(knots, p, t, side="left"), spans)
        rows = basis_functions(knots, p, t, spans)
        slopes = basis_functions(knots, p, t, spans, order=1) if order.any() else rows
        starts = spans - p
        columns = starts[:, None] + np.arange(p + 1)
        if curve.is_rational:
            weights = curve.weights.window(low, high)[columns]
            rows, slopes = rows * weights, slopes * weights
            total = rows.sum(axis=1, keepdims=True)
            slopes = (slopes - slopes.sum(axis=1, keepdims=True) * rows / total) / total
            rows = rows / total
        rows = np.where(order[:, None] == 1, slopes, rows)
        points = curve.points.window(low, high)
        for condition in conditions:
            if len(condition.target) != curve.dimension:
                raise EditError(
                    f"a condition with {len(condition.target)} coordinates at t = {condition.t!r} "
                    f"on a curve with {curve.dimension}"
                )
        target = np.array([condition.target for condition in conditions])
        present = np.einsum("mq,mqd->md", rows, points[columns])
        spread = knots[spans + 1] - knots[spans]
        return cls(low, starts, rows, points, target - present, np.where(order == 1, spread, 1.0))

    @property
    def missed(self) -> Array:
        """How far each condition is from holding, (m,), in the units of the points."""
        return np.asarray(np.sqrt(np.einsum("md,md->m", self.wanted, self.wanted)) * self.lengths)
