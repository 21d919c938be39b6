/* Which vertices of a polyline are to stand for all, and how far the others are from their chords: to
thin it for a fit, see multirep.splines.simplification, and as few as can be for a polyline that follows
samples, see multirep.representations.polyline.simplification. */
#include "core.h"

#include <float.h>
#include <math.h>

/* A polyline to be thinned; how far it may be off at vertex i, squared: squares[i - 1], or `most` at
all of them. */
typedef struct {
    Table t, points;
    const double *squares;
    double most;
    double *slope;
} Polyline;

/* Into `slope`. */
static void aim(const Polyline *line, Index start, Index stop)
{
    Index d = line->points.columns;
    const double *first = line->points.at + start * d, *last = line->points.at + stop * d;
    double length = line->t.at[stop] - line->t.at[start];
    for (Index c = 0; c < d; c++)
        line->slope[c] = (last[c] - first[c]) / length;
}

/* How far a vertex is from the chord that was aimed from `start`, squared. */
static inline double off_chord(const Polyline *line, Index start, Index i)
{
    Index d = line->points.columns;
    const double *first = line->points.at + start * d, *row = line->points.at + i * d;
    double along = line->t.at[i] - line->t.at[start], square = 0.0;
    for (Index c = 0; c < d; c++) {
        double off = row[c] - first[c] - along * line->slope[c];
        square += off * off;
    }
    return square;
}

/* The vertex that is farthest from the chord between two, in terms of what is allowed; -1 if all are
within that. */
static Index worst_beyond(const Polyline *line, Index start, Index stop)
{
    double most = line->most;
    Index worst = -1;
    aim(line, start, stop);
    for (Index i = start + 1; i < stop; i++) {
        double far = off_chord(line, start, i);
        if (line->squares)
            far /= line->squares[i - 1];
        if (far > most) {
            most = far;
            worst = i;
        }
    }
    return worst;
}

/* Whether one chord can stand for all vertices between two. */
static int serves(const Polyline *line, Index start, Index stop)
{
    aim(line, start, stop);
    for (Index i = start + 1; i < stop; i++) {
        double far = off_chord(line, start, i);
        if (line->squares)
            far /= line->squares[i - 1];
        if (far > line->most)
            return 0;
    }
    return 1;
}

/* The vertices whose chords have about the allowed sagitta, from 0 to the last; how many. */
static Index laid_out(const Polyline *line, const double *limits, double limit, Index *chosen)
{
    Index m = line->t.rows - 1, d = line->points.columns, found = 1;
    const double *t = line->t.at;
    double sum = 0.0, next_whole = 1.0, before = t[1] - t[0], *slope = line->slope;
    for (Index c = 0; c < d; c++)
        slope[c] = (line->points.at[c + d] - line->points.at[c]) / before;
    chosen[0] = 0;
    for (Index i = 1; i < m; i++) {
        const double *row = line->points.at + i * d;
        double after = t[i + 1] - t[i], square = 0.0;
        for (Index c = 0; c < d; c++) {
            double next = (row[c + d] - row[c]) / after, kink = next - slope[c];
            square += kink * kink;
            slope[c] = next;
        }
        /* Each vertex stands for a kink J over the mean h of its two steps: h sqrt(J / h / (8 limit)). */
        double share = sqrt(square) * (after + before) / (16 * (limits ? limits[i - 1] : limit));
        sum += smaller(sqrt(share), 1.0);
        before = after;
        if (sum >= next_whole) {
            chosen[found++] = i;
            next_whole = floor(sum) + 1.0;
        }
    }
    chosen[found++] = m;
    return found;
}

/* Append the vertices at which a group is cut, and its end; 0 when more rounds would be needed. */
static int cut(const Polyline *line, Index start, Index stop, Index rounds, Index *kept, Index *count)
{
    Index worst = worst_beyond(line, start, stop);
    if (worst < 0)
        kept[(*count)++] = stop;
    else if (rounds <= 1)
        return 0;
    else
        return cut(line, start, worst, rounds - 1, kept, count) &&
               cut(line, worst, stop, rounds - 1, kept, count);
    return 1;
}

/* Merge groups 2 i + side and 2 i + 1 + side where one chord serves both; how many vertices stay. */
static Index merged(const Polyline *line, Index *kept, Index count, Index side)
{
    Index written = 1 + side;
    for (Index j = 1 + side; j < count; j += 2) {
        /* Vertex j may go, j + 1 stays. */
        if (j + 1 == count || !serves(line, kept[j - 1], kept[j + 1]))
            kept[written++] = kept[j];
        if (j + 1 < count)
            kept[written++] = kept[j + 1];
    }
    return written;
}

