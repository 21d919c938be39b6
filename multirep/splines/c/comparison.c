/* Which rows of two arrays have the same bits, which spans of two splines read the same. */
#include "core.h"

#include <math.h>
#include <string.h>

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
        size_t row = (size_t)a.columns * sizeof(double);
        const double *end_a = a.at + a.rows * a.columns, *end_b = b.at + b.rows * b.columns;
        while (head < least && !memcmp(a.at + head * a.columns, b.at + head * a.columns, row))
            head++;
        while (tail < least - head &&
               !memcmp(end_a - (tail + 1) * a.columns, end_b - (tail + 1) * a.columns, row))
            tail++;
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

METHOD(core_changed_spans)
{
    /* degree, knots and control points of a window of one spline, of another, and of both the
    weights or None; returns the longest intervals, pairs of knots of the first, on whose spans they
    read something else */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Index p = integer(&call, values[0]);
    Table knots = reals(&call, values[1]), other_knots = reals(&call, values[3]);
    Spline one = spline_of(&call, knots, reals(&call, values[2]), p);
    Spline two = spline_of(&call, other_knots, reals(&call, values[4]), p);
    Spline bottoms[2] = {one, one};
    int weighted = values[5] != Py_None && values[6] != Py_None;
    if (weighted) {
        bottoms[0] = spline_of(&call, knots, reals(&call, values[5]), p);
        bottoms[1] = spline_of(&call, other_knots, reals(&call, values[6]), p);
    }
    expect(&call, p >= 1 && one.dimension == two.dimension &&
                      (!weighted || bottoms[0].dimension == bottoms[1].dimension),
           "rows of different lengths are compared");
    PyObject *found = call.failed ? NULL : PyList_New(0);
    call.failed |= !found;
    Index at = p, open = -1; /* the span whose start began an interval */
    for (Index k = p; !call.failed && k <= one.count; k++) {
        int same = k == one.count;
        if (!same) {
            if (!(one.knots[k] < one.knots[k + 1]))
                continue;
            while (at < two.count - 1 && two.knots[at + 1] <= one.knots[k])
                at++;
            same = same_span(&one, k, &two, at) &&
                   (!weighted || same_span(&bottoms[0], k, &bottoms[1], at));
        }
        if (!same && open < 0)
            open = k;
        if (same && open >= 0) {
            PyObject *pair = Py_BuildValue("dd", one.knots[open], one.knots[k]);
            call.failed |= !pair || PyList_Append(found, pair) < 0;
            Py_XDECREF(pair);
            open = -1;
        }
    }
    return finish(&call, found);
}

METHOD(core_level_counts)
{
    /* numbers k / 2**l in [0, 1], counts (levels,): how many have an odd k for each l */
    Call call;
    begin(&call, count, 2);
    if (call.failed)
        return finish(&call, NULL);
    Table u = reals(&call, values[0]);
    Slots counts = slots(&call, values[1]);
    for (Index level = 0; level < counts.rows; level++)
        counts.at[level] = 0;
    for (Index i = 0; !call.failed && i < u.rows; i++) {
        double scaled = u.at[i];
        Index level = 0;
        while (level < counts.rows && scaled != floor(scaled)) {
            scaled *= 2.0;
            level++;
        }
        expect(&call, level < counts.rows, "a knot is not dyadic");
        if (!call.failed)
            counts.at[level]++;
    }
    return finish(&call, Py_NewRef(Py_None));
}
