"""How the compiled core finds and exchanges blocks, against the Python that it stands for."""

from __future__ import annotations

import numpy as np
import pytest
from cores import both
from hypothesis import given
from hypothesis import strategies as st

from multirep import runs
from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.runs import Run
from multirep.splines import compiled

pytestmark = pytest.mark.skipif(compiled.core is None, reason="the core was not built")


def ids(some: tuple[Run, ...]) -> list[list[int]]:
    """Which blocks there are, run by run."""
    return [[id(block) for block in run] for run in some]


@st.composite
def arrays(draw: st.DrawFn) -> tuple[tuple[Run, ...], tuple[int, ...]]:
    """Runs of blocks of ascending numbers, often repeated, and where the runs end."""
    lengths = draw(st.lists(st.lists(st.integers(1, 4), min_size=1, max_size=5), min_size=1))
    total = sum(map(sum, lengths))
    steps = draw(st.lists(st.sampled_from([0.0, 0.0, 1.0]), min_size=total, max_size=total))
    numbers, made, at = np.cumsum(steps), [], 0
    for some in lengths:
        stops = (at + np.cumsum(some)).tolist()
        made.append(Run(numbers[i:j] for i, j in zip([at, *stops], stops, strict=False)))
        at = stops[-1]
    return tuple(made), runs.ends_of(tuple(made))


@given(arrays())
def test_every_row_is_found_in_its_block(array: tuple[tuple[Run, ...], tuple[int, ...]]) -> None:
    """Its block, the first row of that and both numbers; the row after the last in the last."""
    some, ends = array
    expected = []
    for g, run in enumerate(some):
        for k, block in enumerate(run):
            expected += [(block, len(expected), g, k)] * len(block)
    expected.append(expected[-1])
    for row, wanted in enumerate(expected):
        for found in both(lambda row=row: runs.place_of(some, ends, row)):
            assert found[0] is wanted[0]
            assert found[1:] == wanted[1:]


@given(arrays(), st.booleans())
def test_values_are_searched_alike(
    array: tuple[tuple[Run, ...], tuple[int, ...]], right: bool
) -> None:
    """As numpy does in a flat array; repeated over blocks, between numbers and beyond both ends."""
    some, ends = array
    flat = np.concatenate([block for run in some for block in run])
    for value in np.arange(-1.0, flat[-1] + 1.5, 0.5).tolist():
        wanted = int(flat.searchsorted(value, "right" if right else "left"))
        assert both(lambda v=value: runs.searched(some, ends, v, right)) == (wanted, wanted)


@given(arrays(), st.data(), st.integers(1, 6))
def test_blocks_are_exchanged_alike(
    array: tuple[tuple[Run, ...], tuple[int, ...]], data: st.DataObject, size: int
) -> None:
    """All other blocks and runs are the same objects, and ends are where they belong."""
    some, ends = array
    g = data.draw(st.integers(0, len(some) - 1))
    k = data.draw(st.integers(0, len(some[g]) - 1))
    other = np.zeros(size)
    for found, found_ends in both(lambda: runs.with_block(some, ends, g, k, other)):
        wanted = ids(some)
        wanted[g][k] = id(other)
        assert ids(found) == wanted
        assert all(a is b for h, (a, b) in enumerate(zip(some, found, strict=True)) if h != g)
        assert all(type(run) is type(some[0]) for run in found)
        assert found_ends == runs.ends_of(found)


@given(arrays(), st.data())
def test_shared_rows_are_counted_alike(
    array: tuple[tuple[Run, ...], tuple[int, ...]], data: st.DataObject
) -> None:
    """Of versions with other blocks, cut into runs elsewhere or with some left out."""
    some, ends = array
    blocks = [block for run in some for block in run]
    for _ in range(data.draw(st.integers(0, 2))):
        k = data.draw(st.integers(0, len(blocks) - 1))
        blocks[k : k + 1] = data.draw(st.sampled_from([[], [np.zeros(2)], [blocks[k], np.ones(1)]]))
        if not blocks:
            return
    cuts = sorted(data.draw(st.sets(st.integers(1, len(blocks)))) | {len(blocks)})
    others = tuple(tuple(blocks[i:j]) for i, j in zip([0, *cuts], cuts, strict=False))
    for theirs in (others, some[:1] + others, some):
        for from_end in (False, True):
            fast, pure = both(lambda t=theirs, e=from_end: runs.shared_rows(some, ends, t, e))
            assert fast == pure


