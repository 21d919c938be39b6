"""One curve, many representations, kept in step with a proved deviation.

``import multirep as mr`` costs nothing: every name is loaded when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.blocks import BlockArray as BlockArray
    from multirep.constraint import Constraint as Constraint
    from multirep.deviation import Deviation as Deviation
    from multirep.edit import Edit as Edit
    from multirep.framework import Framework as Framework
    from multirep.interval import Interval as Interval
    from multirep.multirepresentation import MultiRepresentation as MultiRepresentation
    from multirep.registry import Registry as Registry
    from multirep.representation import Representation as Representation
    from multirep.sampled import SampledSplice as SampledSplice
    from multirep.scene import Scene as Scene
    from multirep.session import Session as Session
    from multirep.splices import SpliceList as SpliceList
    from multirep.tool import Tool as Tool

__version__ = "0.1.0"

_HOMES = {
    "BlockArray": "blocks",
    "Constraint": "constraint",
    "Deviation": "deviation",
    "Edit": "edit",
    "Framework": "framework",
    "Interval": "interval",
    "MultiRepresentation": "multirepresentation",
    "Registry": "registry",
    "Representation": "representation",
    "SampledSplice": "sampled",
    "Scene": "scene",
    "Session": "session",
    "SpliceList": "splices",
    "Tool": "tool",
}

__all__ = [*_HOMES, "__version__"]


__getattr__ = on_demand(__name__, _HOMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
