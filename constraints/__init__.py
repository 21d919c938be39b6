"""The built-in constraints; each is loaded when it is first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.constraints.condition import Condition as Condition
    from multirep.constraints.corner import CornerConstraint as CornerConstraint
    from multirep.constraints.derivative import DerivativeConstraint as DerivativeConstraint
    from multirep.constraints.freeze import Freeze as Freeze
    from multirep.constraints.linear import LinearConstraint as LinearConstraint
    from multirep.constraints.mark import Mark as Mark
    from multirep.constraints.point import PointConstraint as PointConstraint

_HOMES = {
    "Condition": "condition",
    "CornerConstraint": "corner",
    "DerivativeConstraint": "derivative",
    "Freeze": "freeze",
    "LinearConstraint": "linear",
    "Mark": "mark",
    "PointConstraint": "point",
}

__all__ = [
    "Condition",
    "CornerConstraint",
    "DerivativeConstraint",
    "Freeze",
    "LinearConstraint",
    "Mark",
    "PointConstraint",
]


__getattr__ = on_demand(__name__, _HOMES)
