/* Points and derivatives of a spline at many parameters; see multirep.splines.evaluation.

The arrays may be block arrays: a span reads its 2p knots and p + 1 control points where they are,
and copies them only where they lie in two blocks. Parameters in order go from span to span;
others are put in order roughly first, so that neighbours are read together. The bits of a point
depend on its parameter, knots and control points alone, and are those that scipy gives.
*/
#include "core.h"

#include <math.h>
#include <string.h>

#ifdef __GNUC__
#define PREFETCH(address) __builtin_prefetch(address)
#else
#define PREFETCH(address) ((void)(address))
#endif

/* Say that rows will be read soon. */
static inline void fetch(Rope *rope, Index first, Index count)
{
    Index begin = rope->begins[rope->current];
    if (first < begin || first >= rope->begins[rope->current + 1]) {
        rope_turn(rope, first);
        begin = rope->begins[rope->current];
    }
    const double *at = rope->blocks[rope->current] + (first - begin) * rope->columns;
    PREFETCH(at);
    PREFETCH(at + count * rope->columns - 1);
}

static double knot_at(Rope *knots, Index k)
{
    double room;
    return *rope_rows(knots, k, 1, &room);
}

/* -- the span at hand -------------------------------------------------------------------------- */

typedef struct {
    Rope knots, points, weights;
    Index degree, order;
    int rational, left, settled;
    Index first, last; /* the spans at the ends of the domain */
    double *knot_room, *point_room, *weight_room, *net_room, *basis;
    /* of the span at hand */
    Index near, span, columns;
    double low, high;
    const double *local, *rows, *net; /* knots, points, what the basis functions combine */
    int corner_low, corner_high;
} Reader;

/* Whether a knot stands before a parameter: the span of the parameter begins at the last such. */
static inline int before(const Reader *reader, double knot, double t)
{
    return reader->left ? knot < t : knot <= t;
}

/* Knots that are looked at together, and how often, before the rest is halved. */
enum { LINE = 16, LINES = 3 };

