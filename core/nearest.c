/* Nearest places in a tree of capsules; see multirep.nearest_tree. */
#include "closest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Capsules as columns: start (d), chord (d), 1 / length**2, radius. */
typedef struct {
    const double *at;
    Index count, dimension;
} Nodes;

static Nodes nodes_of(Call *call, Table table, Index dimension)
{
    expect(call, table.rows == 2 * dimension + 2 && table.columns > 0,
           "capsules are columns of 2 d + 2 numbers");
    return (Nodes){table.at, table.columns, dimension};
}

/* The distance of a point from the chord of a capsule; u is the place on it. */
static inline double distance_of(const Nodes *nodes, Index k, const double *point, double *u)
{
    Index d = nodes->dimension, count = nodes->count;
    const double *start = nodes->at + k, *chord = start + d * count;
    double along = 0.0, square = 0.0;
    for (Index c = 0; c < d; c++)
        along += (point[c] - start[c * count]) * chord[c * count];
    along *= chord[d * count];
    along = along > 0.0 ? (along < 1.0 ? along : 1.0) : 0.0;
    for (Index c = 0; c < d; c++) {
        double offset = point[c] - start[c * count] - along * chord[c * count];
        square += offset * offset;
    }
    *u = along;
    return sqrt(square);
}

static inline double radius_of(const Nodes *nodes, Index k)
{
    return nodes->at[(2 * nodes->dimension + 1) * nodes->count + k];
}

METHOD(core_capsule)
{
    /* points (k, d), both ends (2, d) of a stretch in their hull, what rounding may be as a part of
    the largest coordinate, the capsule found (2 d + 2,) */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table points = reals(&call, values[0]), ends = reals(&call, values[1]);
    double part = real(&call, values[2]), square = 0.0, far = 0.0, largest = 0.0;
    Table found = output(&call, values[3]);
    Index d = points.columns;
    expect(&call, ends.rows == 2 && ends.columns == d && found.rows * found.columns == 2 * d + 2,
           "two ends and room for a capsule are wanted");
    if (call.failed)
        return finish(&call, NULL);
    Nodes capsule = {found.at, 1, d};
    double *chord = found.at + d, *inverse = chord + d, *radius = inverse + 1;
    *radius = 0.0;
    for (Index c = 0; c < d; c++) {
        found.at[c] = ends.at[c];
        chord[c] = ends.at[d + c] - ends.at[c];
        square += chord[c] * chord[c];
    }
    *inverse = 1.0 / square;
    if (!isfinite(*inverse)) { /* so short that it is the point where it starts */
        *inverse = 0.0;
        for (Index c = 0; c < d; c++)
            *radius += fabs(chord[c]);
    }
    for (Index r = 0; r < points.rows; r++) {
        double u, away = distance_of(&capsule, 0, points.at + r * d, &u);
        far = larger(far, away);
        for (Index c = 0; c < d; c++)
            largest = larger(largest, fabs(points.at[r * d + c]));
    }
    *radius += far + part * largest;
    return finish(&call, Py_NewRef(Py_None));
}

/* -- which leaves ------------------------------------------------------------------------------ */

typedef struct {
    Index *at, count, room;
} Row;

static void append(Call *call, Row *row, Index number)
{
    if (row->count == row->room) {
        Index room = 2 * row->room + 64, *at = realloc(row->at, (size_t)room * sizeof(Index));
        if (!at) {
            PyErr_NoMemory();
            call->failed = 1;
            return;
        }
        row->at = at;
        row->room = room;
    }
    row->at[row->count++] = number;
}

/* Append the capsules among some that may hold the nearest place. */
static void keep(Call *call, const Nodes *nodes, const double *point, const Index *among,
                 Index count, double *least, Row *row)
{
    double reach = INFINITY, u;
    for (Index j = 0; j < count; j++) {
        Index k = among ? among[j] : j;
        double away = distance_of(nodes, k, point, &u), radius = radius_of(nodes, k);
        least[j] = away - radius;
        reach = smaller(reach, away + radius);
    }
    for (Index j = 0; j < count && !call->failed; j++)
        if (least[j] <= reach)
            append(call, row, among ? among[j] : j);
}

