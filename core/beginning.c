/* The knots that a wavelet fit begins with: what its ends and its corners need, and what is predicted
in between. See multirep.representations.wavelet.beginning.
*/
#include "core.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Knots that grow in number. */
typedef struct {
    double *at;
    Index count, room;
} Knots;

static void take(Call *call, Knots *knots, const double *more, Index count)
{
    if (knots->count + count > knots->room) {
        knots->room = 2 * knots->room + count;
        double *at = scratch(call, knots->room);
        if (at && knots->count)
            memcpy(at, knots->at, (size_t)knots->count * sizeof(double));
        knots->at = at;
    }
    if (!call->failed && count) {
        memcpy(knots->at + knots->count, more, (size_t)count * sizeof(double));
        knots->count += count;
    }
}

static int ascending(const void *one, const void *two)
{
    double a = *(const double *)one, b = *(const double *)two;
    return (a > b) - (a < b);
}

static void put_in_order(Knots *knots)
{
    if (knots->count)
        qsort(knots->at, (size_t)knots->count, sizeof(double), ascending);
}

static void without_repetition(Knots *knots)
{
    Index kept = 0;
    for (Index i = 0; i < knots->count; i++)
        if (kept == 0 || knots->at[i] > knots->at[kept - 1])
            knots->at[kept++] = knots->at[i];
    knots->count = kept;
}

/* How far the old piece, continued from an end by steps of `whole`, goes with the target: until it
has departed from it by 3/2 of the room that the gap at the end leaves. Zero if it departs at once,
negative if the gap is too large already. `rows` has room for five points. */
static double turn(const Target *target, const double *allowances, const Piece *piece, double end,
                   double whole, double *rows)
{
    enum { DEGREE = 3, ORDER = 4, HALVINGS = 38 };
    Index d = target->d;
    double *first = rows + ORDER * d, room = 0.0, before = 0.0;
    for (Index i = 0, chord = 0; i <= HALVINGS; i++) {
        double step = i ? whole * ldexp(1.0, (int)(i - 1 - HALVINGS)) : 0.0, square = 0.0;
        double t = end + step;
        memcpy(rows, piece->points.at, (size_t)(ORDER * d) * sizeof(double));
        for (Index k = 0; k < DEGREE; k++)
            blossom_step(piece->knots.at, DEGREE, d, t, k, rows);
        chord = chord_at(target, chord, t);
        for (Index c = 0; c < d; c++) {
            double away = rows[c] - value_at(target, chord, t, c);
            if (i == 0)
                first[c] = away;
            away -= i == 0 ? 0.0 : first[c];
            square += away * away;
        }
        if (i == 0) {
            double gap = sqrt(square), allowed = allowances[chord];
            if (!(gap <= allowed))
                return -1.0;
            room = 1.5 * larger(allowed - gap, allowed / 8.0);
        } else if (square > room * room)
            return before;
        before = fabs(step);
    }
    return fabs(whole);
}

/* Three spans of about a length beside an end, towards `sign`. */
static void take_steps(Call *call, Knots *knots, double end, double length, double sign)
{
    int exponent = 0;
    frexp(length, &exponent);
    double grain = ldexp(1.0, exponent - 3), origin = rint(end / grain) * grain;
    double step = sign * rint(length / grain) * grain;
    double steps[] = {origin + step, origin + 2.0 * step, origin + 3.0 * step};
    take(call, knots, steps, 3);
}

/* Three knots about each corner that lies between two knots. */
static void take_clusters(Call *call, Knots *knots, Table corners, Table widths, double start,
                          double length, double narrowest, double first, double last)
{
    for (Index i = 0; !call->failed && i < corners.rows; i++) {
        double place = (corners.at[i] - start) / length;
        double width = larger(widths.at[i] / length, narrowest);
        int exponent = 0;
        frexp(width, &exponent);
        double grain = ldexp(0.25, exponent);
        double centre = rint(place / grain) * grain, apart = rint(width / grain) * grain;
        double around[] = {centre - apart, centre, centre + apart};
        for (Index k = 0; k < 3; k++)
            if (around[k] > first && around[k] < last)
                take(call, knots, around + k, 1);
    }
}

/* Whether old knots beside an end are not much farther apart than a length. */
static int near_enough(Table kept, double about)
{
    for (Index i = 0; i + 1 < kept.rows; i++)
        if (kept.at[i + 1] - kept.at[i] > about)
            return 0;
    return 1;
}

