/* Polylines: points at parameters, stretches of them, kinks, pieces joined. */
#include "core.h"

#include <math.h>
#include <string.h>

/* The segment of a parameter: its vertex is the last that does not stand behind. Near an earlier one
it is found soon, and where the vertices of a block are about equally far apart. */
static Index segment_at(Rope *t, Index near, double here)
{
    Index b = t->current, last = t->count - 1;
    if (here < t->firsts[b] || (b < last && here >= t->firsts[b + 1]))
        b = t->current = bisected(t->firsts, 0, last, here);
    const double *at = t->blocks[b];
    Index begin = t->begins[b], end = t->begins[b + 1] - 1 - begin, from = near - begin;
    if (from < 0 || from > end) {
        double share = (here - at[0]) / (at[end] - at[0]) * (double)end;
        from = share > 4.0 && share < (double)end ? (Index)share - 4 : 0;
    }
    Index rows = t->begins[t->count];
    return at_most(begin + interval_at(at, 0, end, from, here), rows - 2);
}

METHOD(core_interpolate)
{
    /* t (m,), points (m, d) (each an array, or a rope), parameters or a number, points there (.., d);
    at a vertex the vertex itself */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Rope t = rope_of(&call, values[0]), points = rope_of(&call, values[1]);
    double number = 0.0;
    Table at = {&number, 1, 1};
    if (PyFloat_Check(values[2]))
        number = real(&call, values[2]);
    else
        at = reals(&call, values[2]);
    Table found = output(&call, values[3]);
    Index d = points.columns, all = at.rows * at.columns, k = -1;
    expect(&call, rope_length(&t) >= 2 && t.columns == 1 && rope_length(&points) == rope_length(&t),
           "a polyline needs two vertices");
    expect(&call, found.rows * found.columns == all * d, "room for the points is missing");
    double *room = scratch(&call, 2 * d), ends[2];
    const double *span = NULL, *low = NULL;
    for (Index i = 0; !call.failed && i < all; i++) {
        double here = at.at[i];
        Index near = k;
        k = segment_at(&t, near, here);
        if (k != near) {
            span = rope_rows(&t, k, 2, ends);
            low = rope_rows(&points, k, 2, room);
        }
        const double *high = low + d;
        double *point = found.at + i * d, u = (here - span[0]) / (span[1] - span[0]);
        for (Index c = 0; c < d; c++)
            point[c] = u == 1.0 ? high[c] : low[c] + u * (high[c] - low[c]);
    }
    return finish(&call, Py_NewRef(Py_None));
}

/* The parameters of inner vertices at which the jump of the slope times the shorter segment exceeds a
limit. */
static PyObject *kinks_of(Call *call, Table t, Table points, double limit, double from, double to)
{
    Index d = points.columns, found = 0;
    double *kinks = scratch(call, t.rows);
    /* Of two segments that are no longer than half the limit nothing shows: most of a dense polyline. */
    double short_square = 0.2499 * limit * limit;
    int short_before = 0;
    for (Index i = 1; !call->failed && i + 1 < t.rows; i++) {
        const double *here = points.at + i * d;
        double square = 0.0;
        for (Index c = 0; c < d; c++)
            square += (here[c + d] - here[c]) * (here[c + d] - here[c]);
        int short_after = square < short_square, hidden = short_before && short_after;
        short_before = short_after;
        if (hidden || t.at[i] < from || t.at[i] > to)
            continue;
        double before = t.at[i] - t.at[i - 1], after = t.at[i + 1] - t.at[i];
        /* without dividing by a length alone: slopes of tiny segments overflow */
        double shorter = smaller(after, before);
        square = 0.0;
        for (Index c = 0; c < d; c++) {
            double jump = (here[c + d] - here[c]) * (shorter / after) -
                          (here[c] - here[c - d]) * (shorter / before);
            square += jump * jump;
        }
        if (sqrt(square) > limit)
            kinks[found++] = t.at[i];
    }
    return numbers(call, kinks, found);
}

/* The point at a parameter of segment k; returns how far rounding may have moved it. */
static double cut_at(const Table *t, const Table *points, Index k, double at, double unit, double *point)
{
    Index d = points->columns;
    const double *low = points->at + k * d, *high = low + d;
    double u = (at - t->at[k]) / (t->at[k + 1] - t->at[k]), square = 0.0;
    for (Index c = 0; c < d; c++) {
        point[c] = u == 1.0 ? high[c] : low[c] + u * (high[c] - low[c]);
        double rounding = 5 * fabs(high[c] - low[c]) + fabs(point[c]);
        square += rounding * rounding;
    }
    return t->at[k] == at || t->at[k + 1] == at ? 0.0 : unit * sqrt(square);
}

