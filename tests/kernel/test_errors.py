"""Errors: a built-in parent, one sentence, the offender as an attribute."""

from __future__ import annotations

import inspect
import pickle

import pytest

from multirep import errors
from multirep.errors import (
    ConflictError,
    MultirepError,
    ScriptError,
    ToleranceError,
    UnknownNameError,
)

PUBLIC = [
    kind
    for _, kind in inspect.getmembers(errors, inspect.isclass)
    if issubclass(kind, MultirepError) and kind is not MultirepError
]


@pytest.mark.parametrize("kind", PUBLIC, ids=lambda kind: kind.__name__)
def test_every_error_is_a_builtin_error_too(kind: type[MultirepError]) -> None:
    """A caller who catches ValueError, LookupError, ... catches ours; and each one says what it
    means.
    """
    parents = [base for base in kind.__mro__ if base.__module__ == "builtins"]
    assert any(issubclass(parent, Exception) and parent is not Exception for parent in parents)
    assert kind.__doc__
    assert kind.__name__.endswith("Error")


def test_an_unknown_name_offers_the_nearest() -> None:
    """The message has the name asked for, a near one, and all that exist, sorted."""
    error = UnknownNameError("tool", "spatla", ["sweep", "spatula"])
    assert str(error) == "no tool named 'spatla'; did you mean 'spatula'? known: 'spatula', 'sweep'"
    assert error.available == ("spatula", "sweep")
    assert isinstance(error, LookupError)


def test_an_unknown_name_among_none() -> None:
    """Nothing near and nothing known is said so."""
    assert str(UnknownNameError("curve", "cat", [])) == "no curve named 'cat'; known: none"


def test_a_script_error_says_where() -> None:
    """File, step and key lead the message and are attributes."""
    error = ScriptError("must be positive, got -1", file="cat.toml", step=2, key="radius")
    assert str(error) == "cat.toml: step 2: radius: must be positive, got -1"
    assert (error.file, error.step, error.key) == ("cat.toml", 2, "radius")
    assert str(ScriptError("is empty")) == "is empty"


def test_errors_carry_what_they_are_about() -> None:
    """Tolerances and conflicts are readable by programs."""
    error = ToleranceError("cannot", tolerance=1e-3, reachable=2e-3, where=0.5)
    assert (error.tolerance, error.reachable, error.where) == (1e-3, 2e-3, 0.5)
    conflict = ConflictError(
        "fight", constraints=["a", "b"], residuals={"a": 1.0}, cycle=["a", "b"]
    )
    assert conflict.constraints == conflict.cycle == ("a", "b")
    assert conflict.residuals == {"a": 1.0}


@pytest.mark.parametrize(
    "error",
    [
        UnknownNameError("tool", "a", ["b"]),
        ScriptError("bad", file="f", step=1, key="k"),
        ToleranceError("cannot", tolerance=1.0),
        errors.PluginError("broke", "nudge"),
        errors.InvariantError("broken", 3),
        ConflictError("fight", constraints=["a"]),
    ],
    ids=lambda error: type(error).__name__,
)
def test_errors_survive_pickling(error: MultirepError) -> None:
    """A worker process can send an error home with its message and attributes."""
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error)
