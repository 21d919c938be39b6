/* Chords of equal shares of a density; see multirep.splines.sampling. */
#include "core.h"

#include <math.h>

/* j with at[j] <= x < at[j + 1], walking on from an earlier one; the first or last interval outside. */
static Index interval_of(const double *at, Index count, Index j, double x)
{
    Index low = 0, high = count - 2;
    if (at[j] <= x && (j == high || x < at[j + 1]))
        return j;
    if (at[j] <= x && (j + 1 == high || x < at[j + 2]))
        return j + 1;
    while (low < high) {
        Index middle = low + (high - low + 1) / 2;
        if (at[middle] <= x)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The piecewise linear function through (x, y) on an interval, constant beyond its ends. */
static double between(const double *x, const double *y, Index j, double t)
{
    if (t <= x[j])
        return y[j];
    if (t >= x[j + 1])
        return y[j + 1];
    return (y[j + 1] - y[j]) / (x[j + 1] - x[j]) * (t - x[j]) + y[j];
}

static double *sums_of(Call *call, Table shares)
{
    double *sums = scratch(call, shares.rows + 1);
    if (call->failed)
        return NULL;
    sums[0] = 0.0;
    for (Index i = 0; i < shares.rows; i++)
        sums[i + 1] = sums[i] + shares.at[i];
    return sums;
}

METHOD(core_lay_out)
{
    /* nodes (m + 1,), shares (m,), begins, ends, the least and the most chords of an interval, what
    is added to a need and above which need; returns the starts of the chords and, of each interval,
    how many there are, as bytes */
    Call call;
    begin(&call, count, 8);
    if (call.failed)
        return finish(&call, NULL);
    Table nodes = reals(&call, values[0]), shares = reals(&call, values[1]);
    Table begins = reals(&call, values[2]), ends = reals(&call, values[3]);
    double least = real(&call, values[4]), most = real(&call, values[5]);
    double spare = real(&call, values[6]), from = real(&call, values[7]), total = 0.0;
    Index n = begins.rows;
    expect(&call, shares.rows >= 1 && nodes.rows == shares.rows + 1 && ends.rows == n,
           "a grid, and two ends of each interval are wanted");
    double *sums = sums_of(&call, shares), *marks = scratch(&call, n), *needs = scratch(&call, n);
    Index *counts = index_scratch(&call, n);
    Index j = 0, k = 0, r = 0;
    for (Index i = 0; !call.failed && i < n; i++) {
        j = interval_of(nodes.at, nodes.rows, j, begins.at[i]);
        marks[i] = between(nodes.at, sums, j, begins.at[i]);
        k = interval_of(nodes.at, nodes.rows, k, ends.at[i]);
        needs[i] = between(nodes.at, sums, k, ends.at[i]) - marks[i];
        double wanted = ceil(needs[i] + (needs[i] > from ? spare : 0.0));
        wanted = smaller(larger(wanted, least), most);
        total += wanted;
        expect(&call, total < 1e15, "the chords are without end");
        counts[i] = call.failed ? 0 : (Index)wanted;
    }
    double *t = scratch(&call, call.failed ? 0 : (Index)total);
    j = 0;
    for (Index i = 0; !call.failed && i < n; i++) {
        t[r++] = begins.at[i];
        double step = needs[i] / (double)counts[i];
        for (Index part = 1; part < counts[i]; part++) {
            double wanted = (double)part * step + marks[i];
            j = interval_of(sums, nodes.rows, j, wanted);
            t[r++] = between(sums, nodes.at, j, wanted);
        }
    }
    PyObject *found = NULL;
    if (!call.failed)
        found = pair_of(&call, bytes_of(t, r * (Index)sizeof(double)),
                        bytes_of(counts, n * (Index)sizeof(Index)));
    return finish(&call, found);
}

METHOD(core_corrected)
{
    /* nodes (m + 1,), shares (m,), chord ends t (c + 1,), what each chord needs (c,), the least that
    counts; returns the finer grid and the shares scaled so that each chord's are what it needs */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    Table nodes = reals(&call, values[0]), shares = reals(&call, values[1]);
    Table t = reals(&call, values[2]), needs = reals(&call, values[3]);
    double least = real(&call, values[4]);
    Index all = nodes.rows + t.rows, c = needs.rows;
    expect(&call, shares.rows >= 1 && nodes.rows == shares.rows + 1 && t.rows == c + 1 && c >= 1,
           "a grid, and a need of each chord are wanted");
    double *sums = sums_of(&call, shares), *grid = scratch(&call, all);
    double *finer = scratch(&call, all), *totals = scratch(&call, c);
    Index *chords = index_scratch(&call, all);
    if (call.failed)
        return finish(&call, NULL);
    for (Index r = 0, i = 0, j = 0; r < all; r++)
        grid[r] = j == t.rows || (i < nodes.rows && nodes.at[i] <= t.at[j]) ? nodes.at[i++]
                                                                            : t.at[j++];
    for (Index chord = 0; chord < c; chord++)
        totals[chord] = 0.0;
    double before = between(nodes.at, sums, 0, grid[0]);
    for (Index r = 0, j = 0, chord = 0; r + 1 < all; r++) {
        j = interval_of(nodes.at, nodes.rows, j, grid[r + 1]);
        double after = between(nodes.at, sums, j, grid[r + 1]);
        while (chord + 1 < c && t.at[chord + 1] <= grid[r])
            chord++;
        finer[r] = after - before;
        before = after;
        chords[r] = chord;
        totals[chord] += finer[r];
    }
    for (Index r = 0; r + 1 < all; r++) {
        double total = totals[chords[r]];
        if (total > 0.0)
            finer[r] *= larger(needs.at[chords[r]], least) / total;
    }
    return finish(&call, pair_of(&call, bytes_of(grid, all * (Index)sizeof(double)),
                                 bytes_of(finer, (all - 1) * (Index)sizeof(double))));
}
