"""What must hold after any edit, splice, fit or view, whoever made it.

Each law raises :class:`~multirep.errors.InvariantError` (an AssertionError) with the numbers and
with the offending value as ``subject``; a law that holds returns what it checked, so that it can
stand where the operation stood. Everything is compared densely *and* where mistakes hide: at stored
parameters and beside the ends of splices, one ulp away from them.

Known limits: a dense comparison can miss what a proof would not. The laws test proofs, they do not
replace them.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from multirep.arrays import Array
from multirep.edit import Edit
from multirep.errors import InvariantError
from multirep.interval import Interval
from multirep.representation import Representation
from multirep.sampled import SampledSplice
from multirep.splices import SpliceList
from multirep.testing.elements import ElementsOf, default_elements
from multirep.testing.looking import GRID, STORED, dense_parameters, even, seen_deviation

if TYPE_CHECKING:
    from multirep.multirepresentation import MultiRepresentation

R = TypeVar("R", bound=Representation)

#: Points looked at on each chord of a sampled splice, ends included.
PER_CHORD = 9
#: Rounding of evaluation itself, in ulp of the largest coordinate: what seen may exceed proved by.
ROUNDING = 64 * np.finfo(float).eps
#: Largest change, in terms of the largest coordinate, of a stretch that is only written in other
#: control points (knot insertion beside a splice).
SAME_CURVE = 1e-11


def check_same(
    one: Representation, two: Representation, *, elements: ElementsOf = default_elements
) -> None:
    """Check that two values are bit-identical: stored arrays, evaluation, and data if offered.

    Examples
    --------
    >>> from multirep.testing import LoopbackRepresentation
    >>> line = LoopbackRepresentation([0, 1], [[0, 0], [1, 1]])
    >>> check_same(line, LoopbackRepresentation([0, 1], [[0, 0], [1, 1]]))
    """
    _same_kind(one, two)
    for mine, theirs in zip(elements(one), elements(two), strict=True):
        if not _equal_bits(mine.rows, theirs.rows):
            raise InvariantError(f"the {mine.name} differ", (one, two))
    t = dense_parameters(one, SpliceList.EMPTY, elements=elements)
    if not _equal_bits(one(t), two(t)):
        raise InvariantError("the curves evaluate differently", (one, two))
    data, other = _as_data(one), _as_data(two)
    if data != other:
        raise InvariantError("the values are written as different data", (one, two))


def check_edit(
    before: R,
    edit: Edit[R] | Callable[[R], Edit[R]],
    *,
    elements: ElementsOf = default_elements,
    several: bool = False,
) -> Edit[R]:
    """Check everything that must hold after *any* edit of ``before``, and return the edit.

    - The splices are canonical and lie in T; the kind, T and the dimension are as before.
    - Outside the splices the curve evaluates bit-identically, one ulp beside their ends too.
    - Every stored row whose support does not meet the splices is bit-identical.
    - ``before.changes(after)`` reports no change outside the splices and misses none inside.
    - The new value survives being written as data and read again, bit by bit.
    - Given an operation instead of its result: ``before`` is untouched by it, and a second run
      gives the same result, bit by bit.

    Parameters
    ----------
    before : Representation
    edit : Edit, or callable that makes one of ``before``
    elements : callable, optional
        What the representation stores; see :class:`~multirep.testing.Elements`.
    several : bool
        Whether several edits are put together here; ``changes()`` may then find more than they
        report, for it may look at the whole between the first difference and the last.

    Raises
    ------
    InvariantError
        With the edit as ``subject``.

    Examples
    --------
    >>> from multirep.testing import LoopbackRepresentation
    >>> line = LoopbackRepresentation([0, 0.5, 1], [[0, 0], [1, 0], [2, 0]])
    >>> print(check_edit(line, lambda line: line.move(1, [1, 1])).splices)
    [0,1]
    """
    if callable(edit):
        edit = _performed_twice(before, edit, elements)
    if not isinstance(edit, Edit):
        raise InvariantError(f"an operation returns an Edit, not a {type(edit).__name__}", edit)
    after, splices = edit.value, edit.splices
    splices.check()
    _same_kind(before, after)
    if splices and not before.domain.contains(splices.hull):
        raise InvariantError(f"splices {splices} leave the domain {before.domain}", edit)
    differs = _check_outside(before, edit, elements)
    changes = before.changes(after)
    exact = type(before).changes is not Representation.changes and not several
    if exact and not splices.contains(changes):
        raise InvariantError(
            f"changes() finds {changes - splices}, which the splices {splices} do not cover", edit
        )
    missed = [s for s in differs if not changes.contains(float(s))]
    if missed:
        raise InvariantError(f"changes() misses a difference at t = {missed[0]!r}", edit)
    if after.size <= STORED:  # long ones are slow to write, and the suite writes one of them
        check_data(after, elements=elements)
    return edit


def _performed_twice(before: R, operation: Callable[[R], Edit[R]], elements: ElementsOf) -> Edit[R]:
    """Return the edit; raise if it changed its subject, or if a second one is another."""
    untouched = _fingerprint(before, elements)
    edit = operation(before)
    if _fingerprint(before, elements) != untouched:
        raise InvariantError("the operation changed the value that it was given", edit)
    again = operation(before)
    if again.splices != edit.splices:
        raise InvariantError("a second run reports other splices", edit)
    check_same(edit.value, again.value, elements=elements)
    return edit


def _check_outside(before: R, edit: Edit[R], elements: ElementsOf) -> Array:
    """Raise if anything changed outside the splices; return parameters at which the curve did."""
    after, splices = edit.value, edit.splices
    t = dense_parameters(before, splices, after, elements=elements)
    inside = np.zeros(len(t), dtype=bool)
    for splice in splices:
        inside |= (splice.start <= t) & (t <= splice.stop)
    differs = (_bits(before(t)) != _bits(after(t))).any(axis=1)
    if (differs & ~inside).any():
        where = t[differs & ~inside]
        raise InvariantError(
            f"the curve changed outside the splices {splices}: at {len(where)} of "
            f"{int((~inside).sum())} parameters, the first t = {where[0]!r}",
            edit,
        )
    for mine, theirs in zip(elements(before), elements(after), strict=True):
        kept, found = mine.outside(splices), theirs.outside(splices)
        if not _equal_bits(kept, found):
            raise InvariantError(
                f"{mine.name} changed outside the splices {splices}: "
                f"{len(kept)} rows before, {len(found)} after",
                edit,
            )
    changed: Array = t[differs]
    return changed


def check_data(value: Representation, *, elements: ElementsOf = default_elements) -> None:
    """Check that a value survives ``to_dict``, JSON and ``from_dict``, if it offers them."""
    data = _as_data(value)
    if data is not None:
        again = type(value).from_dict(json.loads(json.dumps(data)))
        check_same(value, again, elements=elements)


def check_sample(
    value: Representation, interval: Interval, *, tolerance: float, per_chord: int = PER_CHORD
) -> SampledSplice:
    """Check that ``value.sample`` keeps its certificate, chord by chord, and return the sample.

    The ends are those of the interval and the end points are on the curve; ``bound`` is within
    the tolerance; on every chord the curve stays within the certificate (looked at densely).
    """
    sampled = value.sample(interval, tolerance=tolerance)
    if sampled.interval != interval:
        raise InvariantError(f"asked for {interval!r}, got {sampled.interval!r}", sampled)
    rounding = ROUNDING * value.magnitude
    if not sampled.bound <= tolerance:
        raise InvariantError(f"bound {sampled.bound:g} exceeds tolerance {tolerance:g}", sampled)
    ends = np.linalg.norm(sampled.points[[0, -1]] - value(np.array([*interval])), axis=1)
    if ends.max() > rounding:
        raise InvariantError(f"an end point is {ends.max():g} off the curve", sampled)
    certified = np.full(len(sampled.t) - 1, sampled.bound)
    if sampled.chord_bounds is not None:
        certified = sampled.chord_bounds
        if certified.shape != (len(sampled.t) - 1,) or not (certified <= sampled.bound).all():
            raise InvariantError("chord bounds: one for each chord, none above bound", sampled)
    if not set(sampled.breaks) <= set(sampled.t.tolist()):
        raise InvariantError("a break is not among the sample parameters", sampled)
    _within(value, sampled, certified + rounding, "the sampled curve", per_chord)
    return sampled


def check_splice(
    before: R,
    sampled: SampledSplice,
    *,
    tolerance: float,
    elements: ElementsOf = default_elements,
    per_chord: int = PER_CHORD,
) -> Edit[R]:
    """Check that ``before.splice(sampled)`` is certified, continuous and local; return the edit.

    Besides :func:`check_edit`: on each chord ``||R' - L||`` stays within
    ``sampled.allowance(tolerance)`` and within the bound that the edit claims to have proved;
    outside the interval of the samples the curve is the same up to rounding, and at ends inside T
    it joins what stands there.
    """
    edit = check_edit(
        before, lambda value: value.splice(sampled, tolerance=tolerance), elements=elements
    )
    _check_followed(edit.value, sampled, tolerance, edit.bound, per_chord)
    start, stop = sampled.interval
    grids = [np.linspace(splice.start, splice.stop, GRID) for splice in edit.splices]
    t = np.concatenate([*grids, [start, stop]])
    left, right = start > before.domain.start, stop < before.domain.stop
    t = t[((t <= start) & left) | ((t >= stop) & right)]
    moved = np.linalg.norm(before(t) - edit.value(t), axis=1)
    if moved.max(initial=0.0) > SAME_CURVE * max(before.magnitude, edit.value.magnitude):
        raise InvariantError(
            f"outside the samples on {sampled.interval} the curve moved by {moved.max():g} "
            f"at t = {t[moved.argmax()]!r}",
            edit,
        )
    return edit


def check_fit(
    kind: type[R],
    sampled: SampledSplice,
    *,
    tolerance: float,
    per_chord: int = PER_CHORD,
    **options: Any,
) -> R:
    """Check that ``kind.fit`` gives a value over all of T within the allowance, and return it."""
    value = kind.fit(sampled, tolerance=tolerance, **options)
    if type(value) is not kind:
        raise InvariantError(f"{kind.name}.fit returned a {type(value).__name__}", value)
    if value.domain != sampled.interval or value.dimension != sampled.dimension:
        raise InvariantError(
            f"fitted over {sampled.interval} in {sampled.dimension} coordinates, "
            f"got {value.domain} in {value.dimension}",
            value,
        )
    _check_followed(value, sampled, tolerance, None, per_chord)
    return value


def check_certificate(
    curve: MultiRepresentation,
    *,
    kinds: Iterable[str] | None = None,
    elements: ElementsOf = default_elements,
) -> float:
    """Check that any two representations of a curve are within its tolerance of each other.

    Every pair is compared densely, at all stored parameters, and again around the largest
    distances; what is seen must not exceed ``Deviation.upper``, which must not exceed the
    tolerance, and ``Deviation.lower`` must occur.

    Returns
    -------
    float
        The largest distance seen.
    """
    tolerance = curve.tolerance
    values = {kind: curve.view(kind) for kind in (kinds or curve.kinds)}
    largest = 0.0
    for one, two in itertools.combinations(values, 2):
        claimed = curve.deviation(one, two)
        seen, at = seen_deviation(
            values[one], values[two], tolerance=tolerance / 64, elements=elements
        )
        rounding = ROUNDING * max(values[one].magnitude, values[two].magnitude)
        numbers = f"{one} ~ {two}: seen {seen:g} at t = {at!r}, claimed {claimed}"
        if not 0 <= claimed.lower <= claimed.upper:
            raise InvariantError(f"the bounds are out of order; {numbers}", curve)
        if claimed.upper > tolerance:
            raise InvariantError(f"not proved to be within {tolerance:g}; {numbers}", curve)
        if seen > claimed.upper + rounding:
            raise InvariantError(f"the proof is contradicted; {numbers}", curve)
        if claimed.lower > 1.01 * seen + 0.01 * tolerance + rounding:
            raise InvariantError(f"the lower bound does not occur; {numbers}", curve)
        largest = max(largest, seen)
    return largest


def _same_kind(one: Representation, two: Representation) -> None:
    if type(one) is not type(two):
        raise InvariantError(f"a {type(one).__name__} became a {type(two).__name__}", (one, two))
    if one.domain != two.domain or one.dimension != two.dimension:
        raise InvariantError(
            f"domain and dimension: {one.domain} and {one.dimension} before, "
            f"{two.domain} and {two.dimension} after",
            (one, two),
        )


def _check_followed(
    value: Representation,
    sampled: SampledSplice,
    tolerance: float,
    bound: float | None,
    per_chord: int,
) -> None:
    allowance = sampled.allowance(tolerance)
    rounding = ROUNDING * max(value.magnitude, float(np.abs(sampled.points).max()))
    _within(value, sampled, allowance + rounding, "the fitted curve", per_chord)
    if bound is not None:
        claimed = np.full_like(allowance, bound + rounding)
        _within(value, sampled, claimed, "the claimed bound: the fitted curve", per_chord)


def _within(
    value: Representation, sampled: SampledSplice, allowed: Array, what: str, per_chord: int
) -> None:
    """Raise unless the curve stays within ``allowed`` (m,) of the polyline, chord by chord."""
    u = np.linspace(0.0, 1.0, per_chord)[:, None]
    t = np.clip(sampled.t[:-1] + u * np.diff(sampled.t), sampled.t[:-1], sampled.t[1:])
    line = sampled(t)  # at the rounded t: far from 0 an ulp of t is a visible step along the curve
    apart = np.linalg.norm(value(t.ravel()).reshape(line.shape) - line, axis=2).max(axis=0)
    worst = int((apart - allowed).argmax())
    if apart[worst] > allowed[worst]:
        raise InvariantError(
            f"{what} is {apart[worst]:g} from L on "
            f"[{sampled.t[worst]!r}, {sampled.t[worst + 1]!r}], allowed: {allowed[worst]:g}",
            value,
        )


def _fingerprint(value: Representation, elements: ElementsOf) -> tuple[object, ...]:
    t = even(value.domain, GRID)
    arrays = [element.rows.tobytes() for element in elements(value)]
    return (value.domain, value.dimension, value(t).tobytes(), *arrays, _as_data(value))


def _as_data(value: Representation) -> dict[str, Any] | None:
    try:
        return value.to_dict()
    except NotImplementedError:
        return None


def _bits(array: Array) -> Any:
    return np.ascontiguousarray(array).view(np.int64)


def _equal_bits(one: Array, two: Array) -> bool:
    return one.shape == two.shape and bool((_bits(one) == _bits(two)).all())
