"""The conformance kit: laws, strategies, doubles and suites (``pip install multirep[testing]``).

For the author of a plugin, in reading order: subclass :class:`RepresentationSuite`,
:class:`ToolSuite` or :class:`ConstraintSuite` in a test module and supply the fixtures that it
names; use the laws (:func:`check_edit` and its companions) behind tests of your own, the strategies
in :mod:`multirep.testing.strategies` for generated input, and the doubles in
:mod:`multirep.testing.doubles` where a test needs a partner that is trivially right or deliberately
wrong.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from multirep.loading import on_demand

if TYPE_CHECKING:
    from multirep.testing.constraint_suite import ConstraintSuite as ConstraintSuite
    from multirep.testing.doubles import CountingRepresentation as CountingRepresentation
    from multirep.testing.doubles import NoTouchRepresentation as NoTouchRepresentation
    from multirep.testing.doubles import RecordingTool as RecordingTool
    from multirep.testing.doubles import VetoConstraint as VetoConstraint
    from multirep.testing.elements import Elements as Elements
    from multirep.testing.elements import default_elements as default_elements
    from multirep.testing.faults import faulty_tools as faulty_tools
    from multirep.testing.laws import check_certificate as check_certificate
    from multirep.testing.laws import check_data as check_data
    from multirep.testing.laws import check_edit as check_edit
    from multirep.testing.laws import check_fit as check_fit
    from multirep.testing.laws import check_same as check_same
    from multirep.testing.laws import check_sample as check_sample
    from multirep.testing.laws import check_splice as check_splice
    from multirep.testing.loopback import LoopbackRepresentation as LoopbackRepresentation
    from multirep.testing.representation_suite import RepresentationSuite as RepresentationSuite
    from multirep.testing.tool_suite import ToolSuite as ToolSuite

_HOMES = {
    "ConstraintSuite": "constraint_suite",
    "CountingRepresentation": "doubles",
    "Elements": "elements",
    "LoopbackRepresentation": "loopback",
    "NoTouchRepresentation": "doubles",
    "RecordingTool": "doubles",
    "RepresentationSuite": "representation_suite",
    "ToolSuite": "tool_suite",
    "VetoConstraint": "doubles",
    "check_certificate": "laws",
    "check_data": "laws",
    "check_edit": "laws",
    "check_fit": "laws",
    "check_same": "laws",
    "check_sample": "laws",
    "check_splice": "laws",
    "default_elements": "elements",
    "faulty_tools": "faults",
}

__all__ = list(_HOMES)

if "pytest" in sys.modules:  # let the asserts of the suites say what they compared
    sys.modules["pytest"].register_assert_rewrite(
        *(f"multirep.testing.{kind}_laws" for kind in ("value", "sampling", "splicing", "fitting")),
        *(f"multirep.testing.{kind}_suite" for kind in ("tool", "constraint")),
    )


__getattr__ = on_demand(__name__, _HOMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
