/* Spans, basis functions and polar forms of one parameter at a time.

Cox-de Boor for the basis, de Boor's algorithm with another argument in each step for polar forms;
see multirep.splines.basis and multirep.splines.polar for sources and for the reasons.
*/
#include "core.h"

#include <string.h>

Spline spline_of(Call *call, Table knots, Table coefficients, Index degree)
{
    Spline spline = {knots.at, coefficients.at, degree, 0, coefficients.columns, 0, 0};
    expect(call, degree >= 0 && degree <= (knots.rows - 2) / 2 && knots.columns == 1,
           "a spline needs 2 p + 2 knots or more");
    expect(call, !coefficients.at || coefficients.rows == knots.rows - degree - 1,
           "a spline needs n + p + 1 knots for n coefficients");
    if (call->failed)
        return spline;
    Index count = spline.count = knots.rows - degree - 1;
    spline.first = degree;
    while (spline.first < count - 1 && !(knots.at[spline.first + 1] > knots.at[degree]))
        spline.first++;
    spline.last = count - 1;
    while (spline.last > spline.first && !(knots.at[spline.last] < knots.at[count]))
        spline.last--;
    return spline;
}

Spline perhaps_rational(Call *call, PyObject *const *values, int *rational)
{
    Table knots = reals(call, values[0]), coefficients = reals(call, values[1]);
    Spline spline = spline_of(call, knots, coefficients, integer(call, values[2]));
    *rational = integer(call, values[3]) != 0;
    expect(call, spline.degree >= 1 && spline.dimension >= 1 + *rational, "no such spline");
    return spline;
}

/* k with knots[k] <= t < knots[k + 1], or the first or last span of the domain. */
Index span_of(const Spline *spline, double t)
{
    return bisected(spline->knots, spline->first, spline->last, t);
}

/* The same, walking on from the span of a parameter that was not larger. */
Index walked(const Spline *spline, Index span, double t)
{
    return interval_at(spline->knots, spline->first, spline->last, span, t);
}

/* The p + 1 basis functions that do not vanish on a span, given its local knots. */
void basis_values(const double *local, Index degree, double t, double *values)
{
    if (degree == 3) {
        cubic_values(local, t, values);
        return;
    }
    values[0] = 1.0;
    for (Index step = 1; step <= degree; step++) {
        double carried = 0.0;
        for (Index j = 0; j < step; j++) {
            double low = local[degree - step + j], high = local[degree + j];
            double share = values[j] / (high - low);
            values[j] = carried + (high - t) * share;
            carried = (t - low) * share;
        }
        values[step] = carried;
    }
}

/* One step of the polar form on the p + 1 control points of a span; p of them leave it in the first
row. Both products are formed, to be exact where the argument is a knot. */
void blossom_step(const double *local, Index degree, Index dimension, double argument, Index step,
                  double *rows)
{
    for (Index j = 0; j < degree - step; j++) {
        double low = local[step + j];
        double share = (argument - low) / (local[degree + j] - low), rest = 1.0 - share;
        double *row = rows + j * dimension;
        for (Index c = 0; c < dimension; c++)
            row[c] = row[c] * rest + row[c + dimension] * share;
    }
}

/* The point of a piece in the first of p + 1 rows. */
void evaluate_piece(const Spline *spline, Index span, double t, double *rows)
{
    Index p = spline->degree, d = spline->dimension;
    const double *local = local_knots(spline, span);
    memcpy(rows, local_rows(spline, span), (size_t)((p + 1) * d) * sizeof(double));
    for (Index step = 0; step < p; step++)
        blossom_step(local, p, d, t, step, rows);
}

/* Bernstein coefficients (p + 1, D) of a piece on [start, stop], which lies in the span: insert the
start p times, then the stop p times. `rows` is as long as the net. */
void bernstein_net(const Spline *spline, Index span, double start, double stop, double *net,
                   double *rows)
{
    Index p = spline->degree, d = spline->dimension;
    size_t row = (size_t)d * sizeof(double);
    const double *local = local_knots(spline, span);
    memcpy(rows, local_rows(spline, span), (size_t)(p + 1) * row);
    memcpy(net + p * d, rows + p * d, row);
    for (Index step = 0; step < p; step++) {
        blossom_step(local, p, d, start, step, rows);
        memcpy(net + (p - step - 1) * d, rows + (p - step - 1) * d, row);
    }
    for (Index step = 0; step < p; step++)
        for (Index j = p; j > step; j--) {
            double share = (stop - start) / (local[p + j - step - 1] - start);
            double rest = 1.0 - share, *here = net + j * d;
            for (Index c = 0; c < d; c++)
                here[c] = here[c - d] * rest + here[c] * share;
        }
}

METHOD(core_find_spans)
{
    /* knots, degree, t, spans */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), t = reals(&call, values[2]);
    Spline spline = spline_of(&call, knots, (Table){NULL, 0, 0}, integer(&call, values[1]));
    Slots spans = slots(&call, values[3]);
    expect(&call, spans.rows == t.rows * t.columns, "a span for each parameter is wanted");
    if (!call.failed) {
        Index span = spline.first;
        for (Index r = 0; r < spans.rows; r++)
            spans.at[r] = span = walked(&spline, span, t.at[r]);
    }
    return finish(&call, Py_NewRef(Py_None));
}

METHOD(core_basis_functions)
{
    /* knots, degree, t, spans, values */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), t = reals(&call, values[2]);
    Index p = integer(&call, values[1]);
    Places spans = places(&call, values[3]);
    Table found = output(&call, values[4]);
    expect(&call, spans.rows == t.rows && found.rows == t.rows && found.columns == p + 1 && p >= 0,
           "a span and p + 1 values for each parameter are wanted");
    for (Index r = 0; !call.failed && r < t.rows; r++) {
        Index span = spans.at[r];
        expect(&call, span >= p - 1 && span + (p > 0) <= knots.rows - at_least(p, 1),
               "a span is out of bounds");
        if (!call.failed)
            basis_values(knots.at + span + 1 - p, p, t.at[r], found.at + r * (p + 1));
    }
    return finish(&call, Py_NewRef(Py_None));
}

METHOD(core_blossom)
{
    /* knots, coefficients, degree, spans, arguments, points; the arrays need not be one spline's:
    several may stand side by side */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), coefficients = reals(&call, values[1]);
    Index p = integer(&call, values[2]), d = coefficients.columns;
    Places spans = places(&call, values[3]);
    Table arguments = reals(&call, values[4]), points = output(&call, values[5]);
    expect(&call,
           p >= 1 && arguments.columns == p && arguments.rows == spans.rows &&
               points.rows == spans.rows && points.columns == d,
           "p arguments and a point for each span are wanted");
    double *rows = scratch(&call, (p + 1) * d);
    for (Index r = 0; !call.failed && r < spans.rows; r++) {
        Index span = spans.at[r];
        expect(&call, span >= p && span + p < knots.rows && span < coefficients.rows,
               "a span is out of bounds");
        if (call.failed)
            break;
        memcpy(rows, coefficients.at + (span - p) * d, (size_t)((p + 1) * d) * sizeof(double));
        for (Index step = 0; step < p; step++)
            blossom_step(knots.at + span + 1 - p, p, d, arguments.at[r * p + step], step, rows);
        memcpy(points.at + r * d, rows, (size_t)d * sizeof(double));
    }
    return finish(&call, Py_NewRef(Py_None));
}
