"""The loopback representation passes the suite that every representation must pass."""

from __future__ import annotations

import numpy as np
import pytest

from multirep.testing import LoopbackRepresentation, RepresentationSuite


class TestLoopback(RepresentationSuite):
    @pytest.fixture
    def representation(self) -> LoopbackRepresentation:
        t = np.linspace(0.0, 1.0, 33)
        return LoopbackRepresentation(t, np.column_stack([np.cos(5 * t), np.sin(3 * t), t**2]))