METHOD(core_stretch)
{
    /* t (m,), points (m, d), the first vertex inside a stretch and the first behind those, its ends, a
    limit of kinks, the roundoff unit, the stretch's t and points or None; returns a bound of the
    rounding at the ends, and the parameters of kinks in the stretch beyond the limit */
    Call call;
    begin(&call, count, 10);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Index first = integer(&call, values[2]), last = integer(&call, values[3]), d = points.columns;
    double start = real(&call, values[4]), stop = real(&call, values[5]);
    double limit = real(&call, values[6]), unit = real(&call, values[7]), bound = 0.0;
    expect(&call,
           points.rows == t.rows && t.columns == 1 && 1 <= first && first <= last && last < t.rows,
           "a stretch lies between two vertices");
    if (!call.failed && values[8] != Py_None) {
        Table new_t = output(&call, values[8]), rows = output(&call, values[9]);
        Index inside = last - first;
        expect(&call,
               new_t.rows == inside + 2 && rows.rows == inside + 2 && rows.columns == d &&
                   new_t.columns == 1,
               "room for the stretch is missing");
        if (call.failed)
            return finish(&call, NULL);
        memcpy(new_t.at + 1, t.at + first, (size_t)inside * sizeof(double));
        memcpy(rows.at + d, points.at + first * d, (size_t)(inside * d) * sizeof(double));
        new_t.at[0] = start;
        new_t.at[inside + 1] = stop;
        double at_start = cut_at(&t, &points, first - 1, start, unit, rows.at);
        double at_stop = cut_at(&t, &points, last - 1, stop, unit, rows.at + (inside + 1) * d);
        bound = larger(at_start, at_stop);
    }
    if (call.failed)
        return finish(&call, NULL);
    PyObject *rounding = PyFloat_FromDouble(bound);
    return finish(&call, pair_of(&call, rounding, kinks_of(&call, t, points, limit, start, stop)));
}

/* The polyline with the middles of the chords beside kinks as vertices, unless rounding puts them on
an end. */
static PyObject *with_middles(Call *call, Table t, Table points, const double *heights, double kink)
{
    Index d = points.columns, m = t.rows - 1, count = 0;
    double *finer = scratch(call, 2 * m + 1), *rows = scratch(call, (2 * m + 1) * d);
    if (call->failed)
        return NULL;
    for (Index i = 0; i <= m; i++) {
        const double *row = points.at + i * d;
        finer[count] = t.at[i];
        memcpy(rows + count++ * d, row, (size_t)d * sizeof(double));
        int beside = i < m && ((i > 0 && heights[i - 1] > kink) || (i + 1 < m && heights[i] > kink));
        double middle = beside ? 0.5 * (t.at[i] + t.at[i + 1]) : t.at[i];
        if (!(t.at[i] < middle && middle < t.at[i + 1]))
            continue;
        finer[count] = middle;
        for (Index c = 0; c < d; c++)
            rows[count * d + c] = 0.5 * row[c] + 0.5 * row[c + d];
        count++;
    }
    Index size = (Index)sizeof(double);
    return pair_of(call, bytes_of(finer, count * size), bytes_of(rows, count * d * size));
}

METHOD(core_course)
{
    /* t (m + 1,), points (m + 1, d), allowance (m,), what counts as a kink, heights (m - 1,): how far
    each inner vertex stands from the line between its neighbours, over what both chords allow. Returns
    the smallest and the largest allowance, the largest |coordinate|, and parameters and points of the
    polyline with middles beside kinks as bytes, or None without kinks. */
    Call call;
    begin(&call, count, 5);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table allowance = reals(&call, values[2]), heights = output(&call, values[4]);
    double kink = real(&call, values[3]), least = INFINITY, most = 0.0, largest = 0.0;
    Index d = points.columns, m = allowance.rows;
    int kinked = 0;
    expect(&call,
           m >= 1 && t.rows == m + 1 && points.rows == m + 1 && heights.rows == m - 1,
           "each chord needs an allowance, each inner vertex a place for its height");
    for (Index i = 0; !call.failed && i < m; i++) {
        least = smaller(allowance.at[i], least);
        most = larger(allowance.at[i], most);
    }
    for (Index i = 0; !call.failed && i < points.rows * d; i++)
        largest = worse(largest, fabs(points.at[i]));
    for (Index i = 0; !call.failed && i + 1 < m; i++) {
        const double *row = points.at + i * d;
        double share = (t.at[i + 1] - t.at[i]) / (t.at[i + 2] - t.at[i]), square = 0.0;
        for (Index c = 0; c < d; c++) {
            double off = (row[c + 2 * d] - row[c]) * share + row[c] - row[c + d];
            square += off * off;
        }
        heights.at[i] = sqrt(square) / smaller(allowance.at[i], allowance.at[i + 1]);
        kinked |= heights.at[i] > kink;
    }
    PyObject *finer = NULL;
    if (!call.failed)
        finer = kinked ? with_middles(&call, t, points, heights.at, kink) : Py_NewRef(Py_None);
    return finish(&call, finer ? Py_BuildValue("dddN", least, most, largest, finer) : NULL);
}

