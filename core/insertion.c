/* Knot insertion in a window of a NURBS: Euclidean control points, and weights if there are any.

Control points that read one new knot by Boehm's algorithm, others as polar forms; see
multirep.representations.nurbs.boehm.
*/
#include "core.h"

#include <string.h>

/* A piece that much shorter than another one is continued too far by polar forms. */
static const double MUCH_LONGER = 4.0;

static int all_equal(const double *row, Index count)
{
    for (Index i = 1; i < count; i++)
        if (row[i] != row[0])
            return 0;
    return 1;
}

static Table output_or_none(Call *call, PyObject *array)
{
    return array == Py_None ? (Table){NULL, 0, 0} : output(call, array);
}

/* Merge the new knots in, behind equal ones: the place of each in the union, and how often it was a
knot before. Whether none is there more than p times. */
static int merge(Call *call, const Spline *old, const Table *added, double *united, Index *places,
                 Index *times)
{
    Index all = old->count + old->degree + 1, from = 0, equal = 0;
    for (Index j = 0; j < added->rows; j++) {
        double t = added->at[j];
        Index start = from;
        while (from < all && old->knots[from] <= t)
            from++;
        memcpy(united + start + j, old->knots + start, (size_t)(from - start) * sizeof(double));
        united[from + j] = t;
        if (from > start || j == 0 || added->at[j - 1] != t)
            for (equal = 0; equal < from && old->knots[from - 1 - equal] == t;)
                equal++;
        places[j] = from + j;
        times[j] = equal;
        expect(call,
               from - equal > old->degree && from <= old->count && (!j || added->at[j - 1] <= t),
               "new knots must be sorted and inside the domain");
        if (call->failed)
            return 0;
        Index before = places[j] - old->degree;
        if (united[before] == t)
            return 0;
    }
    memcpy(united + from + added->rows, old->knots + from, (size_t)(all - from) * sizeof(double));
    return 1;
}

/* The new span in which the polar form of a row is taken: in the middle of its support, or the
longest where that one is tiny. */
static Index span_for(const double *knots, Index degree, Index count, Index row)
{
    Index middle = row + degree / 2, right = at_least(middle, degree), left = middle - 1, chosen;
    while (right < count && !(knots[right] < knots[right + 1]))
        right++;
    left = at_most(left, count - 1);
    while (left >= degree && !(knots[left] < knots[left + 1]))
        left--;
    if (right == count)
        chosen = left;
    else
        chosen = left < degree || right - middle <= middle - left ? right : left;
    Index longest = chosen;
    double length = -1.0;
    for (Index k = at_least(row, degree); k <= at_most(row + degree, count - 1); k++)
        if (knots[k + 1] - knots[k] > length) {
            length = knots[k + 1] - knots[k];
            longest = k;
        }
    return length > MUCH_LONGER * (knots[chosen + 1] - knots[chosen]) ? longest : chosen;
}

/* Boehm's algorithm: a control point that reads one new knot lies between two neighbours, of which
`next` is the second. */
static void row_between(const Spline *old, const double *weights, Index next, double t,
                        double *point, double *bottom)
{
    Index d = old->dimension;
    const double *knots = old->knots, *a = old->coefficients + (next - 1) * d, *b = a + d;
    double share = (t - knots[next]) / (knots[next + old->degree] - knots[next]);
    double rest = 1.0 - share;
    double v = weights ? weights[next - 1] : 1.0, w = weights ? weights[next] : 1.0;
    if (v == w) {
        for (Index c = 0; c < d; c++)
            point[c] = rest * a[c] + share * b[c];
        if (weights)
            *bottom = v;
        return;
    }
    *bottom = rest * v + share * w;
    for (Index c = 0; c < d; c++)
        point[c] = (rest * (v * a[c]) + share * (w * b[c])) / *bottom;
}

/* The polar form of the piece of an old span at p arguments; the weight or nothing. */
static void polar_row(const Spline *old, const double *weights, Index span, const double *arguments,
                      double *rows, double *point, double *bottom)
{
    Index p = old->degree, d = old->dimension;
    const double *points = local_rows(old, span), *local = local_knots(old, span);
    const double *w = weights ? weights + span - p : NULL;
    int rational = w && !all_equal(w, p + 1);
    if (rational)
        for (Index i = 0; i <= p; i++) {
            for (Index c = 0; c < d; c++)
                rows[i * (d + 1) + c] = points[i * d + c] * w[i];
            rows[i * (d + 1) + d] = w[i];
        }
    else
        memcpy(rows, points, (size_t)((p + 1) * d) * sizeof(double));
    for (Index step = 0; step < p; step++)
        blossom_step(local, p, d + rational, arguments[step], step, rows);
    for (Index c = 0; c < d; c++)
        point[c] = rational ? rows[c] / rows[d] : rows[c];
    if (w)
        *bottom = rational ? rows[d] : w[0];
}

