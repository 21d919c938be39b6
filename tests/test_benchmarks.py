"""The benchmarks' own logic, on given numbers: nothing is timed here."""

from __future__ import annotations

import sys
from pathlib import Path

import attrs
import pytest

ROOT = Path(__file__).resolve().parent.parent
if not (ROOT / "benchmarks").is_dir():
    pytest.skip("the benchmarks are not beside these tests", allow_module_level=True)
sys.path.append(str(ROOT))

from benchmarks.checking import check, losses, ratios  # noqa: E402
from benchmarks.goals import GOALS, goal_table  # noqa: E402
from benchmarks.page import PAGE  # noqa: E402
from benchmarks.results import Cell, Entry, Results  # noqa: E402
from benchmarks.running import TOO_SLOW, measured  # noqa: E402
from benchmarks.tables import filled, machine_line, table  # noqa: E402
from benchmarks.timing import LEAST, MOST, Stopwatch, in_turns  # noqa: E402
from benchmarks.workload import Absent, Case, Contestant, Counted, Timed, Workload  # noqa: E402
from benchmarks.workloads import WORKLOADS  # noqa: E402

MACHINE: dict[str, str | float] = {"copy_16_MB_ms": 1.2, "processor": "abacus", "python": "3"}


def cell(size: int, ours: float, peer: float, workload: str = "job") -> Cell:
    """One of ours against one peer, in seconds."""
    small = [0.001] if size == 100_000 else None
    entries = (
        Entry.of("fast", [ours * 0.9, ours, ours * 1.1], ours=True, small=small),
        Entry.of("peer", [peer], ours=False),
        Entry("ghost", why="not installed"),
    )
    return Cell(workload, "smooth", size, 1e-3, entries)


def results(ours: float = 0.001, large: float = 0.002) -> Results:
    """Sizes 10^3 and 10^5; the peer takes 50 ms and 5 s."""
    return Results(MACHINE, (cell(1000, ours, 0.05), cell(100_000, large, 5.0)))


# -- tables ----------------------------------------------------------------------------------------


def test_tables_put_ratios_first_and_say_who_is_missing() -> None:
    """Ratios, then ours with quartiles, then the peer; a missing peer is no error."""
    text = table(results().cells)
    head, _, first, second = text.splitlines()[:4]
    columns = [column.strip() for column in head.split("|")[1:-1]]
    assert columns == ["n", "what", "peer : ours", "t : t(10³)", "ours", "peer"]
    assert [x.strip() for x in first.split("|")[1:-1]] == [
        "1 000", "fast", "50", "–", "1 ms (950 µs – 1.05 ms)", "50 ms",
    ]  # fmt: skip
    assert "2 500" in second
    assert "ghost: not installed (n = 1000, 100000)" in text


def test_numbers_without_a_peer_have_a_table_of_their_own() -> None:
    """One row an entry, one column a case, or the other way round."""
    entries = (Entry.of("here", [3.0], ours=True, unit="calls"),)
    for count in (1, 3):
        cells = [Cell("job", "smooth", 10**k, 1e-3, entries) for k in range(count)]
        text = table(cells)
        assert "here" in text
        assert len(text.splitlines()) == 2 + count


def test_units_that_differ_are_not_compared() -> None:
    """Control points are no seconds."""
    one = Entry.of("ours", [3.0], ours=True, unit="controls")
    two = Entry.of("peer", [3.0], ours=False)
    assert ratios(Results(MACHINE, (Cell("job", "smooth", 1000, 1e-3, (one, two)),))) == {}


def test_a_page_keeps_its_text() -> None:
    """Only what stands between the marks is replaced, again and again."""
    page = "# A\n\n<!-- x -->\nold\n<!-- /x -->\n\ntext\n"
    once = filled(page, {"x": "new"})
    assert once == "# A\n\n<!-- x -->\nnew\n<!-- /x -->\n\ntext\n"
    assert filled(once, {"x": "new"}) == once
    with pytest.raises(KeyError, match="x"):
        filled(page, {})


def test_the_page_has_a_place_for_every_workload() -> None:
    """And none for others."""
    text = PAGE.read_text(encoding="utf-8")
    for name in (*WORKLOADS, "goals", "machine"):
        assert text.count(f"<!-- {name} -->") == 1 == text.count(f"<!-- /{name} -->")
    filled(text, dict.fromkeys((*WORKLOADS, "goals", "machine"), ""))