METHOD(core_beginning)
{
    /* t, points, slopes, allowances, corners, widths of the target; the ends of the stretch, each
    with the old knots inside that should stay; knots (6,) and control points (4, d) of the old
    pieces on the left and on the right, None where nothing is joined; the fewest spans, both ends of
    T, the shortest span; margin, projections and places as for `predict`. Returns the knots as
    bytes, None when an old piece is too far off or a span too short. */
    static const double ABOUT = 1.5, NARROWEST = 8.0, BOTH_ENDS = 6.0;
    Call call;
    begin(&call, count, 19);
    if (call.failed)
        return finish(&call, NULL);
    Target target = target_of(&call, values);
    Table allowances = reals(&call, values[3]), corners = reals(&call, values[4]);
    Table widths = reals(&call, values[5]), kept[2] = {reals(&call, values[6]), reals(&call, values[7])};
    Piece old[2] = {piece_of(&call, values + 8, target.d), piece_of(&call, values + 10, target.d)};
    Index fewest = integer(&call, values[12]);
    double low = real(&call, values[13]), high = real(&call, values[14]), length = high - low;
    double shortest = real(&call, values[15]), margin = real(&call, values[16]);
    Table projections = reals(&call, values[17]);
    Prediction given = prediction_of(&call, target, allowances, corners, projections,
                                     reals(&call, values[18]), 2 * target.t.rows + 64);
    given.start = low, given.stop = high, given.shortest = shortest, given.margin = margin;
    expect(&call, widths.rows == corners.rows && kept[0].rows && kept[1].rows,
           "a width for each corner and two ends are wanted");
    double *rows = scratch(&call, 5 * target.d);
    if (call.failed)
        return finish(&call, NULL);
    double ends[2] = {kept[0].at[0], kept[1].at[kept[1].rows - 1]}, t[2] = {ends[0], ends[1]};
    if (low != 0.0 || high != 1.0)
        for (int k = 0; k < 2; k++)
            t[k] = (1.0 - ends[k]) * low + ends[k] * high;
    Index room = 3 * corners.rows + kept[0].rows + kept[1].rows + 64;
    Knots knots = {scratch(&call, room), 0, room};
    take(&call, &knots, ends, 2);
    if (old[0].knots.at || old[1].knots.at) {
        double spans[2];
        for (int side = 0; side < 2; side++) {
            double whole = side ? t[0] - t[1] : t[1] - t[0];
            double far = old[side].knots.at
                             ? turn(&target, allowances.at, old + side, t[side], whole, rows)
                             : fabs(whole);
            if (!(far > 0.0))
                return finish(&call, Py_NewRef(Py_None));
            spans[side] = far / length;
        }
        if (!near_enough(kept[0], ABOUT * spans[0]))
            kept[0].rows = 1;
        if (!near_enough(kept[1], ABOUT * spans[1])) {
            kept[1].at += kept[1].rows - 1;
            kept[1].rows = 1;
        }
        double first = knots.at[0] = kept[0].at[kept[0].rows - 1];
        double last = knots.at[1] = kept[1].at[0];
        if (BOTH_ENDS * spans[0] < last - first)
            take_steps(&call, &knots, first, spans[0], 1.0);
        if (BOTH_ENDS * spans[1] < last - first)
            take_steps(&call, &knots, last, spans[1], -1.0);
    }
    expect(&call, call.failed || knots.at[0] < knots.at[1], "a stretch is wanted");
    if (!call.failed)
        take_clusters(&call, &knots, corners, widths, low, length, NARROWEST * shortest, knots.at[0],
                      knots.at[1]);
    put_in_order(&knots);
    without_repetition(&knots);
    while (!call.failed && knots.count <= fewest) {
        for (Index i = knots.count - 1; !call.failed && i > 0; i--) {
            double middle = half_of(knots.at[i - 1], knots.at[i]);
            take(&call, &knots, &middle, 1);
        }
        put_in_order(&knots);
    }
    for (Index i = 0; !call.failed && i + 1 < knots.count; i++)
        if (!(knots.at[i + 1] - knots.at[i] >= shortest))
            return finish(&call, Py_NewRef(Py_None));
    for (Index i = 0; !call.failed && i + 1 < knots.count; i++)
        halve(&given, knots.at[i], knots.at[i + 1], 0);
    take(&call, &knots, given.found, given.count);
    take(&call, &knots, kept[0].at, kept[0].rows - 1);
    take(&call, &knots, kept[1].at + 1, kept[1].rows - 1);
    put_in_order(&knots);
    return finish(&call, call.failed ? NULL
                                     : bytes_of(knots.at, knots.count * (Index)sizeof(double)));
}
