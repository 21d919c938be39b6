/* Nearest places in a tree of capsules; see multirep.nearest_tree. */
#include "capsules.h"
#include "closest.h"

#include <stdlib.h>
#include <string.h>

#define NAME "multirep.leaf"

/* -- leaves, made once --------------------------------------------------------------------------- */

/* Neighbouring pieces, and the capsules around `fan` of them each. */
typedef struct {
    Nodes pieces, groups;
    const double *starts, *stops, *hulls;
    Index fan, degree, width; /* the hulls are (degree + 1, width, pieces); without width is 0 */
    PyObject *arrays;
} Leaf;

static void release(PyObject *capsule)
{
    Leaf *leaf = PyCapsule_GetPointer(capsule, NAME);
    Py_DECREF(leaf->arrays);
    free(leaf);
}

METHOD(core_leaf)
{
    /* starts and stops of pieces (k,), their capsules, those around `fan` of them each, hulls
    (p + 1, D, k) or None, fan; returns a leaf, which keeps the arrays */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Table starts = reals(&call, values[0]), stops = reals(&call, values[1]);
    Table pieces = reals(&call, values[2]), groups = reals(&call, values[3]);
    Table hulls = reals_or_none(&call, values[4]);
    Index fan = integer(&call, values[5]), d = pieces.rows / 2 - 1, k = starts.rows;
    Leaf leaf = {nodes_of(&call, pieces, d), nodes_of(&call, groups, d), starts.at, stops.at, hulls.at,
                 fan, hulls.at ? hulls.rows - 1 : 0, hulls.at && k ? hulls.columns / k : 0, NULL};
    expect(&call, call.failed || !call.held, "the arrays of a leaf must lie row after row");
    expect(&call, stops.rows == k && pieces.columns == k,
           "two ends and a capsule of each piece are wanted");
    expect(&call, fan > 0 && groups.columns == (k + fan - 1) / fan,
           "a capsule around each few pieces is wanted");
    expect(&call,
           !hulls.at || (hulls.columns == leaf.width * k && leaf.degree >= 1 && leaf.degree < 512 &&
                         (leaf.width == d || leaf.width == d + 1)),
           "hulls are p + 1 rows of each piece");
    Leaf *kept = call.failed ? NULL : malloc(sizeof(Leaf));
    leaf.arrays =
        kept ? PyTuple_Pack(5, values[0], values[1], values[2], values[3], values[4]) : NULL;
    PyObject *capsule = NULL;
    if (leaf.arrays) {
        *kept = leaf;
        capsule = PyCapsule_New(kept, NAME, release);
    } else if (!call.failed && !kept)
        PyErr_NoMemory();
    if (!capsule) {
        Py_XDECREF(leaf.arrays);
        free(kept);
        call.failed = 1;
    }
    return finish(&call, capsule);
}

/* -- candidates ---------------------------------------------------------------------------------- */

/* A capsule that may hold the nearest place, of a leaf or above all leaves. */
typedef struct {
    double least, u;
    const Leaf *leaf;
    Index at;
} Candidate;

/* Some of them; the nearest place is not farther than `reach`. */
typedef struct {
    Candidate *at;
    Index count, room;
    double reach;
} Row;

static int by_least(const void *one, const void *other)
{
    double a = ((const Candidate *)one)->least, b = ((const Candidate *)other)->least;
    return (a > b) - (a < b);
}

static void empty(Row *row)
{
    row->count = 0;
    row->reach = INFINITY;
}

/* Look at some capsules. */
static void look(Call *call, Row *row, const Nodes *nodes, Index first, Index stop, const Leaf *leaf,
                 const double *point)
{
    if (row->count + stop - first > row->room) {
        Index room = 2 * (row->count + stop - first);
        Candidate *at = realloc(row->at, (size_t)room * sizeof(Candidate));
        if (!at) {
            PyErr_NoMemory();
            call->failed = 1;
            return;
        }
        row->at = at;
        row->room = room;
    }
    for (Index k = first; k < stop; k++) {
        double u, away = distance_of(nodes, k, point, &u), radius = *radius_of(nodes, k);
        if (away - radius <= row->reach)
            row->at[row->count++] = (Candidate){away - radius, u, leaf, k};
        row->reach = smaller(row->reach, away + radius);
    }
}

/* Drop what begins behind the reach. */
static void settle(Row *row)
{
    Index kept = 0;
    for (Index j = 0; j < row->count; j++)
        if (row->at[j].least <= row->reach)
            row->at[kept++] = row->at[j];
    row->count = kept;
}

/* -- the search ---------------------------------------------------------------------------------- */

enum { MOST_LEVELS = 10 };

typedef struct {
    Nodes levels[MOST_LEVELS]; /* each around `fan` of the next, the last around leaves */
    Index count, fan, dimension;
    PyObject *leaves, *missing; /* lists */
    Row here, next;
    Seeker seeker;
} Search;

static void swap(Search *search)
{
    Row row = search->here;
    search->here = search->next;
    search->next = row;
    empty(&search->next);
}

static void read_levels(Call *call, Search *search, PyObject *levels)
{
    expect(call, PyTuple_Check(levels) && PyTuple_Size(levels) > 0 &&
                     PyTuple_Size(levels) <= MOST_LEVELS,
           "a tuple of capsules is wanted, level by level");
    search->count = call->failed ? 0 : PyTuple_Size(levels);
    for (Index k = 0; k < search->count && !call->failed; k++) {
        Table table = reals(call, PyTuple_GetItem(levels, k));
        if (!k)
            search->dimension = table.rows / 2 - 1;
        search->levels[k] = nodes_of(call, table, search->dimension);
        expect(call, !k || search->levels[k - 1].count ==
                               (search->levels[k].count + search->fan - 1) / search->fan,
               "a capsule around each few of the next level is wanted");
    }
    expect(call, call->failed || (PyList_Check(search->leaves) &&
                     PyList_Size(search->leaves) == search->levels[search->count - 1].count),
           "a list of as many leaves as there are capsules is wanted");
}

