/* Proofs: how far a spline leaves the chords of a polyline, at equal parameters.

See multirep.splines.deviation for the bounds and multirep.splines.pieces for the rounding that is
added; both are the same here. A cell is a nonempty span, a piece the part of a chord on one cell.
*/
#include "core.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* (8 p + 16) units in the last place of the largest coordinate between two parameters, see
`rounding` of pieces.py. */
double rounding_unit(const Spline *spline, int rational, double start, double stop,
                     const Table *points, int tables)
{
    Index all = spline->dimension, d = all - rational;
    Index first = span_of(spline, start), last = span_of(spline, stop);
    while (last > first && !(spline->knots[last] < stop))
        last--;
    double largest = 0.0;
    for (Index i = first - spline->degree; i <= last; i++) {
        const double *row = spline->coefficients + i * all;
        for (Index c = 0; c < d; c++)
            largest = worse(largest, fabs(rational ? row[c] / row[d] : row[c]));
    }
    for (int k = 0; k < tables; k++)
        for (Index i = 0; i < points[k].rows * points[k].columns; i++)
            largest = worse(largest, fabs(points[k].at[i]));
    return (8 * (double)spline->degree + 16) * DBL_EPSILON * sqrt((double)d) * largest;
}

/* S'' at the ends of a cell of degree 2 or 3: differences of differences of its control points. */
void second_derivatives(const Spline *spline, Index span, double *second)
{
    Index p = spline->degree, d = spline->dimension;
    const double *local = local_knots(spline, span), *rows = local_rows(spline, span);
    for (Index end = 0; end < p - 1; end++) {
        double before = (double)p / (local[end + p] - local[end]);
        double after = (double)p / (local[end + 1 + p] - local[end + 1]);
        double scale = (double)(p - 1) / (local[end + p] - local[end + 1]);
        const double *row = rows + end * d;
        for (Index c = 0; c < d; c++) {
            double first = (row[c + d] - row[c]) * before;
            second[end * d + c] = ((row[c + 2 * d] - row[c + d]) * after - first) * scale;
        }
    }
    if (p == 2)
        memcpy(second + d, second, (size_t)d * sizeof(double));
}

void enter_cell(Proof *proof, Index span)
{
    const Spline *spline = &proof->spline;
    if (span == proof->cell)
        return;
    proof->cell = span;
    proof->slack = proof->unit;
    if (proof->rational) {
        const double *weight = local_rows(spline, span) + proof->d;
        double least = weight[0], most = weight[0];
        for (Index i = 1; i <= spline->degree; i++) {
            least = smaller(weight[i * spline->dimension], least);
            most = larger(weight[i * spline->dimension], most);
        }
        proof->slack *= most / least;
    } else if (spline->degree == 2 || spline->degree == 3)
        second_derivatives(spline, span, proof->second);
}

/* Largest squared norm of Bernstein coefficients (over the squared weight), after halving the
interval so many times; `net` is overwritten, `room` has a net for each halving. */
static double hull(double *net, Index size, Index d, int rational, Index splits, double *room)
{
    Index all = d + rational;
    if (!splits) {
        double largest = 0.0;
        for (Index i = 0; i < size; i++) {
            const double *row = net + i * all;
            double square = squared_norm(row, d);
            if (rational)
                square /= row[d] * row[d];
            largest = worse(largest, square);
        }
        return largest;
    }
    /* de Casteljau at the middle: the left half comes out first, the right half stays. */
    for (Index step = 0; step < size; step++) {
        memcpy(room + step * all, net, (size_t)all * sizeof(double));
        for (Index i = 0; i < (size - 1 - step) * all; i++)
            net[i] = (net[i] + net[i + all]) / 2;
    }
    double left = hull(room, size, d, rational, splits - 1, room + size * all);
    double right = hull(net, size, d, rational, splits - 1, room + size * all);
    return worse(left, right);
}

/* The bound from Bernstein coefficients of the difference, which for a rational is E = A - w L. */
static double bernstein_bound(Proof *proof, Index span, double start, double stop, Index splits)
{
    const Spline *spline = &proof->spline;
    Index p = spline->degree, d = proof->d, all = spline->dimension;
    double *net = proof->net;
    bernstein_net(spline, span, start, stop, net, proof->rows);
    if (!proof->rational) {
        for (Index i = 0; i <= p; i++) {
            double share = (double)i / (double)p, rest = 1.0 - share;
            for (Index c = 0; c < d; c++)
                net[i * d + c] = net[i * d + c] - rest * proof->low[c] - share * proof->high[c];
        }
        return sqrt(hull(net, p + 1, d, 0, splits, proof->rows));
    }
    /* Raised to degree p + 1: row i mixes rows i - 1 and i; from behind, in place. */
    for (Index i = p + 1; i >= 0; i--) {
        double share = (double)i / (double)(p + 1), rest = 1.0 - share;
        double *row = net + i * all, *before = row - all;
        for (Index c = 0; c <= d; c++) {
            double sum = 0.0;
            if (i <= p)
                sum = rest * (c < d ? row[c] - row[d] * proof->low[c] : row[d]);
            if (i > 0)
                sum += share * (c < d ? before[c] - before[d] * proof->high[c] : before[d]);
            proof->rows[c] = sum;
        }
        memcpy(row, proof->rows, (size_t)all * sizeof(double));
    }
    return sqrt(hull(net, p + 2, d, 1, splits, proof->rows));
}

