"""Options of strokes as fields of tools: how they are checked."""

from __future__ import annotations

import math
from typing import Any

from attrs import Attribute


def length(instance: object, attribute: Attribute[Any], value: float) -> None:
    """Raise ValueError unless the field is a length > 0."""
    if not 0 < value < math.inf:
        raise ValueError(f"{attribute.name!r} must be a length > 0: {value!r}")


def length_or_zero(instance: object, attribute: Attribute[Any], value: float) -> None:
    """Raise ValueError unless the field is a length or 0."""
    if not 0 <= value < math.inf:
        raise ValueError(f"{attribute.name!r} must be a length >= 0: {value!r}")