METHOD(core_near)
{
    /* capsules around leaves, those around `fan` of them each or None, fan, points (m, d); returns,
    as bytes, where the leaves of each point begin (m + 1,), and the leaves that may hold its
    nearest place */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table points = reals(&call, values[3]);
    Index d = points.columns, m = points.rows, fan = integer(&call, values[2]);
    Nodes tops = nodes_of(&call, reals(&call, values[0]), d), crowns = {NULL, 0, d};
    if (values[1] != Py_None)
        crowns = nodes_of(&call, reals(&call, values[1]), d);
    expect(&call, fan > 0 && (!crowns.count || crowns.count == (tops.count + fan - 1) / fan),
           "a capsule around each few leaves is wanted");
    double *least = scratch(&call, tops.count);
    Index *children = index_scratch(&call, tops.count), *firsts = index_scratch(&call, m + 1);
    Row row = {NULL, 0, 0}, high = {NULL, 0, 0};
    for (Index r = 0; r < m && !call.failed; r++) {
        const double *point = points.at + r * d;
        firsts[r] = row.count;
        if (!crowns.count) {
            keep(&call, &tops, point, NULL, tops.count, least, &row);
            continue;
        }
        Index some = 0;
        high.count = 0;
        keep(&call, &crowns, point, NULL, crowns.count, least, &high);
        for (Index j = 0; j < high.count; j++)
            for (Index k = fan * high.at[j]; k < at_most(fan * (high.at[j] + 1), tops.count); k++)
                children[some++] = k;
        keep(&call, &tops, point, children, some, least, &row);
    }
    PyObject *found = NULL;
    if (!call.failed) {
        firsts[m] = row.count;
        found = pair_of(&call, bytes_of(firsts, (m + 1) * (Index)sizeof(Index)),
                        bytes_of(row.at, row.count * (Index)sizeof(Index)));
    }
    free(row.at);
    free(high.at);
    return finish(&call, found);
}

/* -- which place ------------------------------------------------------------------------------- */

/* The pieces of a leaf. */
typedef struct {
    const double *starts, *stops, *hulls;
    Nodes nodes;
} Leaf;

/* The next array of a tuple. Its buffer need not stay open, since the tuple keeps it. */
static Table taken(Call *call, PyObject *tuple, Index at)
{
    Table none = {NULL, 0, 0};
    if (call->failed)
        return none;
    int held = call->held;
    Table table = reals(call, PyTuple_GetItem(tuple, at));
    expect(call, call->held == held, "the arrays of a leaf must lie row after row");
    if (!call->failed)
        PyBuffer_Release(&call->views[--call->opened]);
    return table;
}

static Leaf leaf_of(Call *call, PyObject *arrays, Index dimension, Table *hulls)
{
    Leaf leaf = {NULL, NULL, NULL, {NULL, 0, dimension}};
    expect(call, PyTuple_Check(arrays) && PyTuple_Size(arrays) == 4,
           "starts, stops, capsules and hulls of each leaf are wanted");
    Table starts = taken(call, arrays, 0), stops = taken(call, arrays, 1);
    leaf.nodes = nodes_of(call, taken(call, arrays, 2), dimension);
    *hulls = (Table){NULL, 0, 0};
    if (!call->failed && PyTuple_GetItem(arrays, 3) != Py_None)
        *hulls = taken(call, arrays, 3);
    expect(call, starts.rows == leaf.nodes.count && stops.rows == leaf.nodes.count,
           "two ends of each piece are wanted");
    leaf.starts = starts.at;
    leaf.stops = stops.at;
    leaf.hulls = hulls->at;
    return leaf;
}

/* A piece that may hold the nearest place. */
typedef struct {
    double least, u;
    Index leaf, piece;
} Candidate;

static int by_least(const void *one, const void *other)
{
    double a = ((const Candidate *)one)->least, b = ((const Candidate *)other)->least;
    return (a > b) - (a < b);
}

