"""The conformance suite of tools: subclass it, supply two fixtures, inherit the laws.

.. code-block:: python

    from multirep.testing import ToolSuite

    class TestNudge(ToolSuite):
        @pytest.fixture
        def tool(self):
            return Nudge(index=1, offset=(0.0, 0.5))

        @pytest.fixture
        def value(self):
            return Polyline.from_points([[0, 0], [1, 1], [2, 0]])
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import pytest

from multirep.edit import Edit
from multirep.errors import EditRejectedError, MultirepError
from multirep.multirepresentation import MultiRepresentation
from multirep.registry import validate
from multirep.representation import Representation
from multirep.scene import Scene
from multirep.session import Session
from multirep.testing.curves import size_of
from multirep.testing.doubles import follower_of
from multirep.testing.elements import default_elements
from multirep.testing.laws import check_certificate, check_edit, check_same
from multirep.testing.parameters import check_parameters
from multirep.tool import Tool


class ToolSuite:
    """Laws of the tool contract; all tests are inherited.

    Must supply
    -----------
    value : fixture
        A representation of the kind that the tool edits.
    tool : fixture
        An instance of the class under test that changes ``value``.

    May override
    ------------
    refused : fixture
        Instances that are well formed but that ``value`` must make them refuse (an index that is
        not there, say).
    malformed : sequence of dict
        Keyword arguments that the class must refuse.
    others : method
        The other curves of the scene by name, for a tool that looks at them.
    tolerance : float
        In terms of the size of the curve, for the tests with other representations.
    """

    malformed: ClassVar[Sequence[Mapping[str, Any]]] = ()
    tolerance: ClassVar[float] = 1e-3

    # -- must supply -------------------------------------------------------------------------------

    @pytest.fixture
    def tool(self) -> Tool[Any]:
        """Fail with the sentence that says what to supply."""
        pytest.fail(
            f"{type(self).__name__} must supply a fixture `tool` that returns an instance of the "
            "class under test which changes `value`"
        )

    @pytest.fixture
    def value(self) -> Representation:
        """Fail with the sentence that says what to supply."""
        pytest.fail(
            f"{type(self).__name__} must supply a fixture `value` that returns a representation of "
            "the kind that the tool edits"
        )

    # -- may override ------------------------------------------------------------------------------

    @pytest.fixture
    def refused(self) -> Sequence[Tool[Any]]:
        """Nothing is refused, unless the subclass says what."""
        return ()

    def others(self) -> Mapping[str, Representation]:
        """List the other curves of the scene by name, for tools that look at them; none."""
        return {}

    def elements(self, value: Representation) -> Any:
        """List what a value stores; see :class:`~multirep.testing.Elements`."""
        return default_elements(value)

    # -- the contract ------------------------------------------------------------------------------

    def test_the_class_is_a_complete_plugin(self, tool: Tool[Any], value: Representation) -> None:
        """It registers, has a name in kebab case and a docstring, and edits what it says."""
        validate(type(tool), "tool", Tool)
        assert re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", tool.name), tool.name
        assert inspect.getdoc(type(tool))
        assert isinstance(value, tool.edits)

    def test_parameters_are_documented_validated_and_plain_data(self, tool: Tool[Any]) -> None:
        """Each field is described, refuses nonsense, is frozen and survives a script."""
        check_parameters(tool)

    def test_malformed_parameters_are_refused(self, tool: Tool[Any]) -> None:
        """Constructing raises what a caller would catch, with a message."""
        for arguments in self.malformed:
            with pytest.raises((ValueError, TypeError, LookupError, MultirepError), match=r"\w"):
                type(tool)(**arguments)

    # -- editing -----------------------------------------------------------------------------------

    def test_the_edit_is_exact(self, tool: Tool[Any], value: Representation) -> None:
        """Outside its splices nothing changes by one bit; the input stays; twice is the same."""
        edit = self.check(value, tool)
        assert edit.splices, "the tool under test must change the value under test"

    def test_every_splice_holds_a_change(self, tool: Tool[Any], value: Representation) -> None:
        """A reported splice on which nothing differs would cost everyone else a needless fit."""
        edit = tool.edit(value, self.scene())
        found = value.changes(edit.value)
        for splice in edit.splices:
            t = np.linspace(splice.start, splice.stop, 65)
            moved = (value(t) != edit.value(t)).any()
            assert moved or any(splice.overlaps(change) for change in found), splice

    def test_it_can_be_applied_again(self, tool: Tool[Any], value: Representation) -> None:
        """A tool has no memory: on its own result it is a sound edit again, or a refusal."""
        after = tool.edit(value, self.scene()).value
        try:
            tool.edit(after, self.scene())
        except MultirepError:
            return
        self.check(after, tool)

    def test_refusals_leave_no_trace(
        self, tool: Tool[Any], value: Representation, refused: Sequence[Tool[Any]]
    ) -> None:
        """What cannot be done raises with the tool's name; curve and history are as before."""
        for wrong in refused:
            session = self.session(value)
            curve = session.curve("curve")
            curve.view(follower_of(value))
            before = curve.snapshot()
            with pytest.raises(EditRejectedError, match=re.escape(tool.name)):
                session.apply("curve", wrong)
            assert curve.snapshot() is before
            assert session.undoable == 0

    # -- in a session ------------------------------------------------------------------------------

    def test_others_follow_and_undo_restores(self, tool: Tool[Any], value: Representation) -> None:
        """In a session the certificate holds after the edit; undo and redo restore every bit."""
        session = self.session(value)
        curve = session.curve("curve")
        other = curve.view(follower_of(value))
        outcome = session.apply("curve", tool)
        assert outcome.changed == tool.edit(value, self.scene()).splices
        check_certificate(curve, elements=self.elements)
        after = curve.view(type(value))
        followed = curve.view(follower_of(value))
        session.undo()
        check_same(curve.view(type(value)), value, elements=self.elements)
        check_same(curve.view(follower_of(value)), other)
        session.redo()
        check_same(curve.view(type(value)), after, elements=self.elements)
        check_certificate(curve, elements=self.elements)
        check_same(curve.view(follower_of(value)), followed)

    def test_a_drag_is_one_undo_step(self, tool: Tool[Any], value: Representation) -> None:
        """Applied several times in one gesture, it is undone at once."""
        session = self.session(value)
        with session.gesture("curve") as gesture:
            gesture.apply(tool)
            try:
                gesture.apply(tool)
            except EditRejectedError:
                pass
        session.undo()
        assert session.curve("curve").view(type(value)) is value

    # -- ways to say it ----------------------------------------------------------------------------

    def check(self, value: Representation, tool: Tool[Any]) -> Edit[Any]:
        """Edit and check the law of edits."""
        return check_edit(value, lambda v: tool.edit(v, self.scene()), elements=self.elements)

    def scene(self) -> Scene:
        """Return the scene of the other curves."""
        return Scene({name: self.multiple(other) for name, other in self.others().items()})

    def session(self, value: Representation) -> Session:
        """Return a session with the value, a loopback that follows it, and the other curves."""
        session = Session()
        session.add("curve", self.multiple(value))
        for name, other in self.others().items():
            session.add(name, self.multiple(other))
        return session

    def multiple(self, value: Representation) -> MultiRepresentation:
        """Return a multi-representation of a value and its loopback."""
        tolerance = self.tolerance * size_of(value)
        kinds = [type(value), follower_of(value)]
        return MultiRepresentation(value, tolerance=tolerance, kinds=kinds)
