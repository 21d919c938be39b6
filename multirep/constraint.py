"""The contract of a constraint: a condition re-established after every change (Grimm-Ayers 4.1)."""

from __future__ import annotations

import abc
from collections.abc import Mapping
from typing import Any, ClassVar, Generic, TypeVar

from multirep.edit import Edit
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.splices import SpliceList

R = TypeVar("R", bound=Representation)


class Constraint(abc.ABC, Generic[R]):
    """A frozen attrs class: a condition on one kind of representation, always active.

    You must set ``name`` and ``needs`` and override :meth:`region`, :meth:`residual` and
    :meth:`enforce`. You may override what stands below the second line.

    After every change the framework asks the constraints whose region the change touches for
    their residuals, and lets those that do not hold re-establish themselves, in rounds, until all
    hold. It may be the change of another constraint that woke yours. If that goes round in circles
    the whole edit is rejected (:class:`~multirep.errors.ConflictError`).
    """

    __slots__ = ()

    #: The name in scripts, as in "point".
    name: ClassVar[str]
    #: The representation that the condition is about.
    needs: ClassVar[type[Representation]]
    #: Groups are settled from high to low.
    priority: ClassVar[int] = 0
    #: Constraints of one family are solved together where their regions overlap, by one call of
    #: :meth:`enforce_together`; None: each for itself.
    family: ClassVar[str | None] = None

    @abc.abstractmethod
    def region(self, value: R, /) -> Interval:
        """Return the stretch of T that the constraint claims.

        It may change the curve there, and changes there wake it.
        """

    @abc.abstractmethod
    def residual(self, value: R, /) -> float:
        """How far the condition is from holding, in the units of the points; 0 when it holds.

        Below a billionth of the size of the curve it counts as holding.
        """

    @abc.abstractmethod
    def enforce(self, value: R, change: SpliceList, scene: Scene, /) -> Edit[R]:
        """Return an edit after which the condition holds; ``change`` woke the constraint.

        ``scene.frozen`` is where the curve may not change, ``scene.aims`` what the tool asked for.
        Raise :class:`~multirep.errors.ConflictError` when it cannot hold.
        """

    # -- may override ------------------------------------------------------------------------------

    @classmethod
    def enforce_together(
        cls, group: Mapping[str, Constraint[Any]], value: R, change: SpliceList, scene: Scene, /
    ) -> Edit[R]:
        """Return an edit after which all of ``group`` hold: constraints of this family by name.

        Called only when ``family`` is set, on the class of the first of them. Raise
        :class:`~multirep.errors.ConflictError` with the names of those that exclude each other.
        """
        raise NotImplementedError(f"{cls.__name__} sets a family but no enforce_together")

    def frozen(self, value: R, /) -> SpliceList:
        """Return the stretches that nothing may change from now on, not by a bit; none by default.

        Asked once, when the constraint is added and holds. From then on the kernel sees to it, and
        a constraint that freezes is asked for nothing else.
        """
        return SpliceList.EMPTY