/* The capsules of the last level that may hold the nearest place. */
static void descend(Call *call, Search *search, const double *point)
{
    empty(&search->here);
    empty(&search->next);
    look(call, &search->here, search->levels, 0, search->levels[0].count, NULL, point);
    settle(&search->here);
    for (Index level = 1; level < search->count && !call->failed; level++) {
        const Nodes *nodes = &search->levels[level];
        for (Index j = 0; j < search->here.count && !call->failed; j++) {
            Index first = search->fan * search->here.at[j].at;
            look(call, &search->next, nodes, first, at_most(first + search->fan, nodes->count), NULL,
                 point);
        }
        settle(&search->next);
        swap(search);
    }
}

/* Put leaves in the place of capsules around them; of those that are not made, say which. */
static int find_leaves(Call *call, Search *search)
{
    int found = 1;
    for (Index j = 0; j < search->here.count && !call->failed; j++) {
        Index at = search->here.at[j].at;
        PyObject *capsule = PyList_GetItem(search->leaves, at);
        if (capsule == Py_None) {
            PyObject *number = PyLong_FromSsize_t(at);
            found = 0;
            call->failed |= !number || PyList_Append(search->missing, number) < 0;
            Py_XDECREF(number);
            continue;
        }
        const Leaf *leaf = capsule ? PyCapsule_GetPointer(capsule, NAME) : NULL;
        if (!leaf) {
            call->failed = 1;
            return 0;
        }
        Seeker *seeker = &search->seeker;
        if (!seeker->degree && leaf->width)
            *seeker = seeker_of(call, leaf->degree, leaf->pieces.dimension,
                                leaf->width > leaf->pieces.dimension);
        expect(call, leaf->pieces.dimension == search->dimension && leaf->degree == seeker->degree &&
                         (!leaf->width || seeker->rational == (leaf->width > search->dimension)),
               "leaves of one curve are wanted");
        search->here.at[j].leaf = leaf;
    }
    return found && !call->failed;
}

/* The pieces of leaves that may hold the nearest place. */
static void find_pieces(Call *call, Search *search, const double *point)
{
    for (Index j = 0; j < search->here.count && !call->failed; j++) {
        const Leaf *leaf = search->here.at[j].leaf;
        look(call, &search->next, &leaf->groups, 0, leaf->groups.count, leaf, point);
    }
    settle(&search->next);
    swap(search);
    for (Index j = 0; j < search->here.count && !call->failed; j++) {
        const Leaf *leaf = search->here.at[j].leaf;
        Index first = leaf->fan * search->here.at[j].at;
        look(call, &search->next, &leaf->pieces, first, at_most(first + leaf->fan, leaf->pieces.count),
             leaf, point);
    }
    settle(&search->next);
    swap(search);
}

/* The parameter of the nearest place of these pieces. */
static double decide(Call *call, Search *search, const double *point, double slack)
{
    Row *row = &search->here;
    if (call->failed || !row->count)
        return NAN;
    qsort(row->at, (size_t)row->count, sizeof(Candidate), by_least);
    Candidate best = row->at[0];
    double distance = INFINITY, at = best.u;
    for (Index j = 0; j < row->count && row->at[j].least <= distance && !call->failed; j++) {
        const Leaf *leaf = row->at[j].leaf;
        if (!leaf->width)
            break; /* the pieces are their chords */
        seeker_take(&search->seeker, leaf->hulls, leaf->pieces.count, row->at[j].at, point);
        if (seeker_may(&search->seeker, distance, slack) &&
            seeker_finds(call, &search->seeker, row->at[j].u, slack, &distance, &at))
            best = row->at[j];
    }
    double start = best.leaf->starts[best.at], stop = best.leaf->stops[best.at];
    return smaller(larger(start + at * (stop - start), start), stop);
}

METHOD(core_nearest)
{
    /* capsules level by level, each around `fan` of the next, the last around leaves; a list of the
    leaves, None for those that are not made; fan; points (m, d); how much nearer than the answer
    another place may be, and what to add to that for each unit of a point's largest coordinate; the
    parameters found (m,). Returns the numbers of leaves to be made first: without any all are found. */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Search search = {.leaves = values[1], .fan = integer(&call, values[2])};
    expect(&call, search.fan > 0, "a capsule holds some others");
    read_levels(&call, &search, values[0]);
    Table points = reals(&call, values[3]), found = output(&call, values[6]);
    double slack = real(&call, values[4]), unit = real(&call, values[5]);
    Index d = search.dimension, m = found.rows * found.columns;
    expect(&call, points.rows * points.columns == m * d, "room for a parameter of each point is wanted");
    search.missing = call.failed ? NULL : PyList_New(0);
    call.failed |= !search.missing;
    for (Index r = 0; r < m && !call.failed; r++) {
        const double *point = points.at + r * d;
        double largest = 0.0;
        for (Index c = 0; c < d; c++)
            largest = larger(largest, fabs(point[c]));
        descend(&call, &search, point);
        if (call.failed || !find_leaves(&call, &search))
            continue;
        find_pieces(&call, &search, point);
        found.at[r] = decide(&call, &search, point, slack + unit * largest);
    }
    free(search.here.at);
    free(search.next.at);
    seeker_end(&search.seeker);
    return finish(&call, search.missing);
}
