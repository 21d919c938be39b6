/* Numbers k / 2**l; see multirep.representations.wavelet.dyadic. */
#include "core.h"

#include <math.h>

METHOD(core_halves)
{
    /* starts and stops of spans, the knots that halve them: the multiple, nearest to the middle, of
    the largest power of two that is not longer than the span, or else of half of it */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table starts = reals(&call, values[0]), stops = reals(&call, values[1]);
    Table found = output(&call, values[2]);
    expect(&call, stops.rows == starts.rows && found.rows == starts.rows,
           "each span needs a start, a stop and a place for its knot");
    for (Index i = 0; !call.failed && i < starts.rows; i++) {
        double length = stops.at[i] - starts.at[i], middle = starts.at[i] + 0.5 * length;
        int exponent = 0;
        frexp(length, &exponent);
        double step = ldexp(0.5, exponent), coarse = rint(middle / step) * step;
        step *= 0.5;
        found.at[i] = fabs(coarse - middle) <= 0.25 * length ? coarse : rint(middle / step) * step;
    }
    return finish(&call, Py_NewRef(Py_None));
}

METHOD(core_level_counts)
{
    /* numbers k / 2**l in [0, 1], counts (levels,): how many have an odd k for each l */
    Call call;
    begin(&call, count, 2);
    if (call.failed)
        return finish(&call, NULL);
    Table u = reals(&call, values[0]);
    Slots counts = slots(&call, values[1]);
    for (Index level = 0; level < counts.rows; level++)
        counts.at[level] = 0;
    for (Index i = 0; !call.failed && i < u.rows; i++) {
        double scaled = u.at[i];
        Index level = 0;
        while (level < counts.rows && scaled != floor(scaled)) {
            scaled *= 2.0;
            level++;
        }
        expect(&call, level < counts.rows, "a knot is not dyadic");
        if (!call.failed)
            counts.at[level]++;
    }
    return finish(&call, Py_NewRef(Py_None));
}
