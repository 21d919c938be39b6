"""What a value of any representation is: evaluation, immutability, data, optional methods."""

from __future__ import annotations

import inspect
import pickle

import numpy as np
import pytest

from multirep.errors import ParameterError
from multirep.interval import Interval
from multirep.registry import validate
from multirep.representation import Representation
from multirep.splices import SpliceList
from multirep.testing.curves import bumped, place_of, size_of, stretches
from multirep.testing.laws import check_data, check_same
from multirep.testing.looking import even
from multirep.testing.representation_base import RepresentationBase


class ValueLaws(RepresentationBase):
    """Laws of values and of what may be overridden."""

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
        values = representation(even(representation.domain, 500))
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
        t = even(representation.domain, 101)
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
        t = even(representation.domain, 101)
        for element in self.elements(representation):
            t = np.union1d(t, element.starts)
        t = t[(t > representation.domain.start) & (t < representation.domain.stop)]
        ulps = np.spacing(np.abs(t).max()) / representation.domain.length
        jump = representation(np.nextafter(t, -np.inf)) - representation(t)
        assert np.abs(jump).max() <= representation.magnitude * (1e-10 + 1e6 * ulps)

    def test_pickling_keeps_every_bit(self, representation: Representation) -> None:
        """A worker process gets the same value, whatever this one was asked before."""
        representation.nearest(representation(representation.domain.start))
        again = pickle.loads(pickle.dumps(representation))
        check_same(representation, again, elements=self.elements)

    def test_data_keep_every_bit(self, representation: Representation) -> None:
        """What to_dict writes goes through JSON and comes back the same."""
        check_data(representation, elements=self.elements)

    def test_patches_keep_every_bit(self, representation: Representation) -> None:
        """What the history keeps of a value makes it again of its neighbour, either way."""
        size, interval = size_of(representation), place_of("inside", representation.domain)
        bump = bumped(representation, interval, 1e-3, 0.1 * size)
        other = representation.splice(bump, tolerance=1e-3 * size).value
        for value, base in ((representation, other), (other, representation)):
            patch = value.patch(base)
            if patch is None:
                pytest.skip("keeps values whole")
            made, back = base.patched(patch)
            check_same(value, made, elements=self.elements)
            if back is not None:
                check_same(base, made.patched(back)[0], elements=self.elements)

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

    def test_changes_of_two_stretches_are_told_apart(self, representation: Representation) -> None:
        """What lies between two changes is not reported, or no tool could edit in two places."""
        if type(representation).changes is Representation.changes:
            pytest.skip("compares samples")
        size, (start, stop) = size_of(representation), representation.domain
        value, reported = representation, SpliceList.EMPTY
        for u in (0.12, 0.83):
            interval = Interval(start + u * (stop - start), start + (u + 0.02) * (stop - start))
            edit = value.splice(bumped(value, interval, 1e-3, 0.1 * size), tolerance=1e-3 * size)
            value, reported = edit.value, reported | edit.splices
        assert reported.contains(representation.changes(value))
        assert reported.contains(value.changes(representation))

    def test_nearest_agrees_with_brute_force(self, representation: Representation) -> None:
        """No point of a dense grid is nearer than the place that is found."""
        rng, size = np.random.default_rng(3), size_of(representation)
        grid = representation(even(representation.domain, 20_001))
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
