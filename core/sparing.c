/* Which knots a wavelet fit can spare; see multirep.representations.wavelet.fitting. */
#include "core.h"

#include <math.h>
#include <string.h>

/* The numbers of multirep.representations.wavelet.fitting; see there. */
static const double JUMP_SHARE = 0.15, WORTHWHILE = 0.02;
enum { TRIALS = 2 };

/* An attempt, and for each of its knots whether it must stay and which one of the first knots it
is. */
typedef struct {
    Table x, points;
    double *nets, *ratios, bound;
    char *needed;
    Index *place;
} Fit;

static Fit empty_fit(Call *call, Index knots, Index d)
{
    Fit fit = {{scratch(call, knots), knots, 1}, {scratch(call, d * (knots + 2)), d, knots + 2},
               scratch(call, 4 * d * (knots - 1)), scratch(call, knots - 1), 0.0,
               (char *)scratch(call, knots / 8 + 1), index_scratch(call, knots)};
    return fit;
}

/* What taking out an interior knot is expected to leave, in terms of what is allowed. */
static double cost_of(const Fit *fit, Index d, Index knot, double limit)
{
    const double *x = fit->x.at;
    Index n = fit->x.rows - 1, before = at_least(knot - 2, 0), after = at_most(knot + 2, n);
    double jump = 0.0;
    for (Index c = 0; c < d; c++) {
        double third[2];
        for (Index side = 0; side < 2; side++) {
            const double *net = fit->nets + c * n + knot - 1 + side;
            double length = x[knot + side] - x[knot - 1 + side];
            double cubic = net[3 * d * n] - net[0] + 3.0 * (net[d * n] - net[2 * d * n]);
            third[side] = 6.0 * cubic / (length * length * length);
        }
        jump += (third[1] - third[0]) * (third[1] - third[0]);
    }
    double product = (x[knot] - x[before]) * (x[knot] - x[knot - 1]);
    product *= (x[knot + 1] - x[knot]) * (x[after] - x[knot]);
    product /= 6.0 * (x[after] - x[before]);
    return JUMP_SHARE * sqrt(jump) * product / limit +
           0.5 * larger(fit->ratios[knot - 1], fit->ratios[knot]);
}

/* Mark the interior knots that promise to cost least among the two on either side; returns how
many. */
static Index mark_sparable(const Fit *fit, Index d, double limit, double *costs, char *spared)
{
    Index n = fit->x.rows - 1, marked = 0;
    memset(spared, 0, (size_t)(n + 1));
    if (n < 4)
        return 0;
    for (Index i = 1; i < n; i++)
        costs[i] = fit->needed[i] ? INFINITY : cost_of(fit, d, i, limit);
    for (Index i = 1; i < n; i++) {
        int least = costs[i] <= 1.0;
        for (Index k = at_least(i - 2, 1); k < i; k++)
            least &= costs[i] < costs[k];
        for (Index k = i + 1; k <= at_most(i + 2, n - 1); k++)
            least &= costs[i] <= costs[k];
        spared[i] = (char)least;
        marked += least;
    }
    return marked;
}

/* Copy the knots that are not spared. */
static void take_out(const Fit *fit, const char *spared, Fit *trial)
{
    Index kept = 0;
    for (Index i = 0; i < fit->x.rows; i++)
        if (!spared[i]) {
            trial->x.at[kept] = fit->x.at[i];
            trial->needed[kept] = fit->needed[i];
            trial->place[kept++] = fit->place[i];
        }
    trial->x.rows = kept;
    trial->points.columns = kept + 2;
}

/* Mark spared knots within two spans of one that fails as needed, all if there is none such; returns
how many remain spared. */
static Index put_back(const Fit *fit, const Fit *trial, char *spared)
{
    const double *x = fit->x.at, *u = trial->x.at;
    Index last = trial->x.rows - 1, from = 0, back = 0, left = 0;
    for (Index span = 0; span < last; span++) {
        if (trial->ratios[span] <= 1.0)
            continue;
        double low = u[at_least(span - 2, 0)], high = u[at_most(span + 3, last)];
        while (x[from] <= low)
            from++;
        for (Index i = from; x[i] < high; i++)
            if (spared[i]) {
                spared[i] = 0;
                fit->needed[i] = 1;
                back++;
            }
    }
    for (Index i = 0; i < fit->x.rows; i++)
        if (spared[i] && !back) {
            spared[i] = 0;
            fit->needed[i] = 1;
        } else
            left += spared[i];
    return left;
}

