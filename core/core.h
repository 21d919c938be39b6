/* The compiled core: the mathematics of splines that an edit calls many times on short arrays.

Every function here stands for a numpy function of multirep.splines or of a representation, which
stays beside it as the reference and the fall-back: the same formulas in the same order, without
the cost of some dozens of numpy calls. Only the limited API (3.11) and the buffer protocol are
used, so one build serves every Python from 3.11 on and no headers of numpy are needed.

Compiled without contraction (-ffp-contract=off) and without -ffast-math: the rounding terms of the
proofs count one rounding an operation.
*/
#ifndef MULTIREP_CORE_H
#define MULTIREP_CORE_H

#define PY_SSIZE_T_CLEAN
#include <Python.h>

typedef Py_ssize_t Index;

/* -- arguments.c: arrays in and out ------------------------------------------------------------ */

/* A float64 array, C-contiguous; (n,) has one column, (n, a, b) has a b. */
typedef struct {
    double *at;
    Index rows, columns;
} Table;

/* An intp array, flat. */
typedef struct {
    const Index *at;
    Index rows;
} Places;

/* The same, to be filled. */
typedef struct {
    Index *at;
    Index rows;
} Slots;

enum { MOST_VIEWS = 16, MOST_BLOCKS = 32 };

/* What one call holds until `finish`: views of arrays and scratch memory. The first error sticks,
and what is read after it is empty: check `failed` once, before any table is used. */
typedef struct {
    Py_buffer views[MOST_VIEWS];
    void *blocks[MOST_BLOCKS];
    int opened, held, failed;
} Call;

void begin(Call *call, Index count, Index expected);
PyObject *finish(Call *call, PyObject *result);
Table reals(Call *call, PyObject *array);
Table reals_or_none(Call *call, PyObject *array);
Table output(Call *call, PyObject *array);
Places places(Call *call, PyObject *array);
Slots slots(Call *call, PyObject *array);
Index integer(Call *call, PyObject *number);
double real(Call *call, PyObject *number);
double *scratch(Call *call, Index count);
Index *index_scratch(Call *call, Index count);
void expect(Call *call, int condition, const char *otherwise);
/* Free what was asked for since `held` blocks were, but for some of it. */
void drop(Call *call, int held, void *const *wanted, int count);
/* A new bytearray of numbers, to be read by numpy.frombuffer, and a pair of such. */
PyObject *bytes_of(const void *numbers, Index size);
PyObject *pair_of(Call *call, PyObject *first, PyObject *second);
/* A list of numbers, for few of them. */
PyObject *numbers(Call *call, const double *at, Index count);

/* -- small things ------------------------------------------------------------------------------ */

static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double smaller(double a, double b) { return a < b ? a : b; }
/* The larger one in a proof: what is no number stays. */
static inline double worse(double a, double b) { return a >= b || a != a ? a : b; }
static inline Index at_least(Index a, Index b) { return a > b ? a : b; }
static inline Index at_most(Index a, Index b) { return a < b ? a : b; }
static inline double squared_norm(const double *row, Index dimension)
{
    double sum = 0.0;
    for (Index c = 0; c < dimension; c++)
        sum += row[c] * row[c];
    return sum;
}