/* How many knots of a block stand before t; near a guess it is found soon. No branch depends on a
single knot there: mispredicted, it would cost more than the comparison of a line. */
static Index count_before(const Reader *reader, const double *knots, Index count, Index guess,
                          double t)
{
    Index low = guess, high = count;
    if (low && !before(reader, knots[low - 1], t)) {
        high = low - 1;
        low = at_least(high - LINE, 0);
        if (low && !before(reader, knots[low - 1], t)) {
            high = low - 1;
            low = 0;
        }
    }
    for (Index line = 0; line < LINES && low + LINE <= high; line++) {
        Index found = 0;
        if (reader->left)
            for (Index i = 0; i < LINE; i++)
                found += knots[low + i] < t;
        else
            for (Index i = 0; i < LINE; i++)
                found += knots[low + i] <= t;
        low += found;
        if (found < LINE)
            return low;
    }
    while (low < high) {
        Index middle = low + (high - low) / 2;
        if (before(reader, knots[middle], t))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The last block of knots that begins before t; first it is looked for where it would be if all were
equally long. */
static Index block_before(const Reader *reader, double t)
{
    const double *firsts = reader->knots.firsts;
    Index low = 0, high = reader->knots.count - 1;
    double share = (t - firsts[0]) / (firsts[high] - firsts[0]);
    Index middle = share > 0.0 && share < 1.0 ? (Index)(share * (double)high) : 0;
    while (low < high) {
        if (before(reader, firsts[middle], t))
            low = middle;
        else
            high = middle - 1;
        if (low == high || !before(reader, firsts[low + 1], t))
            break;
        middle = low + (high - low + 1) / 2;
    }
    return low;
}

/* The span of a parameter, near the one at hand or far. */
static Index span_near(Reader *reader, double t)
{
    if (reader->left ? reader->low < t && t <= reader->high : reader->low <= t && t < reader->high)
        return reader->near;
    Rope *knots = &reader->knots;
    Index b = knots->current, last = knots->count - 1;
    /* the last block that begins before t */
    int ahead = before(reader, knots->firsts[b], t);
    if (ahead && b < last && before(reader, knots->firsts[b + 1], t))
        ahead = ++b == last || !before(reader, knots->firsts[b + 1], t);
    if (!ahead)
        b = block_before(reader, t);
    knots->current = b;
    Index begin = knots->begins[b], count = knots->begins[b + 1] - begin;
    Index guess = at_most(at_least(reader->near + 1 - begin, 0), count);
    const double *row = knots->blocks[b];
    if (guess + LINES * LINE < count && before(reader, row[guess + LINES * LINE], t)) {
        /* not near: where it would stand if the knots of the block were equally far apart */
        double share = (t - row[0]) / (row[count - 1] - row[0]) * (double)count;
        guess = share > LINE && share < (double)count ? (Index)share - LINE / 2 : guess;
    }
    Index k = begin + count_before(reader, knots->blocks[b], count, guess, t) - 1;
    k = at_most(at_least(k, reader->first), reader->last);
    reader->near = k;
    reader->low = k == reader->first ? -INFINITY : knot_at(knots, k);
    reader->high = k == reader->last ? INFINITY : knot_at(knots, k + 1);
    fetch(&reader->points, k - reader->degree, reader->degree + 1);
    if (reader->rational)
        fetch(&reader->weights, k - reader->degree, reader->degree + 1);
    return k;
}

/* Read what a span depends on. */
static void enter(Reader *reader, Index span)
{
    Index p = reader->degree, d = reader->points.columns;
    reader->span = span;
    const double *local = rope_rows(&reader->knots, span + 1 - p, 2 * p, reader->knot_room);
    const double *rows = rope_rows(&reader->points, span - p, p + 1, reader->point_room);
    reader->local = local;
    reader->rows = reader->net = rows;
    reader->columns = d;
    reader->corner_low = reader->settled && local[0] == local[p - 1];
    reader->corner_high = reader->settled && local[p] == local[2 * p - 1];
    if (!reader->rational)
        return;
    const double *weights = rope_rows(&reader->weights, span - p, p + 1, reader->weight_room);
    Index ones = 0;
    while (ones <= p && weights[ones] == 1.0)
        ones++;
    if (ones > p)
        return; /* a polynomial span */
    double *net = reader->net_room;
    for (Index i = 0; i <= p; i++) {
        for (Index c = 0; c < d; c++)
            *net++ = rows[i * d + c] * weights[i];
        *net++ = weights[i];
    }
    reader->net = reader->net_room;
    reader->columns = d + 1;
}

/* -- basis functions --------------------------------------------------------------------------- */

/* The same, of which the last `order` steps differentiate instead of blending. */
static void basis_derivatives(const double *local, Index degree, double t, Index order,
                              double *values)
{
    basis_values(local + order, degree - order, t, values);
    for (Index step = degree - order + 1; step <= degree; step++) {
        double carried = 0.0;
        for (Index j = 0; j < step; j++) {
            double low = local[degree - step + j], high = local[degree + j];
            double share = (double)step * values[j] / (high - low);
            values[j] = carried - share;
            carried = share;
        }
        values[step] = carried;
    }
}

/* Sum basis functions times rows, from the first to the last. */
static inline void combine(const double *basis, const double *net, Index degree, Index columns,
                           double *sums)
{
    for (Index c = 0; c < columns; c++) {
        double sum = 0.0;
        for (Index i = 0; i <= degree; i++)
            sum += net[i * columns + c] * basis[i];
        sums[c] = sum;
    }
}

static void read_point(Reader *reader, double t, double *found)
{
    Index p = reader->degree, d = reader->points.columns;
    const double *local = reader->local, *net = reader->net;
    if (reader->corner_low && t == local[p - 1]) {
        memcpy(found, reader->rows, (size_t)d * sizeof(double));
        return;
    }
    if (reader->corner_high && t == local[p]) {
        memcpy(found, reader->rows + p * d, (size_t)d * sizeof(double));
        return;
    }
    double cubic[4], *basis = cubic;
    if (p == 3 && !reader->order)
        cubic_values(local, t, basis);
    else
        basis_derivatives(local, p, t, reader->order, basis = reader->basis);
    if (reader->columns == d) {
        if (p == 3 && d == 2)
            combine(basis, net, 3, 2, found);
        else
            combine(basis, net, p, d, found);
        return;
    }
    double planar[3], *sums = planar;
    if (p == 3 && d == 2)
        combine(basis, net, 3, 3, sums);
    else
        combine(basis, net, p, d + 1, sums = reader->basis + p + 1);
    for (Index c = 0; c < d; c++)
        found[c] = sums[c] / sums[d];
}

/* A parameter and its place among all. */
typedef struct {
    double t;
    Index row;
} Wanted;

enum { GROUP = 16 };

static void read_points(Reader *reader, const Wanted *wanted, Index count, double *found)
{
    Index spans[GROUP], d = reader->points.columns;
    for (Index first = 0; first < count; first += GROUP) {
        Index some = at_most(GROUP, count - first);
        for (Index r = 0; r < some; r++)
            spans[r] = span_near(reader, wanted[first + r].t);
        for (Index r = 0; r < some; r++) {
            if (spans[r] != reader->span)
                enter(reader, spans[r]);
            read_point(reader, wanted[first + r].t, found + wanted[first + r].row * d);
        }
    }
}

/* -- parameters in no order -------------------------------------------------------------------- */

/* So few are taken as they come; so many are put in order at once, in room of 8 MiB. */
enum { FEW = 64, TOGETHER = 1 << 19, A_BUCKET = 4 };

static int in_order(const double *t, Index count)
{
    for (Index r = 1; r < count; r++)
        if (!(t[r - 1] <= t[r]))
            return 0;
    return 1;
}

static inline Index bucket_of(double t, double low, double scale, Index last)
{
    double place = (t - low) * scale;
    return place > 0.0 ? (place < (double)last ? (Index)place : last) : 0;
}

/* Deal parameters into equal buckets of the domain: neighbours come together. */
static void sort_roughly(const double *t, Index first, Index count, double low, double high,
                         Index *stops, Wanted *sorted)
{
    Index buckets = at_least(count / A_BUCKET, 1), last = buckets - 1;
    double scale = (double)buckets / (high - low);
    memset(stops, 0, (size_t)(buckets + 1) * sizeof(Index));
    for (Index r = first; r < first + count; r++)
        stops[bucket_of(t[r], low, scale, last) + 1]++;
    for (Index b = 0; b < buckets; b++)
        stops[b + 1] += stops[b];
    for (Index r = first; r < first + count; r++)
        sorted[stops[bucket_of(t[r], low, scale, last)]++] = (Wanted){t[r], r};
}

METHOD(core_points)
{
    /* knots, points, weights or None (each an array, a tuple of blocks, or a rope), degree, t (m,) or a
    number, the order of the derivative (0 with weights), whether the left side is meant, whether a
    control point at a knot of full multiplicity is the curve's point there, found (m, d) */
    Call call;
    begin(&call, count, 9);
    if (call.failed)
        return finish(&call, NULL);
    Reader reader = {.degree = integer(&call, values[3]), .order = integer(&call, values[5]),
                     .left = integer(&call, values[6]) != 0,
                     .settled = integer(&call, values[7]) != 0,
                     .rational = values[2] != Py_None};
    Index p = reader.degree, m = 1;
    expect(&call, p >= 1 && p < 1 << 20 && reader.order >= 0 && reader.order <= p,
           "a degree of 1 or more is wanted, and no derivative of a higher order");
    expect(&call, !reader.rational || !reader.order, "a rational spline has points only");
    reader.knots = rope_of(&call, values[0]);
    reader.points = rope_of(&call, values[1]);
    if (reader.rational)
        reader.weights = rope_of(&call, values[2]);
    double number = 0.0;
    const double *t = &number;
    if (PyFloat_Check(values[4]))
        number = real(&call, values[4]);
    else {
        Table all = reals(&call, values[4]);
        t = all.at;
        m = all.rows * all.columns;
    }
    Table found = output(&call, values[8]);
    Index n = rope_length(&reader.points), d = reader.points.columns;
    expect(&call, n > p && rope_length(&reader.knots) == n + p + 1 && reader.knots.columns == 1,
           "a spline needs n + p + 1 knots for n points, n > p");
    expect(&call,
           !reader.rational || (rope_length(&reader.weights) == n && reader.weights.columns == 1),
           "a weight for each point is wanted");
    expect(&call, found.rows * found.columns == m * d, "room for a point a parameter is wanted");
    reader.knot_room = scratch(&call, 2 * p + (p + 1) * (2 * d + 3) + d + 1);
    if (call.failed)
        return finish(&call, NULL);
    reader.point_room = reader.knot_room + 2 * p;
    reader.weight_room = reader.point_room + (p + 1) * d;
    reader.net_room = reader.weight_room + p + 1;
    reader.basis = reader.net_room + (p + 1) * (d + 1);
    double low = knot_at(&reader.knots, p), high = knot_at(&reader.knots, n);
    reader.first = p;
    while (reader.first < n - 1 && !(knot_at(&reader.knots, reader.first + 1) > low))
        reader.first++;
    reader.last = n - 1;
    while (reader.last > reader.first && !(knot_at(&reader.knots, reader.last) < high))
        reader.last--;
    reader.near = reader.first;
    reader.span = -1;
    reader.low = INFINITY;
    if (m < FEW || !(high > low) || in_order(t, m)) {
        Wanted wanted[GROUP];
        for (Index r = 0; r < m; r += GROUP) {
            Index some = at_most(GROUP, m - r);
            for (Index g = 0; g < some; g++)
                wanted[g] = (Wanted){t[r + g], r + g};
            read_points(&reader, wanted, some, found.at);
        }
        return finish(&call, Py_NewRef(Py_None));
    }
    Index most = at_most(m, TOGETHER);
    Index *stops = index_scratch(&call, most / A_BUCKET + 1);
    Wanted *sorted = (Wanted *)index_scratch(&call, 2 * most);
    for (Index first = 0; first < m && !call.failed; first += most) {
        Index count = at_most(most, m - first);
        sort_roughly(t, first, count, low, high, stops, sorted);
        read_points(&reader, sorted, count, found.at);
    }
    return finish(&call, Py_NewRef(Py_None));
}