/* A stretch of samples: its certificates chord by chord, or one for all. */
typedef struct {
    Table t, points, bounds;
    double bound;
} Samples;

static Samples samples_of(Call *call, PyObject *given)
{
    Samples piece = {{NULL, 0, 0}, {NULL, 0, 0}, {NULL, 0, 0}, 0.0};
    PyObject *t, *points, *bounds;
    if (call->failed || !PyArg_ParseTuple(given, "OOOd", &t, &points, &bounds, &piece.bound)) {
        call->failed = 1;
        return piece;
    }
    piece.t = reals(call, t);
    piece.points = reals(call, points);
    piece.bounds = reals_or_none(call, bounds);
    expect(call,
           piece.t.rows >= 2 && piece.t.columns == 1 && piece.points.rows == piece.t.rows &&
               (!piece.bounds.at || piece.bounds.rows == piece.t.rows - 1),
           "each sample needs a point, each chord a bound");
    return piece;
}

METHOD(core_join)
{
    /* A tuple of pieces (t (m,), points (m, d), bounds of chords (m - 1,) or None, bound of all), and
    t, points and bounds of chords of the whole, which passes through the middle of each seam; half
    the gap there is added to the bounds of both chords. Returns the largest bound. */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table t = output(&call, values[1]), points = output(&call, values[2]);
    Table bounds = output(&call, values[3]);
    Index d = points.columns, at = 0;
    double largest = 0.0;
    expect(&call, PyTuple_Check(values[0]) && PyTuple_Size(values[0]) > 0, "pieces are missing");
    for (Index k = 0; !call.failed && k < PyTuple_Size(values[0]); k++) {
        Samples piece = samples_of(&call, PyTuple_GetItem(values[0], k));
        Index chords = piece.t.rows - 1;
        expect(&call,
               piece.points.columns == d && at + chords < t.rows && points.rows == t.rows &&
                   bounds.rows == t.rows - 1,
               "room for the whole is missing");
        if (call.failed)
            break;
        for (Index i = 0; i < chords; i++)
            bounds.at[at + i] = piece.bounds.at ? piece.bounds.at[i] : piece.bound;
        double square = 0.0;
        for (Index c = 0; k > 0 && c < d; c++) {
            double *seam = points.at + at * d + c, off = *seam - piece.points.at[c];
            square += off * off;
            *seam = off == 0.0 ? *seam : 0.5 * (*seam + piece.points.at[c]);
        }
        if (square > 0.0) {
            bounds.at[at - 1] += 0.5 * sqrt(square);
            bounds.at[at] += 0.5 * sqrt(square);
        }
        Index skip = k > 0;
        memcpy(t.at + at + skip, piece.t.at + skip, (size_t)(chords + 1 - skip) * sizeof(double));
        memcpy(points.at + (at + skip) * d, piece.points.at + skip * d,
               (size_t)((chords + 1 - skip) * d) * sizeof(double));
        at += chords;
    }
    expect(&call, at + 1 == t.rows, "the pieces do not make the whole");
    for (Index i = 0; !call.failed && i < at; i++)
        largest = worse(largest, bounds.at[i]);
    return finish(&call, call.failed ? NULL : PyFloat_FromDouble(largest));
}

METHOD(core_between_common)
{
    /* t, points, t and points of another polyline; returns the stretches between common vertices
    that are not one segment in both, ends of the arrays counted as vertices */
    Call call;
    begin(&call, count, 4);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), points = reals(&call, values[1]);
    Table other_t = reals(&call, values[2]), other_points = reals(&call, values[3]);
    Index d = points.columns, last = other_t.rows - 1, before = -1, other_before = -1, at = 0;
    expect(&call,
           t.rows >= 1 && last >= 0 && points.rows == t.rows && other_points.rows == last + 1 &&
               other_points.columns == d,
           "each vertex needs a parameter");
    PyObject *found = call.failed ? NULL : PyList_New(0);
    call.failed |= !found;
    for (Index i = 0; !call.failed && i <= t.rows; i++) {
        int ending = i == t.rows;
        if (!ending) {
            while (at < last && other_t.at[at] < t.at[i])
                at++;
            if (other_t.at[at] != t.at[i])
                continue;
            const double *mine = points.at + i * d, *theirs = other_points.at + at * d;
            Index c = 0;
            while (c < d && mine[c] == theirs[c])
                c++;
            if (c < d)
                continue;
        }
        /* Broken unless the vertices follow each other in both, or are both at an end. */
        int whole = ending ? before == t.rows - 1 && other_before == last
                           : i - before <= 1 && at - other_before <= 1;
        if (!whole) {
            double start = before < 0 ? t.at[0] : t.at[before];
            PyObject *pair = Py_BuildValue("dd", start, t.at[ending ? i - 1 : i]);
            call.failed |= !pair || PyList_Append(found, pair) < 0;
            Py_XDECREF(pair);
        }
        before = i;
        other_before = at;
    }
    return finish(&call, found);
}
