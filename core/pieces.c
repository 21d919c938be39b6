/* The cells of a stretch, and how large its coordinates are; see multirep.splines.pieces. */
#include "core.h"

#include <math.h>

METHOD(core_largest)
{
    /* coefficients, rational, points; returns the largest coordinate of control points or points */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table coefficients = reals(&call, values[0]), points = reals(&call, values[2]);
    Index rational = integer(&call, values[1]) != 0, d = coefficients.columns - rational;
    double largest = 0.0;
    for (Index i = 0; !call.failed && i < coefficients.rows; i++) {
        const double *row = coefficients.at + i * (d + rational);
        for (Index c = 0; c < d; c++)
            largest = worse(largest, fabs(rational ? row[c] / row[d] : row[c]));
    }
    for (Index i = 0; !call.failed && i < points.rows * points.columns; i++)
        largest = worse(largest, fabs(points.at[i]));
    return finish(&call, PyFloat_FromDouble(largest));
}

METHOD(core_cells)
{
    /* knots, degree, start, stop; returns the first and the last span between, and of those that are
    not empty the breaks around them and their numbers, counted so that the first is the degree */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]);
    Spline spline = spline_of(&call, knots, (Table){NULL, 0, 0}, integer(&call, values[1]));
    double start = real(&call, values[2]), stop = real(&call, values[3]);
    expect(&call, start <= stop, "an interval is wanted");
    if (call.failed)
        return finish(&call, NULL);
    const double *at = knots.at;
    Index first = span_of(&spline, start), last = span_of(&spline, stop), cells = 0;
    stop = smaller(stop, at[spline.count]);
    while (last > first && !(at[last] < stop))
        last--;
    double *breaks = scratch(&call, last - first + 2);
    Index *spans = index_scratch(&call, last - first + 1);
    if (call.failed)
        return finish(&call, NULL);
    for (Index span = first; span <= last; span++)
        if (at[span] < at[span + 1]) {
            breaks[cells] = at[span];
            spans[cells++] = span - first + spline.degree;
        }
    breaks[cells] = at[last + 1];
    PyObject *grid = bytes_of(breaks, (cells + 1) * (Index)sizeof(double));
    PyObject *numbers = bytes_of(spans, cells * (Index)sizeof(Index)), *found = NULL;
    if (grid && numbers)
        found = Py_BuildValue("nnOO", first, last, grid, numbers);
    Py_XDECREF(grid);
    Py_XDECREF(numbers);
    call.failed = !found;
    return finish(&call, found);
}
