"""Setting and moving the marks between which edits are allowed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from attrs import field, frozen, validators
from attrs.converters import optional

from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import EditError
from multirep.fields import finite_number
from multirep.interval import Interval
from multirep.registry import Registry
from multirep.representations.polyline import Polyline
from multirep.scene import Scene
from multirep.splices import SpliceList
from multirep.tool import Tool


def _label(instance: object, attribute: object, value: object) -> None:
    if not isinstance(value, str) or not value:
        raise ValueError(f"'label' must be a name, got {value!r}")


@frozen
class Mark(Tool[Polyline]):
    """Create, move or remove a left and a right mark (Grimm-Ayers 5.2).

    What is not between the marks is frozen: the constraint ``mark`` does that, under the name of
    the label. The curve itself stays as it is.

    Parameters
    ----------
    left : float, optional
        Where on T the left mark goes; it stays where it is without it, at first the start of T.
    right : float, optional
        Likewise, at first the end of T.
    remove : bool
        Take both marks away.
    label : str
        Name of the pair, to have several; only what lies between all of them is free.

    Examples
    --------
    >>> import multirep as mr
    >>> zigzag = Polyline([0, 1, 2, 4], [[0, 0], [1, 1], [2, 0], [3, 1]])
    >>> framework = mr.Framework()
    >>> framework.add("zigzag", mr.MultiRepresentation(zigzag, tolerance=1e-3, kinds=[Polyline]))
    >>> outcome = framework.apply("zigzag", Mark(left=1.0))
    >>> outcome = framework.apply("zigzag", Mark(right=3.0))
    >>> framework.constraints("zigzag")
    {'mark': Mark(interval=(1.0, 3.0))}
    >>> print(framework.curve("zigzag").frozen)
    [0,1] [3,4]
    """

    name = "mark"
    edits = Polyline

    left: float | None = field(
        default=None, converter=optional(float), validator=validators.optional(finite_number)
    )
    """Where on T the left mark goes."""
    right: float | None = field(
        default=None, converter=optional(float), validator=validators.optional(finite_number)
    )
    """Where on T the right mark goes."""
    remove: bool = field(default=False, validator=validators.instance_of(bool))
    """Take both marks away."""
    label: str = field(default="mark", validator=_label)
    """Name of the pair."""

    def __attrs_post_init__(self) -> None:
        given = self.left is not None or self.right is not None
        if given == self.remove:
            found = "both" if given else "neither"
            raise ValueError(f"give 'left', 'right' or both, or else 'remove'; got {found}")

    def edit(self, polyline: Polyline, scene: Scene) -> Edit[Polyline]:
        """Return the curve as it is."""
        return Edit(polyline, SpliceList.EMPTY)

    def constrains(
        self, polyline: Polyline, held: Mapping[str, Constraint[Any]]
    ) -> Mapping[str, Constraint[Any] | None]:
        """Return the constraint between the marks, or None in its place to remove it.

        Raises
        ------
        EditError
            When there are no marks to remove, or they would be in the wrong order or outside T.
        """
        kind: Any = Registry.discover().constraints["mark"]
        present: Any = held.get(self.label)
        if present is not None and not isinstance(present, kind):
            raise EditError(f"{self.label!r} names a constraint of another kind: {present!r}")
        if self.remove:
            if present is None:
                raise EditError(f"there are no marks named {self.label!r}")
            return {self.label: None}
        start, stop = polyline.domain if present is None else present.interval
        left = start if self.left is None else self.left
        right = stop if self.right is None else self.right
        if not (left < right and polyline.domain.contains(Interval(left, right))):
            raise EditError(
                f"the marks must stand in order within {polyline.domain}, "
                f"got {left!r} and {right!r}"
            )
        return {self.label: kind(interval=(left, right))}
