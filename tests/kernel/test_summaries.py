"""What is known of blocks and runs, taken over from version to version."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import blocks, runs
from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.runs import shared_ends
from multirep.summaries import Summaries


@pytest.fixture(autouse=True, scope="module")
def small_blocks() -> Iterator[None]:
    """Blocks of 8 rows in runs of 4, so that short arrays have many."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "BLOCK_ROWS", 8)
        patch.setattr(runs, "RUN_BLOCKS", 4)
        yield


def largest(block: Array) -> float:
    return float(block.max())


@given(data=st.data(), rows=st.integers(1, 200))
def test_summaries_are_those_of_a_version_made_from_nothing(data: st.DataObject, rows: int) -> None:
    """Along any versions, forth and back; only blocks that are not shared are looked into."""
    array = BlockArray.of(np.arange(rows, dtype=float))
    versions = [array]
    for k in range(data.draw(st.integers(0, 8))):
        start = data.draw(st.integers(0, len(array)))
        stop = data.draw(st.integers(start, min(len(array), start + 30)))
        new = np.full(data.draw(st.integers(0 if stop - start < len(array) else 1, 30)), 1e3 + k)
        array = array.replaced(start, stop, new)
        versions.append(array)
    known = Summaries[float, float]()
    before = BlockArray.of(np.empty(0))
    for array in (*versions, data.draw(st.sampled_from(versions))):
        looked: list[Array] = []

        def look(block: Array, looked: list[Array] = looked) -> float:
            looked.append(block)
            return largest(block)

        known = known.renewed(array, look, max)
        fresh = Summaries[float, float]().renewed(array, largest, max)
        assert known.blocks == fresh.blocks
        assert known.wholes == fresh.wholes
        assert max(known.wholes) == max(array)
        head, tail = shared_ends(before.blocks, array.blocks)
        assert len(looked) <= max(len(array.blocks) - head - tail, 1)
        before = array


def test_the_same_version_gives_the_same_summaries() -> None:
    """Of one block or many, nothing is made again."""
    for rows in (5, 500):
        array = BlockArray.of(np.arange(rows, dtype=float))
        known = Summaries[float, float]().renewed(array, largest, max)
        assert known.renewed(array, pytest.fail, pytest.fail) is known


@given(one=st.lists(st.integers(0, 2), max_size=9), two=st.lists(st.integers(0, 2), max_size=9))
def test_shared_ends_agree_with_the_definition(one: list[int], two: list[int]) -> None:
    """As many as there are at the head, then as many as there are left at the tail."""
    most = min(len(one), len(two))
    head = max(k for k in range(most + 1) if one[:k] == two[:k])
    tail = max(k for k in range(most - head + 1) if one[len(one) - k :] == two[len(two) - k :])
    assert shared_ends(one, two) == (head, tail)
