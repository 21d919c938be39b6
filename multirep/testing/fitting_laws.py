"""Fitting from nothing: any tolerance, any dimension, any domain, any size of coordinates."""

from __future__ import annotations

import attrs
import numpy as np
import pytest

from multirep.errors import UnknownNameError
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.testing.curves import bumped, place_of, polygon, wave
from multirep.testing.laws import check_same, check_sample
from multirep.testing.representation_base import RepresentationBase

#: Tolerances in terms of the size of the curve.
TOLERANCES = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8]


class FittingLaws(RepresentationBase):
    """Laws of `fit`."""

    @pytest.mark.parametrize("relative", TOLERANCES)
    def test_fits_are_certified(self, representation: Representation, relative: float) -> None:
        """From nothing, over all of T, at any tolerance, in every dimension."""
        if relative >= self.finest:
            for dimension in self.dimensions if relative > 1e-6 else self.dimensions[:1]:
                sampled = wave(dimension, tolerance=0.25 * relative)
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
            sampled = wave(self.dimensions[-1], tolerance=1e-4)
            moved = attrs.evolve(
                sampled, t=np.r_[start, start + (stop - start) * sampled.t[1:-1], stop]
            )
            value = self.fit(representation, moved, tolerance=1e-3)
            check_sample(value, value.domain, tolerance=1e-4)
            part = bumped(value, place_of("inside", value.domain), 1e-3, 0.1)
            self.splice(value, part, tolerance=1e-3)

    def test_fits_with_standing_and_crowded_samples(self, representation: Representation) -> None:
        """Repeated points and spacings of 1 : 10 000 are followed too."""
        base = wave(self.dimensions[0], tolerance=1e-3)
        t = np.union1d(base.t, 0.5 + 1e-5 * np.arange(-5, 6))
        points = np.stack([np.interp(t, base.t, column) for column in base.points.T], axis=1)
        rest = (t >= 0.2) & (t <= 0.3)
        points[rest] = points[rest.argmax()]
        points[t > 0.3] += points[rest.argmax()] - points[(t > 0.3).argmax()]
        crowded = SampledSplice(t, points, 1e-3)
        self.fit(representation, crowded, tolerance=1e-2)

    def test_unknown_options_are_refused(self, representation: Representation) -> None:
        """With an error that names the option, not taken silently for another."""
        sampled = wave(self.dimensions[0], tolerance=1e-3)
        with pytest.raises(UnknownNameError, match="nonsense") as refused:
            type(representation).fit(sampled, tolerance=1e-1, **self.fit_options, nonsense=1)
        assert refused.value.name == "nonsense"

    @pytest.mark.parametrize("scale", [1e-12, 1e-6, 1.0, 1e6, 1e12])
    def test_coordinates_of_any_size(self, representation: Representation, scale: float) -> None:
        """Tolerances are relative to the data: at any scale, and far from the origin."""
        for offset in (0.0, 1e3 * scale):
            base = wave(self.dimensions[-1], tolerance=1e-4)
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
            self.splice(value, part, tolerance=1e-3 * scale)

    def test_fitting_and_splicing_are_deterministic(self, representation: Representation) -> None:
        """The same input gives the same bits."""
        sampled = wave(self.dimensions[-1], tolerance=1e-5)
        one = type(representation).fit(sampled, tolerance=1e-4, **self.fit_options)
        two = type(representation).fit(sampled, tolerance=1e-4, **self.fit_options)
        check_same(one, two, elements=self.elements)
