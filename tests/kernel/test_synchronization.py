"""Which stretch a representation follows: up to what it authored itself, and no further."""

import numpy as np

import multirep as mr
from multirep.events import Fitted
from multirep.interval import Interval
from multirep.representations import Polyline
from multirep.sampled import SampledSplice
from multirep.testing.loopback import LoopbackRepresentation

EPS = 1e-3
VERTEX = 1 / 64


class Greedy(LoopbackRepresentation):
    """Takes all the room that it is offered."""

    name = "greedy"

    def reach(self, interval: Interval, within: Interval) -> Interval:
        """Reach as far as allowed."""
        return within


def zigzag() -> mr.MultiRepresentation:
    """A line of 65 vertices, in step as a polyline and as a greedy loopback."""
    t = np.linspace(0, 1, 65)
    author = Polyline(t, np.stack([t, np.arange(65) % 2 * 0.1], axis=1))
    curve = mr.MultiRepresentation(author, tolerance=EPS, kinds=[Polyline, Greedy])
    curve.view(Greedy)
    return curve


def author_greedily(curve: mr.MultiRepresentation, own: Interval) -> None:
    """Let the greedy one author a stretch."""
    value = curve.view(Greedy)
    moved = value.sample(own, tolerance=EPS)
    points = moved.points + np.array([0.0, EPS])
    points[[0, -1]] = moved.points[[0, -1]]
    curve.commit(Greedy, value.splice(SampledSplice(moved.t, points), tolerance=EPS))
    curve.view(Polyline)


def move_vertices(curve: mr.MultiRepresentation, *vertices: int) -> None:
    """Move vertices of the polyline, by number on the even grid."""
    for number in vertices:
        value = curve.view(Polyline)
        vertex = int(np.asarray(value.t).searchsorted(number * VERTEX))
        assert value.t[vertex] == number * VERTEX
        to = value.points[vertex] + [0.0, 5 * EPS]
        curve.commit(Polyline, value.move_vertex(vertex, to))


def fitted(curve: mr.MultiRepresentation) -> list[Interval]:
    """Bring the greedy one up to date; returns what it followed."""
    with curve.listening() as events:
        curve.view(Greedy)
    return [event.interval for event in events if isinstance(event, Fitted)]


def test_a_splice_reaches_up_to_what_the_representation_authored_and_no_further() -> None:
    """However greedy, it does not follow others where it is the author, nor changes a bit there."""
    curve, own = zigzag(), Interval(24 * VERTEX, 40 * VERTEX)
    author_greedily(curve, own)
    before = curve.view(Greedy)
    move_vertices(curve, 22, 42)
    left, right = fitted(curve)
    assert left == Interval(19 * VERTEX, own.start)  # as long again to the left, room to the right
    assert right == Interval(own.stop, 45 * VERTEX)
    inside = np.linspace(*own, 257)[1:-1]
    assert np.array_equal(before(inside), curve.view(Greedy)(inside))


def test_stale_stretches_on_both_sides_of_ones_own_are_spliced_apart() -> None:
    """Neighbouring stale stretches go together, but not across what one authored oneself."""
    curve, own = zigzag(), Interval(30 * VERTEX, 31 * VERTEX)
    author_greedily(curve, own)
    move_vertices(curve, 25, 26, 27, 28, 33, 34, 35, 36)
    left, right = Interval(24 * VERTEX, 29 * VERTEX), Interval(32 * VERTEX, 37 * VERTEX)
    assert list(curve.stale(Greedy)) == [left, right]
    assert right.start - left.stop < left.length
    assert [interval.contains(own.middle) for interval in fitted(curve)] == [False, False]


def test_stale_stretches_close_to_each_other_go_together() -> None:
    """Two stale stretches with less between them than they are long are one splice."""
    curve = zigzag()
    move_vertices(curve, 26, 27, 28, 34, 35, 36)
    assert len(fitted(curve)) == 2  # as far apart as they are long
    curve = zigzag()
    move_vertices(curve, 26, 27, 28, 33, 34, 35)
    (together,) = fitted(curve)
    assert together.contains(Interval(25 * VERTEX, 36 * VERTEX))
