"""The algebra of splice lists, on end points k/64: float arithmetic is exact, so laws hold with
==.
"""

from __future__ import annotations

import pickle
import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import multirep as mr
from multirep.errors import IntervalError, InvariantError
from multirep.interval import Interval
from multirep.splices import SpliceList
from multirep.testing.reference_splices import mask_of, point_is_inside, splices_of
from multirep.testing.strategies import CELLS, dyadic_intervals, splice_lists, touching_intervals

T = SpliceList([(0.0, 1.0)])
lists = splice_lists()
laws = settings(max_examples=200)


def complement(a: SpliceList) -> SpliceList:
    return T - a


@laws
@given(lists, lists, lists)
def test_union_is_associative(a: SpliceList, b: SpliceList, c: SpliceList) -> None:
    """(a | b) | c is a | (b | c)."""
    assert (a | b) | c == a | (b | c)


@laws
@given(lists, lists, lists)
def test_intersection_is_associative(a: SpliceList, b: SpliceList, c: SpliceList) -> None:
    """(a & b) & c is a & (b & c)."""
    assert (a & b) & c == a & (b & c)


@laws
@given(lists, lists)
def test_union_and_intersection_commute(a: SpliceList, b: SpliceList) -> None:
    """The order of the operands does not matter, for equality and for the hash."""
    assert a | b == b | a
    assert a & b == b & a
    assert hash(a | b) == hash(b | a)


@laws
@given(lists, lists, lists)
def test_each_operation_distributes_over_the_other(
    a: SpliceList, b: SpliceList, c: SpliceList
) -> None:
    """a & (b | c) is (a & b) | (a & c), and the other way round."""
    assert a & (b | c) == (a & b) | (a & c)
    assert a | (b & c) == (a | b) & (a | c)


@laws
@given(lists, lists)
def test_absorption(a: SpliceList, b: SpliceList) -> None:
    """a | (a & b) and a & (a | b) are a."""
    assert a | (a & b) == a
    assert a & (a | b) == a


@laws
@given(lists, lists)
def test_de_morgan_relative_to_t(a: SpliceList, b: SpliceList) -> None:
    """The complement in T of a union is the intersection of the complements, and the other way
    round.
    """
    assert complement(a | b) == complement(a) & complement(b)
    assert complement(a & b) == complement(a) | complement(b)


@laws
@given(lists)
def test_complement_is_an_involution(a: SpliceList) -> None:
    """Twice the complement is the list itself; a list and its complement share nothing and make
    T.
    """
    assert complement(complement(a)) == a
    assert a | complement(a) == T
    assert a & complement(a) == SpliceList.EMPTY


@laws
@given(lists, lists)
def test_difference_then_union_restores_the_cover(a: SpliceList, b: SpliceList) -> None:
    """(a - b) | b is a | b, and a - b is the part of a outside b."""
    assert (a - b) | b == a | b
    assert a - b == a & complement(b)
    assert (a - b) | (a & b) == a


@laws
@given(lists)
def test_empty_and_t_are_the_units(a: SpliceList) -> None:
    """EMPTY adds nothing and annihilates, T is everything, and an operation with itself changes
    nothing.
    """
    assert a | SpliceList.EMPTY == a == SpliceList.EMPTY | a
    assert a & SpliceList.EMPTY == SpliceList.EMPTY
    assert a & T == a
    assert a - a == SpliceList.EMPTY
    assert a | a == a == a & a


@laws
@given(lists, lists)
def test_operations_agree_with_a_dense_mask(a: SpliceList, b: SpliceList) -> None:
    """Union, intersection and difference are those of the masks of cells."""
    x, y = mask_of(a, CELLS), mask_of(b, CELLS)
    assert splices_of(x) == a
    assert a | b == splices_of(x | y)
    assert a & b == splices_of(x & y)
    assert a - b == splices_of(x & ~y)
    assert a.intersects(b) == bool((x & y).any()) == b.intersects(a)
    assert a.contains(b) == (not (y & ~x).any())


