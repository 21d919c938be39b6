/* One attempt of a wavelet fit: least squares on given knots, and the proof of what they achieve.

See multirep.representations.wavelet.attempt: cubic splines on graded knots, followed in Bernstein
form span by span. Coordinates come first in all arrays, as there.
*/
#include "core.h"

#include <math.h>
#include <string.h>

/* Rows per span that carry no vertex; control points that are dictated at a joined end. */
enum { QUARTERS = 4, DEGREE = 3, PINNED = 3 };

/* Cubic Bernstein polynomials, and a third of their derivatives. */
static void bernstein(double local, double *values, double *turns)
{
    double other = 1.0 - local, square = local * local, mixed = 2.0 * local * other;
    double other_square = other * other;
    values[0] = other_square * other;
    values[1] = other_square * (3.0 * local);
    values[2] = square * (3.0 * other);
    values[3] = square * local;
    turns[0] = -other_square;
    turns[1] = other_square - mixed;
    turns[2] = mixed - square;
    turns[3] = square;
}

/* The matrix from the four control points of a span to its Bernstein coefficients. `knots` are the
six around it: two before, its ends, two behind. */
static void map_of(const double *knots, double map[4][4])
{
    double lowest = knots[0], low = knots[1], start = knots[2], stop = knots[3], high = knots[4];
    double highest = knots[5], length = stop - start, wide = high - low;
    memset(map, 0, 16 * sizeof(double));
    map[1][1] = (high - start) / wide;
    map[1][2] = (start - low) / wide;
    map[2][1] = (high - stop) / wide;
    map[2][2] = (stop - low) / wide;
    /* At its start: the polar form at (start, start, start), from those at (low, start, start) and
    the coefficient beside it; likewise at its stop. */
    double share = length / (stop - low), inner = share * (length / (stop - lowest));
    map[0][0] = inner;
    map[0][2] = (1.0 - share) * map[1][2];
    map[0][1] = 1.0 - inner - map[0][2];
    share = length / (high - start);
    inner = share * (length / (highest - start));
    map[3][3] = inner;
    map[3][1] = (1.0 - share) * map[2][1];
    map[3][2] = 1.0 - inner - map[3][1];
}

/* The control points (d, columns) at a joined end, from column `first` on: polar forms of the old
piece. `around` are the five knots that define them. */
static void dictate(const Piece *piece, const double *around, Index first, double *room,
                    Table points)
{
    Index d = piece->points.columns;
    for (Index k = 0; k < PINNED; k++) {
        memcpy(room, piece->points.at, (size_t)((DEGREE + 1) * d) * sizeof(double));
        for (Index step = 0; step < DEGREE; step++)
            blossom_step(piece->knots.at, DEGREE, d, around[k + step], step, room);
        for (Index c = 0; c < d; c++)
            points.at[c * points.columns + first + k] = room[c];
    }
}

/* Where a stretch is looked at: quarters of its spans, its end, and the vertices between; with the
span and the chord of each, and the target there, (marks, d). */
typedef struct {
    double *t, *values;
    Index *spans, *chords, count;
} Marks;

static Marks placed_marks(Call *call, const Target *target, Table x)
{
    Index n = x.rows - 1, d = target->d, vertex = 0, last = target->t.rows;
    const double *vertices = target->t.at;
    Marks marks = {NULL, NULL, NULL, NULL, 0};
    vertex = chord_at(target, 0, x.at[0]);
    while (vertex < last && vertices[vertex] <= x.at[0])
        vertex++;
    Index room = QUARTERS * n + 1;
    for (Index k = vertex; k < last && vertices[k] < x.at[n]; k++)
        room++;
    marks.t = scratch(call, room);
    marks.values = scratch(call, room * d);
    marks.spans = index_scratch(call, room);
    marks.chords = index_scratch(call, room);
    if (call->failed)
        return marks;
    for (Index span = 0; span < n; span++) {
        double start = x.at[span], stop = x.at[span + 1], length = stop - start;
        for (Index quarter = 0; quarter <= QUARTERS; quarter++) {
            double next = start + length * ((double)quarter / QUARTERS);
            if (quarter == QUARTERS)
                next = stop;
            for (; vertex < last && vertices[vertex] < next; vertex++)
                if (marks.count == 0 || vertices[vertex] > marks.t[marks.count - 1]) {
                    marks.spans[marks.count] = span;
                    marks.t[marks.count++] = vertices[vertex];
                }
            int ending = quarter == QUARTERS, past = quarter && !(next < stop);
            if ((ending && span < n - 1) || (past && !ending))
                continue;
            if (marks.count == 0 || next > marks.t[marks.count - 1]) {
                marks.spans[marks.count] = span;
                marks.t[marks.count++] = next;
            }
        }
    }
    Index chord = chord_at(target, 0, marks.t[0]);
    for (Index i = 0; i < marks.count; i++) {
        marks.chords[i] = chord = chord_at(target, chord, marks.t[i]);
        for (Index c = 0; c < d; c++)
            marks.values[i * d + c] = value_at(target, chord, marks.t[i], c);
    }
    return marks;
}

