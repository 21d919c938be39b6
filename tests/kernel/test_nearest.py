"""The nearest place by certified sampling, against brute force and against a known answer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given

from multirep.arrays import Array, ArrayLike
from multirep.edit import Edit
from multirep.errors import EditError, InvalidCurveError, ParameterError
from multirep.interval import Interval
from multirep.nearest import distance_to_chords, nearest_by_sampling
from multirep.place import locate
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.testing import LoopbackRepresentation
from multirep.testing.strategies import coordinates, polylines


class Circle(Representation):
    """A half circle of a given radius by angle; its samples are certified by their sagitta."""

    name = "circle"
    domain = Interval(0.0, np.pi)
    dimension = 2

    def __init__(self, radius: float, centre: ArrayLike = (0.0, 0.0)) -> None:
        self.radius, self.centre = radius, np.array(centre)
        self.samples = 0

    def __call__(self, t: ArrayLike) -> Array:
        at = self.parameters(t)
        return self.centre + self.radius * np.stack([np.cos(at), np.sin(at)], axis=-1)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        pieces = int(np.ceil(interval.length / np.sqrt(8 * tolerance / self.radius)))
        t = np.linspace(interval.start, interval.stop, pieces + 1)
        self.samples += pieces + 1
        return SampledSplice(t, self(t), self.radius * (interval.length / pieces) ** 2 / 8)

    @property
    def magnitude(self) -> float:
        return self.radius + float(np.abs(self.centre).max())

    def splice(self, sampled: SampledSplice, *, tolerance: float) -> Edit[Circle]:
        raise NotImplementedError

    @classmethod
    def fit(cls, sampled: SampledSplice, *, tolerance: float, **options: Any) -> Circle:
        raise NotImplementedError


@given(polylines(dimension=2), coordinates(), coordinates())
def test_agrees_with_brute_force_on_a_loopback(
    data: tuple[Array, Array], x: float, y: float
) -> None:
    """The distance is the smallest one to any chord, taken one by one."""
    curve, point = LoopbackRepresentation(*data), np.array([x, y])
    brute = np.inf
    for a, b in zip(curve.points, curve.points[1:], strict=False):
        length = (b - a) @ (b - a)
        u = min(max((point - a) @ (b - a) / length, 0.0), 1.0) if length else 0.0
        brute = min(brute, float(np.linalg.norm(a + u * (b - a) - point)))
    found = nearest_by_sampling(curve, point)
    assert curve.domain.contains(found.t)
    assert found.distance == pytest.approx(brute, abs=1e-9)
    np.testing.assert_array_equal(found.point, curve(found.t))
    assert found.distance == float(np.linalg.norm(found.point - point))


@pytest.mark.parametrize("radius", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize("far", [0.0, 0.3, 0.999, 1.001, 2.0, 1e3])
@pytest.mark.parametrize("angle", [0.0, 0.1, 1.0, 3.0])
def test_finds_the_known_place_on_a_circle(radius: float, far: float, angle: float) -> None:
    """Radially below the point; at the centre, where all are equally near, any will do."""
    circle = Circle(radius, [3 * radius, -radius])
    point = circle.centre + far * radius * np.array([np.cos(angle), np.sin(angle)])
    found = nearest_by_sampling(circle, point)
    assert found.distance == pytest.approx(abs(1 - far) * radius, abs=1e-9 * radius * max(far, 1))
    if 0 < far < 1e3:
        assert found.t == pytest.approx(angle, abs=1e-4)


class LineAndArc(Circle):
    """A vertical line at x = -1, then an arc that bulges to x = 0.999 between coarse samples."""

    domain = Interval(0.0, 4.0)

    def __init__(self) -> None:
        super().__init__(2.0, (2.999, 0.0))

    def __call__(self, t: ArrayLike) -> Array:
        at = self.parameters(t)
        angle = np.pi + (at - 3) * 0.9 + 0.1234
        arc = self.centre + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        line = np.stack([np.full_like(at, -1.0), at - 1], axis=-1)
        return np.where((at <= 2)[..., None], line, arc)

    def sample(self, interval: Interval, *, tolerance: float) -> SampledSplice:
        pieces = int(np.ceil(0.9 * interval.length / np.sqrt(8 * tolerance / self.radius)))
        ends = np.linspace(interval.start, interval.stop, pieces + 1)
        t = np.unique(np.append(ends, [2.0, np.nextafter(2.0, 3.0)]).clip(*interval))
        return SampledSplice(t, self(t), tolerance)


def test_a_place_that_coarse_samples_hide_is_not_discarded() -> None:
    """Chords cut the bulge off: at first the line seems nearer, within the bound it is not."""
    found = nearest_by_sampling(LineAndArc(), np.zeros(2))
    assert found.distance == pytest.approx(0.999, abs=1e-9)
    assert found.t > 2


def test_costs_a_coarse_sampling_and_then_only_the_neighbourhood() -> None:
    """A place that is clearly nearest is found with a few hundred samples in all."""
    circle = Circle(1.0)
    nearest_by_sampling(circle, np.array([0.4, 0.3]))
    assert circle.samples < 1000


def test_the_default_of_the_contract_is_this_search() -> None:
    """A representation that overrides nothing answers with it."""
    curve = LoopbackRepresentation([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    found = curve.nearest([1.0, 2.0])
    assert (found.t, found.distance) == (1.0, 1.0)
    assert found.point.tolist() == [1.0, 1.0]


@pytest.mark.parametrize("point", [[0.0], [0.0, 0.0, 0.0], [np.nan, 0.0], [np.inf, 0.0]])
def test_points_that_are_none_are_refused(point: list[float]) -> None:
    """Another dimension, NaN and infinity raise InvalidCurveError with the number of
    coordinates.
    """
    curve = LoopbackRepresentation([0, 1], [[0, 0], [1, 1]])
    with pytest.raises(InvalidCurveError, match="2 coordinates"):
        curve.nearest(point)


def test_a_chord_without_length_is_a_point() -> None:
    """Distances to chords of length zero are those to their ends."""
    u, distance = distance_to_chords(np.zeros((1, 2)), np.zeros((1, 2)), np.array([3.0, 4.0]))
    assert (u[0], distance[0]) == (0.0, 5.0)


def test_a_place_is_a_parameter_or_a_point() -> None:
    """Exactly one of t and at; t must lie in T, at means the nearest place."""
    curve = LoopbackRepresentation([0, 1, 2], [[0, 0], [1, 1], [2, 0]])
    assert locate(curve, 0.25, None) == 0.25
    assert locate(curve, None, [1.0, 5.0]) == 1.0
    with pytest.raises(EditError, match="neither"):
        locate(curve, None, None)
    with pytest.raises(EditError, match="both"):
        locate(curve, 0.25, [1.0, 5.0])
    with pytest.raises(ParameterError, match="outside the domain"):
        locate(curve, 2.5, None)