@laws
@given(lists, st.integers(0, 2 * CELLS))
def test_membership_agrees_with_a_dense_mask(a: SpliceList, k: int) -> None:
    """A grid point is inside when a cell beside it is, the middle of a cell when that cell is."""
    mask = mask_of(a, CELLS)
    inside = point_is_inside(mask, k // 2) if k % 2 == 0 else bool(mask[k // 2])
    assert a.contains(k / (2 * CELLS)) == inside
    assert (k / (2 * CELLS) in a) == inside


@laws
@given(lists, dyadic_intervals())
def test_an_interval_is_contained_when_nothing_of_it_is_left_outside(
    a: SpliceList, b: Interval
) -> None:
    """contains(interval) agrees with the difference."""
    assert a.contains(b) == (SpliceList([b]) - a).is_empty
    assert (b in a) == a.contains(SpliceList([b]))


@laws
@given(lists)
def test_text_notation_round_trips(a: SpliceList) -> None:
    """parse(str(a)) is a, and the repr evaluates to a."""
    assert SpliceList.parse(str(a)) == a
    assert eval(repr(a), {"SpliceList": SpliceList}) == a


@laws
@given(st.lists(st.tuples(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300)), max_size=5))
def test_text_notation_round_trips_for_any_floats(pairs: list[tuple[float, float]]) -> None:
    """Ends of any size survive the text notation bit by bit."""
    a = SpliceList(tuple(sorted(pair)) for pair in pairs)
    again = SpliceList.parse(str(a))
    assert [tuple(s) for s in again] == [tuple(s) for s in a]


@laws
@given(lists)
def test_the_value_survives_pickling_and_its_own_iteration(a: SpliceList) -> None:
    """A list made of the splices of a list is that list; so is an unpickled one."""
    assert SpliceList(a) == a
    assert pickle.loads(pickle.dumps(a)) == a
    assert len(list(a)) == len(a)
    assert bool(a) is not a.is_empty


@laws
@given(lists)
def test_length_and_hull_agree_with_the_mask(a: SpliceList) -> None:
    """The total length counts cells; the hull spans the first to the last."""
    mask = mask_of(a, CELLS)
    assert a.length == mask.sum() / CELLS
    if a:
        first, last = mask.nonzero()[0][[0, -1]]
        assert a.hull == Interval(first / CELLS, (last + 1) / CELLS)


@laws
@given(touching_intervals())
def test_touching_splices_become_one_and_gaps_of_one_ulp_stay(
    pair: tuple[Interval, Interval],
) -> None:
    """Equal, adjacent and overlapping intervals merge; one ulp of a gap keeps two splices apart."""
    a, b = pair
    union = SpliceList([a]) | SpliceList([b])
    assert union == SpliceList([a, b]) == SpliceList([b, a])
    union.check()
    apart = a.stop < b.start or b.stop < a.start
    assert len(union) == (2 if apart else 1)
    meet = SpliceList([a]) & SpliceList([b])
    meet.check()
    common = a.intersection(b)
    assert meet == SpliceList([] if common is None else [common])
    assert SpliceList([a]).intersects(SpliceList([b])) == bool(meet)
    assert (SpliceList([a]) - SpliceList([b])) | meet == SpliceList([a])


@pytest.mark.parametrize("seed", range(5))
def test_a_thousand_random_operations_stay_canonical(seed: int) -> None:
    """1 000 operations on one list agree with the mask, with check() after each."""
    rng = random.Random(seed)
    splices, mask = SpliceList.EMPTY, mask_of(SpliceList.EMPTY, 8 * CELLS)
    for _ in range(1000):
        cuts = sorted(rng.sample(range(8 * CELLS + 1), 2 * rng.randint(1, 4)))
        other = SpliceList(
            (a / (8 * CELLS), b / (8 * CELLS)) for a, b in zip(cuts[::2], cuts[1::2], strict=True)
        )
        cells = mask_of(other, 8 * CELLS)
        match rng.choice("||-&^"):
            case "|":
                splices, mask = splices | other, mask | cells
            case "-":
                splices, mask = splices - other, mask & ~cells
            case "&":
                splices, mask = splices & other | other, mask & cells | cells
            case _:
                splices = (splices - other) | (other - splices)
                mask = mask ^ cells
        splices.check()
        assert splices == splices_of(mask)