/* Least squares for the control points first .. stop - 1 of (d, n + 3); the others are given. */
static int solved_points(Call *call, const Marks *marks, Table x, Index d, double (*maps)[4][4],
                         const double *limits, double tightest, Index first, Index stop,
                         Table points)
{
    Index unknowns = stop - first, all = points.columns;
    if (unknowns <= 0)
        return 1;
    double *band = scratch(call, unknowns * 4), *right = scratch(call, unknowns * d);
    double *wanted = scratch(call, d);
    if (call->failed)
        return 0;
    memset(band, 0, (size_t)(unknowns * 4) * sizeof(double));
    memset(right, 0, (size_t)(unknowns * d) * sizeof(double));
    double before = 0.0;
    for (Index i = 0; i < marks->count; i++) {
        Index span = marks->spans[i];
        double local = (marks->t[i] - x.at[span]) / (x.at[span + 1] - x.at[span]);
        double values[4], turns[4], row[4];
        bernstein(local, values, turns);
        for (Index k = 0; k < 4; k++) {
            row[k] = 0.0;
            for (Index j = 0; j < 4; j++)
                row[k] += values[j] * maps[span][j][k];
        }
        /* The length of the pieces on either side, in terms of what is allowed there. */
        double after = 0.0;
        if (i + 1 < marks->count) {
            double ratio = tightest / limits[marks->chords[i]];
            after = (marks->t[i + 1] - marks->t[i]) * (ratio * ratio);
        }
        double weight = before + after;
        before = after;
        for (Index c = 0; c < d; c++) {
            wanted[c] = marks->values[i * d + c];
            for (Index k = 0; k < 4; k++)
                if (span + k < first || span + k >= stop)
                    wanted[c] -= row[k] * points.at[c * all + span + k];
        }
        for (Index j = 0; j < 4; j++) {
            Index unknown = span + j - first;
            if (unknown < 0 || unknown >= unknowns)
                continue;
            double weighted = row[j] * weight;
            for (Index k = j; k < 4; k++)
                band[unknown * 4 + k - j] += weighted * row[k];
            for (Index c = 0; c < d; c++)
                right[unknown * d + c] += weighted * wanted[c];
        }
    }
    if (!solve_banded(band, right, unknowns, 3, d, 0.0))
        return 0;
    for (Index i = 0; i < unknowns; i++)
        for (Index c = 0; c < d; c++)
            points.at[c * all + first + i] = right[i * d + c];
    return 1;
}

/* Off and a third of the slope at a mark, from the net of its span. */
static void residual(const Marks *marks, Table x, Index d, const double *nets, Index mark,
                     double *off, double *turn)
{
    Index n = x.rows - 1, span = marks->spans[mark];
    double values[4], turns[4];
    bernstein((marks->t[mark] - x.at[span]) / (x.at[span + 1] - x.at[span]), values, turns);
    for (Index c = 0; c < d; c++) {
        double value = 0.0, slope = 0.0;
        for (Index j = 0; j < 4; j++) {
            value += values[j] * nets[(j * d + c) * n + span];
            slope += turns[j] * nets[(j * d + c) * n + span];
        }
        off[c] = value - marks->values[mark * d + c];
        turn[c] = slope;
    }
}

/* The largest deviation of each span in terms of its limit; returns the largest of all. On a piece
between marks the Bernstein coefficients of R - L are its ends, and from there a third of the slope
times the length. */
static double certified(const Marks *marks, Table x, Index d, const double *nets,
                        const double *limits, double *room, double *ratios)
{
    Index n = x.rows - 1;
    double *off = room, *turn = off + d, *next_off = turn + d, *next_turn = next_off + d;
    double bound = 0.0;
    memset(ratios, 0, (size_t)n * sizeof(double));
    residual(marks, x, d, nets, 0, off, turn);
    for (Index i = 0; i + 1 < marks->count; i++) {
        Index span = marks->spans[i];
        double limit = limits[marks->chords[i]], allowed = limit * limit;
        residual(marks, x, d, nets, i + 1, next_off, next_turn);
        double share = (marks->t[i + 1] - marks->t[i]) / (x.at[span + 1] - x.at[span]);
        /* Before a knot the slope is that of the span's own net: what the next one says, if that is
        far shorter, carries a far larger rounding error. */
        int at_knot = marks->spans[i + 1] != span;
        double first = 0.0, second = 0.0, third = 0.0, fourth = 0.0;
        for (Index c = 0; c < d; c++) {
            double rise = (marks->values[(i + 1) * d + c] - marks->values[i * d + c]) / 3.0;
            double slope = at_knot ? nets[(3 * d + c) * n + span] - nets[(2 * d + c) * n + span]
                                   : next_turn[c];
            double after_start = turn[c] * share - rise + off[c];
            double before_stop = slope * share - rise - next_off[c];
            first += off[c] * off[c];
            second += after_start * after_start;
            third += before_stop * before_stop;
            fourth += next_off[c] * next_off[c];
        }
        double largest = worse(worse(second, third), worse(first, fourth));
        bound = worse(bound, largest);
        /* A mark belongs to both pieces, so to that on which less is allowed; the span after a knot
        answers for it, as does the span before. */
        double ratio = largest / allowed;
        if (i > 0) {
            double other = limits[marks->chords[i - 1]];
            ratio = worse(ratio, first / (other * other));
        }
        if (i + 2 < marks->count) {
            double other = limits[marks->chords[i + 1]];
            ratio = worse(ratio, fourth / (other * other));
        }
        ratios[span] = worse(ratios[span], ratio);
        memcpy(off, next_off, (size_t)(2 * d) * sizeof(double));
    }
    for (Index span = 0; span < n; span++)
        ratios[span] = sqrt(ratios[span]);
    return sqrt(bound);
}

