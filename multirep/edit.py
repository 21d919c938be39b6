"""An edit: a new value of a representation and the splices on which it differs from the old one."""

from __future__ import annotations

from typing import Generic, TypeVar

import attrs

from multirep.splices import SpliceList

V = TypeVar("V", covariant=True)


@attrs.frozen(eq=False)
class Edit(Generic[V]):
    """What an operation on a representation returns.

    Parameters
    ----------
    value : Representation
        The new value; the old one is untouched.
    splices : SpliceList
        Where they differ. Outside, the curve evaluates bit-identically, and every array element
        whose support does not meet the interior of a splice is bit-identical.
    bound : float
        For a splice: the largest ``||value - L||`` that was proved. 0 for edits by hand.
    """

    value: V
    splices: SpliceList
    bound: float = 0.0
