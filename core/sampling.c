/* Sampling a spline by few chords, each proved; see multirep.splines.sampling for the reasons. */
#include "core.h"

#include <math.h>
#include <string.h>

/* The numbers of multirep.splines.sampling; see there. */
enum { MOST_PARTS = 16, BLOCK = 6, BLOCK_ROUNDS = 2, ROUNDS = 62, SPLITS = 2 };
static const double MARGIN = 0.95, SPARE = 0.25, SPARE_FROM = 5.0, FEW = 0.02, LEAST_ROOM = 0.25;

/* Chords from t[i] to t[i + 1], points (count + 1, d) there, and their bounds. */
typedef struct {
    Index count;
    double *t, *points, *bounds;
} Samples;

/* Parameters that must stay samples, and what each stretch between them is proved with. */
typedef struct {
    Proof proof;
    double tolerance, worst, room;
    double *fixed;
    Index stretches;
} Task;

/* The curve at increasing parameters, summed as scipy sums. */
static void points_at(const Proof *proof, Index count, const double *t, double *points)
{
    const Spline *spline = &proof->spline;
    Index p = spline->degree, all = spline->dimension, d = proof->d, span = spline->first;
    double *values = proof->net, *row = proof->rows;
    for (Index i = 0; i < count; i++) {
        span = walked(spline, span, t[i]);
        basis_values(local_knots(spline, span), p, t[i], values);
        const double *rows = local_rows(spline, span);
        for (Index c = 0; c < all; c++) {
            double sum = 0.0;
            for (Index a = 0; a <= p; a++)
                sum += rows[a * all + c] * values[a];
            row[c] = sum;
        }
        for (Index c = 0; c < d; c++)
            points[i * d + c] = proof->rational ? row[c] / row[d] : row[c];
    }
}

/* The ends, and the knots between them of multiplicity p or more. */
static void fix(Call *call, Task *task, double start, double stop)
{
    const Spline *spline = &task->proof.spline;
    const double *knots = spline->knots;
    Index p = spline->degree, first = span_of(spline, start), last = span_of(spline, stop);
    while (last > first && !(knots[last] < stop))
        last--;
    double *fixed = task->fixed = scratch(call, last - first + 2);
    if (call->failed)
        return;
    fixed[0] = start;
    for (Index i = first + 1; i + p - 1 <= last; i++)
        if (knots[i] == knots[i + p - 1] && knots[i] > fixed[task->stretches])
            fixed[++task->stretches] = knots[i];
    fixed[++task->stretches] = stop;
    task->worst = task->proof.unit;
    for (Index span = first; task->proof.rational && span <= last; span++)
        if (knots[span] < knots[span + 1]) {
            enter_cell(&task->proof, span);
            task->worst = worse(task->worst, task->proof.slack);
        }
}

/* Lay chords out between the fixed parameters. */
static Samples laid_out(Call *call, Task *task, Density *density)
{
    Samples found = {0, NULL, NULL, NULL};
    Index stretches = task->stretches;
    const double *fixed = task->fixed;
    double *sums = scratch(call, stretches + 1), total = 0.0;
    for (Index i = 0; !call->failed && i <= stretches; i++) {
        sums[i] = sum_at(density, fixed[i]);
        if (i > 0)
            total += ceil(sums[i] - sums[i - 1]) + 2;
    }
    expect(call, total < 1e15, "the chords are without end");
    found.t = scratch(call, call->failed ? 0 : (Index)total + 1);
    for (Index i = 0; !call->failed && i < stretches; i++) {
        double need = sums[i + 1] - sums[i];
        Index chords = at_least((Index)ceil(need + (need > SPARE_FROM ? SPARE : 0.0)), 1);
        double *t = found.t + found.count;
        lay_out(density, fixed[i], sums[i], sums[i + 1], chords, t);
        Index kept = 1; /* rounding may lay two together */
        for (Index part = 1; part < chords; part++)
            if (t[part] > t[kept - 1] && t[part] < fixed[i + 1])
                t[kept++] = t[part];
        found.count += kept;
    }
    if (!call->failed)
        found.t[found.count] = fixed[stretches];
    return found;
}

