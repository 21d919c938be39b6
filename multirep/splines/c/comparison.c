/* Which rows of two arrays have the same bits. */
#include "core.h"

#include <string.h>

METHOD(core_common)
{
    /* Lengths of the common prefix of two arrays, and of the common suffix of what follows it; -0.0
    and 0.0 differ. */
    Call call;
    begin(&call, count, 2);
    if (call.failed)
        return finish(&call, NULL);
    Table a = reals(&call, values[0]), b = reals(&call, values[1]);
    expect(&call, a.columns == b.columns, "rows of different lengths are compared");
    Index least = at_most(a.rows, b.rows), head = 0, tail = 0;
    if (!call.failed) {
        size_t row = (size_t)a.columns * sizeof(double);
        const double *end_a = a.at + a.rows * a.columns, *end_b = b.at + b.rows * b.columns;
        while (head < least && !memcmp(a.at + head * a.columns, b.at + head * a.columns, row))
            head++;
        while (tail < least - head &&
               !memcmp(end_a - (tail + 1) * a.columns, end_b - (tail + 1) * a.columns, row))
            tail++;
    }
    return finish(&call, Py_BuildValue("nn", head, tail));
}
