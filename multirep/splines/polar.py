"""The polar form (blossom) of B-splines: change of knots, Bernstein form.

The blossom of a polynomial of degree p is the symmetric function of p arguments that is affine in
each and agrees with the polynomial on the diagonal. A control point is the blossom at its p inner
knots, a Bernstein coefficient of the piece on [u, v] is the blossom at (u, .., u, v, .., v). All
that follows is repeated affine interpolation between neighbours, vectorised over rows; inside the
span that is given every weight lies in [0, 1], so nothing is amplified.
"""

from functools import cache

import numpy as np

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray

__all__ = ["bernstein", "blossom", "inner_knots", "refine"]

#: A piece may be continued over so many times its length: that costs a few units in the last place.
_MUCH_LONGER = 4.0


@cache
def _ladder(degree: int) -> tuple[IntArray, IntArray, IntArray]:
    """List the local knots between which each interpolation of de Boor's algorithm takes place.

    Step r has ``p - r`` of them, one below the other; the third array holds the step of each.
    """
    steps = np.repeat(np.arange(degree), np.arange(degree, 0, -1))
    low = np.array([row for step in range(degree) for row in range(step, degree)], dtype=np.intp)
    ladder = (low, low + degree - steps, steps)
    for column in ladder:
        column.setflags(write=False)
    return ladder


def _mixed(points: Array, share: Array, rest: Array) -> Array:
    """Interpolate neighbouring rows. Both products, to be exact at share 0 and 1."""
    mixed = points[:-1] * rest
    mixed += points[1:] * share
    return mixed


def _local(knots: Array, coefficients: Array, degree: int, spans: IntArray) -> tuple[Array, Array]:
    """Cut out knots k-p+1 .. k+p, shape (2p, m), and coefficients k-p .. k, shape (p+1, m, D)."""
    index = np.arange(-degree, degree + 1)[:, None] + spans
    return knots.take(index[1:]), coefficients.take(index[: degree + 1], axis=0)


def _triangle(local: Array, points: Array, degree: int, arguments: Array) -> list[Array]:
    """List the rows that 0, 1, .., p steps of de Boor's algorithm leave, (p + 1 - r, m, D) each.

    ``arguments`` are those of the steps on the ladder, one below the other, or one for all, (m,).
    """
    low, high, _ = _ladder(degree)
    below = local.take(low, axis=0)
    shares = ((arguments - below) / (local.take(high, axis=0) - below))[..., None]
    rest = 1.0 - shares
    found = [points]
    row = 0
    for left in range(degree, 0, -1):
        stop = row + left
        found.append(_mixed(found[-1], shares[row:stop], rest[row:stop]))
        row = stop
    return found


def blossom(
    knots: Array,
    coefficients: Array,
    degree: int,
    spans: IntArray,
    arguments: Array,
) -> Array:
    """Evaluate the polar form of polynomial pieces.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing.
    coefficients : (n, D) array
        Control points, homogeneous ones too.
    degree : int
        Degree p of the spline, at least 1.
    spans : (m,) integer array
        Whose piece each row means: ``knots[k] < knots[k + 1]``.
    arguments : (m, p) array
        The arguments of each row; their order within a row matters only for rounding.

    Returns
    -------
    (m, D) array

    Notes
    -----
    de Boor's algorithm with another argument in each step; m p (p + 1) / 2 interpolations.
    Arguments within the 2p local knots of the span are stable; farther away the result is an
    extrapolation.

    Examples
    --------
    The blossom of t**2 at (a, b) is a b.

    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> square = np.array([[0.0], [0.0], [1.0]])
    >>> blossom(knots, square, 2, np.array([2]), np.array([[0.5, 0.25]]))
    array([[0.125]])
    """
    if compiled.active:
        found = np.empty((len(spans), coefficients.shape[1]))
        compiled.core.blossom(knots, coefficients, degree, spans, arguments, found)
        return found
    local, points = _local(knots, coefficients, degree, spans)
    steps = _ladder(degree)[2]
    return np.asarray(_triangle(local, points, degree, arguments.T.take(steps, axis=0))[-1][0])


