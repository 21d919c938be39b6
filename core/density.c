/* How many chords a stretch of a spline needs, on a fine grid; and chords of equal shares of it.

The density is sqrt(||R''|| / (8 tolerance)); see multirep.splines.sampling.
*/
#include "core.h"

#include <math.h>
#include <string.h>

/* Cells per chord on which the density is constant, and the fewest and the most on a span; places
where the density of a rational spline or of a high degree is looked at first. */
enum { CELLS_PER_CHORD = 4, FEWEST_CELLS = 2, MOST_CELLS = 64, LOOKS = 3 };
/* No chord is taken to need less than this part of the tolerance's square root. */
static const double LEAST_NEED = 1e-3;

/* ||R''|| on a cell; `rows` has room for p + 1 rows. */
static double bending(const Spline *spline, int rational, Index span, double t, double *rows)
{
    Index p = spline->degree, all = spline->dimension, d = all - rational;
    const double *local = local_knots(spline, span);
    memcpy(rows, local_rows(spline, span), (size_t)((p + 1) * all) * sizeof(double));
    for (Index step = 0; step < p - 2; step++)
        blossom_step(local, p, all, t, step, rows);
    /* Of the polar form with two free arguments: value, slope and bending, column by column; a line
    bends only through its weights. */
    double sum = 0.0, weight[3] = {1.0, 0.0, 0.0};
    for (Index turn = 0; turn < all; turn++) {
        Index c = rational ? (turn == 0 ? d : turn - 1) : turn; /* the weight first */
        double value, slope, bend = 0.0;
        if (p == 1) {
            double width = local[1] - local[0], share = (t - local[0]) / width;
            value = rows[c] * (1.0 - share) + rows[c + all] * share;
            slope = (rows[c + all] - rows[c]) / width;
        } else {
            const double *knot = local + p - 2; /* two before, two behind the parameter */
            double one = (rows[c + all] - rows[c]) / (knot[2] - knot[0]);
            double two = (rows[c + 2 * all] - rows[c + all]) / (knot[3] - knot[1]);
            double low = rows[c] + (t - knot[0]) * one, high = rows[c + all] + (t - knot[1]) * two;
            double width = knot[2] - knot[1];
            value = low + (t - knot[1]) / width * (high - low);
            slope = (double)p * (high - low) / width;
            bend = (double)(p * (p - 1)) * (two - one) / width;
        }
        if (rational && turn == 0) {
            weight[0] = value, weight[1] = slope, weight[2] = bend;
            continue;
        }
        if (rational) {
            double point = value / weight[0], velocity = (slope - weight[1] * point) / weight[0];
            bend = (bend - 2 * weight[1] * velocity - weight[2] * point) / weight[0];
        }
        sum += bend * bend;
    }
    return sqrt(sum);
}

/* Whether S'' is linear or constant on a span, and so known from `second_derivatives`. */
static int bends_linearly(const Spline *spline, int rational)
{
    return !rational && (spline->degree == 2 || spline->degree == 3);
}

/* Cells that a span is cut into; fills in S'' at its ends where that is all there is to know. */
static double cells_of(const Spline *spline, int rational, Index span, double low, double width,
                       double target, double *rows, double *second)
{
    Index d = spline->dimension;
    double bent = 0.0;
    if (bends_linearly(spline, rational)) {
        second_derivatives(spline, span, second); /* largest at an end */
        bent = sqrt(larger(squared_norm(second, d), squared_norm(second + d, d)));
    } else if (spline->degree > 1 || rational)
        for (Index look = 0; look < LOOKS; look++) {
            double at = low + width * (((double)look + 0.5) / LOOKS);
            bent = larger(bending(spline, rational, span, at, rows), bent);
        }
    double cells = ceil(width * sqrt(bent * (CELLS_PER_CHORD * CELLS_PER_CHORD / (8 * target))));
    return cells >= FEWEST_CELLS ? smaller(cells, MOST_CELLS) : FEWEST_CELLS;
}

/* ||S''|| at a part of a span, from S'' at both ends of it. */
static double blended(const double *second, Index d, double share)
{
    double sum = 0.0;
    for (Index c = 0; c < d; c++) {
        double bend = second[c] + share * (second[c + d] - second[c]);
        sum += bend * bend;
    }
    return sqrt(sum);
}

Density empty_density(Call *call, Index cells)
{
    Density density = {cells, 0, 0, scratch(call, cells + 1), scratch(call, cells),
                       scratch(call, cells + 1)};
    return density;
}