/* The cheap bound up to degree 3: what is off at both ends, and the sagitta from S'' between. On a
piece of length h, with x from -1 to 1, S'' = M + x D, and the sagitta is at most
h**2 / 8 (1 - x**2) (||M|| + |x| ||D|| / 3). */
static double curvature_bound(Proof *proof, double start, double stop, double before, double after)
{
    const Spline *spline = &proof->spline;
    Index d = proof->d;
    if (spline->degree == 1)
        return worse(before, after);
    double half = (stop - start) / 2, scale = half * half / 2, odd = 0.0, even = 0.0;
    double left = spline->knots[proof->cell], width = spline->knots[proof->cell + 1] - left;
    const double *at_left = proof->second, *at_right = at_left + d;
    for (Index c = 0; c < d; c++) {
        double slope = (at_right[c] - at_left[c]) / width;
        double middle = at_left[c] + slope * (start - left + half);
        odd += slope * slope;
        even += middle * middle;
    }
    odd = sqrt(odd) * (half * scale / 3);
    even = sqrt(even) * scale;
    /* The maximum over x of base + even (1 - x**2) + lean |x|, whose top may lie beyond x = 1. */
    double base = (before + after) / 2, lean = fabs(after - before) / 2 + odd;
    double inside = smaller(lean, 2 * even);
    return base + (even + (lean - inside)) + inside * inside / (4 * even + DBL_MIN);
}

/* How far the spline is from the end of a line, at a parameter of a cell. */
static double off(Proof *proof, Index span, double t, const double *line)
{
    double sum = 0.0;
    evaluate_piece(&proof->spline, span, t, proof->rows);
    for (Index c = 0; c < proof->d; c++)
        sum += (proof->rows[c] - line[c]) * (proof->rows[c] - line[c]);
    return sqrt(sum);
}

Proof proof_of(Call *call, Spline spline, int rational, Index splits)
{
    expect(call, splits >= 0 && splits < 64, "a piece is halved 0 to 63 times");
    Index d = spline.dimension - rational, net = (spline.degree + 2) * spline.dimension;
    Proof proof = {spline, rational, splits, d, 0.0, -1, 0.0, scratch(call, 2 * d),
                   scratch(call, net * (splits + 1)), scratch(call, net), scratch(call, d),
                   scratch(call, d)};
    return proof;
}

void prove_chords(Proof *proof, const Chords *chords, const double *limits, Index limited,
                  double *bounds)
{
    const Spline *spline = &proof->spline;
    Index d = proof->d, span = spline->first;
    int curved = !proof->rational && spline->degree <= 3, inscribed = chords->inscribed;
    size_t point = (size_t)d * sizeof(double);
    double after = 0.0;
    for (Index chord = 0; chord < chords->count; chord++) {
        double start = chords->starts[chord], stop = chords->stops[chord], largest = 0.0;
        double limit = limited ? limits[limited > 1 ? chord : 0] : 0.0;
        const double *first = chords->first + chord * d, *last = chords->last + chord * d;
        span = walked(spline, span, start);
        memcpy(proof->low, first, point);
        double before = 0.0;
        if (curved && limited && !inscribed)
            before = chord > 0 && start == chords->stops[chord - 1]
                         ? after
                         : off(proof, span, start, first);
        for (double from = start;;) {
            int ending = span == spline->last || stop <= spline->knots[span + 1];
            double to = ending ? stop : spline->knots[span + 1];
            enter_cell(proof, span);
            if (ending)
                memcpy(proof->high, last, point);
            else {
                double share = (to - start) / (stop - start);
                for (Index c = 0; c < d; c++)
                    proof->high[c] = first[c] + share * (last[c] - first[c]);
            }
            double bound;
            if (!limited)
                bound = bernstein_bound(proof, span, from, to, proof->splits) + proof->slack;
            else {
                if (curved) {
                    after = inscribed && ending ? 0.0 : off(proof, span, to, proof->high);
                    bound = curvature_bound(proof, from, to, before, after);
                } else
                    bound = bernstein_bound(proof, span, from, to, 0);
                bound += proof->slack;
                if (!(bound <= limit)) {
                    double sharper = bernstein_bound(proof, span, from, to, proof->splits);
                    bound = smaller(bound, sharper + proof->slack);
                }
            }
            largest = worse(largest, bound);
            if (ending)
                break;
            memcpy(proof->low, proof->high, point);
            before = after;
            from = to;
            do
                span++;
            while (span < spline->last && !(spline->knots[span + 1] > spline->knots[span]));
        }
        bounds[chord] = largest;
    }
}

METHOD(core_chord_bounds)
{
    /* knots, coefficients, degree, rational, starts, stops, points where chords start, points where
    they stop, splits, allowance (0,) or (1,) or (m,), bounds */
    Call call;
    begin(&call, count, 11);
    if (call.failed)
        return finish(&call, NULL);
    int rational;
    Spline spline = perhaps_rational(&call, values, &rational);
    Table starts = reals(&call, values[4]), stops = reals(&call, values[5]);
    Table ends[2] = {reals(&call, values[6]), reals(&call, values[7])};
    Proof proof = proof_of(&call, spline, rational, integer(&call, values[8]));
    Table allowance = reals(&call, values[9]), bounds = output(&call, values[10]);
    Index d = proof.d, m = starts.rows;
    expect(&call,
           stops.rows == m && ends[0].rows == m && ends[1].rows == m && bounds.rows == m &&
               ends[0].columns == d && ends[1].columns == d,
           "each chord needs two parameters and two points");
    expect(&call, allowance.rows <= 1 || allowance.rows == m, "each chord needs an allowance");
    if (!call.failed && m > 0) {
        Chords chords = {m, starts.at, stops.at, ends[0].at, ends[1].at, 0};
        proof.unit = rounding_unit(&spline, rational, starts.at[0], stops.at[m - 1], ends, 2);
        prove_chords(&proof, &chords, allowance.at, allowance.rows, bounds.at);
    }
    return finish(&call, Py_NewRef(Py_None));
}
