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

/* -- the search ---------------------------------------------------------------------------------- */

enum { MOST_LEVELS = 10 };

/* A capsule that may hold the nearest place: how far it is at least, and where on its chord. */
typedef struct {
    double least, u;
    Index at;
} Candidate;

typedef struct {
    Nodes levels[MOST_LEVELS]; /* each around `fan` of the next, the last around leaves */
    Index count, fan, dimension;
    PyObject *leaves, *missing; /* lists */
    Candidate *stack;           /* those that wait, of each level on the way down */
    Index height, room;
    Seeker seeker;
    /* for the point at hand: the nearest place is not farther than `reach`, and the one found, on a
    piece of a leaf, no farther than the nearest one and the slack */
    const double *point;
    double slack, reach, distance, u;
    const Leaf *leaf;
    Index piece;
} Search;

static void read_levels(Call *call, Search *search, PyObject *levels)
{
    expect(call,
           PyTuple_Check(levels) && PyTuple_Size(levels) > 0 && PyTuple_Size(levels) <= MOST_LEVELS,
           "a tuple of capsules is wanted, level by level");
    search->count = call->failed ? 0 : PyTuple_Size(levels);
    for (Index k = 0; k < search->count && !call->failed; k++) {
        Table table = reals(call, PyTuple_GetItem(levels, k));
        if (!k)
            search->dimension = table.rows / 2 - 1;
        search->levels[k] = nodes_of(call, table, search->dimension);
        expect(call,
               !k || search->levels[k - 1].count ==
                         (search->levels[k].count + search->fan - 1) / search->fan,
               "a capsule around each few of the next level is wanted");
    }
    expect(call,
           call->failed || (PyList_Check(search->leaves) &&
                            PyList_Size(search->leaves) == search->levels[search->count - 1].count),
           "a list of as many leaves as there are capsules is wanted");
}

/* A leaf; of one that is not made, say which. */
static const Leaf *leaf_at(Call *call, Search *search, Index at)
{
    PyObject *capsule = PyList_GetItem(search->leaves, at);
    if (capsule == Py_None) {
        PyObject *number = PyLong_FromSsize_t(at);
        call->failed |= !number || PyList_Append(search->missing, number) < 0;
        Py_XDECREF(number);
        return NULL;
    }
    const Leaf *leaf = capsule ? PyCapsule_GetPointer(capsule, NAME) : NULL;
    if (!leaf) {
        call->failed = 1;
        return NULL;
    }
    Index d = search->dimension;
    Seeker *seeker = &search->seeker;
    if (leaf->width && !seeker->degree)
        *seeker = seeker_of(call, leaf->degree, d, leaf->width > d);
    expect(call,
           leaf->pieces.dimension == d && leaf->degree == seeker->degree &&
               (!leaf->width || seeker->rational == (leaf->width > d)),
           "leaves of one curve are wanted");
    return call->failed ? NULL : leaf;
}

static inline void look_at(Search *search, const Nodes *nodes, Index first, Index stop,
                           Index dimension)
{
    double reach = search->reach;
    Candidate *next = search->stack + search->height;
    for (Index k = first; k < stop; k++) {
        double radius = *radius_of(nodes, k), far = reach + search->slack + radius, u;
        double square = square_of(nodes, k, search->point, dimension, &u);
        if (!(square <= far * far))
            continue; /* most: without a root */
        double away = sqrt(square);
        *next++ = (Candidate){away - radius, u, k};
        reach = smaller(reach, away + radius);
    }
    search->height = next - search->stack;
    search->reach = reach;
}

/* Put those of some capsules on the stack that may hold the nearest place, the nearest first. */
static void look(Call *call, Search *search, const Nodes *nodes, Index first, Index stop)
{
    Index begin = search->height, most = begin + stop - first;
    if (most > search->room) {
        Candidate *stack = realloc(search->stack, (size_t)(2 * most) * sizeof(Candidate));
        if (!stack) {
            PyErr_NoMemory();
            call->failed = 1;
            return;
        }
        search->stack = stack;
        search->room = 2 * most;
    }
    if (nodes->dimension == 2)
        look_at(search, nodes, first, stop, 2);
    else
        look_at(search, nodes, first, stop, nodes->dimension);
    Candidate *found = search->stack + begin;
    for (Index j = 1; j < search->height - begin; j++) {
        Candidate one = found[j];
        Index to = j;
        for (; to && found[to - 1].least > one.least; to--)
            found[to] = found[to - 1];
        found[to] = one;
    }
}

/* Look for a nearer place on a piece. */
static void try_piece(Call *call, Search *search, const Leaf *leaf, Candidate piece)
{
    Seeker *seeker = &search->seeker;
    int nearer = !search->leaf;
    if (!leaf->width) { /* the piece is its chord */
        nearer |= piece.least < search->distance;
        if (nearer)
            search->distance = piece.least;
    } else {
        seeker_take(seeker, leaf->hulls, leaf->pieces.count, piece.at, search->point);
        if (seeker_may(seeker, search->distance, search->slack))
            nearer |= seeker_finds(call, seeker, piece.u, search->slack, &search->distance, &piece.u);
        search->reach = smaller(search->reach, search->distance);
    }
    if (nearer) {
        search->leaf = leaf;
        search->piece = piece.at;
        search->u = piece.u;
    }
}

/* Go down into those of some capsules that may hold the nearest place, the nearest first. Levels are
followed by the groups of a leaf, and these by its pieces. */
static void go_down(Call *call, Search *search, Index level, const Leaf *leaf, Index first,
                    Index stop)
{
    Index begin = search->height, last = search->count - 1;
    const Nodes *nodes = level <= last       ? &search->levels[level]
                         : level == last + 1 ? &leaf->groups
                                             : &leaf->pieces;
    look(call, search, nodes, first, at_most(stop, nodes->count));
    Index end = search->height;
    for (Index j = begin; j < end && !call->failed; j++) {
        Candidate one = search->stack[j];
        if (one.least > search->reach + search->slack)
            break;
        if (level == last) {
            const Leaf *below = leaf_at(call, search, one.at);
            if (below)
                go_down(call, search, level + 1, below, 0, below->groups.count);
        } else if (level <= last + 1) {
            Index fan = leaf ? leaf->fan : search->fan;
            go_down(call, search, level + 1, leaf, fan * one.at, fan * (one.at + 1));
        } else
            try_piece(call, search, leaf, one);
    }
    search->height = begin;
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
    expect(&call, points.rows * points.columns == m * d,
           "room for a parameter of each point is wanted");
    search.missing = call.failed ? NULL : PyList_New(0);
    call.failed |= !search.missing;
    for (Index r = 0; r < m && !call.failed; r++) {
        double largest = 0.0;
        search.point = points.at + r * d;
        for (Index c = 0; c < d; c++)
            largest = larger(largest, fabs(search.point[c]));
        search.slack = slack + unit * largest;
        search.reach = search.distance = INFINITY;
        search.leaf = NULL;
        go_down(&call, &search, 0, NULL, 0, search.levels[0].count);
        found.at[r] = NAN;
        if (!search.leaf)
            continue;
        double start = search.leaf->starts[search.piece], stop = search.leaf->stops[search.piece];
        found.at[r] = smaller(larger(start + search.u * (stop - start), start), stop);
    }
    free(search.stack);
    seeker_end(&search.seeker);
    return finish(&call, search.missing);
}
