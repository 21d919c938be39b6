"""Whether the compiled core is there: the same mathematics in one call instead of dozens.

An edit works on short arrays, where a numpy call costs more than its arithmetic. The core, the C
files in the project's folder ``core``, takes over there; the numpy functions stay as its reference
and do all the work where the core was not built or ``MULTIREP_PURE`` is set in the environment.
"""

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multirep.splines import _core as core
else:
    try:
        from multirep.splines import _core as core
    except ImportError:
        core = None

__all__ = ["active", "core"]

#: Whether functions hand their work to the core.
active: bool = core is not None and not os.environ.get("MULTIREP_PURE")