@given(st.integers(1, 40), st.data(), st.sampled_from([(), (1,), (3,)]))
def test_rows_are_replaced_alike(rows: int, data: st.DataObject, tail: tuple[int, ...]) -> None:
    """Rows may lie anywhere in memory, and be none."""
    rng = np.random.default_rng(rows)
    old: Array = rng.random((rows, *tail))
    start = data.draw(st.integers(0, rows))
    stop = data.draw(st.integers(start, rows))
    new = rng.random((2 * data.draw(st.integers(0, 5)), *tail))[::-2]
    array = BlockArray.of(old)
    wanted = np.concatenate((old[:start], new, old[stop:]))
    for found in both(lambda: np.asarray(array.replaced(start, stop, new))):
        assert found.shape == wanted.shape
        assert found.tobytes() == wanted.tobytes()


def test_what_is_no_array_of_blocks_is_refused() -> None:
    """Errors, not crashes."""
    call, block = compiled.core, np.arange(4.0)
    some, ends = ((block, block + 4.0), (block + 8.0,)), (8, 12)
    for wrong in ([block], (block,)):
        with pytest.raises(ValueError, match="runs of blocks"):
            call.place(wrong, ends, 0)  # type: ignore[arg-type]
    with pytest.raises(IndexError):
        call.place((), (), 0)
    with pytest.raises(IndexError):
        call.place(some, (), 9)
    with pytest.raises(IndexError):
        call.searched((), (), 0.5, True)
    with pytest.raises(IndexError):
        call.searched(((), ()), (0, 0), 0.5, True)
    with pytest.raises(ValueError, match="numbers in a row"):
        call.searched(((block.reshape(2, 2),),), (2,), 0.5, True)
    with pytest.raises(ValueError, match="numbers in a row"):
        call.searched(((block[::2],),), (2,), 0.5, True)
    with pytest.raises(TypeError):
        call.with_block(some, ends, 0, 0, 1.0)  # type: ignore[arg-type]
    with pytest.raises(IndexError):
        call.with_block(some, ends, 0, 2, block)
    with pytest.raises(IndexError):
        call.with_block(some, ends, -1, 0, block)
    with pytest.raises(ValueError, match="as many runs as ends"):
        call.with_block(some, (8,), 0, 0, block[:1])
    with pytest.raises(IndexError):
        call.shared_rows(some, (), some, False)
    for start, stop, rows, room in (
        (-1, 2, 1, 2),
        (2, 1, 1, 6),
        (3, 5, 0, 2),
        (0, 1, 1, 5),
        (2**63 - 1, 2**63 - 1, 0, 4),
    ):
        with pytest.raises(ValueError, match="room for all rows"):
            call.joined(block, start, stop, np.zeros(rows), np.empty(room))
    with pytest.raises(ValueError, match="room for all rows"):
        call.joined(block, 0, 1, np.zeros((1, 2)), block.copy())
    knots, points = np.array([0, 0, 0, 1, 1, 1.0]), np.zeros((3, 2))
    room = np.empty(7), np.empty((4, 2)), None
    for degree, at, last in (
        (0, 3, 2),
        (2, 1, 2),
        (2, 5, 2),
        (2, 3, 1),
        (2, 3, 3),
        (2**62, 2**62, 2),
    ):
        with pytest.raises(ValueError, match="its neighbours in one block"):
            call.insert_knot(degree, 0.5, 0.0, 1.0, knots, at, points, last, None, 0, *room)
    with pytest.raises(ValueError, match="its neighbours in one block"):
        call.insert_knot(2, 0.5, 0.0, 1.0, knots, 3, points, 2, np.ones(3), 2, *room)
    for heaviest, more in ((1, 4), (3, 4), (2, 3)):
        with pytest.raises(ValueError, match="its weights in one block"):
            call.insert_knot(
                2,
                0.5,
                0.0,
                1.0,
                knots,
                3,
                points,
                2,
                np.ones(3),
                heaviest,
                *room[:2],
                np.empty(more),
            )