static void add_up(Density *density)
{
    density->sums[0] = 0.0;
    for (Index i = 0; i < density->cells; i++)
        density->sums[i + 1] = density->sums[i] + density->shares[i];
}

Density density_of(Call *call, const Spline *spline, int rational, double start, double stop,
                   double target)
{
    Index p = spline->degree, d = spline->dimension;
    double *rows = scratch(call, (p + 1) * d);
    Index first = call->failed ? 0 : span_of(spline, start), last = first;
    while (!call->failed && last < spline->last && spline->knots[last + 1] < stop)
        last++;
    double *parts = scratch(call, last - first + 1);
    double *seconds = scratch(call, (last - first + 1) * 2 * d);
    Index total = 0;
    for (Index span = first; !call->failed && span <= last; span++) {
        double low = span == first ? start : spline->knots[span];
        double width = (span == last ? stop : spline->knots[span + 1]) - low, cells = 0.0;
        if (width > 0.0)
            cells = cells_of(spline, rational, span, low, width, target, rows,
                             seconds + (span - first) * 2 * d);
        parts[span - first] = cells;
        total += (Index)cells;
    }
    Density density = empty_density(call, total);
    Index node = 0;
    int linear = bends_linearly(spline, rational);
    for (Index span = first; !call->failed && span <= last; span++) {
        const double *knots = spline->knots + span;
        double low = span == first ? start : knots[0];
        double whole = (span == last ? stop : knots[1]) - low;
        Index cells = (Index)parts[span - first];
        double width = cells ? whole / (double)cells : 0.0;
        double per_length = 1.0 / (knots[1] - knots[0]), per_root = width / sqrt(8 * target);
        /* Never quite zero, so that the density can be inverted where the curve is straight. */
        double least = 1e-6 * (width / (stop - start));
        for (Index cell = 0; cell < cells; cell++, node++) {
            double at = density.nodes[node] = low + (double)cell * width, middle = at + width / 2;
            double bent = linear ? blended(seconds + (span - first) * 2 * d, d,
                                           (middle - knots[0]) * per_length)
                                 : bending(spline, rational, span, middle, rows);
            density.shares[node] = sqrt(bent) * per_root + least;
        }
    }
    if (!call->failed) {
        density.nodes[total] = stop;
        add_up(&density);
    }
    return density;
}

/* The piecewise linear function through (x, y) on an interval, constant beyond its ends. */
static double between(const double *x, const double *y, Index j, double t)
{
    if (t <= x[j])
        return y[j];
    if (t >= x[j + 1])
        return y[j + 1];
    return (y[j + 1] - y[j]) / (x[j + 1] - x[j]) * (t - x[j]) + y[j];
}

double sum_at(Density *density, double t)
{
    density->node = interval_at(density->nodes, 0, density->cells - 1, density->node, t);
    return between(density->nodes, density->sums, density->node, t);
}

void lay_out(Density *density, double begin, double from, double to, Index chords, double *t)
{
    double step = (to - from) / (double)chords;
    t[0] = begin;
    for (Index part = 1; part < chords; part++) {
        double wanted = (double)part * step + from;
        density->sum = interval_at(density->sums, 0, density->cells - 1, density->sum, wanted);
        t[part] = between(density->sums, density->nodes, density->sum, wanted);
    }
}

double share_needed(double need) { return larger(need, LEAST_NEED); }

void correct(Density *density, Index chords, const double *t, const double *needs, Density *finer)
{
    finer->cells = finer->node = finer->sum = 0;
    finer->sums[0] = 0.0;
    double from = sum_at(density, t[0]);
    for (Index chord = 0; chord < chords; chord++) {
        Index first = finer->cells, node = density->node + 1, cell = first;
        double to = sum_at(density, t[chord + 1]), before = from;
        double scale = to > from ? share_needed(needs[chord]) / (to - from) : 1.0;
        finer->nodes[cell] = t[chord];
        for (; node <= density->node; node++)
            if (density->nodes[node] > t[chord] && density->nodes[node] < t[chord + 1]) {
                finer->shares[cell++] = density->sums[node] - before;
                finer->nodes[cell] = density->nodes[node];
                before = density->sums[node];
            }
        finer->shares[cell++] = to - before;
        for (finer->cells = cell; first < cell; first++)
            finer->sums[first + 1] = finer->sums[first] + finer->shares[first] * scale;
        from = to;
    }
    finer->nodes[finer->cells] = t[chords];
}
