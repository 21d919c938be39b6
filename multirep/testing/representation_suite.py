"""The conformance suite of representations: subclass it, supply one fixture, inherit the laws.

.. code-block:: python

    from multirep.testing import RepresentationSuite

    class TestMyCurve(RepresentationSuite):
        @pytest.fixture
        def representation(self):
            return MyCurve.from_points(...)

Everything else is derived from that value: samples of it, moved, scaled and perturbed, are spliced
into it, and its class is fitted to curves of the suite's own in one, two and three dimensions.
"""

from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable
from typing import Any, ClassVar

import attrs
import numpy as np
import pytest

from multirep.edit import Edit
from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.interval import Interval
from multirep.registry import validate
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.testing.elements import default_elements
from multirep.testing.laws import (
    check_data,
    check_fit,
    check_same,
    check_sample,
    check_splice,
)

#: Tolerances in terms of the size of the curve.
TOLERANCES = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8]


class RepresentationSuite:
    """Laws of the representation contract; all tests are inherited.

    Must supply
    -----------
    representation : fixture
        A value of the class under test: any dimension, not a straight line, T of any length.

    May override
    ------------
    fit_options : dict
        Keyword arguments for ``fit``.
    finest : float
        The smallest tolerance, in terms of the size of the curve, that is asked for.
    dimensions : tuple of int
        Which numbers of coordinates the class can have.
    elements : callable
        What a value stores and where it matters; see :class:`~multirep.testing.Elements`.
    """

    fit_options: ClassVar[dict[str, Any]] = {}
    finest: ClassVar[float] = 1e-8
    dimensions: ClassVar[tuple[int, ...]] = (1, 2, 3)

    # -- must supply -------------------------------------------------------------------------------

    @pytest.fixture
    def representation(self) -> Representation:
        """Fail with the sentence that says what to supply."""
        pytest.fail(
            f"{type(self).__name__} must supply a fixture `representation` that returns a value of "
            "the class under test (any dimension, not a straight line)"
        )

    # -- may override ------------------------------------------------------------------------------

    def elements(self, value: Representation) -> Any:
        """List what a value stores; see :class:`~multirep.testing.Elements`."""
        return default_elements(value)

    # -- the contract ------------------------------------------------------------------------------

    def test_the_class_is_a_complete_plugin(self, representation: Representation) -> None:
        """It registers, has a name in lower case, a docstring and one line for listings."""
        kind = type(representation)
        validate(kind, "representation", Representation)
        assert inspect.getdoc(kind)
        assert kind.summary, "set `summary`: one line for `multirep plugins`"
        assert "\n" not in kind.summary

    def test_domain_dimension_and_size_describe_the_value(
        self, representation: Representation
    ) -> None:
        """T has a length, the others are plain integers, magnitude bounds the coordinates."""
        assert isinstance(representation.domain, Interval)
        assert representation.domain.length > 0
        assert type(representation.dimension) is int
        assert representation.dimension >= 1
        assert type(representation.size) is int
        assert representation.size >= 2
        values = representation(np.linspace(*representation.domain, 500))
        assert np.abs(values).max() <= representation.magnitude * (1 + 1e-12)

    def test_values_are_immutable(self, representation: Representation) -> None:
        """Nothing can be set on a value, and its arrays cannot be written to."""
        for name in ("domain", "dimension", "points", "new_attribute"):
            with pytest.raises((AttributeError, TypeError)):
                setattr(representation, name, None)
        for name in ("t", "points", "knots", "weights"):
            array = getattr(representation, name, None)
            if array is not None:
                window = array[:1]
                assert not window.flags.writeable, f"{name} can be written to"

    def test_scalar_and_array_parameters(self, representation: Representation) -> None:
        """A scalar gives (d,), (m,) gives (m, d), nothing gives (0, d); lists are read."""
        d, (start, stop) = representation.dimension, representation.domain
        assert representation(start).shape == (d,)
        assert representation(np.float64(stop)).shape == (d,)
        assert representation([start, stop]).shape == (2, d)
        assert representation(np.empty(0)).shape == (0, d)
        assert representation(start).dtype == np.float64

    def test_evaluation_does_not_depend_on_the_batch(self, representation: Representation) -> None:
        """One by one, together, in another order or repeated: the same bits."""
        t = np.linspace(*representation.domain, 101)
        values = representation(t)
        order = np.random.default_rng(1).permutation(101)
        np.testing.assert_array_equal(representation(t[order]), values[order])
        np.testing.assert_array_equal(np.array([representation(float(s)) for s in t]), values)
        np.testing.assert_array_equal(representation(np.repeat(t, 2)), np.repeat(values, 2, axis=0))
        np.testing.assert_array_equal(representation(t[40:60]), values[40:60])

    def test_parameters_outside_the_domain_are_refused(
        self, representation: Representation
    ) -> None:
        """One ulp outside, far outside and NaN raise ParameterError, alone and among others."""
        start, stop = representation.domain
        for t in (np.nextafter(start, -np.inf), np.nextafter(stop, np.inf), stop + 1, np.nan):
            with pytest.raises(ParameterError):
                representation(float(t))
            with pytest.raises(ParameterError):
                representation(np.array([start, t]))

    def test_the_curve_is_continuous(self, representation: Representation) -> None:
        """At neighbouring parameters, stored ones among them, the curve does not jump."""
        t = np.linspace(*representation.domain, 101)
        for element in self.elements(representation):
            t = np.union1d(t, element.starts)
        t = t[(t > representation.domain.start) & (t < representation.domain.stop)]
        ulps = np.spacing(np.abs(t).max()) / representation.domain.length
        jump = representation(np.nextafter(t, -np.inf)) - representation(t)
        assert np.abs(jump).max() <= representation.magnitude * (1e-10 + 1e6 * ulps)

    def test_pickling_keeps_every_bit(self, representation: Representation) -> None:
        """A worker process gets the same value."""
        again = pickle.loads(pickle.dumps(representation))
        check_same(representation, again, elements=self.elements)

    def test_data_keep_every_bit(self, representation: Representation) -> None:
        """What to_dict writes goes through JSON and comes back the same."""
        check_data(representation, elements=self.elements)

    # -- sampling ----------------------------------------------------------------------------------

    @pytest.mark.parametrize("relative", TOLERANCES)
    def test_samples_are_certified(self, representation: Representation, relative: float) -> None:
        """Over all of T, at any tolerance, the certificate holds chord by chord."""
        if relative >= self.finest:
            tolerance = relative * size_of(representation)
            check_sample(representation, representation.domain, tolerance=tolerance)

    @pytest.mark.parametrize("seed", range(4))
    def test_samples_of_sub_intervals_are_certified(
        self, representation: Representation, seed: int
    ) -> None:
        """Anywhere: at the ends of T, across, inside, and on very short stretches."""
        for interval in stretches(representation.domain, seed):
            for relative in (1e-2, 1e-5):
                tolerance = relative * size_of(representation)
                check_sample(representation, interval, tolerance=tolerance)

    def test_sampling_is_deterministic(self, representation: Representation) -> None:
        """Asked twice, the same samples come, bit by bit."""
        tolerance = 1e-4 * size_of(representation)
        one = representation.sample(representation.domain, tolerance=tolerance)
        two = representation.sample(representation.domain, tolerance=tolerance)
        assert one.t.tobytes() == two.t.tobytes()
        assert one.points.tobytes() == two.points.tobytes()
        assert (one.bound, one.breaks) == (two.bound, two.breaks)

    def test_finer_samples_are_not_fewer(self, representation: Representation) -> None:
        """A smaller tolerance costs samples, and its bound is not larger."""
        counts = [
            len(
                representation.sample(
                    representation.domain, tolerance=r * size_of(representation)
                ).t
            )
            for r in (1e-2, 1e-4, 1e-6)
        ]
        assert counts == sorted(counts)

    def test_sampling_outside_the_domain_is_refused(self, representation: Representation) -> None:
        """An interval that leaves T raises ParameterError."""
        start, stop = representation.domain
        for interval in (Interval(start - 1, stop), Interval(start, stop + 1)):
            with pytest.raises(ParameterError):
                representation.sample(interval, tolerance=1e-3)

    def test_corners_are_breaks(self, representation: Representation) -> None:
        """A class that can follow a corner says in its samples where it is."""
        zigzag = polygon(2 if 2 in self.dimensions else self.dimensions[0])
        value = self.fit(representation, zigzag, tolerance=1e-4)
        sampled = check_sample(value, value.domain, tolerance=1e-5)
        for corner in zigzag.breaks:
            if has_corner(value, corner):
                near = [s for s in sampled.breaks if abs(s - corner) <= 1e-6]
                assert near, f"the corner at t = {corner} is not among breaks {sampled.breaks}"

    # -- splicing ----------------------------------------------------------------------------------

    @pytest.mark.parametrize("relative", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
    @pytest.mark.parametrize("place", ["inside", "start", "stop", "everywhere"])
    def test_splices_follow_moved_data(
        self, representation: Representation, place: str, relative: float
    ) -> None:
        """A bump on the curve is followed, inside T, at its ends and over all of it."""
        if relative >= self.finest:
            size = size_of(representation)
            sampled = bumped(
                representation, place_of(place, representation.domain), relative, size / 4
            )
            self.splice(representation, sampled, relative * size)

    @pytest.mark.parametrize("place", ["start", "stop", "everywhere"])
    def test_splices_follow_scaled_data(self, representation: Representation, place: str) -> None:
        """At the ends of T nothing is held: the curve goes wherever the samples go."""
        interval, size = place_of(place, representation.domain), size_of(representation)
        sampled = bumped(representation, interval, 1e-3, 0.0)
        fixed = sampled.points[-1 if place == "start" else 0]
        scaled = attrs.evolve(
            sampled,
            points=fixed + 1.5 * (sampled.points - fixed),
            bound=1.5 * sampled.bound,
            chord_bounds=None if sampled.chord_bounds is None else 1.5 * sampled.chord_bounds,
        )
        self.splice(representation, scaled, 1e-3 * size)

    @pytest.mark.parametrize("seed", range(3))
    def test_splices_follow_perturbed_data(self, representation: Representation, seed: int) -> None:
        """Noise below the tolerance does no harm, and noise above it is followed."""
        rng, size = np.random.default_rng(seed), size_of(representation)
        for relative, noise in ((1e-2, 1e-3), (1e-3, 1e-2)):
            sampled = bumped(
                representation, place_of("inside", representation.domain), relative, 0.0
            )
            shift = noise * size * rng.uniform(-1, 1, sampled.points.shape)
            shift[[0, -1]] = 0.0
            self.splice(
                representation,
                attrs.evolve(sampled, points=sampled.points + shift),
                relative * size,
            )

    @pytest.mark.parametrize("seed", range(4))
    def test_splices_go_anywhere(self, representation: Representation, seed: int) -> None:
        """Random and very short stretches, with the ends nowhere in particular."""
        size = size_of(representation)
        for interval in stretches(representation.domain, seed):
            sampled = bumped(representation, interval, 1e-3, 1e-2 * size)
            self.splice(representation, sampled, 1e-3 * size)

    @pytest.mark.parametrize("part", [0.1, 0.5])
    @pytest.mark.parametrize("length", [0.3, 1e-2, 1e-4])
    def test_the_end_gap_is_closed_inside(
        self, representation: Representation, part: float, length: float
    ) -> None:
        """Samples that stand off at both ends are followed, joined where the curve stands."""
        tolerance = 1e-3 * size_of(representation)
        sampled = self.gaping(representation, length, tolerance, part)
        edit = self.splice(representation, sampled, tolerance)
        assert edit.splices

    def test_a_gap_beyond_the_allowance_is_refused(self, representation: Representation) -> None:
        """What no continuous curve can follow raises ToleranceError."""
        tolerance = 1e-3 * size_of(representation)
        sampled = self.gaping(representation, 0.3, tolerance, 3.0)
        with pytest.raises(ToleranceError):
            representation.splice(sampled, tolerance=tolerance)

    def test_splices_follow_corners(self, representation: Representation) -> None:
        """Samples with breaks are followed as closely as smooth ones, or refused."""
        size = size_of(representation)
        sampled = bumped(representation, place_of("inside", representation.domain), 1e-3, 0.0)
        t = sampled.interval.middle
        tent = 1 - np.abs(sampled.t - t) / (0.5 * sampled.interval.length)
        kinked = attrs.evolve(sampled, points=sampled.points + 0.2 * size * tent[:, None])
        kinked = refined(kinked, [t])
        kinked = attrs.evolve(kinked, breaks=tuple(sorted({*kinked.breaks, t})))
        self.splice(representation, kinked, 1e-3 * size)

    def test_splicing_in_its_own_samples_stays_within_tolerance(
        self, representation: Representation
    ) -> None:
        """Nothing need change, and nothing may change by more than it is allowed."""
        tolerance = 1e-3 * size_of(representation)
        sampled = bumped(representation, place_of("inside", representation.domain), 1e-3, 0.0)
        self.splice(representation, sampled, tolerance)

    def test_splicing_again_and_again_does_not_pile_up(
        self, representation: Representation
    ) -> None:
        """Twenty splices of one stretch leave about as many controls as two."""
        size = size_of(representation)
        interval = place_of("inside", representation.domain)
        sizes, value = [], representation
        there = bumped(value, interval, 1e-3, 1e-1 * size)
        back = bumped(value, interval, 1e-3, 0.0)
        for k in range(20):
            value = value.splice((there, back)[k % 2], tolerance=1e-3 * size).value
            sizes.append(value.size)
        assert sizes[-1] <= 1.5 * sizes[1] + 8, sizes

    def test_splices_out_of_place_are_refused(self, representation: Representation) -> None:
        """Samples of another dimension or outside T raise, and say so."""
        d, (start, stop) = representation.dimension, representation.domain
        other = SampledSplice([start, stop], np.zeros((2, d + 1)))
        beyond = SampledSplice([start, stop + 1], np.zeros((2, d)))
        with pytest.raises(InvalidCurveError, match=str(d + 1)):
            representation.splice(other, tolerance=1e-3)
        with pytest.raises((ParameterError, InvalidCurveError)):
            representation.splice(beyond, tolerance=1e-3)

    def test_what_cannot_be_proved_is_refused(self, representation: Representation) -> None:
        """At a hopeless tolerance a splice is exact or raises; it is never quietly out of it."""
        size = size_of(representation)
        sampled = bumped(
            representation, place_of("inside", representation.domain), 1e-3, 1e-2 * size
        )
        sampled = attrs.evolve(sampled, chord_bounds=None)
        for relative in (1e-17, 1e-30):
            try:
                edit = representation.splice(sampled, tolerance=relative * size)
            except ToleranceError:
                continue
            assert edit.bound <= relative * size
            check_splice(representation, sampled, tolerance=relative * size, elements=self.elements)

    # -- fitting -----------------------------------------------------------------------------------

    @pytest.mark.parametrize("relative", TOLERANCES)
    def test_fits_are_certified(self, representation: Representation, relative: float) -> None:
        """From nothing, over all of T, at any tolerance, in every dimension."""
        if relative >= self.finest:
            for dimension in self.dimensions if relative > 1e-6 else self.dimensions[:1]:
                sampled = wave(dimension, 0.25 * relative)
                value = self.fit(representation, sampled, tolerance=relative)
                check_sample(value, value.domain, tolerance=relative)

    def test_fits_follow_corners(self, representation: Representation) -> None:
        """A polygon with its corners as breaks is fitted within tolerance."""
        for dimension in self.dimensions:
            for tolerance in (1e-1, 1e-3):
                self.fit(representation, polygon(dimension), tolerance=tolerance)

    def test_fits_of_two_samples(self, representation: Representation) -> None:
        """The smallest input, one chord, is a straight line."""
        for dimension in self.dimensions:
            line = SampledSplice([0.0, 1.0], [[0.0] * dimension, [1.0] * dimension])
            self.fit(representation, line, tolerance=1e-6)

    def test_fits_over_other_domains(self, representation: Representation) -> None:
        """T may be any interval, far from 0, long or short."""
        for start, stop in ((-3.0, 5.0), (1e3, 1e3 + 1.0), (0.0, 1e-6), (-1e6, 1e6)):
            sampled = wave(self.dimensions[-1], 1e-4)
            moved = attrs.evolve(
                sampled, t=np.r_[start, start + (stop - start) * sampled.t[1:-1], stop]
            )
            value = self.fit(representation, moved, tolerance=1e-3)
            check_sample(value, value.domain, tolerance=1e-4)
            part = bumped(value, place_of("inside", value.domain), 1e-3, 0.1)
            self.splice(value, part, 1e-3)

    def test_fits_with_standing_and_crowded_samples(self, representation: Representation) -> None:
        """Repeated points and spacings of 1 : 10 000 are followed too."""
        base = wave(self.dimensions[0], 1e-3)
        t = np.union1d(base.t, 0.5 + 1e-5 * np.arange(-5, 6))
        points = np.stack([np.interp(t, base.t, column) for column in base.points.T], axis=1)
        rest = (t >= 0.2) & (t <= 0.3)
        points[rest] = points[rest.argmax()]
        points[t > 0.3] += points[rest.argmax()] - points[(t > 0.3).argmax()]
        crowded = SampledSplice(t, points, 1e-3)
        self.fit(representation, crowded, tolerance=1e-2)

    @pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
    def test_coordinates_of_any_size(self, representation: Representation, scale: float) -> None:
        """Tolerances are relative to the data: at any scale, and far from the origin."""
        for offset in (0.0, 1e3 * scale):
            base = wave(self.dimensions[-1], 1e-4)
            sampled = attrs.evolve(
                base,
                points=base.points * scale + offset,
                bound=base.bound * scale,
                chord_bounds=None,
            )
            value = self.fit(representation, sampled, tolerance=1e-3 * scale)
            check_sample(value, value.domain, tolerance=1e-4 * scale)
            part = bumped(
                value, place_of("inside", value.domain), 1e-3 * scale, 0.1 * scale, absolute=True
            )
            self.splice(value, part, 1e-3 * scale)

    def test_fitting_and_splicing_are_deterministic(self, representation: Representation) -> None:
        """The same input gives the same bits."""
        sampled = wave(self.dimensions[-1], 1e-5)
        one = type(representation).fit(sampled, tolerance=1e-4, **self.fit_options)
        two = type(representation).fit(sampled, tolerance=1e-4, **self.fit_options)
        check_same(one, two, elements=self.elements)

    # -- what may be overridden --------------------------------------------------------------------

    @pytest.mark.parametrize("seed", range(3))
    def test_reach_stays_within(self, representation: Representation, seed: int) -> None:
        """The ends that a value prefers cover what they must and stay where they may."""
        for interval in stretches(representation.domain, seed):
            for margin in (0.0, 0.1 * interval.length, interval.length, 1e3 * interval.length):
                within = interval.widened(margin).clipped(representation.domain)
                reached = representation.reach(interval, within)
                assert within.contains(reached)
                assert reached.contains(interval)

    def test_changes_cover_every_difference(self, representation: Representation) -> None:
        """None for a value and itself; all that a splice changed, in both directions."""
        assert representation.changes(representation) == SpliceList.EMPTY
        size, (start, stop) = size_of(representation), representation.domain
        value = representation
        for place in ("inside", "start"):
            interval = place_of(place, representation.domain)
            value = value.splice(
                bumped(value, interval, 1e-3, 0.1 * size), tolerance=1e-3 * size
            ).value
        t = np.linspace(start, stop, 1001)
        differs = t[(value(t) != representation(t)).any(axis=1)]
        for changes in (representation.changes(value), value.changes(representation)):
            assert all(changes.contains(float(s)) for s in differs)

    def test_nearest_agrees_with_brute_force(self, representation: Representation) -> None:
        """No point of a dense grid is nearer than the place that is found."""
        rng, size = np.random.default_rng(3), size_of(representation)
        grid = representation(np.linspace(*representation.domain, 20_001))
        centre = grid.mean(axis=0)
        for _ in range(8):
            point = centre + size * rng.uniform(-1, 1, representation.dimension)
            found = representation.nearest(point)
            assert representation.domain.contains(found.t)
            np.testing.assert_allclose(representation(found.t), found.point, atol=1e-12 * size)
            assert found.distance == pytest.approx(
                np.linalg.norm(found.point - point), abs=1e-12 * size
            )
            assert found.distance <= np.linalg.norm(grid - point, axis=1).min() + 1e-9 * size

    def test_derivatives_agree_with_differences(self, representation: Representation) -> None:
        """One-sided difference quotients approach the one-sided derivatives, if there are any."""
        start, stop = representation.domain
        t = np.linspace(start, stop, 38)[1:-1]
        try:
            right = representation.derivative(t, 1, "right")
        except NotImplementedError:
            pytest.skip("offers no derivatives")
        left = representation.derivative(t, 1, "left")
        here, h = representation(t), 1e-7 * (stop - start)
        for found, sign in ((right, 1.0), (left, -1.0)):
            quotient = (representation(t + sign * h) - here) / (sign * h)
            half = (representation(t + 0.5 * sign * h) - here) / (0.5 * sign * h)
            rounding = 64 * np.spacing(representation.magnitude) / h
            allowed = 4 * np.abs(quotient - half).max() + rounding
            assert allowed <= 0.1 * np.abs(found).max()  # or the test would say nothing
            assert np.abs(half - found).max() <= allowed
        assert representation.derivative(start).shape == (representation.dimension,)
        assert np.isfinite(representation.derivative(start)).all()
        assert np.isfinite(representation.derivative(stop, 1, "left")).all()

    # -- ways to say it ----------------------------------------------------------------------------

    def fit(
        self, representation: Representation, sampled: SampledSplice, *, tolerance: float
    ) -> Representation:
        """Fit the class under test and check the law of fits."""
        return check_fit(type(representation), sampled, tolerance=tolerance, **self.fit_options)

    def splice(
        self, value: Representation, sampled: SampledSplice, tolerance: float
    ) -> Edit[Representation]:
        """Splice and check the law of splices."""
        return check_splice(value, sampled, tolerance=tolerance, elements=self.elements)

    def gaping(
        self, value: Representation, length: float, tolerance: float, part: float
    ) -> SampledSplice:
        """Sample in the middle of T, finely, and shift everything by ``part`` of the tolerance."""
        start, stop = value.domain
        middle, half = start + 0.47 * (stop - start), 0.5 * length * (stop - start)
        interval = Interval(middle - half, middle + half)
        sampled = value.sample(interval, tolerance=tolerance / 64)
        direction = np.ones(value.dimension) / np.sqrt(value.dimension)
        points = sampled.points + part * tolerance * direction
        return SampledSplice(sampled.t, points, sampled.bound, sampled.breaks, sampled.chord_bounds)


def size_of(value: Representation) -> float:
    """Return the largest extent of a curve along a coordinate axis, from a grid."""
    return float(np.ptp(value(np.linspace(*value.domain, 257)), axis=0).max())


def stretches(domain: Interval, seed: int) -> list[Interval]:
    """Return intervals in ``domain``: all of it, its ends, random ones, and very short ones."""
    rng, (start, stop) = np.random.default_rng(seed), domain
    length = stop - start
    found = [domain] if seed == 0 else []
    a, b = np.sort(rng.uniform(start, stop, 2))
    found += [Interval(a, b), Interval(start, b), Interval(a, stop)]
    for short in (1e-2, 1e-4, 1e-6):
        at = start + rng.uniform(0.0, 1.0 - short) * length
        found.append(Interval(at, at + short * length))
    found.append(Interval(start, start + 1e-5 * length))
    return [interval.clipped(domain) for interval in found if interval.length > 0]


def place_of(place: str, domain: Interval) -> Interval:
    """Return "inside", "start", "stop" or "everywhere" as an interval, with odd ends."""
    start, stop = domain
    at: Callable[[float], float] = lambda u: start + u * (stop - start)  # noqa: E731
    ends = {
        "inside": (at(0.2137), at(0.6011)),
        "start": (start, at(0.3719)),
        "stop": (at(0.5813), stop),
        "everywhere": (start, stop),
    }
    return Interval(*ends[place])


def bumped(
    value: Representation,
    interval: Interval,
    relative: float,
    height: float,
    *,
    absolute: bool = False,
) -> SampledSplice:
    """Sample a value at a quarter of the tolerance and raise a smooth bump of ``height`` on it.

    The bump vanishes at the ends of ``interval``; the certificate grows by what the chords cut off.
    """
    tolerance = relative if absolute else relative * size_of(value)
    sampled = value.sample(interval, tolerance=tolerance / 8)
    start, stop = interval
    if height:
        # |second derivative| of height sin^2(pi u) is at most 2 pi^2 height
        pieces = int(np.ceil(np.sqrt(2 * np.pi**2 * height / (8 * tolerance / 8)))) + 1
        sampled = refined(sampled, np.linspace(start, stop, pieces + 1)[1:-1])
        direction = np.ones(value.dimension) / np.sqrt(value.dimension)
        u = (sampled.t - start) / (stop - start)
        shift = height * np.sin(np.pi * np.clip(u, 0, 1)) ** 2
        shift[[0, -1]] = 0.0
        sampled = attrs.evolve(
            sampled,
            points=sampled.points + shift[:, None] * direction,
            bound=sampled.bound + tolerance / 8,
            chord_bounds=None
            if sampled.chord_bounds is None
            else sampled.chord_bounds + tolerance / 8,
        )
    return sampled


def refined(sampled: SampledSplice, at: Any) -> SampledSplice:
    """Return the same polyline with more vertices; pieces keep the certificate of their chord."""
    t = np.union1d(sampled.t, at)
    bounds = sampled.chord_bounds
    if bounds is not None:
        bounds = bounds[
            np.clip(sampled.t.searchsorted(t[:-1], side="right") - 1, 0, len(bounds) - 1)
        ]
    return SampledSplice(t, sampled(t), sampled.bound, sampled.breaks, bounds)


def wave(dimension: int, tolerance: float) -> SampledSplice:
    """Return certified samples of a smooth curve over [0, 1] whose coordinates span about 1."""
    rates = 1.0 + np.arange(dimension)
    # |S''| of sin(2 pi r u)/2 is at most 2 pi^2 r^2
    bend = 2 * np.pi**2 * np.linalg.norm(rates**2)
    pieces = int(np.ceil(np.sqrt(bend / (8 * tolerance)))) + 1
    t = np.linspace(0.0, 1.0, pieces + 1)
    points = 0.5 * np.sin(2 * np.pi * rates * t[:, None] + 0.3)
    return SampledSplice(t, points, bend / (8 * pieces**2))


def polygon(dimension: int) -> SampledSplice:
    """Return a polygon over [0, 1] with three corners inside, marked as breaks."""
    t = np.array([0.0, 0.25, 0.5, 0.8125, 1.0])
    heights = np.array([0.0, 1.0, 0.25, 1.0, 0.5])
    points = np.column_stack([heights, t, t[::-1]])[:, :dimension]
    return SampledSplice(t, points, 0.0, (0.25, 0.5, 0.8125))


def has_corner(value: Representation, t: float) -> bool:
    """Whether the directions just before and just after ``t`` differ by more than a few degrees."""
    h = 1e-7 * value.domain.length
    before, at, after = value(np.array([t - h, t, t + h]))
    one, two = at - before, after - at
    apart = np.linalg.norm(two - one)
    return bool(apart > 0.1 * max(np.linalg.norm(one), np.linalg.norm(two)))
