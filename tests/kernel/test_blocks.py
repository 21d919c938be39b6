"""Block arrays against flat numpy, and what they share."""

from __future__ import annotations

import pickle
from bisect import bisect_left, bisect_right
from itertools import takewhile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from multirep import blocks, runs
from multirep.arrays import Array
from multirep.blocks import BlockArray
from multirep.errors import InvariantError
from multirep.splines import compiled


@pytest.fixture(autouse=True, scope="module")
def small_blocks() -> object:
    """Blocks of 8 rows in runs of 8, so that short arrays have many."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(blocks, "BLOCK_ROWS", 8)
        patch.setattr(runs, "RUN_BLOCKS", 8)
        yield


def flat(rows: int, columns: int = 0) -> Array:
    numbers = np.arange(rows * max(columns, 1), dtype=float)
    return numbers.reshape(rows, columns) if columns else numbers


@st.composite
def edits(draw: st.DrawFn, rows: int) -> list[tuple[int, int, int]]:
    """Windows to replace: (start, stop, new rows), each in terms of the length at its turn."""
    steps, n = [], rows
    for _ in range(draw(st.integers(1, 12))):
        start = draw(st.integers(0, n))
        stop = draw(st.integers(start, min(n, start + 30)))
        new = draw(st.integers(0, 30))
        steps.append((start, stop, new))
        n += new - (stop - start)
    return steps


def versions(array: Array, steps: list[tuple[int, int, int]]) -> list[tuple[BlockArray, Array]]:
    """Apply replacements to a block array and to a flat array, and return each version of both."""
    block, plain = BlockArray.of(array), array
    made = [(block, plain)]
    for k, (start, stop, new) in enumerate(steps):
        rows = -1.0 - 100 * k - flat(new, *array.shape[1:])
        block = block.replaced(start, stop, rows)
        plain = np.concatenate([plain[:start], rows, plain[stop:]])
        made.append((block, plain))
    return made


def check_runs(array: BlockArray) -> None:
    """The lists of an array say what its blocks are, and no run is out of bounds."""
    assert [id(b) for run in array.runs for b in run] == [id(b) for b in array.blocks]
    assert all(1 <= len(run) <= 12 for run in array.runs)
    assert array._ends == runs.ends_of(array.runs)
    assert sum(map(len, array.blocks)) == len(array)
    assert array._only is (array.blocks[0] if len(array.blocks) == 1 else None)


@pytest.mark.parametrize("columns", [0, 3])
@given(data=st.data(), rows=st.integers(0, 100))
def test_replaced_agrees_with_flat_numpy(columns: int, data: st.DataObject, rows: int) -> None:
    """Any sequence of replacements reads like the flat array; every earlier version is
    unchanged.
    """
    made = versions(flat(rows, columns), data.draw(edits(rows)))
    for block, plain in made:
        assert len(block) == len(plain)
        assert block.shape == plain.shape
        assert block.ndim == plain.ndim
        assert block.size == plain.size
        np.testing.assert_array_equal(np.asarray(block), plain)
        assert all(len(b) for b in block.blocks), "no empty block"
        check_runs(block)
        assert not any(b.flags.writeable for b in block.blocks)


@pytest.mark.parametrize("columns", [0, 2])
@given(data=st.data(), rows=st.integers(100, 600))
def test_splices_at_borders_copy_what_they_touch(
    columns: int, data: st.DataObject, rows: int
) -> None:
    """In long arrays, at the ends of blocks and runs and beside them, growing and shrinking: the
    same rows as in a flat array, blocks between bounds, and all others the same objects.
    """
    block, plain = BlockArray.of(flat(rows, columns)), flat(rows, columns)
    for step in range(data.draw(st.integers(1, 8))):
        borders = np.cumsum([0, *map(len, block.blocks)]).tolist()
        first = data.draw(st.integers(0, len(borders) - 1))
        last = min(first + data.draw(st.integers(0, 2)), len(borders) - 1)
        beside = st.integers(-2, 2)
        start = min(max(borders[first] + data.draw(beside), 0), len(plain))
        stop = min(max(borders[last] + data.draw(beside), start), len(plain))
        new = -1.0 - 1000 * step - flat(data.draw(st.integers(0, 12)), columns)
        before, block = block, block.replaced(start, stop, new)
        plain = np.concatenate([plain[:start], new, plain[stop:]])
        np.testing.assert_array_equal(np.asarray(block), plain)
        check_runs(block)
        lengths = [len(b) for b in block.blocks]
        assert max(lengths) < 12
        assert min(lengths) >= 2
        touched = max(bisect_left(borders, stop) - bisect_right(borders, start) + 1, 1)
        known = {id(b) for b in before.blocks}
        fresh = [len(b) for b in block.blocks if id(b) not in known]
        assert len(before.blocks) - (len(lengths) - len(fresh)) <= touched + 1
        assert sum(fresh) <= len(new) + 12 * (touched + 1)


@pytest.mark.parametrize("columns", [0, 3])
@given(data=st.data(), rows=st.integers(1, 100))
def test_reading_agrees_with_flat_numpy(columns: int, data: st.DataObject, rows: int) -> None:
    """Rows, slices (negative and out of range too), masks, index arrays and iteration read like
    numpy.
    """
    block, plain = versions(flat(rows, columns), data.draw(edits(rows)))[-1]
    n = len(plain)
    if n:
        index = data.draw(st.integers(-n, n - 1))
        np.testing.assert_array_equal(block[index], plain[index])
        np.testing.assert_array_equal(block[np.int64(index)], plain[index])
        chosen = np.array(data.draw(st.lists(st.integers(-n, n - 1), max_size=5)), dtype=int)
        np.testing.assert_array_equal(block[chosen], plain[chosen])
    i, j = data.draw(st.integers(-n - 3, n + 3)), data.draw(st.integers(-n - 3, n + 3))
    for key in (slice(i, j), slice(None), slice(None, j), slice(i, None), slice(None, None, -1)):
        np.testing.assert_array_equal(block[key], plain[key])
    np.testing.assert_array_equal(block[np.arange(n) % 2 == 0], plain[np.arange(n) % 2 == 0])
    np.testing.assert_array_equal(np.array(list(block)).reshape(plain.shape), plain)
    assert block.tolist() == plain.tolist()
    np.testing.assert_array_equal(block.copy(), plain)
    assert block.copy().flags.writeable
    if n:
        for name in ("min", "max", "sum", "mean"):
            np.testing.assert_array_equal(
                getattr(block, name)(axis=0), getattr(plain, name)(axis=0)
            )
    np.testing.assert_array_equal(2 * block + 1, 2 * plain + 1)
    np.testing.assert_array_equal(np.abs(block), np.abs(plain))
    again = pickle.loads(pickle.dumps(block))
    np.testing.assert_array_equal(np.asarray(again), plain)


@pytest.mark.parametrize("rows", [5, 100])
def test_numbers_of_rows_may_be_numpys(rows: int) -> None:
    """As what `searchsorted` or `nonzero` return; in one block and in several."""
    a, low, high = BlockArray.of(flat(rows)), np.int64(2), np.intp(rows - 1)
    np.testing.assert_array_equal(a.window(low, high), flat(rows)[low:high])
    for start, stop in ((low, high), (low, low), (low, low + 1)):
        b = a.replaced(start, stop, [-1.0])
        np.testing.assert_array_equal(
            b, np.concatenate((flat(rows)[:start], [-1.0], flat(rows)[stop:]))
        )
    assert a.searchsorted(np.float64(2.0)) == 2


@pytest.mark.parametrize("key", [5, -6])
def test_an_index_out_of_range_is_an_index_error(key: int) -> None:
    """As with numpy, with the number in the message."""
    with pytest.raises(IndexError, match=str(key)):
        BlockArray.of(flat(5))[key]


@given(data=st.data(), rows=st.integers(0, 160))
def test_searchsorted_agrees_with_numpy(data: st.DataObject, rows: int) -> None:
    """On sorted arrays with repeated values, for both sides, before, between, at and after the
    values.
    """
    values = sorted(data.draw(st.lists(st.integers(0, 20), min_size=rows, max_size=rows)))
    plain = np.array(values, dtype=float)
    block = BlockArray.of(plain)
    for value in np.arange(-1.0, 21.5, 0.5).tolist():
        for side in ("left", "right"):
            assert block.searchsorted(value, side=side) == plain.searchsorted(value, side=side)


def check_difference(a: BlockArray, b: BlockArray) -> tuple[int, int, int]:
    low, high, other_high = a.difference(b)
    x, y = np.asarray(a), np.asarray(b)
    assert 0 <= low <= high <= len(a)
    assert low <= other_high <= len(b)
    np.testing.assert_array_equal(x[:low], y[:low])
    np.testing.assert_array_equal(x[high:], y[other_high:])
    if low < high and low < other_high:  # as small as it gets
        assert (x[low] != y[low]).any()
        assert (x[high - 1] != y[other_high - 1]).any()
    return low, high, other_high


@pytest.mark.parametrize("columns", [0, 2])
@given(data=st.data(), rows=st.integers(0, 100))
def test_difference_finds_the_smallest_window(columns: int, data: st.DataObject, rows: int) -> None:
    """For any two versions: equal before low, equal behind high, different at both; nothing for
    equal arrays.
    """
    made = [block for block, _ in versions(flat(rows, columns), data.draw(edits(rows)))]
    a, b = data.draw(st.sampled_from(made)), data.draw(st.sampled_from(made))
    check_difference(a, b)
    check_difference(b, a)
    check_difference(a, BlockArray.of(np.array(b)))  # equal values in blocks of its own
    low, high, other_high = a.difference(a)
    assert low == high == other_high
    low, high, other_high = a.difference(BlockArray.of(np.array(a)))
    assert low == high == other_high


def test_difference_tells_zero_from_minus_zero() -> None:
    """Bitwise means bitwise: -0.0 is not 0.0."""
    assert BlockArray.of([1.0, 0.0]).difference(BlockArray.of([1.0, -0.0])) == (1, 2, 2)


def test_untouched_blocks_are_the_same_objects() -> None:
    """A replacement shares every block that it does not touch, by identity."""
    a = BlockArray.of(flat(800))
    b = a.replaced(400, 403, [1.0, 2.0, 3.0])
    mine = {id(block) for block in a.blocks}
    fresh = [block for block in b.blocks if id(block) not in mine]
    assert len(fresh) <= 2
    assert len(b.blocks) - len(fresh) >= len(a.blocks) - 2
    assert not any(np.shares_memory(new, old) for new in fresh for old in a.blocks)


def test_untouched_runs_are_the_same_objects() -> None:
    """A replacement makes one run anew, or two; a version is a few objects, however long."""
    for rows in (2_000, 20_000):
        a = BlockArray.of(flat(rows))
        b = a.replaced(rows // 2, rows // 2 + 3, [1.0] * 5)
        mine = {id(run) for run in a.runs}
        fresh = [run for run in b.runs if id(run) not in mine]
        assert 1 <= len(fresh) <= 2
        assert len(a.runs) - sum(id(run) in mine for run in b.runs) <= 2
        assert sum(map(len, fresh)) <= 2 * 12


@given(data=st.data(), rows=st.integers(0, 200))
def test_shared_rows_are_those_in_common_blocks(data: st.DataObject, rows: int) -> None:
    """From either end up to the first block that is another object, however runs are cut."""
    made = [block for block, _ in versions(flat(rows), data.draw(edits(rows)))]
    a, b = data.draw(st.sampled_from(made)), data.draw(st.sampled_from(made))
    for one, two in ((a, b), (a, BlockArray(b.blocks, ()))):
        counts = []
        for step in (1, -1):
            pairs = zip(one.blocks[::step], two.blocks[::step], strict=False)
            counts.append(sum(len(x) for x, _ in takewhile(lambda pair: pair[0] is pair[1], pairs)))
        assert one.shared(two) == tuple(counts)


@pytest.mark.parametrize(("gone", "come"), [(1, 1), (0, 1), (3, 2), (2, 5), (5, 2), (1, 0)])
def test_edits_at_one_place_keep_the_balance(gone: int, come: int) -> None:
    """Thousands of them: blocks and runs stay between bounds, and the rest is shared."""
    a = BlockArray.of(flat(20_000))
    for k in range(5_000):
        at = min(10_000, len(a) - gone)
        a = a.replaced(at, at + gone, np.full(come, float(k)))
    check_runs(a)
    lengths = [len(block) for block in a.blocks]
    assert max(lengths) <= 12
    assert len(lengths) <= 4 * len(a) / 8
    assert len(a.runs) <= len(lengths) / 2 + 1


@pytest.mark.parametrize("rows", [1_000, 10_000, 50_000])
def test_copied_rows_do_not_depend_on_the_length(rows: int) -> None:
    """A hundred small edits copy the same number of rows in arrays of any length, and sizes stay in
    bounds.
    """
    rng = np.random.default_rng(1)
    a, copied = BlockArray.of(flat(rows)), 0
    for k in range(100):
        at = int(rng.integers(0, len(a) - 5))
        b = a.replaced(at, at + 3, np.full(int(rng.integers(0, 7)), float(k)))
        shared = {id(block) for block in a.blocks}
        copied += sum(len(block) for block in b.blocks if id(block) not in shared)
        a = b
    assert copied <= 100 * 4 * 8
    assert len(a.blocks) <= 4 * len(a) / 8 + 100 / 8


def test_many_deletions_do_not_crumble_the_blocks() -> None:
    """Deleting nearly everything, bit by bit, leaves few blocks."""
    a = BlockArray.of(flat(4_000))
    rng = np.random.default_rng(2)
    while len(a) > 40:
        at = int(rng.integers(0, len(a) - 3))
        a = a.replaced(at, at + 3, [])
    assert len(a.blocks) <= 20


def test_deletions_all_over_leave_no_short_runs() -> None:
    """Nor short blocks that have nobody in their run to join."""
    a = BlockArray.of(flat(20_000))
    rng = np.random.default_rng(3)
    while len(a) > 1_000:
        at = int(rng.integers(0, len(a) - 5))
        a = a.replaced(at, at + 5, [])
    check_runs(a)
    assert len(a.blocks) <= 4 * len(a) / 8
    assert all(len(run) >= 2 for run in a.runs)


def test_a_block_that_repeats_is_counted_once() -> None:
    """In a row of equal numbers in one block over and over, head and tail do not overlap."""
    block = np.ones(8)
    block.setflags(write=False)
    a = BlockArray([block] * 30, ())
    for b in (a.replaced(40, 40, [1.0] * 3), a.replaced(40, 60, []), a.replaced(3, 9, [2.0])):
        check_difference(a, b)
        check_difference(b, a)
    b = BlockArray([block] * 20, ())
    assert a.difference(b) == (160, 240, 160)
    assert a.shared(b) == (160, 160)


def test_difference_does_not_look_into_shared_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Comparing two versions of a long array compares only the rows of blocks that they do not
    share.
    """
    a = BlockArray.of(flat(50_000))
    b = a.replaced(25_000, 25_001, [0.5])
    compared = []
    common = blocks.common_ends
    monkeypatch.setattr(
        blocks, "common_ends", lambda x, y: (compared.append(len(x)), common(x, y))[1]
    )
    assert b.difference(a) == (25_000, 25_001, 25_001)
    assert sum(compared) <= 4 * 8