def bernstein(
    knots: Array,
    coefficients: Array,
    degree: int,
    spans: IntArray,
    starts: Array,
    stops: Array,
) -> Array:
    """Convert pieces of a spline to Bernstein form.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing.
    coefficients : (n, D) array
        Control points, homogeneous ones too.
    degree : int
        Degree p of the spline, at least 1.
    spans : (m,) integer array
        The span that holds each piece.
    starts, stops : (m,) arrays
        ``knots[k] <= start < stop <= knots[k + 1]``; one unit in the last place apart is enough.

    Returns
    -------
    (m, p + 1, D) array
        Row i of a piece is the blossom at (start x (p - i), stop x i). (Laid out in memory as
        (p + 1, m, D).)

    Notes
    -----
    Inserts the start p times, then the stop p times (2p vectorised steps in all). Divides by
    differences of knots and by ``knots[k + 1] - start`` only, never by the length of a piece.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> square = np.array([[0.0], [0.0], [1.0]])
    >>> bernstein(knots, square, 2, np.array([2]), np.array([0.0]), np.array([0.5]))[0, :, 0]
    array([0.  , 0.  , 0.25])
    """
    local, points = _local(knots, coefficients, degree, spans)
    # (start x (p - r), knots k+1 .. k+r) in row r: the last entry of each step.
    rows = np.empty_like(points)
    for step, left in enumerate(_triangle(local, points, degree, starts)):
        rows[degree - step] = left[-1]
    shares = ((stops - starts) / (local[degree:] - starts))[..., None]
    rest = 1.0 - shares
    for step in range(degree):
        rows[step + 1 :] = _mixed(rows[step:], shares[: degree - step], rest[: degree - step])
    return rows.transpose(1, 0, 2)


def refine(knots: Array, coefficients: Array, degree: int, new_knots: Array) -> Array:
    """Express the same spline on more knots.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing; multiplicity up to p inside, up to p + 1 at the ends. A window of a longer
        knot vector will do.
    coefficients : (n, D) array
        Control points, homogeneous ones too.
    degree : int
        Degree p of the spline, at least 1.
    new_knots : (N + degree + 1,) array
        The same knots and any number more, all of these within ``[knots[p], knots[n]]``.

    Returns
    -------
    (N, D) array
        A control point whose p local knots did not change is copied bit by bit.

    Notes
    -----
    Each new control point is the blossom, at its p inner knots, of the old polynomial piece
    nearest to the middle of its support, or of the longest one where that is much shorter (from a
    tiny span among long ones, rounding errors would be continued over many times its length); only
    the changed ones are computed.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> square = np.array([[0.0], [0.0], [1.0]])
    >>> refine(knots, square, 2, np.array([0, 0, 0, 0.5, 1, 1, 1.0]))[:, 0]
    array([0. , 0. , 0.5, 1. ])
    """
    changed, source = _unmatched(knots, new_knots, degree)
    refined = coefficients.take(source, axis=0, mode="clip")
    if len(changed):
        pieces = inner_knots(knots, degree, new_knots, changed)
        refined[changed] = blossom(knots, coefficients, degree, *pieces)
    return refined


def _unmatched(old: Array, new: Array, degree: int) -> tuple[IntArray, IntArray]:
    """Match control points of a refined knot vector to the old ones with the same inner knots.

    Returns the new control points (c,) whose p inner knots belong to no old one, and for each of
    all (N,) which old one it is otherwise.
    """
    count = len(new) - degree - 1
    first = new[1 : count + 1]
    # How many of the new knots stand before; equal ones count as standing behind.
    source = old.searchsorted(first, "right") - new.searchsorted(first, "right")
    source += np.arange(count)
    fits = (source >= 0) & (source < len(old) - degree - 1)
    for k in range(degree):
        fits &= old.take(source + (k + 1), mode="clip") == new[k + 1 : k + 1 + count]
    return np.flatnonzero(~fits), source


def inner_knots(
    knots: Array, degree: int, new_knots: Array, rows: IntArray
) -> tuple[IntArray, Array]:
    """Say of which old piece, and where, some control points of a refined spline are blossoms.

    Parameters
    ----------
    knots, degree, new_knots
        As for `refine`.
    rows : (c,) indices
        Which of the new control points.

    Returns
    -------
    spans : (c,) indices
    arguments : (c, p) array
        Their inner knots.
    """
    count = len(new_knots) - degree - 1
    # The nonempty new spans of the domain, and for each new control point the middlemost one.
    lengths = new_knots[1:] - new_knots[:-1]
    filled = np.flatnonzero(lengths[degree:count]) + degree
    middle = rows + degree // 2
    after = np.minimum(filled.searchsorted(middle), len(filled) - 1)
    right, left = filled[after], filled[np.maximum(after - 1, 0)]
    chosen = np.where(right - middle <= middle - left, right, left)
    support = np.minimum(np.maximum(rows + np.arange(degree + 1)[:, None], degree), count - 1)
    longest = support[lengths.take(support).argmax(axis=0), np.arange(len(rows))]
    tiny = lengths.take(longest) > _MUCH_LONGER * lengths.take(chosen)
    chosen = np.where(tiny, longest, chosen)
    spans = np.asarray(knots.searchsorted(new_knots[chosen], "right") - 1)
    return spans, new_knots.take(rows[:, None] + np.arange(1, degree + 1))
