"""Sample a spline by few chords, each with a proved deviation.

A chord of length h on which the curve bends by S'' leaves it by about ``h**2 / 8 ||S''||``, so the
fewest chords within a tolerance number about the integral of ``sqrt(||S''|| / (8 tolerance))``.
That integrand is the *density* here: it is measured, chords are laid out with equal shares of it,
and what each chord really leaves is then proved (`multirep.splines.deviation`), never assumed.
"""

from typing import NamedTuple, Self

import numpy as np

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray
from multirep.splines.curvature import second_derivative_coefficients
from multirep.splines.deviation import bernstein_deviation, curvature_deviation
from multirep.splines.evaluation import evaluate
from multirep.splines.pieces import (
    Stretch,
    cut_pieces,
    cut_stretch,
    norms,
    project,
    rounding,
)

__all__ = ["sample_spline"]

# Cells per chord on which the density is taken as constant, and the fewest and the most on a span.
# Fewer cells leave more chords above the tolerance; more cost time, which small edits feel.
_CELLS_PER_CHORD = 4
_FEWEST_CELLS, _MOST_CELLS = 2, 64
# Rational splines and high degrees have no cheap bound of the density: it is looked at here first.
_LOOKS = 3
# Chords are laid out for this share of the tolerance: where the density varies within a chord it
# leaves slightly more than its share. Each per cent costs half a per cent of chords.
_MARGIN = 0.95
# A stretch of few chords gets this much of a chord more, lest one failing chord costs a round.
_SPARE = 0.25
_SPARE_FROM = 5.0
# Chords per block in which samples are moved, round by round, when a chord of it failed. Longer
# blocks waste less by rounding up their counts, but where the curve is rough at the scale of the
# chords, moving many samples far only makes other chords fail. 1: cut the chord.
_BLOCKS = (6, 6) + (1,) * 60
# If no more than this share of the chords failed (and one), they are cut at once.
_FEW = 0.02
# No chord is taken to need less than this part of the tolerance's square root.
_LEAST_NEED = 1e-3
# A chord is cut into this many parts at most in one round.
_MOST_PARTS = 16
_SPLITS = 2
# The tolerance must exceed what rounding may cost by this share of it: the count grows without
# bound as the room between them vanishes.
_LEAST_ROOM = 0.25


