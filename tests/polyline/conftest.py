"""A run with tiny blocks, so that short curves have many."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from multirep import blocks
from multirep.representations.polyline import boxes, differences, evaluation, proximity


@pytest.fixture
def tiny_blocks() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "BLOCK_ROWS", 8)
        patch.setattr(boxes, "LEAF", 3)
        patch.setattr(proximity, "LEAF", 3)
        patch.setattr(differences, "NARROW", 4)
        patch.setattr(evaluation, "NARROW", 4)
        yield