Stretch stretch_of(Call *call, PyObject *const *values)
{
    Stretch stretch = {.target = target_of(call, values), .limits = reals(call, values[3]),
                       .before = reals(call, values[4]), .after = reals(call, values[5])};
    for (int side = 0; side < 2; side++)
        stretch.old[side] = piece_of(call, values + 6 + 2 * side, stretch.target.d);
    expect(call,
           stretch.limits.rows == stretch.target.chords && stretch.before.rows == 3 &&
               stretch.after.rows == 3,
           "limits, or knots before or behind, are missing");
    stretch.tightest = call->failed ? 0.0 : stretch.limits.at[0];
    for (Index i = 1; !call->failed && i < stretch.limits.rows; i++)
        stretch.tightest = smaller(stretch.limits.at[i], stretch.tightest);
    return stretch;
}

int attempted(Call *call, const Stretch *stretch, Table x, Table points, double *nets,
              double *ratios, double *bound)
{
    Index n = x.rows - 1, d = stretch->target.d, first = 0, stop = n + 3;
    const double *limits = stretch->limits.at;
    double *knots = scratch(call, n + 7), *room = scratch(call, (DEGREE + 1) * d);
    double(*maps)[4][4] = (double(*)[4][4])scratch(call, 16 * n);
    Marks marks = placed_marks(call, &stretch->target, x);
    if (call->failed)
        return 0;
    memcpy(knots, stretch->before.at, 3 * sizeof(double));
    memcpy(knots + 3, x.at, (size_t)(n + 1) * sizeof(double));
    memcpy(knots + n + 4, stretch->after.at, 3 * sizeof(double));
    for (Index span = 0; span < n; span++)
        map_of(knots + span + 1, maps[span]);
    memset(points.at, 0, (size_t)(d * (n + 3)) * sizeof(double));
    if (stretch->old[0].knots.at) {
        dictate(stretch->old, knots + 1, 0, room, points);
        first += PINNED;
    }
    if (stretch->old[1].knots.at) {
        dictate(stretch->old + 1, knots + n + 1, n, room, points);
        stop -= PINNED;
    }
    if (!solved_points(call, &marks, x, d, maps, limits, stretch->tightest, first, stop, points))
        return 0;
    for (Index c = 0; c < d; c++)
        for (Index span = 0; span < n; span++) {
            const double *row = points.at + c * (n + 3) + span;
            for (Index j = 0; j < 4; j++) {
                double sum = 0.0;
                for (Index k = 0; k < 4; k++)
                    sum += maps[span][j][k] * row[k];
                nets[(j * d + c) * n + span] = sum;
            }
        }
    *bound = certified(&marks, x, d, nets, limits, room, ratios);
    return 1;
}

METHOD(core_attempt)
{
    /* t, points, slopes of the target, limits, knots before the stretch (3,) and behind it, knots (6,)
    and control points (4, d) of the old pieces to be joined on the left and on the right, None where
    there is none; the knots of the stretch (n + 1,), control points (d, n + 3), nets (4, d, n),
    ratios (n,); returns the bound, None if the control points are not determined */
    Call call;
    begin(&call, count, 14);
    if (call.failed)
        return finish(&call, NULL);
    Stretch stretch = stretch_of(&call, values);
    Table x = reals(&call, values[10]), points = output(&call, values[11]);
    Table nets = output(&call, values[12]), ratios = output(&call, values[13]);
    Index n = x.rows - 1, d = stretch.target.d;
    int joined = stretch.old[0].knots.at || stretch.old[1].knots.at;
    expect(&call, n >= (joined ? 2 : 1), "a stretch needs more knots");
    expect(&call,
           points.rows == d && points.columns == n + 3 && nets.rows == 4 &&
               nets.columns == d * n && ratios.rows == n,
           "the outputs are of wrong lengths");
    for (Index span = 0; !call.failed && span < n; span++)
        expect(&call, x.at[span] < x.at[span + 1], "knots must ascend");
    double bound = 0.0;
    if (call.failed || attempted(&call, &stretch, x, points, nets.at, ratios.at, &bound))
        return finish(&call, call.failed ? NULL : PyFloat_FromDouble(bound));
    return finish(&call, Py_NewRef(Py_None));
}
