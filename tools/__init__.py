"""The built-in tools; each is loaded when it is first used."""

from __future__ import annotations

from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.tools.copy_detail import CopyDetail as CopyDetail
    from multirep.tools.corner import Corner as Corner
    from multirep.tools.delete_vertex import DeleteVertex as DeleteVertex
    from multirep.tools.direct_manipulation import DirectManipulation as DirectManipulation
    from multirep.tools.insert_knot import InsertKnot as InsertKnot
    from multirep.tools.insert_vertex import InsertVertex as InsertVertex
    from multirep.tools.mark import Mark as Mark
    from multirep.tools.move_control_point import MoveControlPoint as MoveControlPoint
    from multirep.tools.move_vertex import MoveVertex as MoveVertex
    from multirep.tools.oversketch import Oversketch as Oversketch
    from multirep.tools.set_weight import SetWeight as SetWeight
    from multirep.tools.show_level import ShowLevel as ShowLevel
    from multirep.tools.sketch import Sketch as Sketch
    from multirep.tools.smooth import Smooth as Smooth
    from multirep.tools.spatula import Spatula as Spatula
    from multirep.tools.sweep import Sweep as Sweep

_HOMES = {
    "CopyDetail": "copy_detail",
    "Corner": "corner",
    "DeleteVertex": "delete_vertex",
    "DirectManipulation": "direct_manipulation",
    "InsertKnot": "insert_knot",
    "InsertVertex": "insert_vertex",
    "Mark": "mark",
    "MoveControlPoint": "move_control_point",
    "MoveVertex": "move_vertex",
    "Oversketch": "oversketch",
    "SetWeight": "set_weight",
    "ShowLevel": "show_level",
    "Sketch": "sketch",
    "Smooth": "smooth",
    "Spatula": "spatula",
    "Sweep": "sweep",
}

__all__ = [
    "CopyDetail",
    "Corner",
    "DeleteVertex",
    "DirectManipulation",
    "InsertKnot",
    "InsertVertex",
    "Mark",
    "MoveControlPoint",
    "MoveVertex",
    "Oversketch",
    "SetWeight",
    "ShowLevel",
    "Sketch",
    "Smooth",
    "Spatula",
    "Sweep",
]


__getattr__ = on_demand(__name__, _HOMES)
