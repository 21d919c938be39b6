"""Splicing: samples are followed where they are, and nothing else moves."""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from multirep.errors import InvalidCurveError, ParameterError, ToleranceError
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.testing.curves import bumped, gaping, place_of, refined, size_of, stretches
from multirep.testing.laws import check_splice
from multirep.testing.representation_base import RepresentationBase


class SplicingLaws(RepresentationBase):
    """Laws of `splice`."""

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
            self.splice(representation, sampled, tolerance=relative * size)

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
        self.splice(representation, scaled, tolerance=1e-3 * size)

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
                tolerance=relative * size,
            )

    @pytest.mark.parametrize("seed", range(4))
    def test_splices_go_anywhere(self, representation: Representation, seed: int) -> None:
        """Random and very short stretches, with the ends nowhere in particular."""
        size = size_of(representation)
        for interval in stretches(representation.domain, seed):
            sampled = bumped(representation, interval, 1e-3, 1e-2 * size)
            self.splice(representation, sampled, tolerance=1e-3 * size)

    @pytest.mark.parametrize("part", [0.1, 0.5])
    @pytest.mark.parametrize("length", [0.3, 1e-2, 1e-4])
    def test_the_end_gap_is_closed_inside(
        self, representation: Representation, part: float, length: float
    ) -> None:
        """Samples that stand off at both ends are followed, joined where the curve stands."""
        tolerance = 1e-3 * size_of(representation)
        sampled = gaping(representation, length, part, tolerance=tolerance)
        edit = self.splice(representation, sampled, tolerance=tolerance)
        assert edit.splices

    def test_a_gap_beyond_the_allowance_is_refused(self, representation: Representation) -> None:
        """What no continuous curve can follow raises ToleranceError."""
        tolerance = 1e-3 * size_of(representation)
        sampled = gaping(representation, 0.3, 3.0, tolerance=tolerance)
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
        self.splice(representation, kinked, tolerance=1e-3 * size)

    def test_splicing_in_its_own_samples_stays_within_tolerance(
        self, representation: Representation
    ) -> None:
        """Nothing need change, and nothing may change by more than it is allowed."""
        tolerance = 1e-3 * size_of(representation)
        sampled = bumped(representation, place_of("inside", representation.domain), 1e-3, 0.0)
        self.splice(representation, sampled, tolerance=tolerance)

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
