/* Capsules around stretches of a curve; see multirep.capsules. */
#include "capsules.h"

/* A capsule of no radius from start to stop, but for what is so short that its square vanishes: that
is the point where it starts. */
static void lay(const Nodes *nodes, Index k, const double *start, const double *stop)
{
    Index d = nodes->dimension, count = nodes->count;
    double *at = nodes->at + k, square = 0.0, length = 0.0;
    for (Index c = 0; c < d; c++) {
        double chord = stop[c] - start[c];
        at[c * count] = start[c];
        at[(d + c) * count] = chord;
        square += chord * chord;
        length += fabs(chord);
    }
    int is_chord = isfinite(1.0 / square);
    at[2 * d * count] = is_chord ? 1.0 / square : 0.0;
    *radius_of(nodes, k) = is_chord ? 0.0 : length;
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
    double part = real(&call, values[2]), far = 0.0, largest = 0.0;
    Table found = output(&call, values[3]);
    Index d = points.columns;
    expect(&call, ends.rows == 2 && ends.columns == d && found.rows * found.columns == 2 * d + 2,
           "two ends and room for a capsule are wanted");
    if (call.failed)
        return finish(&call, NULL);
    Nodes capsule = {found.at, 1, d};
    lay(&capsule, 0, ends.at, ends.at + d);
    for (Index r = 0; r < points.rows; r++) {
        far = larger(far, distance_of(&capsule, 0, points.at + r * d));
        for (Index c = 0; c < d; c++)
            largest = larger(largest, fabs(points.at[r * d + c]));
    }
    *radius_of(&capsule, 0) += far + part * largest;
    return finish(&call, Py_NewRef(Py_None));
}

/* The ends of a capsule. */
static void ends_of(const Nodes *nodes, Index k, double *start, double *stop)
{
    Index d = nodes->dimension, count = nodes->count;
    for (Index c = 0; c < d; c++) {
        start[c] = nodes->at[c * count + k];
        stop[c] = start[c] + nodes->at[(d + c) * count + k];
    }
}

METHOD(core_merged_capsules)
{
    /* capsules (2 d + 2, k), how many of them each of the new ones holds, what rounding may be as a
    part of the largest coordinate, the new ones (2 d + 2, ..) */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table table = reals(&call, values[0]), found = output(&call, values[3]);
    Index fan = integer(&call, values[1]), d = table.rows / 2 - 1;
    double part = real(&call, values[2]);
    Nodes nodes = nodes_of(&call, table, d), around = nodes_of(&call, found, d);
    expect(&call, fan > 0 && around.count == (nodes.count + fan - 1) / fan,
           "room for a capsule around each few is wanted");
    double *start = scratch(&call, 4 * d);
    if (call.failed)
        return finish(&call, NULL);
    double *stop = start + d, *low = stop + d, *high = low + d;
    for (Index k = 0; k < around.count; k++) {
        Index first = k * fan, last = at_most(first + fan, nodes.count) - 1;
        double far = 0.0, largest = 0.0;
        ends_of(&nodes, first, start, high);
        ends_of(&nodes, last, low, stop);
        lay(&around, k, start, stop);
        /* the distance to a chord is convex: within a capsule it is largest at an end */
        for (Index i = first; i <= last; i++) {
            ends_of(&nodes, i, low, high);
            double one = distance_of(&around, k, low), other = distance_of(&around, k, high);
            far = larger(far, larger(one, other) + *radius_of(&nodes, i));
        }
        for (Index c = 0; c < 2 * d; c++)
            largest = larger(largest, fabs(around.at[c * around.count + k]));
        *radius_of(&around, k) += far + part * largest;
    }
    return finish(&call, Py_NewRef(Py_None));
}
