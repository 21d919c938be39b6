/* Fits of a spline to a polyline: where it is looked at, the normal equations, the residuals.

See multirep.splines.least_squares for what the rows guarantee, and multirep.representations.nurbs
for the trial that `core_fit` makes in one call.
*/
#include "core.h"

#include <math.h>
#include <string.h>

/* A smaller Cholesky pivot means that the rows do not determine the unknown. */
static const double SMALLEST_PIVOT = 1e-5;

/* A polyline: parameters (m,), vertices (m, dimension). */
typedef struct {
    const double *t, *points;
    Index count, dimension;
} Polyline;

/* Vertices, knots between them, and even parameters where a span holds too few; at most `room`. */
static Index placed_rows(Call *call, const Spline *spline, const Polyline *line, Index per_span,
                         double *rows, Index room)
{
    const double *t = line->t, *knots = spline->knots;
    double start = t[0], stop = t[line->count - 1], mark = start, last = -INFINITY;
    /* Just below, lest rounding splits a gap that is exactly as wide as allowed. */
    double wanted = (double)per_span * (1 - 1e-9);
    Index vertex = 1, span = span_of(spline, start), knot = 0, found = 0;
    Index knot_count = spline->count + spline->degree + 1;
    while (knot < knot_count && !(knots[knot] > start))
        knot++;
    while (vertex < line->count) {
        double next = t[vertex];
        if (knot < knot_count && knots[knot] < next)
            next = knots[knot++];
        else
            vertex++;
        if (!(next > mark))
            continue;
        span = walked(spline, span, mark);
        double gap = next - mark;
        double covered = smaller(knots[span + 1], stop) - larger(knots[span], start);
        double parts = larger(ceil(gap * wanted / covered), 1.0);
        if (!(parts <= (double)(room - 1 - found))) {
            expect(call, 0, "the rows of a fit are without end");
            return 0;
        }
        for (Index part = 0; part < (Index)parts; part++) {
            /* A gap of a few units in the last place: its fractions round together. */
            double row = mark + (double)part / parts * gap;
            if (row > last)
                rows[found++] = last = row;
        }
        mark = next;
    }
    if (stop > last)
        rows[found++] = stop;
    return found;
}

/* The polyline at increasing parameters, vertices bit by bit. */
static void follow(const Polyline *line, const double *rows, Index count, double *targets)
{
    Index d = line->dimension, chord = 0;
    for (Index r = 0; r < count; r++) {
        while (chord + 2 < line->count && line->t[chord + 1] <= rows[r])
            chord++;
        const double *low = line->points + chord * d, *high = low + d;
        double begin = line->t[chord], end = line->t[chord + 1];
        double *target = targets + r * d;
        if (rows[r] == begin || rows[r] >= end)
            memcpy(target, rows[r] == begin ? low : high, (size_t)d * sizeof(double));
        else
            for (Index c = 0; c < d; c++)
                target[c] = (high[c] - low[c]) / (end - begin) * (rows[r] - begin) + low[c];
    }
}

static void trapezoid(const double *rows, Index count, double *weights)
{
    double before = 0.0;
    for (Index r = 0; r < count; r++) {
        double half = r + 1 < count ? (rows[r + 1] - rows[r]) / 2 : 0.0;
        weights[r] = before + half;
        before = half;
    }
}

/* A system: rows (m,) with targets and weights, the free control points, weights of the basis. */
typedef struct {
    const double *t, *targets, *weights, *basis_weights;
    Index rows, free, stop;
} System;

/* Tabulate the basis, (m, p + 1), and the span of each row. */
static void tabulate(const Spline *spline, const System *system, double *basis, Index *spans)
{
    Index p = spline->degree, span = spline->first;
    for (Index r = 0; r < system->rows; r++) {
        double *values = basis + r * (p + 1), sum = 0.0;
        spans[r] = span = walked(spline, span, system->t[r]);
        basis_values(local_knots(spline, span), p, system->t[r], values);
        if (!system->basis_weights)
            continue;
        for (Index j = 0; j <= p; j++)
            sum += values[j] *= system->basis_weights[span - p + j];
        for (Index j = 0; j <= p; j++)
            values[j] /= sum;
    }
}

/* Add a row to the normal equations of `size` neighbouring unknowns. */
static inline void add_row(const double *values, const double *wanted, double weight, Index size,
                           Index d, Index stride, double *entries, double *sums)
{
    for (Index j = 0; j < size; j++) {
        double weighted = values[j] * weight;
        for (Index k = j; k < size; k++)
            entries[j * stride + k - j] += weighted * values[k];
        for (Index c = 0; c < d; c++)
            sums[j * d + c] += weighted * wanted[c];
    }
}

/* How far a row is from what the control points of its span give. */
static inline double off_row(const double *values, const double *rows, const double *target,
                             Index size, Index d)
{
    double square = 0.0;
    for (Index c = 0; c < d; c++) {
        double there = 0.0;
        for (Index j = 0; j < size; j++)
            there += values[j] * rows[j * d + c];
        square += (there - target[c]) * (there - target[c]);
    }
    return sqrt(square);
}

