/* What a wavelet fit follows: a polyline about its first vertex, coordinates first; and how fine the
knots must be for it. See multirep.representations.wavelet.target and .prediction.
*/
#include "core.h"

#include <math.h>
#include <string.h>

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

/* What is needed to look at a span, and the knots found so far. */
typedef struct {
    Call *call;
    Target target;
    const double *allowances, *projections, *places;
    Table corners;
    Index samples, count, room;
    double margin, shortest, start, stop; /* the ends of T */
    double *seen, *left, *found;
} Prediction;

/* What a single polynomial leaves of the target on a span and its margins, squared, in terms of what
is allowed; the largest of it. */
static double unexplained(const Prediction *given, double low, double high)
{
    const Target *target = &given->target;
    const Table *corners = &given->corners;
    Index samples = given->samples, d = target->d;
    double margin = given->margin * (high - low);
    /* A span looks beyond its ends, but not past a corner; one close to its start is on it. */
    double wall = low + 0.5 * margin, from = target->t.at[0], to = target->t.at[target->chords];
    Index side = 0, behind = corners->rows;
    while (side < behind) {
        Index middle = side + (behind - side) / 2;
        if (corners->at[middle] < wall)
            side = middle + 1;
        else
            behind = middle;
    }
    if (side > 0)
        from = corners->at[side - 1];
    if (side < corners->rows)
        to = corners->at[side];
    low = larger(low - margin, from);
    high = smaller(high + margin, to);
    Index chord = 0;
    for (Index s = 0; s < samples; s++) {
        double t = low + (high - low) * given->places[s];
        chord = chord_at(target, chord, t);
        given->left[s] = given->allowances[chord] * given->allowances[chord];
        for (Index c = 0; c < d; c++)
            given->seen[c * samples + s] = value_at(target, chord, t, c);
    }
    double largest = 0.0;
    for (Index row = 0; row < 2 * samples; row++) {
        const double *weights = given->projections + row * samples;
        double square = 0.0;
        for (Index c = 0; c < d; c++) {
            double sum = 0.0;
            for (Index s = 0; s < samples; s++)
                sum += weights[s] * given->seen[c * samples + s];
            square += sum * sum;
        }
        largest = worse(largest, square / given->left[row % samples]);
    }
    return largest;
}

/* Halve a span of dyadic numbers until no part of it needs to be. */
static void halve(Prediction *given, double start, double stop, int depth)
{
    double ends[2] = {start, stop};
    if (given->start != 0.0 || given->stop != 1.0)
        for (int k = 0; k < 2; k++)
            ends[k] = (1.0 - ends[k]) * given->start + ends[k] * given->stop;
    if (!(unexplained(given, ends[0], ends[1]) > 1.0 && stop - start > given->shortest))
        return;
    expect(given->call, depth < 256, "a span is halved without end");
    if (given->count == given->room) {
        double *more = scratch(given->call, 2 * given->room);
        if (more)
            memcpy(more, given->found, (size_t)given->room * sizeof(double));
        given->found = more;
        given->room *= 2;
    }
    if (given->call->failed)
        return;
    double middle = half_of(start, stop);
    given->found[given->count++] = middle;
    halve(given, start, middle, depth + 1);
    if (!given->call->failed)
        halve(given, middle, stop, depth + 1);
}

METHOD(core_predict)
{
    /* t, points, slopes, allowances of the target, its corners, starts and stops of spans, the
    shortest that may be halved, both ends of T, the margin of a span, projections (2 s, s), places
    (s,); returns the knots that halve the spans until a single polynomial explains the target on
    each, as bytes */
    Call call;
    begin(&call, count, 13);
    if (call.failed)
        return finish(&call, NULL);
    Target target = target_of(&call, values);
    Table allowances = reals(&call, values[3]), corners = reals(&call, values[4]);
    Table starts = reals(&call, values[5]), stops = reals(&call, values[6]);
    double shortest = real(&call, values[7]), start = real(&call, values[8]);
    double stop = real(&call, values[9]), margin = real(&call, values[10]);
    Table projections = reals(&call, values[11]), places = reals(&call, values[12]);
    Index n = starts.rows, samples = places.rows, room = 2 * n + 64;
    expect(&call, allowances.rows == target.chords && stops.rows == n,
           "each span needs a start and a stop, each chord an allowance");
    expect(&call, projections.rows == 2 * samples && projections.columns == samples && samples > 0,
           "two projections of the samples are wanted");
    Prediction given = {&call, target, allowances.at, projections.at, places.at, corners, samples, 0,
                        room, margin, shortest, start, stop, scratch(&call, samples * target.d),
                        scratch(&call, samples), scratch(&call, room)};
    for (Index span = 0; !call.failed && span < n; span++)
        halve(&given, starts.at[span], stops.at[span], 0);
    return finish(&call, call.failed ? NULL
                                     : bytes_of(given.found, given.count * (Index)sizeof(double)));
}

METHOD(core_departure)
{
    /* t, points, slopes, allowances of the target, knots and control points about its origin of an
    old cubic, which of its spans is continued, an end that the target reaches, steps from there, the
    first of them 0; returns the first step at which the old piece has departed from the target by
    3/2 of the room that its gap at the end leaves (-1 if none), that gap, and the chord there */
    enum { DEGREE = 3, ORDER = 4 };
    Call call;
    begin(&call, count, 9);
    if (call.failed)
        return finish(&call, NULL);
    Target target = target_of(&call, values);
    Table allowances = reals(&call, values[3]);
    Table knots = reals(&call, values[4]), coefficients = reals(&call, values[5]);
    Index span = integer(&call, values[6]), d = target.d, found = -1, first = 0;
    double end = real(&call, values[7]), gap = 0.0, room = 0.0;
    Table steps = reals(&call, values[8]);
    expect(&call, allowances.rows == target.chords && coefficients.columns == d && steps.rows >= 1,
           "each chord needs an allowance");
    expect(&call, span >= DEGREE && span < coefficients.rows && span + DEGREE < knots.rows,
           "a span is out of bounds");
    double *rows = scratch(&call, ORDER * d), *off = scratch(&call, d);
    if (call.failed)
        return finish(&call, NULL);
    const double *local = knots.at + span + 1 - DEGREE;
    const double *old = coefficients.at + (span - DEGREE) * d;
    for (Index i = 0, chord = 0; i < steps.rows && found < 0; i++) {
        double t = end + steps.at[i], square = 0.0;
        memcpy(rows, old, (size_t)(ORDER * d) * sizeof(double));
        for (Index step = 0; step < DEGREE; step++)
            blossom_step(local, DEGREE, d, t, step, rows);
        chord = chord_at(&target, chord, t);
        for (Index c = 0; c < d; c++) {
            double away = rows[c] - value_at(&target, chord, t, c);
            if (i == 0)
                off[c] = away;
            away -= i == 0 ? 0.0 : off[c];
            square += away * away;
        }
        if (i == 0) {
            first = chord;
            gap = sqrt(square);
            room = 1.5 * larger(allowances.at[chord] - gap, allowances.at[chord] / 8.0);
        } else if (square > room * room)
            found = i;
    }
    return finish(&call, Py_BuildValue("ndn", found, gap, first));
}
