"""What all parts of the suite of representations lean on: the fixture, the hooks, the checks."""

from __future__ import annotations

from typing import Any, ClassVar

import pytest

from multirep.edit import Edit
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.testing.elements import default_elements
from multirep.testing.laws import check_fit, check_splice


class RepresentationBase:
    """Fixture and hooks; see :class:`~multirep.testing.RepresentationSuite`."""

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

    # -- ways to say it ----------------------------------------------------------------------------

    def fit(
        self, representation: Representation, sampled: SampledSplice, *, tolerance: float
    ) -> Representation:
        """Fit the class under test and check the law of fits."""
        return check_fit(type(representation), sampled, tolerance=tolerance, **self.fit_options)

    def splice(
        self, value: Representation, sampled: SampledSplice, *, tolerance: float
    ) -> Edit[Representation]:
        """Splice and check the law of splices."""
        return check_splice(value, sampled, tolerance=tolerance, elements=self.elements)