def sample_spline(
    knots: Array,
    coefficients: Array,
    degree: int,
    start: float,
    stop: float,
    *,
    tolerance: float,
    rational: bool = False,
) -> tuple[Array, Array, Array]:
    """Sample a spline so that the polyline is proved to be within the tolerance of it.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing; multiplicity up to the degree inside the domain.
    coefficients : (n, d) array, or (n, d + 1) if rational
        Control points; of a rational spline homogeneous ones ``(w x, w y, .., w)`` with w > 0.
    degree : int
        Degree p of the spline, at least 1.
    start, stop : float
        The interval, ``start < stop``, within the domain.
    tolerance : float, keyword-only
        What ``||R(t) - L(t)||`` may be at most, for every t.
    rational : bool, keyword-only
        Whether the last coordinate of the coefficients is a weight.

    Returns
    -------
    t : (m + 1,) array
        Strictly increasing from start to stop; knots of multiplicity p or more are among them.
    points : (m + 1, d) array
        The curve there, bit for bit as `evaluate` gives it.
    chord_bounds : (m,) array
        The proved deviation of each chord, rounding included, at most the tolerance.

    Raises
    ------
    ValueError
        If the tolerance is below what rounding allows; the message says what it costs.

    Notes
    -----
    On smooth spans m is within some per cent (and a sample per stretch between corners) of the
    integral of ``sqrt(||R''|| / (8 tolerance))``; a chord may pass over knots, so this holds for
    curves with many knots a chord as well. The time is linear in m and in the knots between start
    and stop.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> square = np.array([[0.0], [0.0], [1.0]])
    >>> t, points, bounds = sample_spline(knots, square, 2, 0.0, 1.0, tolerance=0.017)
    >>> t, points[:, 0]
    (array([0.  , 0.25, 0.5 , 0.75, 1.  ]), array([0.    , 0.0625, 0.25  , 0.5625, 1.    ]))
    >>> bounds.round(9)
    array([0.015625, 0.015625, 0.015625, 0.015625])
    """
    if compiled.active and (degree > 1 or rational):
        found = compiled.core.sample(knots, coefficients, degree, rational, start, stop, tolerance)
        if found is not None:
            t, points, bounds = (np.frombuffer(numbers) for numbers in found)
            return t, points.reshape(len(t), -1), bounds
        # out of reach: numpy finds out why
    stretch = cut_stretch(knots, coefficients, degree, start, stop, rational)
    proof = _Proof.of(stretch, tolerance)
    fixed = _fixed_parameters(stretch, start, stop)
    if degree == 1 and not rational:
        points = evaluate(knots, coefficients, degree, fixed)
        return fixed, points, np.full(len(fixed) - 1, proof.worst)
    density = _density(proof, start, stop)
    # `evaluate` takes a knot from its right, a stretch ends on its left.
    last = evaluate(knots, coefficients, degree, np.array([stop]))
    samples = _first_samples(proof, density, fixed, project(last, rational))
    for turn, size in enumerate(_BLOCKS):
        count = int(np.count_nonzero(samples.bounds > tolerance))
        if not count:
            return samples
        if count <= _FEW * len(samples.bounds) + 1:
            size = 1
        # Every other round, blocks end elsewhere.
        better = _improved(proof, density, samples, fixed, size, size // 2 * (turn % 2))
        if better is None:
            break
        samples = better
    failing = samples.t[:-1][samples.bounds > tolerance]
    raise ValueError(
        f"a tolerance of {tolerance:.3g} is out of reach: the curve bends between neighbouring "
        f"floating-point parameters near {float(failing[0])!r}"
    )


class _Samples(NamedTuple):
    """Parameters (m + 1,), points (m + 1, d) and the bound of each chord (m,)."""

    t: Array
    points: Array
    bounds: Array


class _Density(NamedTuple):
    """A grid (k + 1,) and how many chords each of its cells needs, (k,)."""

    nodes: Array
    shares: Array


class _Proof(NamedTuple):
    """What chords of a stretch are proved with."""

    stretch: Stretch
    second: Array | None
    """S'' where it is linear or constant on spans, as `second_derivative_coefficients` gives it."""
    slack: Array | float
    """What rounding may cost, on each cell or on all."""
    worst: float
    tolerance: float

    @property
    def room(self) -> float:
        """What rounding leaves of the tolerance."""
        return self.tolerance - self.worst

    @classmethod
    def of(cls, stretch: Stretch, tolerance: float) -> Self:
        """Prepare a proof; ValueError when rounding alone takes the tolerance up."""
        hull, degree = stretch.coefficients, stretch.degree
        if stretch.rational:
            hull = hull[:, :-1] / hull[:, -1:]
        slack = rounding(stretch, hull)
        worst = float(np.max(slack))
        exact = degree == 1 and not stretch.rational
        if tolerance < worst or (not exact and tolerance - worst < _LEAST_ROOM * worst):
            raise ValueError(
                f"a tolerance of {tolerance:.3g} is out of reach: rounding of coordinates up to "
                f"{float(np.abs(hull).max()):.3g} alone may cost {worst:.3g}"
            )
        second = None
        if not stretch.rational and degree in (2, 3):
            second = second_derivative_coefficients(stretch.knots, stretch.coefficients, degree)
        return cls(stretch, second, slack, worst, tolerance)


def _fixed_parameters(stretch: Stretch, start: float, stop: float) -> Array:
    """List the ends, and the knots between them of multiplicity p or more."""
    p = stretch.degree
    inner = stretch.knots[p + 1 : -p - 1]
    full = inner[: max(len(inner) - p + 1, 0)]
    full = full[full == inner[p - 1 :]]
    if not len(full):
        return np.array([start, stop])
    return np.unique(np.concatenate(([start], full, [stop])))


def _density(proof: _Proof, start: float, stop: float) -> _Density:
    """Measure how many chords each cell of a fine grid needs."""
    stretch, second, target = proof.stretch, proof.second, proof.room * _MARGIN
    low, high = stretch.breaks[:-1].copy(), stretch.breaks[1:].copy()
    low[0], high[-1] = start, stop
    width = high - low
    if second is None:
        looks = low + width * ((np.arange(_LOOKS)[:, None] + 0.5) / _LOOKS)
        bending = stretch.bending(looks.T.ravel()).reshape(-1, _LOOKS).max(axis=1)
    else:
        # S'' is linear or constant on a span, so largest at an end.
        ends = norms(second)
        bending = ends.take(stretch.spans - stretch.degree)
        if stretch.degree == 3:
            bending = np.maximum(bending, ends.take(stretch.spans - 2))
    cells = np.ceil(width * np.sqrt(bending * (_CELLS_PER_CHORD**2 / (8 * target))))
    parts = np.minimum(np.maximum(cells, _FEWEST_CELLS), _MOST_CELLS).astype(np.intp)
    ends = parts.cumsum()
    width = (width / parts).repeat(parts)
    nodes = np.empty(len(width) + 1)
    nodes[:-1] = low.repeat(parts) + (np.arange(ends[-1]) - (ends - parts).repeat(parts)) * width
    nodes[-1] = stop
    shares = np.sqrt(stretch.bending(nodes[:-1] + width / 2) / (8 * target))
    shares *= width
    # Never quite zero, so that the density can be inverted where the curve is straight.
    shares += 1e-6 * (width / (stop - start))
    return _Density(nodes, shares)


def _first_samples(proof: _Proof, density: _Density, fixed: Array, last: Array) -> _Samples:
    """Lay chords of equal shares out between the fixed parameters; ``last`` is the last point."""
    t = np.append(_lay_out(density, fixed[:-1], fixed[1:], spare=_SPARE)[0], fixed[-1])
    if not bool((t[1:] > t[:-1]).all()):
        t = np.unique(t)
    points = proof.stretch.points(t)
    if t[-1] == proof.stretch.breaks[-1]:
        points[-1] = last
    return _Samples(t, points, _certify(proof, t[:-1], t[1:], points[:-1], points[1:]))


def _improved(
    proof: _Proof, density: _Density, samples: _Samples, fixed: Array, size: int, shift: int
) -> _Samples | None:
    """Lay blocks with a failing chord out anew between their ends, by the corrected density.

    None when two samples would fall together.
    """
    t, points, bounds = samples
    corrected = _corrected(proof, density, samples)
    firsts = _blocks(t, fixed, size, shift)
    redo = np.logical_or.reduceat(bounds > proof.tolerance, firsts)
    begins = firsts[redo]
    ends = np.append(firsts[1:], len(bounds))[redo]
    least = 2 if size == 1 else 1
    starts, counts = _lay_out(corrected, t[begins], t[ends], least=least)
    first, last = points[begins], points[ends]
    stops, low, high = _neighbours(proof.stretch, starts, counts, first, t[ends], last)
    if not bool((stops > starts).all()):
        return None
    proved = _certify(proof, starts, stops, low, high)
    kept = ~redo.repeat(np.diff(np.append(firsts, len(bounds))))
    t = np.concatenate((t[:-1][kept], starts, t[-1:]))
    order = t.argsort()
    points = np.concatenate((points[:-1][kept], low, points[-1:]))[order]
    return _Samples(t[order], points, np.concatenate((bounds[kept], proved))[order[:-1]])


def _corrected(proof: _Proof, density: _Density, samples: _Samples) -> _Density:
    """Scale the density on each chord so that the chord's share is what it proved to need."""
    (nodes, shares), t = density, samples.t
    needs = np.sqrt(np.maximum(samples.bounds - proof.worst, 0.0) / proof.room)
    sums = np.concatenate(([0.0], shares.cumsum()))
    grid = np.concatenate((nodes, t))
    grid.sort()
    shares = np.diff(np.interp(grid, nodes, sums))
    chords = np.minimum(t.searchsorted(grid[:-1], "right") - 1, len(needs) - 1)
    totals = np.bincount(chords, weights=shares, minlength=len(needs))
    scale = np.divide(
        np.maximum(needs, _LEAST_NEED), totals, out=np.ones_like(needs), where=totals > 0
    )
    return _Density(grid, shares * scale.take(chords))


def _blocks(t: Array, fixed: Array, size: int, shift: int) -> IntArray:
    """Choose the first chord of each block: every so many, and every fixed parameter."""
    regular = np.arange(shift, len(t) - 1, size)
    if size == 1:
        return regular
    return np.unique(np.concatenate((regular, t.searchsorted(fixed[:-1]))))


def _lay_out(
    density: _Density, begins: Array, ends: Array, least: int = 1, spare: float = 0.0
) -> tuple[Array, IntArray]:
    """Divide intervals into chords of equal shares, at most 1; return their starts and counts."""
    nodes = density.nodes
    sums = np.concatenate(([0.0], density.shares.cumsum()))
    marks = np.interp(begins, nodes, sums)
    needs = np.interp(ends, nodes, sums) - marks
    counts = np.maximum(np.ceil(needs + spare * (needs > _SPARE_FROM)), least).astype(np.intp)
    if least > 1:
        counts = np.minimum(counts, _MOST_PARTS)
    stops = counts.cumsum()
    firsts = stops - counts
    wanted = (np.arange(stops[-1]) - firsts.repeat(counts)) * (needs / counts).repeat(counts)
    t = np.interp(wanted + marks.repeat(counts), sums, nodes)
    t[firsts] = begins
    return t, counts


def _neighbours(
    stretch: Stretch, starts: Array, counts: IntArray, first: Array, stop: Array, last: Array
) -> tuple[Array, Array, Array]:
    """Find where the chords of each block stop, and the points at both ends of each."""
    ends = counts.cumsum()
    low = stretch.points(starts)
    low[ends - counts] = first
    stops, high = np.empty_like(starts), np.empty_like(low)
    stops[:-1], high[:-1] = starts[1:], low[1:]
    stops[ends - 1], high[ends - 1] = stop, last
    return stops, low, high


def _certify(proof: _Proof, starts: Array, stops: Array, low: Array, high: Array) -> Array:
    """Bound the deviation from chords between points of the curve, rounding included."""
    stretch, second, slack = proof.stretch, proof.second, proof.slack
    pieces = cut_pieces(stretch.breaks, starts, stops)
    count = len(pieces.cells)
    off = np.zeros(count + 1)
    if count > len(starts):
        # Chords that pass a knot: the line there, the same for both pieces that meet.
        is_inner = np.ones(count, dtype=bool)
        is_inner[pieces.firsts] = False
        inner = np.flatnonzero(is_inner)
        there, chords = pieces.starts.take(inner), pieces.chords.take(inner)
        at = starts.take(chords)
        share = (there - at) / (stops.take(chords) - at)
        line = low.take(chords, axis=0)
        line += share[:, None] * (high.take(chords, axis=0) - line)
        low, high = low.take(pieces.chords, axis=0), high.take(pieces.chords, axis=0)
        low[inner] = line
        high[inner - 1] = line
        if second is not None:
            off[inner] = norms(stretch.at(there) - line)
    if isinstance(slack, np.ndarray):
        slack = slack.take(pieces.cells)
    if second is None:
        bounds = bernstein_deviation(stretch, pieces, low, high, _SPLITS) + slack
        return np.asarray(np.maximum.reduceat(bounds, pieces.firsts))
    bounds = curvature_deviation(stretch, pieces, off, second) + slack
    above = np.flatnonzero(bounds > proof.tolerance)
    if len(above):
        sharper = bernstein_deviation(stretch, pieces, low, high, _SPLITS, above) + slack
        bounds[above] = np.minimum(bounds[above], sharper)
    return np.asarray(np.maximum.reduceat(bounds, pieces.firsts))