METHOD(core_nearest)
{
    /* leaves, a tuple of (starts, stops, capsules, hulls (p + 1, D, k) or None); points (m, d); how
    much nearer than the answer another place may be (m,); where the leaves of each point begin
    (m + 1,) and which they are; the parameters found (m,) */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Table points = reals(&call, values[1]), slacks = reals(&call, values[2]);
    Places firsts = places(&call, values[3]), which = places(&call, values[4]);
    Table found = output(&call, values[5]);
    Index d = points.columns, m = points.rows, degree = 0, width = 0, most = 0, total = 0;
    expect(&call, slacks.rows == m && found.rows == m && firsts.rows == m + 1 && d > 0,
           "a slack and a parameter of each point are wanted");
    expect(&call, PyTuple_Check(values[0]), "a tuple of leaves is wanted");
    Index leaves = call.failed ? 0 : PyTuple_Size(values[0]);
    Leaf *all = (Leaf *)scratch(&call, leaves * (Index)(sizeof(Leaf) / sizeof(double)));
    for (Index k = 0; k < leaves && !call.failed; k++) {
        Table hulls;
        all[k] = leaf_of(&call, PyTuple_GetItem(values[0], k), d, &hulls);
        Index pieces = all[k].nodes.count;
        if (call.failed)
            break;
        if (!k) {
            degree = hulls.rows - 1;
            width = hulls.at ? hulls.columns / pieces : 0;
        }
        expect(&call,
               hulls.at ? hulls.rows == degree + 1 && hulls.columns == width * pieces &&
                              degree >= 1 && degree < 512 && (width == d || width == d + 1)
                        : !width,
               "hulls are p + 1 rows of each piece, in all leaves or in none");
        most = at_least(most, pieces);
    }
    for (Index r = 0; r < m && !call.failed; r++) {
        Index first = firsts.at[r], stop = firsts.at[r + 1], some = 0;
        expect(&call, 0 <= first && first < stop && stop <= which.rows, "each point has leaves");
        for (Index j = first; j < stop && !call.failed; j++) {
            expect(&call, 0 <= which.at[j] && which.at[j] < leaves, "there is no such leaf");
            some += call.failed ? 0 : all[which.at[j]].nodes.count;
        }
        total = at_least(total, some);
    }
    Candidate *near = (Candidate *)scratch(&call, total * (Index)(sizeof(Candidate) / sizeof(double)));
    Seeker seeker = seeker_of(&call, at_least(degree, 1), d, width > d);
    for (Index r = 0; r < m && !call.failed; r++) {
        const double *point = points.at + r * d;
        double reach = INFINITY, slack = slacks.at[r];
        Index some = 0, kept = 0;
        for (Index j = firsts.at[r]; j < firsts.at[r + 1]; j++) {
            const Nodes *nodes = &all[which.at[j]].nodes;
            for (Index k = 0; k < nodes->count; k++) {
                double u, away = distance_of(nodes, k, point, &u), radius = radius_of(nodes, k);
                if (away - radius <= reach)
                    near[some++] = (Candidate){away - radius, u, which.at[j], k};
                reach = smaller(reach, away + radius);
            }
        }
        for (Index j = 0; j < some; j++)
            if (near[j].least <= reach)
                near[kept++] = near[j];
        qsort(near, (size_t)kept, sizeof(Candidate), by_least);
        Candidate best = near[0];
        double distance = INFINITY, at = best.u;
        for (Index j = 0; width && j < kept && near[j].least <= distance && !call.failed; j++) {
            const Leaf *leaf = &all[near[j].leaf];
            seeker_take(&seeker, leaf->hulls, leaf->nodes.count, near[j].piece, point);
            if (seeker_may(&seeker, distance, slack) &&
                seeker_finds(&call, &seeker, near[j].u, slack, &distance, &at))
                best = near[j];
        }
        const Leaf *leaf = &all[best.leaf];
        double start = leaf->starts[best.piece], end = leaf->stops[best.piece];
        found.at[r] = smaller(larger(start + at * (end - start), start), end);
    }
    seeker_end(&seeker);
    return finish(&call, Py_NewRef(Py_None));
}
