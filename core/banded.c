/* Symmetric positive definite banded systems, by Cholesky. */
#include "core.h"

#include <math.h>

/* Factorise and solve in place.

Row i of `band` holds the entries (i, i) .. (i + bandwidth, i) of the matrix, of those beyond its
end anything; `right` (count, columns) becomes the solution. Returns 0, with both in ruins, when a
pivot is not positive or below `smallest_pivot` times the root of its diagonal entry. */
int solve_banded(double *band, double *right, Index count, Index bandwidth, Index columns,
                 double smallest_pivot)
{
    Index size = bandwidth + 1;
    for (Index i = 0; i < count; i++) {
        double *row = band + i * size;
        Index reach = at_most(bandwidth, count - 1 - i);
        double entry = row[0], *mine = right + i * columns;
        /* Subtract what the rows before leave in this one: left-looking. */
        for (Index back = 1; back <= at_most(bandwidth, i); back++) {
            const double *before = row - back * size, *solved = mine - back * columns;
            double factor = before[back];
            for (Index k = 0; k <= at_most(bandwidth - back, reach); k++)
                row[k] -= factor * before[back + k];
            for (Index c = 0; c < columns; c++)
                mine[c] -= factor * solved[c];
        }
        if (!(row[0] > 0.0))
            return 0;
        double pivot = sqrt(row[0]);
        if (!(pivot >= smallest_pivot * sqrt(entry)))
            return 0;
        row[0] = pivot;
        for (Index k = 1; k <= reach; k++)
            row[k] /= pivot;
        for (Index c = 0; c < columns; c++)
            mine[c] /= pivot;
    }
    for (Index i = count - 1; i >= 0; i--) {
        const double *row = band + i * size;
        double *mine = right + i * columns;
        for (Index k = 1; k <= at_most(bandwidth, count - 1 - i); k++)
            for (Index c = 0; c < columns; c++)
                mine[c] -= row[k] * mine[k * columns + c];
        for (Index c = 0; c < columns; c++)
            mine[c] /= row[0];
    }
    return 1;
}
