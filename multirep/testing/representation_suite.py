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

from multirep.testing.fitting_laws import FittingLaws
from multirep.testing.sampling_laws import SamplingLaws
from multirep.testing.splicing_laws import SplicingLaws
from multirep.testing.value_laws import ValueLaws


class RepresentationSuite(ValueLaws, SamplingLaws, SplicingLaws, FittingLaws):
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
