"""Edits at the borders of frozen stretches: faded out before them, and followed beside them."""

from __future__ import annotations

from collections.abc import Iterable

from multirep.aim import Aim, misses
from multirep.blending import blended
from multirep.edit import Edit
from multirep.errors import ToleranceError
from multirep.freezing import frozen_error
from multirep.multirepresentation import MultiRepresentation
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.synchronization import hop

#: Of a hop, how closely a faded edit is followed.
FADE_SHARE = 0.5


def clear_of_ice(
    curve: MultiRepresentation,
    value: Representation,
    edit: Edit[Representation],
    who: str,
    aims: Iterable[Aim] = (),
) -> Edit[Representation]:
    """Return the edit, faded out before the frozen stretches that it reaches into.

    Raises
    ------
    FrozenError
        When an aim that the curve does not meet already lies in a frozen stretch, or nothing is
        left of the edit.
    """
    if not edit.splices.intersects(curve.frozen):
        return edit
    aims = tuple(aims)
    forbidden = [
        aim for aim in aims if curve.frozen.contains(aim.t) and not _holds_already(aim, value)
    ]
    faded = None
    if not forbidden:
        tolerance = FADE_SHARE * hop(curve.tolerance)
        faded = blended(value, edit, curve.frozen, tolerance=tolerance, aims=aims)
    if faded is None:
        place = f" at t = {forbidden[0].t:g}" if forbidden else ""
        raise frozen_error(curve.snapshot(), edit.splices, f"{who}{place}")
    return faded


def _holds_already(aim: Aim, value: Representation) -> bool:
    """Whether an aim asks for nothing but the point where the curve is."""
    only_a_point = aim.point is not None and not (aim.left or aim.right or aim.smooth)
    return only_a_point and misses(aim, value) == 0.0


def follow_beside_ice(curve: MultiRepresentation, changed: SpliceList, who: str) -> None:
    """Bring all kinds up to date where a change ends at a frozen border, in time to take it back.

    Raises
    ------
    FrozenError
        When one of them, held at the border, cannot follow the change.
    """
    state = curve.snapshot()
    borders = [end for part in state.frozen for end in part if changed.contains(end)]
    if not borders:
        return
    for kind in curve.kinds:
        try:
            curve.view(kind, changed)
        except ToleranceError as error:
            beside = SpliceList(
                part for part in state.frozen if any(part.contains(end) for end in borders)
            )
            told = frozen_error(state, beside, f"{who} beside {beside}")
            told.args = (f"{who} cannot be followed beside what is frozen: {error}",)
            raise told from error
