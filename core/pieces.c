/* How large coordinates are; see multirep.splines.pieces. */
#include "core.h"

#include <math.h>

METHOD(core_largest)
{
    /* two arrays; returns the largest absolute value in them */
    Call call;
    begin(&call, count, 2);
    if (call.failed)
        return finish(&call, NULL);
    Table arrays[2] = {reals(&call, values[0]), reals(&call, values[1])};
    double largest = 0.0;
    for (int k = 0; !call.failed && k < 2; k++)
        for (Index i = 0; i < arrays[k].rows * arrays[k].columns; i++)
            largest = worse(largest, fabs(arrays[k].at[i]));
    return finish(&call, PyFloat_FromDouble(largest));
}
