"""Re-parameterisation: a monotone map of T, applied to a curve as a whole.

A wavelet curve is at its best when the speed is even (Grimm-Ayers 6.3), and t may have become
uneven by edits that lengthen one stretch. No representation can mend that alone: all of them are
compared at equal t. So the map is applied to the author, which becomes the only one, and every
other representation follows (:meth:`multirep.MultiRepresentation.reparameterize`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Literal, TypeAlias

import numpy as np

from multirep.arrays import Array, ArrayLike
from multirep.composition import compose
from multirep.errors import EditError, RegistrationError
from multirep.events import Committed, Event
from multirep.freezing import frozen_error
from multirep.representation import Representation, starter
from multirep.sampled import SampledSplice, interpolate
from multirep.spacing import told_apart
from multirep.splices import SpliceList
from multirep.state import Held, State
from multirep.synchronization import SAMPLING_SHARE, evolve_stale, hop

#: "even" for even speed, or the pairs (old t, new t) of a piecewise linear map.
ParameterMap: TypeAlias = Literal["even"] | tuple[ArrayLike, ArrayLike]

#: What may fall between two parameters with no room for more, as a part of the curve's size.
LOST = 2.0**-30


def with_parameters(
    state: State,
    kinds: Iterable[type[Representation]],
    mapping: ParameterMap,
    emit: Callable[[Event], None],
) -> State:
    """Return the state under mapped parameters; the same state when they are so already.

    The authors are sampled as for a fit; that polyline at the mapped parameters becomes the only
    author, in the first of ``kinds`` that can be made of points.

    Raises
    ------
    EditError, RegistrationError, FrozenError
        See :meth:`multirep.MultiRepresentation.reparameterize`.
    """
    kinds = list(kinds)
    start = starter(kinds)
    if start is None:
        raise RegistrationError(
            "re-parameterising needs a representation that can be made of points, as the "
            f"polyline; this curve keeps {', '.join(kind.name for kind in kinds)}"
        )
    everywhere = SpliceList([state.authors.domain])
    if state.frozen:
        raise frozen_error(state, everywhere, "re-parameterising")
    share = SAMPLING_SHARE * hop(state.tolerance)
    sampled = compose(state, state.authors.domain, tolerance=share, emit=emit)
    t, points = reparameterized(sampled, mapping)
    value = start(points, t=t)
    name = value.name
    before = state.held[name].value
    if state.authors.names == (name,) and before is not None and not before.changes(value):
        return state
    emit(Committed(name, everywhere))
    return evolve_stale(state, name, Held(value, SpliceList.EMPTY), everywhere)


def reparameterized(sampled: SampledSplice, mapping: ParameterMap) -> tuple[Array, Array]:
    """Apply a map of T to a curve that is given by samples over all of T.

    Parameters
    ----------
    sampled : SampledSplice
    mapping : "even" or pair of (k,) array_like
        Even speed, or a piecewise linear map by its knots: old t and new t, both increasing
        strictly from one end of T to the other.

    Returns
    -------
    t, points : (m,) and (m, d) arrays
        The same polyline in space, with the samples and the knots of the map as vertices.
        Neighbours that no parameter can tell apart any more are merged. Cost: O(samples + knots).

    Raises
    ------
    EditError
        When the map is not monotone, does not map T to itself, or squeezes a stretch of the curve
        into less than a parameter can tell.

    Examples
    --------
    >>> slow_then_fast = SampledSplice([0, 2, 3], [[0, 0], [1, 0], [4, 0]])
    >>> reparameterized(slow_then_fast, "even")[0]
    array([0.  , 0.75, 3.  ])
    >>> reparameterized(slow_then_fast, ([0, 2, 3], [0, 1, 3]))[0]
    array([0., 1., 3.])
    """
    start, stop = sampled.interval
    if isinstance(mapping, str):
        if mapping != "even":
            raise EditError(
                f"a map of T is 'even' or a pair of arrays (old t, new t); got {mapping!r}"
            )
        at, points = sampled.t, sampled.points
        mapped = _even(at, points)
    else:
        old, new = _checked(mapping, start, stop)
        at = np.union1d(sampled.t, old)
        points = sampled(at)
        mapped = np.interp(at, old, new)
    mapped[0], mapped[-1] = start, stop
    return _merged(mapped, points)


def _even(t: Array, points: Array) -> Array:
    """Parameters in proportion to the length of the polyline, over the same T."""
    steps = points[1:] - points[:-1]
    steps = steps / np.abs(steps).max()  # squares of tiny or huge coordinates stay finite
    lengths = np.sqrt(np.einsum("ij,ij->i", steps, steps))
    along = np.concatenate([[0.0], lengths.cumsum()])
    even: Array = t[0] + (t[-1] - t[0]) * (along / along[-1])
    return even


def _checked(
    mapping: tuple[ArrayLike, ArrayLike], start: float, stop: float
) -> tuple[Array, Array]:
    """Return the knots of a map as arrays; EditError unless they map T monotonely to itself."""
    try:
        old, new = (np.array(values, dtype=np.float64) for values in mapping)
    except (TypeError, ValueError):
        raise EditError("a map of T is 'even' or a pair of arrays (old t, new t)") from None
    if old.ndim != 1 or old.shape != new.shape or len(old) < 2:
        raise EditError(
            "a map of T needs two knots or more, as many new parameters as old ones; "
            f"got shapes {old.shape} and {new.shape}"
        )
    for name, values in (("old", old), ("new", new)):
        if not np.isfinite(values).all():
            raise EditError(f"the {name} parameters of a map must be finite")
        rises = values[1:] > values[:-1]
        if not rises.all():
            k = int(rises.argmin())
            raise EditError(
                f"a map of T must be monotone: the {name} parameter {float(values[k])!r} is "
                f"followed by {float(values[k + 1])!r}"
            )
        if values[0] != start or values[-1] != stop:
            raise EditError(
                f"a map of T leads from [{start!r}, {stop!r}] to itself; the {name} parameters run "
                f"from {float(values[0])!r} to {float(values[-1])!r}"
            )
    return old, new


def _merged(t: Array, points: Array) -> tuple[Array, Array]:
    """Drop vertices whose parameters are too close to their neighbours'; the ends stay."""
    kept = told_apart(t)
    if len(kept) == len(t):
        return t, points
    rows = points[kept]
    off = np.abs(interpolate(t[kept], rows, t) - points).max(axis=1)
    k = int(off.argmax())
    if float(off[k]) > LOST * float(np.ptp(points, axis=0).max()):
        raise EditError(
            f"the map squeezes the curve around t = {t[k]:.6g} into less than parameters can tell "
            f"apart: {off[k]:.3g} of it would be lost"
        )
    return t[kept], rows
