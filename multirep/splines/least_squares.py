"""Banded least squares: the free control points that bring a spline nearest to a polyline.

`polyline_rows` chooses where a polyline is looked at, `solve_window` solves. Together they
minimise, up to quadrature, the integral of ``||S(t) - L(t)||**2``, with any control points held.
"""

from functools import cache

import numpy as np

from multirep.splines import compiled
from multirep.splines.arrays import Array, IntArray
from multirep.splines.basis import basis_functions, find_spans

__all__ = ["polyline_rows", "solve_window"]

# A Cholesky pivot this small against its diagonal entry (1e-10 of it, the root here) means that
# the rows do not determine the unknown. With more than p + 1 rows in every span the ratio was above
# 1e-4 for random knots, weights and degrees up to 12; where the matrix is singular, rounding leaves
# up to 1e-12.
_SMALLEST_PIVOT = 1e-5


@cache
def _places(degree: int) -> IntArray:
    """List, for each product of two basis functions of a span, its diagonal and first factor."""
    size = degree + 1
    diagonals = np.repeat(np.arange(size), np.arange(size, 0, -1))
    firsts = np.concatenate([np.arange(size - d) for d in range(size)])
    places = np.stack([diagonals, firsts])
    places.setflags(write=False)
    return places


def solve_window(
    knots: Array,
    degree: int,
    coefficients: Array,
    free: slice,
    t: Array,
    targets: Array,
    row_weights: Array,
    basis_weights: Array | None = None,
) -> Array:
    """Solve for the free control points by weighted least squares.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Non-decreasing, of the window only.
    degree : int
        Degree p of the spline.
    coefficients : (n, d) array
        Control points in the units of the targets (Euclidean for a rational spline too). Those
        outside ``free`` are held; the free ones are not read.
    free : slice
        Contiguous: which control points to solve for.
    t : (m,) array
        Non-decreasing parameters of the rows, within the domain of the window.
    targets : (m, d) array
        The wanted points.
    row_weights : (m,) array
        Non-negative weights of the squared distances.
    basis_weights : (n,) array, optional
        Weights w of a rational spline; its basis is ``w_i N_i / sum(w_j N_j)``.

    Returns
    -------
    (n, d) array
        The coefficients with the free rows solved; the others are bit-identical copies.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the rows do not determine the free control points (Schoenberg-Whitney: each needs a row
        of its own where it does not vanish). `polyline_rows` makes rows that always do.

    Notes
    -----
    Normal equations of bandwidth p, summed span by span, solved by LAPACK ``pbsv``: linear in rows
    and in unknowns. Their condition is that of B-splines squared, below 100 for cubics with evenly
    filled spans. A local origin is subtracted first, so the distance of the data from zero costs
    no more digits than its representation did.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0, 1, 1, 1.0])
    >>> t = np.linspace(0, 1, 5)
    >>> held = np.array([[0.0], [0.0], [1.0]])
    >>> solve_window(knots, 2, held, slice(1, 2), t, t[:, None], np.ones(5)).round(12)[:, 0]
    array([0. , 0.5, 1. ])
    """
    count = free.stop - free.start
    if count <= 0:
        return coefficients.copy()
    if compiled.active:
        solved = np.array(coefficients)
        if not compiled.core.solve_window(
            knots, degree, free.start, free.stop, t, targets, row_weights, basis_weights, solved
        ):
            raise undetermined(len(t), count)
        return solved
    from scipy.linalg.lapack import dpbsv

    origin = targets[len(t) // 2]
    held = coefficients - origin
    held[free] = 0.0
    spans = find_spans(knots, degree, t)
    basis = basis_functions(knots, degree, t, spans).T
    index = np.arange(-degree, 1)[:, None] + spans
    if basis_weights is not None:
        basis = basis * basis_weights.take(index)
        basis /= basis.sum(axis=0)
    wanted = targets - origin
    wanted -= np.einsum("im,imd->md", basis, held.take(index, axis=0))

    band, right = _normal_equations(basis, index[0], wanted, row_weights, len(coefficients))
    band, right = band[:, free], right[free]
    factor, solution, info = dpbsv(band, right, lower=1)
    if info or not bool((factor[0] >= _SMALLEST_PIVOT * np.sqrt(band[0])).all()):
        raise undetermined(len(t), count)
    solved = coefficients.copy()
    solved[free] = solution + origin
    return solved


def _normal_equations(
    basis: Array, first: IntArray, wanted: Array, row_weights: Array, unknowns: int
) -> tuple[Array, Array]:
    """Sum up the normal equations of all control points, in banded form.

    Parameters
    ----------
    basis : (p + 1, m) array
        The basis functions that do not vanish at each row, ...
    first : (m,) integer array
        ... and the first control point they belong to; non-decreasing.
    wanted : (m, d) array
    row_weights : (m,) array
    unknowns : int
        The number n of control points.

    Returns
    -------
    (p + 1, n) array
        The matrix: its diagonal, then those below.
    (n, d) array
        The right-hand sides.
    """
    size, rows = basis.shape
    dimension = wanted.shape[1]
    # Every product that the normal equations need, one row of `products` each ...
    weighted = basis * row_weights
    places = _places(size - 1)
    matrix_rows = places.shape[1]
    products = np.empty((matrix_rows + size * dimension, rows))
    row = 0
    for diagonal in range(size):
        stop = row + size - diagonal
        np.multiply(weighted[: size - diagonal], basis[diagonal:], out=products[row:stop])
        row = stop
    np.multiply(
        weighted[:, None], wanted.T, out=products[matrix_rows:].reshape(size, dimension, rows)
    )
    # ... summed over the rows of each span, then added to where the span's functions stand.
    starts = np.concatenate(([0], (first[1:] != first[:-1]).nonzero()[0] + 1))
    sums = np.add.reduceat(products, starts, axis=1)
    first = first[starts]
    where = (places[0] * unknowns + places[1])[:, None] + first
    band: Array = np.bincount(  # type: ignore[assignment]  # weighted sums are floats
        where.ravel(), weights=sums[:matrix_rows].ravel(), minlength=size * unknowns
    ).reshape(size, unknowns)
    where = (np.arange(size)[:, None] * dimension + np.arange(dimension)).ravel()[:, None]
    right: Array = np.bincount(  # type: ignore[assignment]  # likewise
        (where + first * dimension).ravel(),
        weights=sums[matrix_rows:].ravel(),
        minlength=unknowns * dimension,
    ).reshape(unknowns, dimension)
    return band, right


def undetermined(rows: int, count: int) -> np.linalg.LinAlgError:
    """Return the error that so many rows and so many free control points are worth.

    Examples
    --------
    >>> undetermined(1, 2)
    LinAlgError('1 rows do not determine the 2 free control points: some of them have no row in \
their support')
    """
    return np.linalg.LinAlgError(
        f"{rows} rows do not determine the {count} free control points: "
        "some of them have no row in their support"
    )


def polyline_rows(
    knots: Array,
    degree: int,
    t: Array,
    points: Array,
    *,
    per_span: int | None = None,
) -> tuple[Array, Array, Array]:
    """Choose the rows by which a spline is fitted to a polyline.

    Parameters
    ----------
    knots : (n + degree + 1,) array
        Knots of the spline that will be fitted.
    degree : int
        Its degree p.
    t : (m,) array
        Strictly increasing parameters of the polyline, at least two, within the domain.
    points : (m, d) array
        Its vertices.
    per_span : int, keyword-only, optional
        On no span are neighbouring rows farther apart than the span's length through this; default
        p + 1.

    Returns
    -------
    t : (r,) array
        Strictly increasing: the vertices, the knots between them, and evenly spread parameters
        wherever a span holds too few of these.
    targets : (r, d) array
        The polyline there; vertices bit by bit.
    weights : (r,) array
        Trapezoid weights, so that sums over rows approximate integrals over t.

    Notes
    -----
    Every span of the polyline's interval holds more than p + 1 well separated rows, so the normal
    equations are never singular however the vertices cluster, and the polyline counts between
    its vertices too. At most m + (p + 3) spans rows.

    Examples
    --------
    >>> import numpy as np
    >>> knots = np.array([0, 0, 0.5, 1, 1])
    >>> t, targets, weights = polyline_rows(knots, 1, np.array([0, 1.0]), np.array([[0.0], [4.0]]))
    >>> t
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    >>> targets[:, 0]
    array([0., 1., 2., 3., 4.])
    >>> weights
    array([0.125, 0.25 , 0.25 , 0.25 , 0.125])
    """
    wanted = degree + 1 if per_span is None else per_span
    if compiled.active:
        room = most_rows(knots, t, wanted)
        rows, targets, weights = np.empty(room), np.empty((room, points.shape[1])), np.empty(room)
        found = compiled.core.polyline_rows(
            knots, degree, t, points, wanted, rows, targets, weights
        )
        return rows[:found], targets[:found], weights[:found]
    start, stop = t[0], t[-1]
    inner = knots[knots.searchsorted(start, "right") : knots.searchsorted(stop, "left")]
    marks = np.concatenate((t, inner))
    marks.sort()
    marks = marks[np.concatenate(([True], marks[1:] > marks[:-1]))]
    spans = find_spans(knots, degree, marks[:-1])
    covered = np.minimum(knots[spans + 1], stop) - np.maximum(knots[spans], start)
    gaps = marks[1:] - marks[:-1]
    # Just below, lest rounding splits a gap that is exactly as wide as allowed.
    parts = np.maximum(np.ceil(gaps * (wanted * (1 - 1e-9)) / covered), 1.0).astype(np.intp)
    stops = parts.cumsum()
    fractions = (np.arange(stops[-1]) - (stops - parts).repeat(parts)) / parts.repeat(parts)
    rows = np.empty(len(fractions) + 1)
    rows[:-1] = marks[:-1].repeat(parts) + fractions * gaps.repeat(parts)
    rows[-1] = stop
    if len(marks) < len(rows):
        # A gap of a few units in the last place cannot be split: its fractions round together.
        rows = rows[np.concatenate(([True], rows[1:] > rows[:-1]))]
    targets = np.stack([np.interp(rows, t, column) for column in points.T], axis=1)
    half = (rows[1:] - rows[:-1]) / 2
    weights = np.zeros(len(rows))
    weights[:-1] = half
    weights[1:] += half
    return rows, targets, weights


def most_rows(knots: Array, t: Array, per_span: int) -> int:
    """Bound the number of rows that `polyline_rows` chooses.

    Examples
    --------
    >>> knots, t = np.array([0, 0, 1, 1.0]), np.array([0, 1.0])
    >>> len(polyline_rows(knots, 1, t, t[:, None])[0]) <= most_rows(knots, t, 2)
    True
    """
    return len(t) + (per_span + 1) * len(knots) + 1