static int within_limits(const Fit *fit)
{
    int within = 1;
    for (Index span = 0; span + 1 < fit->x.rows; span++)
        within &= fit->ratios[span] <= 1.0;
    return within;
}

/* One round: 1 when a trial went well and took out enough to go on, 0 at the end, -1 when the round
took out nothing. */
static int thinned_once(Call *call, const Stretch *stretch, Fit *fit, Fit *trial, double *costs,
                        char *spared)
{
    Index d = stretch->target.d;
    Index marked = mark_sparable(fit, d, stretch->tightest, costs, spared), knots = fit->x.rows;
    if (!marked)
        return 0;
    for (int turn = 0; turn < TRIALS; turn++) {
        int held = call->held;
        take_out(fit, spared, trial);
        int determined = attempted(call, stretch, trial->x, trial->points, trial->nets,
                                   trial->ratios, &trial->bound);
        drop(call, held, NULL, 0);
        call->failed |= PyErr_CheckSignals() < 0; /* long fits can be interrupted */
        if (call->failed || !determined)
            return 0;
        if (within_limits(trial)) {
            Fit better = *trial;
            *trial = *fit;
            *fit = better;
            return !(WORTHWHILE * (double)(knots - 2) > (double)marked);
        }
        marked = put_back(fit, trial, spared);
        if (!marked)
            return -1;
    }
    for (Index i = 0; i < knots; i++)
        fit->needed[i] |= spared[i];
    return -1;
}

METHOD(core_spare)
{
    /* as for `attempt`, up to the knots (n + 1,), with nets (4, d, n) and ratios (n,) of an attempt
    within the limits; how many knots beside the ends must stay, rounds at most; returns the places of
    the knots that stay, control points, nets and ratios for these, and the bound; None if all stay */
    Call call;
    begin(&call, count, 16);
    if (call.failed)
        return finish(&call, NULL);
    Stretch stretch = stretch_of(&call, values);
    Table x = reals(&call, values[10]), nets = reals(&call, values[11]);
    Table ratios = reals(&call, values[12]);
    Index first = integer(&call, values[13]), last = integer(&call, values[14]);
    Index rounds = integer(&call, values[15]), n = x.rows - 1, d = stretch.target.d;
    expect(&call, n >= 1 && nets.rows == 4 && nets.columns == d * n && ratios.rows == n,
           "nets and ratios do not fit the knots");
    for (Index span = 0; !call.failed && span < n; span++)
        expect(&call, x.at[span] < x.at[span + 1], "knots must ascend");
    Index room = call.failed ? 1 : n + 1;
    Fit fit = empty_fit(&call, room, d), trial = empty_fit(&call, room, d);
    double *costs = scratch(&call, room);
    char *spared = (char *)scratch(&call, room / 8 + 1);
    if (call.failed)
        return finish(&call, NULL);
    memcpy(fit.x.at, x.at, (size_t)(n + 1) * sizeof(double));
    memcpy(fit.nets, nets.at, (size_t)(4 * d * n) * sizeof(double));
    memcpy(fit.ratios, ratios.at, (size_t)n * sizeof(double));
    for (Index i = 0; i <= n; i++) {
        fit.needed[i] = i <= first || i >= n - last;
        fit.place[i] = i;
    }
    int more = 1;
    for (Index round = 0; more && round < rounds; round++)
        more = thinned_once(&call, &stretch, &fit, &trial, costs, spared);
    if (call.failed || fit.x.rows == n + 1)
        return finish(&call, call.failed ? NULL : Py_NewRef(Py_None));
    Index real = (Index)sizeof(double), spans = fit.x.rows - 1;
    PyObject *places = bytes_of(fit.place, fit.x.rows * (Index)sizeof(Index));
    PyObject *rows = bytes_of(fit.points.at, d * (spans + 3) * real);
    PyObject *pieces = bytes_of(fit.nets, 4 * d * spans * real);
    PyObject *proved = bytes_of(fit.ratios, spans * real);
    PyObject *bound = PyFloat_FromDouble(fit.bound);
    PyObject *found = NULL;
    if (places && rows && pieces && proved && bound)
        found = PyTuple_Pack(5, places, rows, pieces, proved, bound);
    Py_XDECREF(places);
    Py_XDECREF(rows);
    Py_XDECREF(pieces);
    Py_XDECREF(proved);
    Py_XDECREF(bound);
    call.failed |= !found;
    return finish(&call, found);
}