TABLE = [
    # a, operation, b, result
    ("", "|", "", ""),
    ("[0,1/4]", "|", "[1/2,3/4]", "[0,1/4] [1/2,3/4]"),
    ("[0,1/4]", "|", "[1/4,1/2]", "[0,1/2]"),
    ("[0,1/4] [1/2,3/4]", "|", "[1/4,1/2]", "[0,3/4]"),
    ("[0,1/4] [1/2,3/4]", "|", "[1/8,5/8]", "[0,3/4]"),
    ("[1/4,1/2]", "|", "[0,1]", "[0,1]"),
    ("[0,1/8] [1/4,3/8] [1/2,5/8]", "|", "[1/4,3/8]", "[0,1/8] [1/4,3/8] [1/2,5/8]"),
    ("[0,1/4]", "&", "[1/4,1/2]", ""),
    ("[0,1/2]", "&", "[1/4,1]", "[1/4,1/2]"),
    ("[0,1/4] [1/2,3/4]", "&", "[1/8,5/8]", "[1/8,1/4] [1/2,5/8]"),
    ("[0,1]", "&", "[1/8,1/4] [1/2,5/8]", "[1/8,1/4] [1/2,5/8]"),
    ("[0,1]", "&", "", ""),
    ("[0,1]", "-", "[1/4,1/2]", "[0,1/4] [1/2,1]"),
    ("[0,1]", "-", "[0,1/2]", "[1/2,1]"),
    ("[0,1]", "-", "[1/2,1]", "[0,1/2]"),
    ("[0,1/4] [1/2,3/4]", "-", "[1/4,1/2]", "[0,1/4] [1/2,3/4]"),
    ("[0,1/4] [1/2,3/4]", "-", "[1/8,5/8]", "[0,1/8] [5/8,3/4]"),
    ("[0,1/4] [1/2,3/4]", "-", "[0,1]", ""),
    ("[1/4,1/2]", "-", "[1/4,1/2]", ""),
    ("[1/4,1/2]", "-", "", "[1/4,1/2]"),
    ("", "-", "[0,1]", ""),
    ("[-1,-1/2]", "|", "[-1/2,0]", "[-1,0]"),
    ("[0.1,0.3]", "|", "[0.3,0.7]", "[0.1,0.7]"),
]


@pytest.mark.parametrize(("a", "operation", "b", "result"), TABLE)
def test_table_of_cases(a: str, operation: str, b: str, result: str) -> None:
    """Two dozen cases that fit on a screen."""
    x, y = SpliceList.parse(a), SpliceList.parse(b)
    found = {"|": x | y, "&": x & y, "-": x - y}[operation]
    assert str(found) == str(SpliceList.parse(result)) == result


@pytest.mark.parametrize(
    ("given_splices", "canonical"),
    [
        ([(0.5, 0.75), (0.0, 0.25)], "[0,1/4] [1/2,3/4]"),
        ([(0.0, 0.5), (0.25, 0.3)], "[0,1/2]"),
        ([(0.0, 0.5), (0.5, 1.0)], "[0,1]"),
        ([(0.5, 0.5)], ""),
        ([Interval(0.0, 1.0), [0.25, 0.5]], "[0,1]"),
        ([(-0.0, 1.0)], "[0,1]"),
    ],
)
def test_construction_is_canonical(given_splices: list[object], canonical: str) -> None:
    """Construction sorts, merges what touches and drops what has no length."""
    assert str(SpliceList(given_splices)) == canonical  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[0,1", "expected"),
        ("0,1]", "expected"),
        ("[0;1]", "expected"),
        ("[0,1,2]", "expected"),
        ("[0,x]", "not a number"),
        ("[0,1/0]", "not a number"),
        ("[nan,1]", "number"),
        ("[0,inf]", "number|finite"),
        ("[1,0]", "reversed"),
        ("[0,1e400]", "number|finite|large"),
        ("[0,1e999999999]", "number|finite|large"),
    ],
)
def test_malformed_text_is_refused(text: str, message: str) -> None:
    """Bad text raises IntervalError, which says where; huge exponents take no time."""
    with pytest.raises(IntervalError, match=message):
        SpliceList.parse(text)


def test_a_splice_list_is_immutable() -> None:
    """Nothing can be set on a splice list."""
    with pytest.raises(AttributeError, match="immutable"):
        SpliceList([(0, 1)])._starts = ()


def test_check_names_the_broken_value() -> None:
    """check() raises InvariantError with the offending list as subject."""
    broken = SpliceList.unchecked((0.0, 0.5), (0.5, 1.0))
    with pytest.raises(InvariantError) as caught:
        broken.check()
    assert caught.value.subject is broken


def test_an_empty_list_has_no_hull() -> None:
    """The hull of nothing is an error, not an arbitrary interval."""
    with pytest.raises(IntervalError, match="no hull"):
        _ = SpliceList.EMPTY.hull
    assert mr.SpliceList.EMPTY is SpliceList.EMPTY