/* The last j of low .. high with at[j] <= x, or else low; at ascends. */
static inline Index bisected(const double *at, Index low, Index high, double x)
{
    while (low < high) {
        Index middle = low + (high - low + 1) / 2;
        if (at[middle] <= x)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

/* The same, walking on from an earlier one if it is near. */
static inline Index interval_at(const double *at, Index low, Index high, Index from, double x)
{
    if (x < at[from] || (high - from >= 8 && x >= at[from + 8]))
        return bisected(at, low, high, x);
    while (from < high && at[from + 1] <= x)
        from++;
    return from;
}

/* -- rope.c: the rows of a block array, end to end ---------------------------------------------- */

typedef struct {
    const double **blocks;
    double *firsts; /* the first number of each block */
    Index *begins;  /* the first row of each block, and the row after the last */
    Index count, columns, current;
} Rope;

/* Of an array, of a tuple of arrays that lie row after row, or a rope that was made before. */
Rope rope_of(Call *call, PyObject *arrays);
static inline Index rope_length(const Rope *rope)
{
    return rope->count ? rope->begins[rope->count] : 0;
}
/* Make the block of a row the current one. */
void rope_turn(Rope *rope, Index row);
const double *rope_rows_elsewhere(Rope *rope, Index first, Index count, double *room);
/* Some neighbouring rows; copied to `room` where they lie in several blocks. */
static inline const double *rope_rows(Rope *rope, Index first, Index count, double *room)
{
    Index b = rope->current, begin = rope->begins[b];
    if (begin <= first && first + count <= rope->begins[b + 1])
        return rope->blocks[b] + (first - begin) * rope->columns;
    return rope_rows_elsewhere(rope, first, count, room);
}

/* -- basis.c: spans, basis functions, polar forms ---------------------------------------------- */

/* A spline: knots (n + p + 1,), coefficients (n, dimension), degree p >= 1; the first and the last
span of its domain that are not empty. */
typedef struct {
    const double *knots, *coefficients;
    Index degree, count, dimension, first, last;
} Spline;

Spline spline_of(Call *call, Table knots, Table coefficients, Index degree);
/* Of the first four arguments: knots, coefficients, degree, whether the last column is a weight. */
Spline perhaps_rational(Call *call, PyObject *const *values, int *rational);
Index span_of(const Spline *spline, double t);
Index walked(const Spline *spline, Index span, double t);
/* The 2p knots k - p + 1 .. k + p that the functions of span k depend on. */
static inline const double *local_knots(const Spline *spline, Index span)
{
    return spline->knots + span + 1 - spline->degree;
}
/* The p + 1 control points of span k. */
static inline const double *local_rows(const Spline *spline, Index span)
{
    return spline->coefficients + (span - spline->degree) * spline->dimension;
}
void basis_values(const double *local, Index degree, double t, double *values);
/* The same for a cubic, written out: the same operations. */
static inline void cubic_values(const double *u, double t, double *values)
{
    double after = u[3] - t, since = t - u[2], share = 1.0 / (u[3] - u[2]);
    double a = after * share, b = since * share;
    double one = a / (u[3] - u[1]), two = b / (u[4] - u[2]);
    a = after * one;
    b = (t - u[1]) * one + (u[4] - t) * two;
    double c = since * two;
    one = a / (u[3] - u[0]);
    two = b / (u[4] - u[1]);
    double three = c / (u[5] - u[2]);
    values[0] = after * one;
    values[1] = (t - u[0]) * one + (u[4] - t) * two;
    values[2] = (t - u[1]) * two + (u[5] - t) * three;
    values[3] = since * three;
}
void blossom_step(const double *local, Index degree, Index dimension, double argument, Index step,
                  double *rows);
void evaluate_piece(const Spline *spline, Index span, double t, double *rows);
void bernstein_net(const Spline *spline, Index span, double start, double stop, double *net,
                   double *rows);

/* -- deviation.c: proofs -------------------------------------------------------------------------- */

/* A proof under way. */
typedef struct {
    Spline spline;
    int rational;
    Index splits, d;     /* dimension of points */
    double unit;         /* rounding, but for the ratio of the weights of a cell */
    Index cell;          /* the span that `slack` and `second` are about */
    double slack;
    double *second;      /* S'' at both ends of the cell, (2, d); of a quadratic both are equal */
    double *rows, *net;  /* room for (p + 2) rows of all splits */
    double *low, *high;  /* the line where a piece starts and stops, (d,) */
} Proof;

/* Chords in their order. Inscribed: they begin and end on the curve; else they are one polyline's. */
typedef struct {
    Index count;
    const double *starts, *stops, *first, *last;
    int inscribed;
} Chords;

double rounding_unit(const Spline *spline, int rational, double start, double stop,
                     const Table *points, int tables);
void second_derivatives(const Spline *spline, Index span, double *second);
Proof proof_of(Call *call, Spline spline, int rational, Index splits);
void enter_cell(Proof *proof, Index span);
/* Without limits all chords get the sharp bound, else those that a cheaper one leaves above theirs;
one limit may serve all. */
void prove_chords(Proof *proof, const Chords *chords, const double *limits, Index limited,
                  double *bounds);

/* -- density.c: how many chords a stretch needs --------------------------------------------------- */

/* Nodes (cells + 1,) of a grid, how many chords each of its cells needs, and their sums (cells + 1,);
where one looked last in the nodes and in the sums. */
typedef struct {
    Index cells, node, sum;
    double *nodes, *shares, *sums;
} Density;

Density density_of(Call *call, const Spline *spline, int rational, double start, double stop,
                   double target);
Density empty_density(Call *call, Index cells);
/* What a chord counts that proved to need such a part of the tolerance's square root. */
double share_needed(double need);
/* Scale the density between t[0] and t[chords] so that the share of each chord is what it needs;
`finer` has room for a cell more for each chord. */
void correct(Density *density, Index chords, const double *t, const double *needs, Density *finer);
/* The sum up to a parameter. */
double sum_at(Density *density, double t);
/* The starts of so many chords of equal shares between two sums; the first starts at `begin`. */
void lay_out(Density *density, double begin, double from, double to, Index chords, double *t);

/* -- dyadic.c: numbers k / 2**l ---------------------------------------------------------------- */

double half_of(double start, double stop);

/* -- target.c: what a wavelet fit follows ------------------------------------------------------ */

/* A polyline about an origin: parameters (m + 1,), vertices (d, m + 1), slopes (d, m). */
typedef struct {
    Table t, points, slopes;
    Index chords, d;
} Target;

Target target_of(Call *call, PyObject *const *values);
/* The chord of a parameter, walking on from another one; a vertex belongs to the next. */
static inline Index chord_at(const Target *target, Index chord, double t)
{
    return interval_at(target->t.at, 0, target->chords - 1, chord, t);
}
static inline double value_at(const Target *target, Index chord, double t, Index c)
{
    return target->slopes.at[c * target->chords + chord] * (t - target->t.at[chord]) +
           target->points.at[c * (target->chords + 1) + chord];
}

/* An old piece to be joined: the six knots around its span, four control points about the target's
origin; no tables where nothing is joined. */
typedef struct {
    Table knots, points;
} Piece;

Piece piece_of(Call *call, PyObject *const *values, Index dimension);

/* -- attempt.c: least squares and proofs on given knots ------------------------------------------- */

/* What is fitted: the target with what is allowed on each chord, three knots before and behind, and
the old pieces on the left and on the right. */
typedef struct {
    Target target;
    Table limits, before, after;
    Piece old[2];
    double tightest;
} Stretch;

/* Of the first ten arguments: t, points and slopes of the target, limits, knots before and behind,
and the two pieces. */
Stretch stretch_of(Call *call, PyObject *const *values);
/* Control points (d, n + 3), nets (4, d, n) and ratios (n,) for the knots x (n + 1,), and the bound; 0
when the control points are not determined. */
int attempted(Call *call, const Stretch *stretch, Table x, Table points, double *nets,
              double *ratios, double *bound);

/* -- prediction.c: how fine knots must be -------------------------------------------------------- */

/* What is needed to look at a span, and the knots found so far. */
typedef struct {
    Call *call;
    Target target;
    const double *allowances, *projections, *places;
    Table corners;
    Index samples, count, room;
    double margin, shortest, start, stop; /* the ends of T */
    double *seen, *left, *found;
} Prediction;

/* Of the target's allowances and corners, projections (2 s, s) and places (s,), with room for so many
knots at first; the rest is to be filled in. */
Prediction prediction_of(Call *call, Target target, Table allowances, Table corners,
                         Table projections, Table places, Index room);
/* Halve a span of dyadic numbers until no part of it needs to be. */
void halve(Prediction *given, double start, double stop, int depth);

/* -- banded.c: symmetric banded systems -------------------------------------------------------- */

int solve_banded(double *band, double *right, Index count, Index bandwidth, Index columns,
                 double smallest_pivot);

/* -- what Python sees -------------------------------------------------------------------------- */

#define METHOD(name) PyObject *name(PyObject *module, PyObject *const *values, Py_ssize_t count)
METHOD(core_find_spans);
METHOD(core_basis_functions);
METHOD(core_blossom);
METHOD(core_rope);
METHOD(core_points);
METHOD(core_capsule);
METHOD(core_merged_capsules);
METHOD(core_leaf);
METHOD(core_nearest);
METHOD(core_polyline_rows);
METHOD(core_solve_window);
METHOD(core_breakpoints);
METHOD(core_fit);
METHOD(core_chord_bounds);
METHOD(core_sample);
METHOD(core_attempt);
METHOD(core_spare);
METHOD(core_follow);
METHOD(core_predict);
METHOD(core_beginning);
METHOD(core_halves);
METHOD(core_largest);
METHOD(core_course);
METHOD(core_target);
METHOD(core_between_common);
METHOD(core_interpolate);
METHOD(core_stretch);
METHOD(core_join);
METHOD(core_simplify);
METHOD(core_common);
METHOD(core_changed_spans);
METHOD(core_recount);
METHOD(core_refine_uniform);
METHOD(core_add_details);
METHOD(core_analyse);
METHOD(core_plus);
METHOD(core_thin);
METHOD(core_insert_knots);
METHOD(core_insert_knot);
METHOD(core_place);
METHOD(core_searched);
METHOD(core_with_block);
METHOD(core_joined);
METHOD(core_shared_rows);

#endif