static void prove(Task *task, Samples *samples, Index first, Index count)
{
    Index d = task->proof.d;
    Chords chords = {count, samples->t + first, samples->t + first + 1, samples->points + first * d,
                     samples->points + (first + 1) * d, 1};
    int cheap = !task->proof.rational && task->proof.spline.degree <= 3;
    prove_chords(&task->proof, &chords, &task->tolerance, cheap, samples->bounds + first);
}

/* A block of chords, first .. stop - 1, in which one failed or none did. */
typedef struct {
    Index first, stop, parts;
    int fails;
} Block;

/* Lay the blocks with a failing chord out anew, by the density as their chords proved to need it; 0
when two samples would fall together. */
static int improved(Call *call, Task *task, Samples *samples, Density *density, const double *needs,
                    Index size, Index shift)
{
    Index d = task->proof.d, old = samples->count, total = 0, next = 1;
    Samples found = {0, NULL, NULL, NULL};
    Block *blocks = (Block *)scratch(call, (old + 1) * (Index)(sizeof(Block) / sizeof(double)));
    Index count = 0;
    for (Index first = 0, stop; !call->failed && first < old; first = stop) {
        stop = at_most(first + (size - (first - shift % size + size) % size), old);
        if (size > 1) /* no block passes a fixed parameter */
            for (Index i = first + 1; i < stop; i++) {
                while (next < task->stretches && task->fixed[next] < samples->t[i])
                    next++;
                if (samples->t[i] == task->fixed[next])
                    stop = i;
            }
        Block block = {first, stop, stop - first, 0};
        double need = 0.0;
        for (Index i = first; i < stop; i++) {
            block.fails |= !(samples->bounds[i] <= task->tolerance);
            need += share_needed(needs[i]);
        }
        if (block.fails) {
            double parts = ceil(need);
            parts = size == 1 ? smaller(larger(parts, 2), MOST_PARTS) : larger(parts, 1);
            expect(call, parts < 1e15, "the chords are without end");
            block.parts = call->failed ? 1 : (Index)parts;
        }
        total += block.parts;
        blocks[count++] = block;
    }
    found.count = total;
    found.t = scratch(call, total + 1);
    found.points = scratch(call, (total + 1) * d);
    found.bounds = scratch(call, total);
    Density finer = empty_density(call, density->cells + old);
    Index at = 0;
    for (Index k = 0; !call->failed && k < count; k++) {
        Block *block = blocks + k;
        size_t points = (size_t)(block->stop - block->first) * (size_t)d;
        if (!block->fails) {
            size_t length = (size_t)block->parts * sizeof(double);
            memcpy(found.t + at, samples->t + block->first, length);
            memcpy(found.bounds + at, samples->bounds + block->first, length);
            memcpy(found.points + at * d, samples->points + block->first * d,
                   points * sizeof(double));
        } else {
            double *t = found.t + at, *there = found.points + at * d;
            size_t point = (size_t)d * sizeof(double);
            const double *before = samples->t + block->first;
            correct(density, block->stop - block->first, before, needs + block->first, &finer);
            lay_out(&finer, before[0], 0.0, finer.sums[finer.cells], block->parts, t);
            t[block->parts] = samples->t[block->stop];
            for (Index i = 0; i < block->parts; i++)
                if (!(t[i + 1] > t[i]))
                    return 0;
            memcpy(there, samples->points + block->first * d, point);
            points_at(&task->proof, block->parts - 1, t + 1, there + d);
            memcpy(there + block->parts * d, samples->points + block->stop * d, point);
            prove(task, &found, at, block->parts);
        }
        at += block->parts;
    }
    if (call->failed)
        return 0;
    found.t[total] = samples->t[old];
    memcpy(found.points + total * d, samples->points + old * d, (size_t)d * sizeof(double));
    *samples = found;
    return 1;
}