def test_results_survive_as_json() -> None:
    """Every number, and what did not take part."""
    before = results()
    assert Results.from_json(before.to_json()) == before
    assert "1.2 ms" in machine_line(before)


def test_goals_are_judged_by_the_worst() -> None:
    """Within the limit, beyond it by a factor, and not measured; 4 ms beside 1.6 : 1.2 are 3 ms."""
    copy = cell(1000, 0.004, 0.0016, "yardstick")
    copy = attrs.evolve(copy, entries=(copy.entries[0], attrs.evolve(copy.entries[1], name="copy")))
    drag = Results(MACHINE, (copy, cell(100_000, 0.004, 20.0, "drag")))
    rows = goal_table(drag).splitlines()
    assert len(rows) == len(GOALS) + 2
    assert "3 ms" in rows[2]
    assert "**no**, by 3 ×" in rows[2]
    assert "**no**, by 2 ×" in rows[3], "4 ms : 1 ms"
    assert "not measured" in rows[-1]


def test_goals_of_at_least_take_the_least() -> None:
    """20 x at n = 10^3 is below 25 x, 5 000 x at 10^5 is enough."""
    peer = [attrs.evolve(c.entries[1], name="eager, quick") for c in results().cells]
    cells = tuple(
        attrs.evolve(c, workload="drag", entries=(Entry.of("x", [s], ours=True), p))
        for c, p, s in zip(results().cells, peer, (0.0025, 0.001), strict=True)
    )
    text = goal_table(Results(MACHINE, cells))
    (few,) = [row for row in text.splitlines() if "quick : ours, 10³" in row]
    (many,) = [row for row in text.splitlines() if "quick : ours, 10⁵" in row]
    assert "**no**, by 1.25 ×" in few
    assert "| yes" in many


# -- the guard -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("factor", "lost"), [(1.0, 0), (0.2, 0), (1.45, 0), (1.55, 1)])
def test_more_than_a_third_is_a_loss(factor: float, lost: int) -> None:
    """Of a ratio to a peer, at one size; a gain is none."""
    before = results()
    now = Results(MACHINE, (cell(1000, 0.001 * factor, 0.05), before.cells[1]))
    found = [loss for loss in losses(before, now) if "peer" in loss.what]
    assert len(found) == lost


def test_growth_with_the_size_is_a_loss_too() -> None:
    """The peer became slower likewise, so only time at 10^3 : time at 10^5 shows it."""
    slower = cell(100_000, 0.004, 10.0)
    now = Results(MACHINE, (results().cells[0], slower))
    (found,) = losses(results(), now)
    assert found.what.endswith("fast, 10³ : here")
    assert (found.before, found.now) == (0.5, 0.25)


def test_the_guard_passes_fails_and_tries_once_more() -> None:
    """Exit code 1 only when the same ratio is lost twice; the table names it."""
    good, bad = results(), results(ours=0.01)
    for runs, code, asked in (
        ([good], 0, [None]),
        ([bad, good], 0, [None, frozenset({"job"})]),
        ([bad, bad], 1, [None, frozenset({"job"})]),
    ):
        names: list[frozenset[str] | None] = []
        lines: list[str] = []
        left = list(runs)

        def measure(chosen: frozenset[str] | None, left: list[Results] = left) -> Results:
            names.append(chosen)  # noqa: B023
            return left.pop(0)

        assert check(good, measure, lines.append) == code
        assert names == asked
        assert ("peer : fast" in lines[-1]) == bool(code)


def test_the_guard_measures_what_is_known() -> None:
    """Its cases are cases of the workload, so that there is something to compare with."""
    for workload in WORKLOADS.values():
        known = {attrs.evolve(case, full=False) for case in workload.cases if not case.full}
        assert {attrs.evolve(case, full=False) for case in workload.checked} <= known


# -- the runner ------------------------------------------------------------------------------------


def clock_of(seconds: list[float]) -> object:
    """Return a clock that each step moves on, and its step."""
    now = [0.0]

    def step(k: int) -> None:
        now[0] += seconds[min(k, len(seconds) - 1)]

    return step, lambda: now[0]