METHOD(core_insert_knots)
{
    /* knots, points, weights or None, degree, new knots (m,) in order and inside the domain; all
    knots, points, and weights or None. Returns where the supports of control points begin and end
    that are no old ones, or None when a knot would be there more than p times. */
    Call call;
    begin(&call, count, 8);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), points = reals(&call, values[1]);
    Table weights = reals_or_none(&call, values[2]);
    Index p = integer(&call, values[3]), d = points.columns;
    Spline old = spline_of(&call, knots, points, p);
    Table added = reals(&call, values[4]), united = output(&call, values[5]);
    Table made = output(&call, values[6]), bottoms = output_or_none(&call, values[7]);
    if (call.failed)
        return finish(&call, NULL);
    Index m = added.rows, rows = points.rows + m;
    expect(&call,
           p >= 1 && added.columns == 1 && united.rows == knots.rows + m && made.rows == rows &&
               made.columns == d && !weights.at == !bottoms.at &&
               (!weights.at || (weights.rows == points.rows && bottoms.rows == rows)),
           "room for all knots and points is wanted");
    Index *places = index_scratch(&call, m), *times = index_scratch(&call, m);
    double *local = scratch(&call, (p + 1) * (d + 1));
    double *begins = scratch(&call, m), *ends = scratch(&call, m);
    if (call.failed || !merge(&call, &old, &added, united.at, places, times))
        return finish(&call, Py_NewRef(Py_None));
    Index row = 0, span = old.first, parts = 0;
    for (Index j = 0; j <= m; j++) {
        /* Rows that read a new knot and as many others of its value as there were are new. */
        Index start = j < m ? places[j] - p : rows, stop = j < m ? places[j] - times[j] : rows;
        if (row < start) {
            size_t copied = (size_t)(start - row) * sizeof(double);
            memcpy(made.at + row * d, points.at + (row - j) * d, copied * (size_t)d);
            if (weights.at)
                memcpy(bottoms.at + row, weights.at + row - j, copied);
            row = start;
        }
        if (row < stop && (!parts || united.at[row] > ends[parts - 1]))
            begins[parts++] = larger(united.at[row], knots.at[p]);
        for (; row < stop; row++) {
            double *point = made.at + row * d, *bottom = bottoms.at ? bottoms.at + row : NULL;
            if (j + 1 < m && places[j + 1] <= row + p) {
                span = walked(&old, span, united.at[span_for(united.at, p, rows, row)]);
                polar_row(&old, weights.at, span, united.at + row + 1, local, point, bottom);
            } else
                row_between(&old, weights.at, row - j, added.at[j], point, bottom);
            ends[parts - 1] = smaller(united.at[row + p + 1], knots.at[points.rows]);
        }
    }
    PyObject *starts = numbers(&call, begins, parts), *stops = numbers(&call, ends, parts);
    return finish(&call, pair_of(&call, starts, stops));
}

/* Copy a block into one with a row more, all but `fresh` new rows from `row` on. */
static void opened_by(const Table *made, const Table *old, Index row, Index fresh)
{
    Index columns = old->columns, rest = row + fresh - 1;
    memcpy(made->at, old->at, (size_t)(row * columns) * sizeof(double));
    memcpy(made->at + (row + fresh) * columns, old->at + rest * columns,
           (size_t)((old->rows - rest) * columns) * sizeof(double));
}

METHOD(core_insert_knot)
{
    /* Degree, the new knot, both ends of the domain; a block of knots and the row before which it
    belongs; of control points, and of weights or None, with the row of the last one that acts there;
    new blocks to be filled. All that take part lie in these blocks: p knots on either side and p + 1
    control points. Returns where the interval begins and ends on which new control points act, or
    None when the knot is there p times. */
    Call call;
    begin(&call, count, 13);
    if (call.failed)
        return finish(&call, NULL);
    Index p = integer(&call, values[0]);
    double t = real(&call, values[1]);
    double start = real(&call, values[2]), stop = real(&call, values[3]);
    Table knots = reals(&call, values[4]), points = reals(&call, values[6]);
    Table weights = reals_or_none(&call, values[8]);
    Index at = integer(&call, values[5]), last = integer(&call, values[7]);
    Index heaviest = integer(&call, values[9]), d = points.columns, times = 0;
    Table made[3] = {output(&call, values[10]), output(&call, values[11]),
                     output_or_none(&call, values[12])};
    expect(&call,
           p >= 1 && at >= p && p <= knots.rows && at <= knots.rows - p && last >= p &&
               last < points.rows && knots.columns == 1 && made[0].rows == knots.rows + 1 &&
               made[0].columns == 1 && made[1].rows == points.rows + 1 && made[1].columns == d &&
               !weights.at == !made[2].at,
           "a knot needs its neighbours in one block, and room");
    expect(&call,
           !weights.at || (weights.columns == 1 && heaviest >= p && heaviest < weights.rows &&
                           made[2].rows == weights.rows + 1 && made[2].columns == 1),
           "a knot needs its weights in one block, and room");
    if (call.failed)
        return finish(&call, NULL);
    while (times < p && knots.at[at - 1 - times] == t)
        times++;
    if (times == p)
        return finish(&call, Py_NewRef(Py_None));
    /* The second of the control points that act there, and what it acts on. */
    Index second = last - p + 1, fresh = p - times;
    Spline local = {.knots = knots.at + at - p, .coefficients = points.at + second * d,
                    .degree = p, .dimension = d};
    const double *local_weights = weights.at ? weights.at + heaviest - p + 1 : NULL;
    double *bottoms = weights.at ? made[2].at + heaviest - p + 1 : NULL;
    opened_by(&made[0], &knots, at, 1);
    made[0].at[at] = t;
    opened_by(&made[1], &points, second, fresh);
    if (weights.at)
        opened_by(&made[2], &weights, heaviest - p + 1, fresh);
    for (Index i = 0; i < fresh; i++)
        row_between(&local, local_weights, i, t, made[1].at + (second + i) * d,
                    bottoms ? bottoms + i : NULL);
    return finish(&call, Py_BuildValue("dd", larger(knots.at[at - p], start),
                                       smaller(knots.at[at + p - 1 - times], stop)));
}
