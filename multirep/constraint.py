"""The contract of a constraint: a condition re-established after every change (Grimm-Ayers 4.1)."""

from __future__ import annotations

import abc
from typing import ClassVar, Generic, TypeVar

from multirep.edit import Edit
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.splices import SpliceList

R = TypeVar("R", bound=Representation)


class Constraint(abc.ABC, Generic[R]):
    """A frozen attrs class: a condition on one kind of representation, always active.

    You must set ``name`` and ``needs`` and override :meth:`region`, :meth:`residual` and
    :meth:`enforce`.
    """

    __slots__ = ()

    #: The name in scripts, as in "point".
    name: ClassVar[str]
    #: The representation that the condition is about.
    needs: ClassVar[type[Representation]]
    #: Groups are settled from high to low.
    priority: ClassVar[int] = 0

    @abc.abstractmethod
    def region(self, value: R, /) -> Interval:
        """Return the stretch of T that the constraint claims.

        It may change the curve there, and changes there wake it.
        """

    @abc.abstractmethod
    def residual(self, value: R, /) -> float:
        """How far the condition is from holding, in the units of the points; 0 when it holds."""

    @abc.abstractmethod
    def enforce(self, value: R, change: SpliceList, scene: Scene, /) -> Edit[R]:
        """Return an edit after which the condition holds; ``change`` woke the constraint."""
