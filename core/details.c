/* Changes by what lives on one level; see multirep.representations.wavelet.details. */
#include "core.h"

#include <string.h>

METHOD(core_plus)
{
    /* dyadic knots (n + 4,) of a window, the same as parameters, how many spans the level has, the
    first of its control points that change, its knots from six before that one on (r + 10,) as
    parameters, the changes (r, d), control points of the window (n, d) to be changed

    The change of each is a polar form, at its inner knots, of the piece of the cubic spline of the
    level in the middle of its support: on the middlemost of its spans that has a length. */
    enum { DEGREE = 3, ORDER = 4 };
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Table u = reals(&call, values[0]), knots = reals(&call, values[1]);
    double spans = real(&call, values[2]);
    Index first = integer(&call, values[3]);
    Table level = reals(&call, values[4]), rows = reals(&call, values[5]);
    Table points = output(&call, values[6]);
    Index n = points.rows, r = rows.rows, d = points.columns;
    expect(&call,
           u.rows == n + ORDER && knots.rows == u.rows && level.rows == r + 10 && rows.columns == d,
           "the knots and the changes do not fit the control points");
    double *padded = scratch(&call, (r + 6) * d), *local = scratch(&call, ORDER * d);
    if (call.failed)
        return finish(&call, NULL);
    size_t nothing = (size_t)(DEGREE * d) * sizeof(double);
    memset(padded, 0, nothing);
    memcpy(padded + DEGREE * d, rows.at, (size_t)(r * d) * sizeof(double));
    memset(padded + (DEGREE + r) * d, 0, nothing);
    static const Index parts[] = {2, 1, 3, 0};
    for (Index i = 0; i < n; i++) {
        const double *at = u.at + i;
        Index part = 0;
        while (part < DEGREE && !(at[parts[part]] < at[parts[part] + 1]))
            part++;
        double middle = 0.5 * (at[parts[part]] + at[parts[part] + 1]) * spans;
        int inside = middle >= (double)(first - DEGREE) && middle < (double)(first + r);
        expect(&call, inside, "a control point reaches beyond the changes");
        if (!inside)
            break;
        Index span = (Index)middle - first + 6;
        memcpy(local, padded + (span - DEGREE) * d, (size_t)(ORDER * d) * sizeof(double));
        for (Index step = 0; step < DEGREE; step++)
            blossom_step(level.at + span + 1 - DEGREE, DEGREE, d, knots.at[i + 1 + step], step,
                         local);
        for (Index c = 0; c < d; c++)
            points.at[i * d + c] += local[c];
    }
    return finish(&call, Py_NewRef(Py_None));
}