def test_window_inside_a_block_is_a_read_only_view() -> None:
    """Reading a short window copies nothing and cannot be written to; across blocks it is a frozen
    copy.
    """
    a = BlockArray.of(flat(100))
    inside = a[0:4]
    assert np.shares_memory(inside, a.blocks[0])
    for window in (inside, a[4:60], a[3:3]):
        assert not window.flags.writeable
    np.testing.assert_array_equal(a[4:60], flat(100)[4:60])


def test_the_input_array_is_not_kept_alive_for_writing() -> None:
    """Writing to the array that a block array was made of changes nothing in it."""
    source = flat(100)
    a = BlockArray.of(source)
    rows = np.zeros(3)
    b = a.replaced(0, 3, rows)
    source[:] = -1.0
    rows[:] = -1.0
    np.testing.assert_array_equal(np.asarray(a), flat(100))
    np.testing.assert_array_equal(b[:3], np.zeros(3))
    assert BlockArray.of(a) is a


def test_rows_of_the_wrong_shape_are_refused() -> None:
    """Points of another dimension and windows out of range raise, with both in the message."""
    a = BlockArray.of(flat(10, 2))
    with pytest.raises(InvariantError, match=r"\(3,\).*\(2,\)"):
        a.replaced(0, 1, [[1.0, 2.0, 3.0]])
    with pytest.raises(IndexError, match="8:11"):
        a.replaced(8, 11, np.empty((0, 2)))
    with pytest.raises(IndexError, match="5:4"):
        a.replaced(5, 4, np.empty((0, 2)))


@pytest.mark.skipif(compiled.core is None, reason="the core was not built")
def test_an_edit_ropes_the_run_that_it_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    """And puts the ropes of all runs in a row; what nobody reads has none."""
    before = BlockArray.of(flat(2000))
    before.rope  # noqa: B018
    after = before.replaced(1000, 1003, [1.0, 2.0, 3.0])
    made: list[tuple[object, ...]] = []

    class Watched:
        def rope(self, parts: tuple[object, ...]) -> object:
            made.append(parts)
            return core.rope(parts)  # type: ignore[arg-type]

    core = compiled.core
    monkeypatch.setattr(compiled, "core", Watched())
    assert after.rope is after.rope
    known = set(map(id, before.runs))
    (changed,) = [run for run in after.runs if id(run) not in known]
    assert made == [tuple(changed), tuple(run.rope for run in after.runs)]
    assert len(after.runs) > 10
