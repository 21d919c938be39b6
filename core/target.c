/* What a wavelet fit follows: a polyline about its first vertex, coordinates first. See
multirep.representations.wavelet.target.
*/
#include "core.h"

#include <math.h>

/* t, points and slopes, which come first among the arguments. */
Target target_of(Call *call, PyObject *const *values)
{
    Target target = {reals(call, values[0]), reals(call, values[1]), reals(call, values[2]), 0, 0};
    target.chords = target.t.rows - 1;
    target.d = target.points.rows;
    expect(call,
           target.chords >= 1 && target.points.columns == target.t.rows &&
               target.slopes.columns == target.chords && target.slopes.rows == target.d,
           "a target needs a vertex and a slope for each chord");
    return target;
}

Piece piece_of(Call *call, PyObject *const *values, Index dimension)
{
    Piece piece = {reals_or_none(call, values[0]), reals_or_none(call, values[1])};
    expect(call,
           !piece.knots.at || (piece.knots.rows == 6 && piece.points.rows == 4 &&
                               piece.points.columns == dimension),
           "an old piece needs six knots and four control points");
    return piece;
}

METHOD(core_target)
{
    /* t (m + 1,), points (m + 1, d), allowances (m,), two factors, points about the first one
    (d, m + 1), slopes (d, m); returns parameters of corners, and how near their knots must be. See
    multirep.representations.wavelet.target. */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table allowances = reals(&call, values[2]);
    double sharpness = real(&call, values[3]), share = real(&call, values[4]);
    Table about = output(&call, values[5]), slopes = output(&call, values[6]);
    Index d = points.columns, m = allowances.rows, found = 0;
    expect(&call,
           m >= 1 && t.rows == m + 1 && points.rows == m + 1 && about.rows == d &&
               about.columns == m + 1 && slopes.rows == d && slopes.columns == m,
           "each chord needs an allowance and a slope");
    double *corners = scratch(&call, m), *widths = scratch(&call, m);
    if (call.failed)
        return finish(&call, NULL);
    for (Index c = 0; c < d; c++) {
        double *row = about.at + c * (m + 1), *slope = slopes.at + c * m;
        for (Index i = 0; i <= m; i++)
            row[i] = points.at[i * d + c] - points.at[c];
        for (Index i = 0; i < m; i++)
            slope[i] = (row[i + 1] - row[i]) / (t.at[i + 1] - t.at[i]);
    }
    for (Index i = 0; i + 1 < m; i++) {
        double turn = 0.0;
        for (Index c = 0; c < d; c++) {
            double jump = slopes.at[c * m + i + 1] - slopes.at[c * m + i];
            turn += jump * jump;
        }
        double sharp = sqrt(turn), room = smaller(allowances.at[i + 1], allowances.at[i]);
        if (sharp * smaller(t.at[i + 2] - t.at[i + 1], t.at[i + 1] - t.at[i]) > room * sharpness) {
            corners[found] = t.at[i + 1];
            widths[found++] = room * (share / sharp);
        }
    }
    PyObject *first = numbers(&call, corners, found), *second = numbers(&call, widths, found);
    return finish(&call, pair_of(&call, first, second));
}

METHOD(core_follow)
{
    /* t, points, slopes of the target, parameters, values (d, parameters), chords */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Target target = target_of(&call, values);
    Table t = reals(&call, values[3]), found = output(&call, values[4]);
    Slots chords = slots(&call, values[5]);
    Index count_t = t.rows * t.columns;
    expect(&call, found.rows == target.d && found.columns == count_t,
           "room for the values is missing");
    expect(&call, chords.rows == count_t, "room for the chords is missing");
    Index chord = 0;
    for (Index i = 0; !call.failed && i < count_t; i++) {
        chords.at[i] = chord = chord_at(&target, chord, t.at[i]);
        for (Index c = 0; c < target.d; c++)
            found.at[c * count_t + i] = value_at(&target, chord, t.at[i], c);
    }
    return finish(&call, Py_NewRef(Py_None));
}
