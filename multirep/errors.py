"""Every exception that multirep raises on purpose.

Each class also derives from the built-in exception that a caller would catch anyway, says one
thing, and carries what it is about as attributes; the message holds the numbers and the way out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multirep.splices import SpliceList


class MultirepError(Exception):
    """Base of all errors raised by multirep."""

    def __reduce__(self) -> tuple[object, ...]:
        # The default calls the class with `args`, which are the message alone: workers could not
        # send errors home.
        return _restored, (type(self), self.args, self.__dict__)


def _restored(
    kind: type[MultirepError], args: tuple[object, ...], state: dict[str, object]
) -> MultirepError:
    error = kind.__new__(kind)
    error.args = args
    error.__dict__.update(state)
    return error


class InvalidCurveError(MultirepError, ValueError):
    """The data do not describe a curve (NaN, wrong shape, disordered parameters, ...)."""


class IntervalError(MultirepError, ValueError):
    """The interval or splice list is malformed."""


class ParameterError(MultirepError, ValueError):
    """A parameter lies outside the domain T of the curve."""


class InvariantError(MultirepError, AssertionError):
    """An internal invariant is broken; ``subject`` is the value that breaks it."""

    def __init__(self, message: str, subject: object = None) -> None:
        super().__init__(message)
        self.subject = subject


class ToleranceError(MultirepError, ArithmeticError):
    """The tolerance cannot be met, or not be proved.

    Parameters
    ----------
    message : str
        What was asked and what stands in the way.
    tolerance, reachable : float or None
        What was asked, and the smallest tolerance known to be reachable.
    where : float or None
        The parameter at which the proof fails.
    """

    def __init__(
        self,
        message: str,
        *,
        tolerance: float | None = None,
        reachable: float | None = None,
        where: float | None = None,
    ) -> None:
        super().__init__(message)
        self.tolerance = tolerance
        self.reachable = reachable
        self.where = where


class StaleEditError(MultirepError, ValueError):
    """An edit was made on a representation that is not up to date where the edit changes it."""


class UnreportedChangeError(MultirepError, ValueError):
    """A plugin changed more of a representation than the splices that it reported."""


class EditError(MultirepError, ValueError):
    """A representation or tool refuses an edit because its arguments make no sense here."""


class UnknownNameError(MultirepError, LookupError):
    """Nothing of that name; ``name`` is what was asked for, ``available`` what there is."""

    def __init__(self, what: str, name: str, available: Iterable[str]) -> None:
        self.what = what
        self.name = name
        self.available = tuple(sorted(available))
        near = get_close_matches(name, self.available, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ";"
        known = ", ".join(map(repr, self.available)) or "none"
        super().__init__(f"no {what} named {name!r}{hint} known: {known}")

    def __str__(self) -> str:
        return str(self.args[0])


class RegistrationError(MultirepError, ValueError):
    """A plugin cannot be registered; ``plugin`` is the offending class."""

    def __init__(self, message: str, plugin: object = None) -> None:
        super().__init__(message)
        self.plugin = plugin


class PluginError(MultirepError, RuntimeError):
    """A plugin raised or returned something that it must not; nothing was changed.

    ``plugin`` is its name; the original exception, if any, is ``__cause__``.
    """

    def __init__(self, message: str, plugin: str) -> None:
        super().__init__(message)
        self.plugin = plugin


class EditRejectedError(EditError):
    """A tool refused an edit; ``plugin`` is its name, ``__cause__`` its reason."""

    def __init__(self, message: str, plugin: str) -> None:
        super().__init__(message)
        self.plugin = plugin


class ConflictError(MultirepError, RuntimeError):
    """An edit and the constraints cannot all have their way; nothing was changed.

    Parameters
    ----------
    message : str
        Says which constraints, where, and how far off.
    constraints : sequence of str
        Their names.
    residuals : mapping of str to float
        What each is off by, in the units of the points.
    cycle : sequence of str
        The names on the cycle "re-establishing X broke Y", if there is one.
    where : mapping of str to SpliceList
        The stretch of T that each claims.
    release : sequence of str
        The smallest set of constraints without which the edit goes through, as far as one was
        found; empty otherwise.
    """

    def __init__(
        self,
        message: str,
        *,
        constraints: Iterable[str] = (),
        residuals: Mapping[str, float] | None = None,
        cycle: Iterable[str] = (),
        where: Mapping[str, SpliceList] | None = None,
        release: Iterable[str] = (),
    ) -> None:
        super().__init__(message)
        self.constraints = tuple(constraints)
        self.residuals = dict(residuals or {})
        self.cycle = tuple(cycle)
        self.where = dict(where or {})
        self.release = tuple(release)

    def __str__(self) -> str:
        message = str(self.args[0])
        if not self.release:
            return message
        names = " and ".join(map(repr, self.release))
        return f"{message}; releasing {names} lets it through"


class FrozenError(ConflictError):
    """An edit would change a frozen stretch; ``constraints`` names what froze it."""


class HistoryError(MultirepError, IndexError):
    """There is nothing to undo or redo."""


class MissingExtraError(MultirepError, ImportError):
    """Something needs the ``package`` that the ``extra`` installs."""

    def __init__(self, what: str, package: str, extra: str) -> None:
        self.package, self.extra = package, extra
        super().__init__(f"{what} need {package}: pip install 'multirep[{extra}]'")


class ScriptError(MultirepError, ValueError):
    """A script is wrong.

    ``file``, ``line``, ``step`` (counted from 0, as in the report) and ``key`` say where.
    """

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        step: int | None = None,
        key: str | None = None,
    ) -> None:
        self.file, self.line, self.step, self.key = file, line, step, key
        place = file if line is None else f"{file}:{line}"
        where = [part for part in (place, None if step is None else f"step {step}", key) if part]
        super().__init__(": ".join([*where, message]))


class StepFailedError(MultirepError, RuntimeError):
    """A script is right but its work cannot be done; ``__cause__`` is the reason.

    ``file``, ``line`` and ``step`` (counted from 0; None when it happened after the steps) say
    where.
    """

    def __init__(
        self, message: str, *, file: str, line: int | None = None, step: int | None = None
    ) -> None:
        self.file, self.line, self.step = file, line, step
        place = file if line is None else f"{file}:{line}"
        where = [part for part in (place, None if step is None else f"step {step}") if part]
        super().__init__(": ".join([*where, message]))
