/* How far the vertices of a polyline are from the chords that are to stand for them. */
#include "core.h"

#include <math.h>

METHOD(core_farthest)
{
    /* t (m + 1,), points (m + 1, d), limits of inner vertices (m - 1,) or None, chosen vertices
    from 0 to m (k + 1,); for each chord the largest distance at equal parameter, over the limit,
    (k,), and the first vertex there, (k,) */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table limits = reals_or_none(&call, values[2]);
    Places chosen = places(&call, values[3]);
    Table largest = output(&call, values[4]);
    Slots worst = slots(&call, values[5]);
    Index m = t.rows - 1, d = points.columns, chords = chosen.rows - 1;
    expect(&call,
           m >= 1 && t.columns == 1 && points.rows == m + 1 &&
               (!limits.at || limits.rows == m - 1),
           "each vertex needs a parameter, each inner one a limit");
    expect(&call, chords >= 1 && largest.rows == chords && worst.rows == chords,
           "each chord needs a place for its distance");
    if (!call.failed)
        expect(&call, chosen.at[0] == 0 && chosen.at[chords] == m,
               "the first and the last vertex must be chosen");
    double *slope = scratch(&call, d);
    for (Index k = 0; !call.failed && k < chords; k++) {
        Index start = chosen.at[k], stop = chosen.at[k + 1];
        expect(&call, start < stop && stop <= m, "chosen vertices must increase");
        if (call.failed)
            break;
        const double *first = points.at + start * d, *last = points.at + stop * d;
        double length = t.at[stop] - t.at[start], most = 0.0;
        for (Index c = 0; c < d; c++)
            slope[c] = (last[c] - first[c]) / length;
        worst.at[k] = start;
        for (Index i = start + 1; i < stop; i++) {
            double along = t.at[i] - t.at[start], square = 0.0;
            for (Index c = 0; c < d; c++) {
                double off = points.at[i * d + c] - first[c] - along * slope[c];
                square += off * off;
            }
            double far = sqrt(square);
            if (limits.at)
                far /= limits.at[i - 1];
            if (far > most) {
                most = far;
                worst.at[k] = i;
            }
        }
        largest.at[k] = most;
    }
    return finish(&call, Py_NewRef(Py_None));
}
