/* The knots that a spliced window begins with; see multirep.representations.nurbs.refinement. */
#include "core.h"

#include <math.h>
#include <string.h>

/* Drop the lesser of two breakpoints closer than `least`, but never an end; returns how many stay.
`dropped` has room for all. */
static Index spread_apart(double *at, Index *times, Index count, double least, Index *dropped)
{
    Index last = count - 1, kept = 0;
    memset(dropped, 0, (size_t)count * sizeof(Index));
    for (Index i = 0; i < last; i++)
        if (at[i + 1] - at[i] < least) {
            Index lesser = times[i] < times[i + 1] || i + 1 == last ? i : i + 1;
            dropped[lesser] = lesser > 0;
        }
    for (Index i = 0; i < count; i++)
        if (!dropped[i]) {
            at[kept] = at[i];
            times[kept++] = times[i];
        }
    return kept;
}

METHOD(core_breakpoints)
{
    /* knots strictly between two ends, the ends, how often these are knots, degree, t (m + 1,) of a
    course from end to end, heights (m - 1,) of its inner vertices, from where on they make a corner,
    from where on they keep one, in terms of the ends' distance how near two breakpoints may be;
    returns breakpoints and how often they are knots, as bytes */
    Call call;
    begin(&call, count, 11);
    if (call.failed)
        return finish(&call, NULL);
    Table knots = reals(&call, values[0]), t = reals(&call, values[6]);
    Table heights = reals(&call, values[7]);
    double start = real(&call, values[1]), stop = real(&call, values[2]);
    Index first = integer(&call, values[3]), last = integer(&call, values[4]);
    Index degree = integer(&call, values[5]), found = 1, knot = 0, corners = 0;
    double corner = real(&call, values[8]), kink = real(&call, values[9]);
    double nearest = real(&call, values[10]);
    Index room = knots.rows + heights.rows + 2;
    double *at = scratch(&call, room);
    Index *times = index_scratch(&call, room), *dropped = index_scratch(&call, room);
    expect(&call, t.rows == heights.rows + 2, "each inner vertex has a height");
    if (call.failed)
        return finish(&call, NULL);
    at[0] = start;
    times[0] = first;
    for (Index vertex = 1; vertex < t.rows; vertex++) {
        int inner = vertex + 1 < t.rows, there = 0;
        double place = inner ? t.at[vertex] : stop, height = inner ? heights.at[vertex - 1] : 0.0;
        /* The knots up to this vertex. */
        while (knot < knots.rows && knots.at[knot] <= place) {
            Index next = knot + 1;
            while (next < knots.rows && knots.at[next] == knots.at[knot])
                next++;
            there = knots.at[knot] == place;
            int stays = there && next - knot >= degree && height > kink;
            corners += stays;
            at[found] = knots.at[knot];
            times[found++] = stays ? degree : 1;
            knot = next;
        }
        if (!(height > corner))
            continue;
        corners++;
        found -= there;
        at[found] = place;
        times[found++] = degree;
    }
    at[found] = stop;
    times[found++] = last;
    if (corners) {
        double farther = larger(fabs(start), fabs(stop));
        double least = nearest * (stop - start) + 8 * (nextafter(farther, INFINITY) - farther);
        found = spread_apart(at, times, found, least, dropped);
    }
    return finish(&call, pair_of(&call, bytes_of(at, found * (Index)sizeof(double)),
                                 bytes_of(times, found * (Index)sizeof(Index))));
}
