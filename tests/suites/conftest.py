"""Short blocks for all suites: arrays of a hundred rows cross block borders as long ones do."""

from __future__ import annotations

import pytest

from multirep import blocks


@pytest.fixture(autouse=True)
def short_blocks(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of 16 rows, except in classes named after long curves."""
    if request.cls is None or "Long" not in request.cls.__name__:
        monkeypatch.setattr(blocks, "BLOCK_ROWS", 16)
