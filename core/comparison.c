/* Which rows of two arrays have the same bits, which spans of two splines read the same. */
#include "core.h"

#include <string.h>

/* Numbers that are compared at once: the first difference is looked for in so many. */
enum { CHUNK = 32 };

/* How many numbers are the same from the beginning, or from before the end backwards. */
static Index same_numbers(const double *a, const double *b, Index most, int backwards)
{
    Index same = 0;
    for (Index size = CHUNK; size; size = size > 1 ? 1 : 0)
        while (same + size <= most &&
               !memcmp(backwards ? a - same - size : a + same,
                       backwards ? b - same - size : b + same, (size_t)size * sizeof(double)))
            same += size;
    return same;
}

METHOD(core_common)
{
    /* Lengths of the common prefix of two arrays, and of the common suffix of what follows it; -0.0
    and 0.0 differ. */
    Call call;
    begin(&call, count, 2);
    if (call.failed)
        return finish(&call, NULL);
    Table a = reals(&call, values[0]), b = reals(&call, values[1]);
    expect(&call, a.columns == b.columns, "rows of different lengths are compared");
    Index least = at_most(a.rows, b.rows), head = 0, tail = 0;
    if (!call.failed) {
        Index columns = at_least(a.columns, 1); /* of an array without rows, perhaps none */
        head = same_numbers(a.at, b.at, least * columns, 0) / columns;
        tail = same_numbers(a.at + a.rows * columns, b.at + b.rows * columns,
                            (least - head) * columns, 1) / columns;
    }
    return finish(&call, Py_BuildValue("nn", head, tail));
}

/* Whether the span k of one spline reads the same knots and the same rows as the span j of another. */
static int same_span(const Spline *one, Index k, const Spline *two, Index j)
{
    Index p = one->degree;
    const double *mine = local_knots(one, k), *theirs = local_knots(two, j);
    for (Index i = 0; i < 2 * p; i++)
        if (mine[i] != theirs[i])
            return 0;
    size_t rows = (size_t)((p + 1) * one->dimension) * sizeof(double);
    return !memcmp(local_rows(one, k), local_rows(two, j), rows);
}

/* Whether a span of all pairs of splines reads the same. */
static int same_spans(const Spline (*pairs)[2], Index count, Index k, Index j)
{
    for (Index i = 0; i < count; i++)
        if (!same_span(&pairs[i][0], k, &pairs[i][1], j))
            return 0;
    return 1;
}

METHOD(core_changed_spans)
{
    /* degree, knots of a window of one spline and of another, a list of pairs of rows (control
    points, weights); returns the longest intervals, pairs of knots of the first, on whose spans
    they read something else */
    enum { MOST_PAIRS = 4 };
    Spline pairs[MOST_PAIRS][2];
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Index p = integer(&call, values[0]), rows = PyList_Size(values[3]);
    Table knots[2] = {reals(&call, values[1]), reals(&call, values[2])};
    call.failed |= rows < 0;
    expect(&call, p >= 1 && rows >= 1 && rows <= MOST_PAIRS, "one to four pairs are compared");
    for (Index i = 0; !call.failed && i < rows; i++) {
        PyObject *pair = PyList_GetItem(values[3], i); /* borrowed */
        for (Index side = 0; side < 2 && !call.failed; side++) {
            PyObject *array = PyTuple_GetItem(pair, side);
            call.failed |= !array;
            if (!call.failed)
                pairs[i][side] = spline_of(&call, knots[side], reals(&call, array), p);
        }
        expect(&call, call.failed || pairs[i][0].dimension == pairs[i][1].dimension,
               "rows of different lengths are compared");
    }
    PyObject *found = call.failed ? NULL : PyList_New(0);
    call.failed |= !found;
    if (call.failed)
        return finish(&call, found);
    const double *mine = knots[0].at, *theirs = knots[1].at;
    Index stop = pairs[0][0].count, last = pairs[0][1].count - 1;
    Index at = p, open = -1; /* the span whose start begins an interval */
    for (Index k = p; !call.failed && k <= stop; k++) {
        if (k < stop && !(mine[k] < mine[k + 1]))
            continue;
        while (k < stop && at < last && theirs[at + 1] <= mine[k])
            at++;
        int same = k == stop || same_spans(pairs, rows, k, at);
        if (!same && open < 0)
            open = k;
        if (same && open >= 0) {
            PyObject *pair = Py_BuildValue("dd", mine[open], mine[k]);
            call.failed |= !pair || PyList_Append(found, pair) < 0;
            Py_XDECREF(pair);
            open = -1;
        }
    }
    return finish(&call, found);
}
