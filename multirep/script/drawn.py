"""Where the pen went in a step, for pictures: strokes, paths, and from where to where it pulled."""

from __future__ import annotations

from typing import Any

import numpy as np

from multirep.arrays import Array
from multirep.script.model import ConstrainStep, GestureStep, Step, ToolStep


def strokes_of(step: Step) -> tuple[Array, ...]:
    """Return the polylines, each (n, d), that the parameters of a step describe.

    Tools are asked for what they have (``stroke``, ``strokes``, ``path``, ``at`` and ``to``), so
    plugins are drawn too.
    """
    if isinstance(step, GestureStep):
        parts = [part.tool for part in step.parts if isinstance(part, ToolStep)]
    elif isinstance(step, ToolStep):
        parts = [step.tool]
    elif isinstance(step, ConstrainStep):
        parts = [step.constraint]
    else:
        parts = []
    found: list[Array] = []
    for part in parts:
        found += _of(part)
    return tuple(found)


def _of(part: Any) -> list[Array]:
    lines = [getattr(part, "stroke", None), getattr(part, "path", None)]
    lines += list(getattr(part, "strokes", None) or ())
    at, to = getattr(part, "at", None), getattr(part, "to", None)
    if at is not None and to is not None:
        lines.append((at, to))
    found = [_rows(line) for line in lines if line is not None]
    return [rows for rows in found if rows is not None]


def _rows(line: Any) -> Array | None:
    """Return points as an array, or None when they are none."""
    try:
        rows = np.asarray(line, dtype=np.float64)
    except (TypeError, ValueError):
        return None
    return rows if rows.ndim == 2 and len(rows) > 1 else None