/* Sample until every chord is proved; 0 when that cannot be. */
static int sampled(Call *call, Task *task, double start, double stop, Samples *samples)
{
    Proof *proof = &task->proof;
    Density density = density_of(call, &proof->spline, proof->rational, start, stop,
                                 task->room * MARGIN);
    int held = call->held;
    if (!call->failed)
        *samples = laid_out(call, task, &density);
    samples->points = scratch(call, (samples->count + 1) * proof->d);
    samples->bounds = scratch(call, samples->count);
    if (call->failed)
        return 0;
    points_at(proof, samples->count + 1, samples->t, samples->points);
    prove(task, samples, 0, samples->count);
    for (int turn = 0; turn <= ROUNDS; turn++) {
        Index failing = 0, size = turn < BLOCK_ROUNDS ? BLOCK : 1;
        for (Index i = 0; i < samples->count; i++)
            failing += !(samples->bounds[i] <= task->tolerance);
        if (!failing)
            return 1;
        if ((double)failing <= FEW * (double)samples->count + 1)
            size = 1;
        /* What proved to be needed corrects the density in blocks with a failing chord, which are laid
        out anew between their ends; every other round with ends elsewhere. */
        double *needs = scratch(call, samples->count);
        for (Index i = 0; !call->failed && i < samples->count; i++)
            needs[i] = sqrt(larger(samples->bounds[i] - task->worst, 0.0) / task->room);
        if (call->failed ||
            !improved(call, task, samples, &density, needs, size, size / 2 * (turn % 2)))
            return 0;
        void *wanted[] = {samples->points, samples->bounds, samples->t};
        drop(call, held, wanted, 3);
    }
    return 0;
}

/* Whether a walk along the knots comes to an end. */
static int are_sound(const Spline *spline)
{
    Index last = spline->count + spline->degree;
    int sound = isfinite(spline->knots[0]) && isfinite(spline->knots[last]);
    for (Index i = 0; i < last; i++)
        sound &= spline->knots[i] <= spline->knots[i + 1];
    return sound;
}

METHOD(core_sample)
{
    /* knots, coefficients, degree, rational, start, stop, tolerance; returns parameters, points and
    the bound of each chord as bytes, or None when the tolerance is out of reach */
    Call call;
    begin(&call, count, 7);
    if (call.failed)
        return finish(&call, NULL);
    int rational;
    Spline spline = perhaps_rational(&call, values, &rational);
    double start = real(&call, values[4]), stop = real(&call, values[5]);
    Task task = {proof_of(&call, spline, rational, SPLITS), real(&call, values[6]), 0.0, 0.0, NULL, 0};
    expect(&call, start < stop && isfinite(stop - start), "an interval is wanted");
    expect(&call, call.failed || are_sound(&spline), "knots must be finite and not descend");
    if (call.failed)
        return finish(&call, NULL);
    task.proof.unit = rounding_unit(&spline, rational, start, stop, NULL, 0);
    fix(&call, &task, start, stop);
    task.room = task.tolerance - task.worst;
    Samples samples = {0, NULL, NULL, NULL};
    PyObject *found = NULL;
    if (!call.failed && task.room >= LEAST_ROOM * task.worst &&
        sampled(&call, &task, start, stop, &samples)) {
        Index size = (Index)sizeof(double), m = samples.count;
        PyObject *t = bytes_of(samples.t, (m + 1) * size);
        PyObject *points = bytes_of(samples.points, (m + 1) * task.proof.d * size);
        PyObject *bounds = bytes_of(samples.bounds, m * size);
        found = t && points && bounds ? PyTuple_Pack(3, t, points, bounds) : NULL;
        Py_XDECREF(t);
        Py_XDECREF(points);
        Py_XDECREF(bounds);
        call.failed |= !found;
    } else if (!call.failed)
        found = Py_NewRef(Py_None);
    return finish(&call, found);
}
