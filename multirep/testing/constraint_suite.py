"""The conformance suite of constraints: subclass it, supply two fixtures, inherit the laws."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.constraint import Constraint
from multirep.edit import Edit
from multirep.errors import FrozenError, MultirepError
from multirep.multirepresentation import MultiRepresentation
from multirep.registry import validate
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.session import Session
from multirep.settling import HOLDS
from multirep.splices import SpliceList
from multirep.testing.curves import size_of
from multirep.testing.doubles import follower_of
from multirep.testing.elements import default_elements
from multirep.testing.laws import check_certificate, check_edit, check_same
from multirep.testing.looking import even
from multirep.testing.parameters import check_parameters


class ConstraintSuite:
    """Laws of the constraint contract; all tests are inherited.

    Must supply
    -----------
    value : fixture
        A representation of the kind that the constraint is about, on which it does not hold. (A
        constraint that only freezes holds anywhere: any value on which it freezes something.)
    constraint : fixture
        An instance of the class under test.

    May override
    ------------
    malformed : sequence of dict
        Keyword arguments that the class must refuse.
    tolerance : float
        In terms of the size of the curve, for the tests with other representations.
    """

    malformed: ClassVar[Sequence[Mapping[str, Any]]] = ()
    tolerance: ClassVar[float] = 1e-3

    # -- must supply -------------------------------------------------------------------------------

    @pytest.fixture
    def constraint(self) -> Constraint[Any]:
        """Fail with the sentence that says what to supply."""
        pytest.fail(
            f"{type(self).__name__} must supply a fixture `constraint` that returns an instance of "
            "the class under test"
        )

    @pytest.fixture
    def value(self) -> Representation:
        """Fail with the sentence that says what to supply."""
        pytest.fail(
            f"{type(self).__name__} must supply a fixture `value` that returns a representation on "
            "which `constraint` does not hold"
        )

    # -- may override ------------------------------------------------------------------------------

    def elements(self, value: Representation) -> Any:
        """List what a value stores; see :class:`~multirep.testing.Elements`."""
        return default_elements(value)

    # -- the contract ------------------------------------------------------------------------------

    def test_the_class_is_a_complete_plugin(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """It registers, has a name in kebab case and a docstring, and is about what it says."""
        validate(type(constraint), "constraint", Constraint)
        assert re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", constraint.name), constraint.name
        assert inspect.getdoc(type(constraint))
        assert isinstance(value, constraint.needs)
        assert isinstance(constraint.priority, int)

    def test_parameters_are_documented_validated_and_plain_data(
        self, constraint: Constraint[Any]
    ) -> None:
        """Each field is described, refuses nonsense, is frozen and survives a script."""
        check_parameters(constraint)

    def test_malformed_parameters_are_refused(self, constraint: Constraint[Any]) -> None:
        """Constructing raises what a caller would catch, with a message."""
        for arguments in self.malformed:
            with pytest.raises((ValueError, TypeError, LookupError, MultirepError), match=r"\w"):
                type(constraint)(**arguments)

    # -- the condition -----------------------------------------------------------------------------

    def test_the_region_lies_in_the_domain(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """What the constraint claims is a stretch of T of positive length, the same each time."""
        region = constraint.region(value)
        assert value.domain.contains(region)
        assert region.length > 0
        assert constraint.region(value) == region

    def test_the_residual_is_a_distance(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """It is finite, not negative, the same each time, and says that something is amiss."""
        residual = constraint.residual(value)
        assert np.isfinite(residual)
        if constraint.frozen(value):
            assert residual == 0
            return
        assert residual > HOLDS * value.magnitude, "supply a value on which it does not hold"
        assert constraint.residual(value) == residual

    def test_enforcing_makes_it_hold(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """Afterwards the residual is nothing in terms of the coordinates."""
        edit = self.check(value, constraint)
        assert edit.splices or constraint.frozen(value)
        assert constraint.residual(edit.value) <= HOLDS * edit.value.magnitude

    def test_enforcing_stays_in_its_region(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """A constraint changes nothing outside the stretch that it claims."""
        region = constraint.region(value)
        edit = self.check(value, constraint)
        assert SpliceList([region]).contains(edit.splices)

    def test_enforcing_what_holds_changes_next_to_nothing(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """A second enforcement is a correction of rounding, if anything."""
        once = self.check(value, constraint).value
        twice = constraint.enforce(once, SpliceList([once.domain]), Scene()).value
        t = even(once.domain, 501)
        assert np.abs(once(t) - twice(t)).max() <= 1e-7 * once.magnitude

    # -- in a session ------------------------------------------------------------------------------

    def test_it_is_established_kept_and_released(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """Adding it makes it hold, others follow certified, undo restores every bit."""
        session = Session()
        kinds = [type(value), follower_of(value)]
        tolerance = self.tolerance * size_of(value)
        session.add("curve", MultiRepresentation(value, tolerance=tolerance, kinds=kinds))
        curve = session.curve("curve")
        curve.view(follower_of(value))
        name = session.constrain("curve", constraint)
        assert constraint.residual(curve.view(type(value))) <= HOLDS * value.magnitude
        check_certificate(curve, elements=self.elements)
        session.release("curve", name)
        session.undo(2)
        check_same(curve.view(type(value)), value, elements=self.elements)
        assert not session.framework.constraints("curve")

    def test_what_it_freezes_stays_bit_identical(
        self, constraint: Constraint[Any], value: Representation
    ) -> None:
        """Edits that reach in are refused, edits elsewhere do not change a bit of it anywhere."""
        frozen = constraint.frozen(value)
        if not frozen:
            pytest.skip("freezes nothing")
        session = Session()
        follower = follower_of(value)
        tolerance = self.tolerance * size_of(value)
        curve = MultiRepresentation(value, tolerance=tolerance, kinds=[type(value), follower])
        session.add("curve", curve)
        session.constrain("curve", constraint)
        assert curve.frozen.contains(frozen)
        before = {kind: curve.view(kind) for kind in curve.kinds}
        loopback = curve.view(follower)
        edited = refused = 0
        for index in range(1, loopback.size - 1, max(1, loopback.size // 16)):
            edit = loopback.move(index, loopback.points[index] + 10 * tolerance)
            try:
                curve.commit(follower, edit)
                edited += 1
            except FrozenError:
                refused += 1
                assert edit.splices.intersects(curve.frozen)
            curve.view(type(value))
            loopback = curve.view(follower)
        assert edited
        assert refused
        for kind, old in before.items():
            for splice in frozen:
                t = np.linspace(splice.start, splice.stop, 257)
                np.testing.assert_array_equal(old(t), curve.view(kind)(t))
        check_certificate(curve, elements=self.elements)

    # -- ways to say it ----------------------------------------------------------------------------

    def check(self, value: Representation, constraint: Constraint[Any]) -> Edit[Any]:
        """Enforce and check the law of edits."""
        everywhere = SpliceList([value.domain])
        return check_edit(
            value, lambda v: constraint.enforce(v, everywhere, Scene()), elements=self.elements
        )