/* Normal equations about a local origin; `solved` (n, D) holds the given control points and gets
the free ones. Returns 0 if the rows do not determine them. */
static int solved_system(Call *call, const Spline *spline, const System *system,
                         const double *basis, const Index *spans, double *solved)
{
    Index p = spline->degree, size = p + 1, d = spline->dimension;
    Index unknowns = system->stop - system->free;
    if (unknowns <= 0)
        return 1;
    const double *origin = system->targets + system->rows / 2 * d;
    double *band = scratch(call, unknowns * size), *right = scratch(call, unknowns * d);
    double *wanted = scratch(call, d);
    if (call->failed)
        return 0;
    memset(band, 0, (size_t)(unknowns * size) * sizeof(double));
    memset(right, 0, (size_t)(unknowns * d) * sizeof(double));
    for (Index r = 0; r < system->rows; r++) {
        const double *values = basis + r * size, *target = system->targets + r * d;
        Index first = spans[r] - p;
        for (Index c = 0; c < d; c++)
            wanted[c] = target[c] - origin[c];
        if (first >= system->free && first + p < system->stop) {
            double *entries = band + (first - system->free) * size;
            double *sums = right + (first - system->free) * d;
            if (p == 3 && d == 2)
                add_row(values, wanted, system->weights[r], 4, 2, 4, entries, sums);
            else
                add_row(values, wanted, system->weights[r], size, d, size, entries, sums);
            continue;
        }
        for (Index j = 0; j < size; j++)
            if (first + j < system->free || first + j >= system->stop)
                for (Index c = 0; c < d; c++)
                    wanted[c] -= values[j] * (solved[(first + j) * d + c] - origin[c]);
        Index low = at_least(system->free - first, 0), high = at_most(system->stop - first, size);
        if (low < high)
            add_row(values + low, wanted, system->weights[r], high - low, d, size,
                    band + (first + low - system->free) * size,
                    right + (first + low - system->free) * d);
    }
    if (!solve_banded(band, right, unknowns, p, d, SMALLEST_PIVOT))
        return 0;
    for (Index i = 0; i < unknowns; i++)
        for (Index c = 0; c < d; c++)
            solved[(system->free + i) * d + c] = right[i * d + c] + origin[c];
    return 1;
}

METHOD(core_polyline_rows)
{
    /* knots, degree, t, points, per_span, rows, targets, weights; returns how many rows there are */
    Call call;
    begin(&call, count, 8);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), t = reals(&call, values[2]);
    Table points = reals(&call, values[3]), rows = output(&call, values[5]);
    Table targets = output(&call, values[6]), weights = output(&call, values[7]);
    Spline spline = spline_of(&call, knots, (Table){NULL, 0, 0}, integer(&call, values[1]));
    Index per_span = integer(&call, values[4]), found = 0;
    Polyline line = {t.at, points.at, t.rows, points.columns};
    expect(&call, t.rows >= 2 && points.rows == t.rows && per_span >= 1,
           "a polyline needs two vertices");
    expect(&call, targets.columns == line.dimension && targets.rows == rows.rows &&
                      weights.rows == rows.rows, "rows, targets and weights need the same room");
    if (!call.failed)
        found = placed_rows(&call, &spline, &line, per_span, rows.at, rows.rows);
    if (!call.failed) {
        follow(&line, rows.at, found, targets.at);
        trapezoid(rows.at, found, weights.at);
    }
    return finish(&call, PyLong_FromSsize_t(found));
}

METHOD(core_solve_window)
{
    /* knots, degree, first free, stop of the free, t, targets, row weights, basis weights or None,
    control points: the free ones are filled in; returns whether they are determined */
    Call call;
    begin(&call, count, 9);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), t = reals(&call, values[4]);
    Table targets = reals(&call, values[5]), weights = reals(&call, values[6]);
    Table basis_weights = reals_or_none(&call, values[7]), solved = output(&call, values[8]);
    Spline spline = spline_of(&call, knots, solved, integer(&call, values[1]));
    System system = {t.at, targets.at, weights.at, basis_weights.at, t.rows,
                     integer(&call, values[2]), integer(&call, values[3])};
    expect(&call,
           t.rows >= 1 && targets.rows == t.rows && weights.rows == t.rows &&
               targets.columns == solved.columns,
           "each row needs a target and a weight");
    expect(&call, !basis_weights.at || basis_weights.rows == spline.count,
           "each control point needs a weight");
    expect(&call, system.free >= 0 && system.stop <= spline.count, "free rows are out of bounds");
    double *basis = scratch(&call, t.rows * (spline.degree + 1));
    Index *spans = index_scratch(&call, t.rows);
    int determined = 0;
    if (!call.failed) {
        tabulate(&spline, &system, basis, spans);
        determined = solved_system(&call, &spline, &system, basis, spans, solved.at);
    }
    return finish(&call, PyBool_FromLong(determined));
}

