/* Numbers k / 2**l; see multirep.representations.wavelet.dyadic. */
#include "core.h"

#include <math.h>

/* The multiple, nearest to the middle, of the largest power of two that is not longer than a span, or
else of half of it. */
double half_of(double start, double stop)
{
    double length = stop - start, middle = start + 0.5 * length;
    int exponent = 0;
    frexp(length, &exponent);
    double step = ldexp(0.5, exponent), coarse = rint(middle / step) * step;
    step *= 0.5;
    return fabs(coarse - middle) <= 0.25 * length ? coarse : rint(middle / step) * step;
}

METHOD(core_halves)
{
    /* starts and stops of spans, the knots that halve them */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table starts = reals(&call, values[0]), stops = reals(&call, values[1]);
    Table found = output(&call, values[2]);
    expect(&call, stops.rows == starts.rows && found.rows == starts.rows,
           "each span needs a start, a stop and a place for its knot");
    for (Index i = 0; !call.failed && i < starts.rows; i++)
        found.at[i] = half_of(starts.at[i], stops.at[i]);
    return finish(&call, Py_NewRef(Py_None));
}

/* Count numbers k / 2**l by their l, odd k. */
static void count_levels(Call *call, Table u, Index by, Slots counts)
{
    for (Index i = 0; !call->failed && i < u.rows; i++) {
        double scaled = u.at[i];
        Index level = 0;
        while (level < counts.rows && scaled != floor(scaled)) {
            scaled *= 2.0;
            level++;
        }
        expect(call, level < counts.rows, "a knot is not dyadic");
        if (!call->failed)
            counts.at[level] += by;
    }
}

METHOD(core_recount)
{
    /* numbers k / 2**l in [0, 1] that are added, those that are removed, counts (levels,) of those
    with an odd k for each l */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table added = reals(&call, values[0]), removed = reals(&call, values[1]);
    Slots counts = slots(&call, values[2]);
    count_levels(&call, added, 1, counts);
    count_levels(&call, removed, -1, counts);
    return finish(&call, Py_NewRef(Py_None));
}
