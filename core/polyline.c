/* Polylines: points at parameters, kinks, samples that a straight line replaces. */
#include "core.h"

#include <math.h>
#include <string.h>

METHOD(core_interpolate)
{
    /* t (m,), points (m, d), parameters, points there (.., d); at a vertex the vertex itself */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table at = reals(&call, values[2]), found = output(&call, values[3]);
    Index d = points.columns, last = t.rows - 2, all = at.rows * at.columns;
    expect(&call, last >= 0 && t.columns == 1 && points.rows == t.rows,
           "a polyline needs two vertices");
    expect(&call, found.rows * found.columns == all * d, "room for the points is missing");
    Index k = 0;
    for (Index i = 0; !call.failed && i < all; i++) {
        double here = at.at[i];
        if (here < t.at[k] || (k + 8 <= last && here >= t.at[k + 8])) {
            Index high = last;
            for (k = 0; k < high;) {
                Index middle = k + (high - k + 1) / 2;
                if (t.at[middle] <= here)
                    k = middle;
                else
                    high = middle - 1;
            }
        } else
            while (k < last && t.at[k + 1] <= here)
                k++;
        const double *low = points.at + k * d, *high = low + d;
        double *point = found.at + i * d, u = (here - t.at[k]) / (t.at[k + 1] - t.at[k]);
        for (Index c = 0; c < d; c++)
            point[c] = u == 1.0 ? high[c] : low[c] + u * (high[c] - low[c]);
    }
    return finish(&call, Py_NewRef(Py_None));
}

METHOD(core_kinks)
{
    /* t (m,), points (m, d), a limit; returns the parameters of inner vertices at which the jump of
    the slope times the shorter segment exceeds it */
    Call call;
    begin(&call, count, 3);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    double limit = real(&call, values[2]);
    Index d = points.columns;
    expect(&call, points.rows == t.rows && t.columns == 1, "each vertex needs a parameter");
    PyObject *found = call.failed ? NULL : PyList_New(0);
    call.failed |= !found;
    for (Index i = 1; !call.failed && i + 1 < t.rows; i++) {
        double before = t.at[i] - t.at[i - 1], after = t.at[i + 1] - t.at[i], square = 0.0;
        /* without dividing by a length alone: slopes of tiny segments overflow */
        double shorter = smaller(after, before);
        const double *here = points.at + i * d;
        for (Index c = 0; c < d; c++) {
            double jump = (here[c + d] - here[c]) * (shorter / after) -
                          (here[c] - here[c - d]) * (shorter / before);
            square += jump * jump;
        }
        if (sqrt(square) > limit) {
            PyObject *number = PyFloat_FromDouble(t.at[i]);
            call.failed |= !number || PyList_Append(found, number) < 0;
            Py_XDECREF(number);
        }
    }
    return finish(&call, found);
}

/* Whether the chord between two samples is within the allowance of every sample between. */
static int replaces(const Table *t, const Table *vertices, const Table *targets,
                    const double *squares, Index left, Index right)
{
    Index d = vertices->columns;
    const double *first = vertices->at + left * d, *last = vertices->at + right * d;
    double start = t->at[left], length = t->at[right] - start;
    for (Index at = left + 1; at < right; at++) {
        double u = (t->at[at] - start) / length, square = 0.0;
        for (Index c = 0; c < d; c++) {
            double off = first[c] + u * (last[c] - first[c]) - targets->at[at * d + c];
            square += off * off;
        }
        if (!(square <= squares[at]))
            return 0;
    }
    return 1;
}

METHOD(core_simplify)
{
    /* t, vertices to choose from, samples to follow, what is allowed at each, samples that must
    stay (their indices), rounds; returns the indices of the chosen samples, as bytes. Of each run
    of neighbours that can go every other one does, round by round. */
    Call call;
    begin(&call, count, 6);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), vertices = reals(&call, values[1]);
    Table targets = reals(&call, values[2]), allowed = reals(&call, values[3]);
    Places keep = places(&call, values[4]);
    Index rounds = integer(&call, values[5]), m = t.rows, chosen = m;
    expect(&call,
           m >= 2 && vertices.rows == m && targets.rows == m && allowed.rows == m &&
               vertices.columns == targets.columns,
           "each sample needs a vertex, a target and an allowance");
    enum { REFUSED, UNTESTED, HELD };
    double *squares = scratch(&call, m);
    Index *kept = index_scratch(&call, m), *state = index_scratch(&call, m);
    for (Index i = 0; !call.failed && i < m; i++) {
        kept[i] = i;
        state[i] = UNTESTED;
        squares[i] = allowed.at[i] > 0 ? allowed.at[i] * allowed.at[i] : -1.0;
    }
    for (Index i = 0; !call.failed && i < keep.rows; i++) {
        expect(&call, keep.at[i] >= 0 && keep.at[i] < m, "a sample is out of bounds");
        if (!call.failed)
            state[keep.at[i]] = HELD;
    }
    if (call.failed)
        return finish(&call, NULL);
    state[0] = state[m - 1] = HELD;
    for (int changed = 1; changed && rounds > 0; rounds--) {
        Index written = 0, last_tested = 0;
        int removed_before = 0; /* whether the kept sample before this one goes */
        changed = 0;
        for (Index i = 0; i < chosen; i++) {
            Index here = kept[i];
            int goes = 0;
            if (state[here] == UNTESTED) {
                Index left = removed_before ? last_tested : kept[written - 1];
                int fits = replaces(&t, &vertices, &targets, squares, left, kept[i + 1]);
                if (!fits)
                    state[here] = REFUSED;
                goes = fits && !removed_before;
            }
            if (removed_before && state[here] == REFUSED)
                state[here] = UNTESTED; /* with another neighbour it may go next */
            last_tested = here;
            if (goes) {
                changed = 1;
                if (state[kept[written - 1]] == REFUSED)
                    state[kept[written - 1]] = UNTESTED;
            } else
                kept[written++] = here;
            removed_before = goes;
        }
        chosen = written;
    }
    return finish(&call, bytes_of(kept, chosen * (Index)sizeof(Index)));
}
