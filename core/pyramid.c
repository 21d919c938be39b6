/* One level of a pyramid: refinement by P, details by Q, and both undone.

See multirep.representations.wavelet.filters and .analysis. Tables of stencils hold those near
the left end first and the one of all other places last; near the right end they are mirrored.
*/
#include "core.h"

#include <string.h>

/* Entries of a column of Q; diagonals of [P | Q] on either side. */
enum { LONGEST = 11, BANDS = 5 };

/* Whether a place is near the right end, where the table is mirrored; `place` becomes its row. */
static int mirrored(Table table, Index count, Index *place)
{
    Index last = table.rows - 1, left = *place, right = count - 1 - left;
    *place = at_most(at_most(left, right), last);
    return *place < last && right < left;
}

/* Add Q d, times a factor, to points (2 m + 3, d). */
static void add_columns(double *points, const double *details, double factor, Table columns,
                        Index count, Index d)
{
    Index rows = 2 * count + 3, ends = columns.rows - 1;
    for (Index k = 0; k < count; k++) {
        const double *detail = details + k * d;
        Index row = k;
        int backwards = mirrored(columns, count, &row);
        const double *taps = columns.at + row * LONGEST;
        Index first = row == ends ? 2 * k - 3 : row;
        if (backwards) {
            for (Index j = 0; j < at_most(LONGEST, rows - first); j++)
                for (Index c = 0; c < d; c++)
                    points[(rows - 1 - first - j) * d + c] += taps[j] * (factor * detail[c]);
            continue;
        }
        double *at = points + first * d;
        for (Index j = 0; j < at_most(LONGEST, rows - first); j++)
            for (Index c = 0; c < d; c++)
                at[j * d + c] += taps[j] * (factor * detail[c]);
    }
}

static void expect_columns(Call *call, Table columns, Index count)
{
    Index ends = columns.rows - 1;
    expect(call, columns.columns == LONGEST && ends >= 0 && (ends >= 2 || count <= 2 * ends),
           "columns of eleven entries are wanted, for the ends and for the rest");
}

METHOD(core_add_details)
{
    /* details (m, d), columns, a factor, points (2 m + 3, d) to be changed */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table details = reals(&call, values[0]), columns = reals(&call, values[1]);
    double factor = real(&call, values[2]);
    Table points = output(&call, values[3]);
    expect_columns(&call, columns, details.rows);
    expect(&call, points.rows == 2 * details.rows + 3 && points.columns == details.columns,
           "2 m + 3 control points take m details");
    if (!call.failed)
        add_columns(points.at, details.at, factor, columns, details.rows, details.columns);
    return finish(&call, Py_NewRef(Py_None));
}

/* The first rows of P: a few, with four entries. */
static void expect_ends(Call *call, Table ends, Index count)
{
    expect(call, ends.columns == 4 && (ends.rows == 4 || (ends.rows == 3 && count == 1)),
           "four entries of each of the first rows are wanted");
}

METHOD(core_refine_uniform)
{
    /* control points (m + 3, d) of m spans, the first rows of P, refined ones (2 m + 3, d) */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table points = reals(&call, values[0]), ends = reals(&call, values[1]);
    Table refined = output(&call, values[2]);
    Index spans = points.rows - 3, d = points.columns;
    expect_ends(&call, ends, spans);
    expect(&call, spans >= 1 && refined.rows == 2 * spans + 3 && refined.columns == d,
           "m + 3 control points become 2 m + 3");
    if (call.failed)
        return finish(&call, NULL);
    for (Index i = 2; i < spans; i++) {
        const double *row = points.at + i * d;
        double *at = refined.at + 2 * i * d;
        for (Index c = 0; c < d; c++)
            at[c] = 0.5 * (row[c] + row[c + d]);
        for (Index c = 0; i + 1 < spans && c < d; c++)
            at[c + d] = 0.125 * (row[c] + 6.0 * row[c + d] + row[c + 2 * d]);
    }
    const double *back = points.at + (points.rows - 1) * d;
    double *last = refined.at + (refined.rows - 1) * d;
    for (Index row = 0; row < ends.rows; row++)
        for (Index c = 0; c < d; c++) {
            double left = 0.0, right = 0.0;
            for (Index k = 0; k < 4; k++) {
                left += ends.at[row * 4 + k] * points.at[k * d + c];
                right += ends.at[row * 4 + k] * back[c - k * d];
            }
            refined.at[row * d + c] = left;
            last[c - row * d] = right;
        }
    return finish(&call, Py_NewRef(Py_None));
}

/* The row of a factor; from `repeated` on two rows take turns for so many more than are given. */
static inline const double *factor_of(Table factors, Index repeated, Index more, Index i)
{
    if (i >= repeated)
        i = i < repeated + more ? repeated + (i - repeated) % 2 : i - more;
    return factors.at + i * (2 * BANDS + 1);
}

METHOD(core_analyse)
{
    /* points (n, d), triangular factors of [P | Q] with its columns side by side as on the curve,
    (rows, 11), the first of two rows that stand for all those left out, coarse points, details

    A row holds the entries of the lower factor, the inverse of its pivot, those of the upper. */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    Table points = reals(&call, values[0]), factors = reals(&call, values[1]);
    Index repeated = integer(&call, values[2]);
    Table coarse = output(&call, values[3]), details = output(&call, values[4]);
    Index n = points.rows, d = points.columns, m = details.rows, more = n - factors.rows;
    expect(&call,
           m >= 1 && n == 2 * m + 3 && coarse.rows == m + 3 && coarse.columns == d &&
               details.columns == d,
           "2 m + 3 control points become m + 3 and m details");
    expect(&call,
           factors.columns == 2 * BANDS + 1 && more >= 0 && more % 2 == 0 && repeated >= 0 &&
               repeated + 1 < factors.rows,
           "factors of eleven entries are wanted, two of them to be repeated");
    double *rows = scratch(&call, (n + 2 * BANDS) * d);
    if (call.failed)
        return finish(&call, NULL);
    /* Zeros beyond both ends, where the factors are zero too. */
    size_t beyond = (size_t)(BANDS * d) * sizeof(double);
    memset(rows, 0, beyond);
    memset(rows + (n + BANDS) * d, 0, beyond);
    for (Index i = 0; i < n; i++) {
        const double *factor = factor_of(factors, repeated, more, i), *point = points.at + i * d;
        double *row = rows + (i + BANDS) * d;
        for (Index c = 0; c < d; c++) {
            double sum = point[c];
            for (Index back = BANDS; back > 0; back--)
                sum -= factor[BANDS - back] * row[c - back * d];
            row[c] = sum;
        }
    }
    for (Index i = n - 1; i >= 0; i--) {
        const double *factor = factor_of(factors, repeated, more, i) + BANDS;
        double *row = rows + (i + BANDS) * d;
        Index place = i == n - 1 ? m + 2 : (i + 1) / 2;
        double *found = i % 2 || i == 0 || i == n - 1 ? coarse.at + place * d
                                                      : details.at + (place - 1) * d;
        for (Index c = 0; c < d; c++) {
            double sum = row[c];
            for (Index ahead = BANDS; ahead > 0; ahead--)
                sum -= factor[ahead] * row[c + ahead * d];
            found[c] = row[c] = sum * factor[0];
        }
    }
    return finish(&call, Py_NewRef(Py_None));
}