METHOD(core_thin)
{
    /* t (m + 1,), points (m + 1, d), limits of chords (m,) or None, the limit of all then; rounds of
    cutting and of merging, how large a part of the vertices must be left at most to go on. Returns the
    vertices to keep, from 0 to m, and how far the others are from each chord, as bytes. */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Polyline line = {reals(&call, values[0]), reals(&call, values[1]), NULL, 1.0, NULL};
    Table limits = reals_or_none(&call, values[2]);
    double limit = limits.at ? 1.0 : real(&call, values[3]), going_on = real(&call, values[6]);
    Index rounds = integer(&call, values[4]), merges = integer(&call, values[5]);
    Index m = line.t.rows - 1, d = line.points.columns, chosen = 0, found = 1;
    expect(&call,
           m >= 1 && line.t.columns == 1 && line.points.rows == m + 1 &&
               (!limits.at || limits.rows == m),
           "each vertex needs a parameter, each chord a limit");
    expect(&call, rounds <= 64, "at most 64 rounds of cutting are possible");
    Index *groups = index_scratch(&call, m + 1), *kept = index_scratch(&call, m + 1);
    double *inner = limits.at ? scratch(&call, m) : NULL;
    double *squares = limits.at ? scratch(&call, m) : NULL;
    line.slope = scratch(&call, d);
    if (call.failed)
        return finish(&call, NULL);
    for (Index i = 0; limits.at && i + 1 < m; i++) {
        inner[i] = smaller(limits.at[i], limits.at[i + 1]);
        squares[i] = inner[i] * inner[i];
    }
    line.squares = squares;
    line.most = limit * limit;
    chosen = laid_out(&line, inner, limit, groups);
    kept[0] = 0;
    for (Index k = 0; k + 1 < chosen; k++)
        if (!cut(&line, groups[k], groups[k + 1], rounds, kept, &found)) {
            for (found = 0; found <= m; found++)
                kept[found] = found;
            break;
        }
    for (Index side = 0; side < merges; side++) {
        Index before = found;
        found = merged(&line, kept, found, side % 2);
        if ((double)found > going_on * (double)before)
            break;
    }
    double *deviations = scratch(&call, found), largest = 0.0;
    if (call.failed)
        return finish(&call, NULL);
    for (Index i = 0; i < (m + 1) * d; i++)
        largest = larger(largest, fabs(line.points.at[i]));
    double slack = 16 * DBL_EPSILON * sqrt((double)d) * largest;
    for (Index k = 0; k + 1 < found; k++) {
        double most = 0.0;
        aim(&line, kept[k], kept[k + 1]);
        for (Index i = kept[k] + 1; i < kept[k + 1]; i++)
            most = worse(most, off_chord(&line, kept[k], i));
        deviations[k] = kept[k + 1] - kept[k] > 1 ? sqrt(most) + slack : 0.0;
    }
    PyObject *vertices = bytes_of(kept, found * (Index)sizeof(Index));
    return finish(&call, pair_of(&call, vertices,
                                 bytes_of(deviations, (found - 1) * (Index)sizeof(double))));
}

/* How far the chord between two samples is from one between them, squared. */
static inline double off_samples(const Table *t, const Table *vertices, const Table *targets,
                                 Index left, Index right, Index at)
{
    Index d = vertices->columns;
    const double *first = vertices->at + left * d, *last = vertices->at + right * d;
    double u = (t->at[at] - t->at[left]) / (t->at[right] - t->at[left]), square = 0.0;
    for (Index c = 0; c < d; c++) {
        double off = first[c] + u * (last[c] - first[c]) - targets->at[at * d + c];
        square += off * off;
    }
    return square;
}

/* Whether the chord between two samples is within the allowance of every sample between. */
static int replaces(const Table *t, const Table *vertices, const Table *targets,
                    const double *squares, Index left, Index right)
{
    for (Index at = left + 1; at < right; at++)
        if (!(off_samples(t, vertices, targets, left, right, at) <= squares[at]))
            return 0;
    return 1;
}

METHOD(core_simplify)
{
    /* t, vertices to choose from, samples to follow, what is allowed on each chord, samples that must
    stay (their indices), what rounding takes of the largest coordinate, rounds; returns the indices
    of the chosen samples, as bytes, and how far the others are at most. Of each run of neighbours
    that can go every other one does, round by round. */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    Table t = reals(&call, values[0]), vertices = reals(&call, values[1]);
    Table targets = reals(&call, values[2]), allowed = reals(&call, values[3]);
    Places keep = places(&call, values[4]);
    double unit = real(&call, values[5]), largest = 0.0;
    Index rounds = integer(&call, values[6]), m = t.rows, d = vertices.columns, chosen = m;
    expect(&call,
           m >= 2 && vertices.rows == m && targets.rows == m && allowed.rows == m - 1 &&
               d == targets.columns,
           "each sample needs a vertex and a target, each chord an allowance");
    enum { REFUSED, UNTESTED, HELD };
    double *squares = scratch(&call, m);
    Index *kept = index_scratch(&call, m), *state = index_scratch(&call, m);
    for (Index i = 0; !call.failed && i < m * d; i++)
        largest = larger(largest, fabs(vertices.at[i]));
    double rounding = unit * largest * sqrt((double)d);
    for (Index i = 0; !call.failed && i < m; i++) {
        kept[i] = i;
        state[i] = UNTESTED;
        if (i > 0 && i + 1 < m) {
            double room = smaller(allowed.at[i - 1], allowed.at[i]) - rounding;
            squares[i] = room > 0 ? room * room : -1.0;
        }
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
    double worst = 0.0;
    for (Index k = 0; k + 1 < chosen; k++)
        for (Index at = kept[k] + 1; at < kept[k + 1]; at++)
            worst = worse(worst, off_samples(&t, &vertices, &targets, kept[k], kept[k + 1], at));
    PyObject *deviation = PyFloat_FromDouble(chosen < m ? sqrt(worst) + rounding : 0.0);
    return finish(&call, pair_of(&call, bytes_of(kept, chosen * (Index)sizeof(Index)), deviation));
}
