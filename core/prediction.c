/* How fine knots must be for a polyline; see multirep.representations.wavelet.prediction. */
#include "core.h"

#include <string.h>

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

void halve(Prediction *given, double start, double stop, int depth)
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

Prediction prediction_of(Call *call, Target target, Table allowances, Table corners,
                         Table projections, Table places, Index room)
{
    Index samples = places.rows;
    expect(call, allowances.rows == target.chords, "each chord needs an allowance");
    expect(call, projections.rows == 2 * samples && projections.columns == samples && samples > 0,
           "two projections of the samples are wanted");
    Prediction given = {call, target, allowances.at, projections.at, places.at, corners, samples, 0,
                        room, 0.0, 0.0, 0.0, 1.0, scratch(call, samples * target.d),
                        scratch(call, samples), scratch(call, room)};
    return given;
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
    Table projections = reals(&call, values[11]);
    Prediction given = prediction_of(&call, target, allowances, corners, projections,
                                     reals(&call, values[12]), 2 * starts.rows + 64);
    given.shortest = real(&call, values[7]);
    given.start = real(&call, values[8]), given.stop = real(&call, values[9]);
    given.margin = real(&call, values[10]);
    expect(&call, stops.rows == starts.rows, "each span needs a start and a stop");
    for (Index span = 0; !call.failed && span < starts.rows; span++)
        halve(&given, starts.at[span], stops.at[span], 0);
    return finish(&call, call.failed ? NULL
                                     : bytes_of(given.found, given.count * (Index)sizeof(double)));
}