def test_contestants_take_turns() -> None:
    """What disturbs one disturbs all."""
    order: list[str] = []
    slow = [Timed(n, lambda k, n=n: order.append(n), clock=lambda: 9.0 * len(order)) for n in "ab"]
    in_turns([attrs.evolve(c, before=lambda k: None) for c in slow], budget=0.0)
    assert order[:2] == ["a", "b"]


def test_short_steps_are_repeated_and_long_ones_not() -> None:
    """A sample lasts 2 ms at least; a step of seconds is taken once."""
    for seconds, samples in ((2.0**-20, MOST), (0.0625, 8), (0.5, LEAST), (5.0, 1)):
        step, clock = clock_of([seconds])
        watch = Stopwatch(Timed("x", step, clock=clock), budget=0.5)  # type: ignore[arg-type]
        watch.warm_up()
        while not watch.done:
            watch.take()
        assert len(watch.samples) == samples
        assert watch.samples == pytest.approx([seconds] * samples)


def test_the_first_of_short_steps_does_not_count() -> None:
    """It pays for the caches that another contestant has filled."""
    now, cold = 0.0, False

    def step(k: int) -> None:
        nonlocal now, cold
        now += 0.25 if cold else 2.0**-11
        cold = False

    watch = Stopwatch(Timed("x", step, clock=lambda: now), budget=0.5)
    watch.warm_up()
    cold = True
    watch.take()
    assert watch.samples == [2.0**-11]


def test_the_small_size_takes_turns_with_the_large_one() -> None:
    """So that growth is a ratio of one moment: 3 s : 1 s, whatever the small case said before."""
    now = [0.0]

    def contestants(case: Case) -> list[Contestant]:
        def step(k: int) -> None:
            now[0] += 3.0 if case.size == 100_000 else 1.0

        return [Timed("fast", step, True, clock=lambda: now[0]), Timed("peer", lambda k: None)]

    job = Workload("job", "a job", [Case(1000), Case(100_000)], contestants)
    fast, peer = measured(job, Case(100_000)).entries
    assert (fast.growth, peer.growth) == (3.0, None)
    assert measured(job, Case(1000)).entries[0].growth is None


def test_what_would_take_too_long_is_left_out() -> None:
    """As the next smaller case says; what was left out there is left out here."""

    def contestants(case: Case) -> list[Contestant]:
        return [
            Timed("peer", lambda k: None),
            Counted("ours", case.size, "vertices", ours=True),
            Absent("ghost", "not installed"),
        ]

    job = Workload("job", "a job", [Case(1000), Case(10_000)], contestants)
    past = cell(1000, 0.001, 0.5)
    peer, ours, ghost = measured(job, Case(10_000), [past], limit=1.0).entries
    assert (peer.median, peer.why) == (None, f"{TOO_SLOW}, about 5 s a step")
    assert (ours.median, ours.unit) == (10_000, "vertices")
    assert ghost.why == "not installed"
    left_out = attrs.evolve(past, size=10_000, entries=(peer,))
    assert measured(job, Case(10_000), [past, left_out], limit=1.0).entries[0].median is None
    assert measured(job, Case(10_000), [past], limit=9.0).entries[0].median is not None


def test_a_peer_that_fails_is_named_and_ours_is_an_error() -> None:
    """What we cannot do must not go by unseen."""

    def fail(k: int) -> None:
        raise ArithmeticError("out of reach")

    job = Workload("job", "a job", [Case(10)], lambda case: [Timed("peer", fail)])
    (entry,) = measured(job, Case(10)).entries
    assert (entry.median, entry.why) == (None, "failed: out of reach")
    with pytest.raises(ArithmeticError, match="out of reach"):
        in_turns([Timed("fast", fail, ours=True)])


def test_a_workload_sets_up_and_runs() -> None:
    """The drag step of each representation, on a tiny curve; nothing is measured."""
    names = []
    for contestant in WORKLOADS["drag"].contestants(Case(30)):
        assert isinstance(contestant, Timed)
        contestant.step(0)
        names.append((contestant.name, contestant.ours))
    assert [ours for _, ours in names] == [True] * 3 + [False] * 2