/* What a polyline allows at increasing parameters: at a vertex the less of both chords. */
static void allowances(Table t, Table allowance, const double *rows, Index count, double *allowed)
{
    Index chord = 0, last = allowance.rows - 1;
    for (Index r = 0; r < count; r++) {
        while (chord < last && t.at[chord + 1] <= rows[r])
            chord++;
        allowed[r] = allowance.at[chord];
        if (chord > 0 && t.at[chord] == rows[r])
            allowed[r] = smaller(allowed[r], allowance.at[chord - 1]);
    }
}

METHOD(core_fit)
{
    /* knots, degree, first free, stop of the free, weights or None, polyline t, its points,
    breakpoints, their multiplicities, factor of rows on corners, t and allowance (m - 1,) of the
    chords, the tightest, emphasis or None, rows a span, control points, rows, ratios, firsts,
    worst; returns how many rows there are, -1 if they do not determine the control points */
    Call call;
    begin(&call, count, 20);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), basis_weights = reals_or_none(&call, values[4]);
    Table t = reals(&call, values[5]), points = reals(&call, values[6]);
    Table at = reals(&call, values[7]);
    Places times = places(&call, values[8]);
    double corner_weight = real(&call, values[9]), tightest = real(&call, values[12]);
    Table chord_t = reals(&call, values[10]), allowance = reals_or_none(&call, values[11]);
    Table emphasis = reals_or_none(&call, values[13]);
    Index per_span = integer(&call, values[14]);
    Table solved = output(&call, values[15]), rows = output(&call, values[16]);
    Table ratios = output(&call, values[17]);
    Slots firsts = slots(&call, values[18]);
    Table worst = output(&call, values[19]);
    Spline spline = spline_of(&call, knots, solved, integer(&call, values[1]));
    Index p = spline.degree, d = solved.columns, s = at.rows - 1, found = 0;
    Polyline line = {t.at, points.at, t.rows, d};
    expect(&call, t.rows >= 2 && points.rows == t.rows && points.columns == d && per_span >= 1,
           "a polyline needs two vertices");
    expect(&call, !basis_weights.at || basis_weights.rows == spline.count,
           "each control point needs a weight");
    expect(&call, !allowance.at || (chord_t.rows == allowance.rows + 1 && allowance.rows >= 1),
           "each chord needs an allowance");
    expect(&call, s >= 1 && times.rows == s + 1 && firsts.rows == s + 1 && worst.rows == s &&
                      ratios.rows == rows.rows, "the outputs are of wrong lengths");
    if (call.failed)
        return finish(&call, NULL);
    found = placed_rows(&call, &spline, &line, per_span, rows.at, rows.rows);
    expect(&call, !emphasis.at || emphasis.rows == found, "each row needs its emphasis");
    double *targets = scratch(&call, found * d), *weights = scratch(&call, found);
    double *allowed = scratch(&call, found), *basis = scratch(&call, found * (p + 1));
    Index *spans = index_scratch(&call, found);
    if (call.failed)
        return finish(&call, NULL);
    follow(&line, rows.at, found, targets);
    trapezoid(rows.at, found, weights);
    for (Index k = 0, r = 0; k <= s; k++) {
        while (r < found && rows.at[r] < at.at[k])
            r++;
        firsts.at[k] = r;
        expect(&call, r < found, "a breakpoint lies beyond the polyline");
        if (!call.failed && k > 0 && k < s && times.at[k] >= p)
            weights[r] *= corner_weight;
    }
    if (allowance.at) {
        allowances(chord_t, allowance, rows.at, found, allowed);
        for (Index r = 0; r < found; r++) {
            double ratio = allowed[r] / tightest;
            weights[r] /= ratio * ratio;
        }
    }
    for (Index r = 0; emphasis.at && r < found; r++)
        weights[r] *= emphasis.at[r];
    System system = {rows.at, targets, weights, basis_weights.at, found,
                     integer(&call, values[2]), integer(&call, values[3])};
    expect(&call, system.free >= 0 && system.stop <= spline.count, "free rows are out of bounds");
    if (call.failed)
        return finish(&call, NULL);
    tabulate(&spline, &system, basis, spans);
    if (!solved_system(&call, &spline, &system, basis, spans, solved.at))
        return finish(&call, PyLong_FromSsize_t(-1));
    for (Index r = 0; r < found; r++) {
        const double *values = basis + r * (p + 1), *held = solved.at + (spans[r] - p) * d;
        double off = p == 3 && d == 2 ? off_row(values, held, targets + r * 2, 4, 2)
                                      : off_row(values, held, targets + r * d, p + 1, d);
        ratios.at[r] = off / (allowance.at ? allowed[r] : tightest);
    }
    for (Index k = 0; k < s; k++) {
        worst.at[k] = 0.0;
        for (Index r = firsts.at[k]; r <= firsts.at[k + 1]; r++)
            /* so that a ratio that is no number stays seen */
            worst.at[k] = worse(worst.at[k], ratios.at[r]);
    }
    return finish(&call, PyLong_FromSsize_t(found));
}
