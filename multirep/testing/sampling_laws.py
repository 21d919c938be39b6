"""Sampling: every certificate holds, at any tolerance, on any stretch."""

from __future__ import annotations

import pytest

from multirep.errors import ParameterError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.testing.curves import has_corner, polygon, size_of, stretches
from multirep.testing.laws import check_sample
from multirep.testing.representation_base import RepresentationBase

#: Tolerances in terms of the size of the curve.
TOLERANCES = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8]


class SamplingLaws(RepresentationBase):
    """Laws of `sample`."""

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
