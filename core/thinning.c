/* Which vertices of a polyline are to stand for all, and how far the others are from their chords;
see multirep.splines.simplification. */
#include "core.h"

#include <math.h>

METHOD(core_spread)
{
    /* t (m + 1,), points (m + 1, d), limits of inner vertices (m - 1,); returns the vertices, from 0
    to m, whose chords have about the allowed sagitta, as bytes */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table limits = reals(&call, values[2]);
    Index m = t.rows - 1, d = points.columns, found = 1;
    expect(&call,
           m >= 1 && t.columns == 1 && points.rows == m + 1 && limits.rows == m - 1,
           "each vertex needs a parameter, each inner one a limit");
    Index *chosen = index_scratch(&call, m + 1);
    double *slope = scratch(&call, d);
    if (call.failed)
        return finish(&call, NULL);
    chosen[0] = 0;
    double sum = 0.0, next_whole = 1.0, before = t.at[1] - t.at[0];
    for (Index c = 0; c < d; c++)
        slope[c] = (points.at[c + d] - points.at[c]) / before;
    for (Index i = 1; i < m; i++) {
        const double *row = points.at + i * d;
        double after = t.at[i + 1] - t.at[i], square = 0.0;
        for (Index c = 0; c < d; c++) {
            double next = (row[c + d] - row[c]) / after, kink = next - slope[c];
            square += kink * kink;
            slope[c] = next;
        }
        /* Each vertex stands for a kink J over the mean h of its two steps: h sqrt(J / h / (8 limit)). */
        sum += smaller(sqrt(sqrt(square) * (after + before) / (16 * limits.at[i - 1])), 1.0);
        before = after;
        if (sum >= next_whole) {
            chosen[found++] = i;
            next_whole = floor(sum) + 1.0;
        }
    }
    chosen[found++] = m;
    return finish(&call, bytes_of(chosen, found * (Index)sizeof(Index)));
}

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
