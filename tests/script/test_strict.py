"""Strict structuring: what fits is taken as it is, everything else is refused with its place."""

from __future__ import annotations

import pytest
from attrs import field, frozen, validators

from multirep.script.model import Points
from multirep.script.strict import Mismatch, check_keys, quote, structure


@frozen
class Inner:
    """A table inside a table."""

    n: int = 1


@frozen
class Outer:
    """One field of every sort that tools use."""

    name = "outer"

    radius: float = field(validator=validators.gt(0))
    path: tuple[tuple[float, ...], ...] = ()
    t: float | None = None
    at: tuple[float, ...] | float | None = None
    pair: tuple[int, int] = (0, 0)
    flag: bool = False
    inner: Inner = Inner()
    inners: tuple[Inner, ...] = ()
    points: Points = field(default=Points(()))
    words: list[str] = field(factory=list)

    def __attrs_post_init__(self) -> None:
        if self.flag and self.t is None:
            raise ValueError("a flag needs t")


GOOD = [
    ({"radius": 1}, Outer(1.0)),
    ({"radius": 2.5, "path": [[0, 1], [2, 3]]}, Outer(2.5, ((0.0, 1.0), (2.0, 3.0)))),
    ({"radius": 1, "at": [1, 2]}, Outer(1.0, at=(1.0, 2.0))),
    ({"radius": 1, "at": 3}, Outer(1.0, at=3.0)),
    ({"radius": 1, "inners": [{"n": 2}, {}]}, Outer(1.0, inners=(Inner(2), Inner()))),
    ({"radius": 1, "words": ["a"]}, Outer(1.0, words=["a"])),
]

BAD = [
    (7, "", "expected a table, got 7"),
    ({}, "radius", "missing"),
    ({"raduis": 1}, "raduis", "unknown key of 'outer'; did you mean 'radius'? allowed: at, flag"),
    ({"radius": 0}, "radius", "must be > 0, got 0.0"),
    ({"radius": True}, "radius", "expected a number, got True"),
    ({"radius": "1"}, "radius", "expected a number, got text '1'"),
    ({"radius": 10**400}, "radius", "expected a finite number"),
    ({"radius": float("nan")}, "radius", "expected a finite number, got nan"),
    ({"radius": 1, "path": "ab"}, "path", "expected a list, got text 'ab'"),
    ({"radius": 1, "path": [[0, 1], [0, "x"]]}, "path[1][1]", "expected a number, got text 'x'"),
    ({"radius": 1, "at": "x"}, "at", "expected a list or a number, got text 'x'"),
    ({"radius": 1, "at": ["x"]}, "at[0]", "expected a number, got text 'x'"),
    ({"radius": 1, "pair": [1]}, "pair", "expected a list of 2, got a list [1]"),
    ({"radius": 1, "pair": [1, 2.0]}, "pair[1]", "expected a whole number, got 2.0"),
    ({"radius": 1, "pair": [1, True]}, "pair[1]", "expected a whole number, got True"),
    ({"radius": 1, "pair": [1, 2**60]}, "pair[1]", "expected a whole number below 2^53"),
    ({"radius": 1, "flag": 1}, "flag", "expected true or false, got 1"),
    ({"radius": 1, "flag": True}, "", "a flag needs t"),
    ({"radius": 1, "inner": []}, "inner", "expected a table, got a list []"),
    ({"radius": 1, "inner": {"m": 1}}, "inner.m", "unknown key of Inner; allowed: n"),
    ({"radius": 1, "inners": [{"n": ""}]}, "inners[0].n", "expected a whole number, got text ''"),
    ({"radius": 1, "points": [[1, 2], []]}, "points[1]", "expected a point"),
    ({"radius": 1, "points": 3}, "points", "expected a list of points, got 3"),
    ({"radius": 1, "words": [1]}, "words[0]", "expected text, got 1"),
    ({"radius": 1, "words": ["x" * 9999]}, "words[0]", "expected at most 4096 characters"),
]


@pytest.mark.parametrize(("data", "expected"), GOOD)
def test_what_fits_is_taken(data: object, expected: Outer) -> None:
    """Whole numbers are numbers; lists become tuples; nothing else is converted."""
    assert structure(data, Outer) == expected


@pytest.mark.parametrize(("data", "key", "problem"), BAD)
def test_what_does_not_fit_is_refused(data: object, key: str, problem: str) -> None:
    """The key leads to the value; the problem says what was found and what is allowed."""
    with pytest.raises(Mismatch) as caught:
        structure(data, Outer)
    assert caught.value.key == key
    assert caught.value.problem.startswith(problem)


def test_long_values_are_quoted_briefly() -> None:
    """An error message stays one line that a person reads."""
    assert len(quote(list(range(1000)))) < 80


def test_a_key_without_a_neighbour_gets_the_list() -> None:
    """No suggestion is better than a silly one."""
    with pytest.raises(Mismatch, match="allowed: a, b") as caught:
        check_keys({"zzz": 1}, "ab", "it")
    assert "did you mean" not in str(caught.value)
