/* The nearest place of one Bernstein piece, with proof; see multirep.splines.closest.

The squared distance is f / g, both in Bernstein form. No place is nearer than c where all
coefficients of f - c**2 g are non-negative; where they are not, Newton's method looks for a nearest
place, and the halves on its either side are looked at in the same way.
*/
#include "closest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* See multirep.splines.closest for what they are. */
enum { STEPS = 12, POLISH = 4 };
#define CONVERGED 1e-9
#define SHORTEST 0x1p-20
#define FROM_END 0x1p-20
#define NOISE (64 * 0x1p-53)
#define NEAR 0x1p20

static void binomials(Index n, double *row)
{
    row[0] = 1.0;
    for (Index k = 1; k <= n; k++)
        row[k] = row[k - 1] * (double)(n - k + 1) / (double)k;
}

Seeker seeker_of(Call *call, Index degree, Index dimension, int rational)
{
    Index p = degree, n = 2 * p, size = (rational ? 2 : 1) * (n + 1);
    Seeker seeker = {.degree = p, .dimension = dimension, .rational = rational, .size = size};
    Index rows = (p + 1) * (dimension + 1);
    seeker.offsets = scratch(call, 2 * rows + 2 * (dimension + 1) + 4 * size + 2 * (n + 1) + p + 1);
    if (call->failed)
        return seeker;
    seeker.cast = seeker.offsets + rows;
    seeker.value = seeker.cast + rows;
    seeker.f = seeker.value + 2 * (dimension + 1);
    seeker.low = seeker.f + size;
    seeker.high = seeker.low + size;
    seeker.powers = seeker.high + size;
    seeker.above = seeker.powers + size;
    seeker.twice = seeker.above + n + 1;
    seeker.single = seeker.twice + n + 1;
    binomials(p, seeker.single);
    binomials(n, seeker.twice);
    return seeker;
}

void seeker_end(Seeker *seeker)
{
    free(seeker->parts);
    seeker->parts = NULL;
}

/* Take a piece: column `at` of hulls (p + 1, D, count), seen from a point. */
void seeker_take(Seeker *seeker, const double *hulls, Index count, Index at, const double *point)
{
    Index p = seeker->degree, d = seeker->dimension, width = d + seeker->rational;
    double *f = seeker->f, *g = f + 2 * p + 1;
    memset(f, 0, (size_t)seeker->size * sizeof(double));
    for (Index i = 0; i <= p; i++) {
        const double *row = hulls + i * width * count + at;
        double *offset = seeker->offsets + i * width;
        double weight = seeker->rational ? row[d * count] : 1.0;
        for (Index c = 0; c < d; c++)
            offset[c] = row[c * count] - weight * point[c];
        if (seeker->rational)
            offset[d] = weight;
        for (Index j = 0; j <= i; j++) {
            const double *other = seeker->offsets + j * width;
            double share = seeker->single[i] * seeker->single[j] / seeker->twice[i + j], sum = 0.0;
            if (j < i)
                share *= 2.0;
            for (Index c = 0; c < d; c++)
                sum += offset[c] * other[c];
            f[i + j] += share * sum;
            if (seeker->rational)
                g[i + j] += share * (weight * other[d]);
        }
    }
    seeker->noise = 0.0;
    for (Index k = 0; k <= 2 * p; k++)
        seeker->noise = larger(seeker->noise, NOISE * f[k]);
}

static double least_of(const double *row, Index count)
{
    double least = row[0];
    for (Index k = 1; k < count; k++)
        least = smaller(least, row[k]);
    return least;
}

/* f - floor g in `above`; the least of them. */
static double least_above(Seeker *seeker, const double *f, double floor)
{
    Index n = 2 * seeker->degree;
    const double *g = f + n + 1;
    for (Index k = 0; k <= n; k++)
        seeker->above[k] = f[k] - (seeker->rational ? floor * g[k] : floor);
    return least_of(seeker->above, n + 1);
}

/* Whether the piece at hand may have a place nearer than `best`, for all that its coefficients say. */
int seeker_may(Seeker *seeker, double best, double slack)
{
    double reach = larger(best - slack, 0.0);
    return least_above(seeker, seeker->f, reach * reach) < seeker->noise;
}

/* Cut in two by de Casteljau's algorithm; the row becomes the second half. */
static void divide(double *row, Index n, double at, double *low)
{
    double rest = 1.0 - at;
    for (Index k = 0; k <= n; k++) {
        low[k] = row[0];
        for (Index j = 0; j < n - k; j++)
            row[j] = rest * row[j] + at * row[j + 1];
    }
}

/* Coefficients of 1, t, .. t**n: differences times binomials. */
static void to_powers(const double *f, Index n, const double *binomial, double *powers)
{
    memcpy(powers, f, (size_t)(n + 1) * sizeof(double));
    for (Index k = 1; k <= n; k++)
        for (Index j = n; j >= k; j--)
            powers[j] -= powers[j - 1];
    for (Index k = 1; k <= n; k++)
        powers[k] *= binomial[k];
}

static void derivatives(const double *powers, Index n, double at, double *value, double *first,
                        double *second)
{
    double v = 0.0, s = 0.0, half = 0.0;
    for (Index k = n; k >= 0; k--) {
        half = half * at + s;
        s = s * at + v;
        v = v * at + powers[k];
    }
    *value = v;
    *first = s;
    *second = 2.0 * half;
}

/* Go down to where the derivative of f / g vanishes, or to an end. */
static double newton(Seeker *seeker, const double *f, double at)
{
    Index n = 2 * seeker->degree;
    double *powers = seeker->powers, *below = powers + n + 1;
    to_powers(f, n, seeker->twice, powers);
    if (seeker->rational)
        to_powers(f + n + 1, n, seeker->twice, below);
    for (int turn = 0; turn < STEPS; turn++) {
        double value, slope, bend, next;
        derivatives(powers, n, at, &value, &slope, &bend);
        if (seeker->rational) {
            double weight, first, second;
            derivatives(below, n, at, &weight, &first, &second);
            slope = slope * weight - value * first;
            bend = bend * weight - value * second;
        }
        if (bend > 0.0)
            next = smaller(larger(at - slope / bend, 0.0), 1.0);
        else
            next = slope > 0.0 ? 0.0 : 1.0;
        double moved = fabs(next - at);
        at = next;
        if (moved < CONVERGED)
            break;
    }
    return at;
}

/* |N / w|**2; N / w and its derivative in `value`. */
static double offset_at(Seeker *seeker, double at)
{
    Index p = seeker->degree, d = seeker->dimension, width = d + seeker->rational;
    double rest = 1.0 - at, *rows = seeker->cast, sum = 0.0;
    double *value = seeker->value, *slope = value + width;
    memcpy(rows, seeker->offsets, (size_t)((p + 1) * width) * sizeof(double));
    for (Index step = p; step > 1; step--)
        for (Index k = 0; k < step * width; k++)
            rows[k] = rest * rows[k] + at * rows[k + width];
    for (Index c = 0; c < width; c++) {
        value[c] = rest * rows[c] + at * rows[c + width];
        slope[c] = (double)p * (rows[c + width] - rows[c]);
    }
    for (Index c = 0; c < d; c++) {
        if (seeker->rational) {
            value[c] /= value[d];
            slope[c] = (slope[c] - value[c] * slope[d]) / value[d];
        }
        sum += value[c] * value[c];
    }
    return sum;
}

/* The distance at a place, which Gauss-Newton steps improve where its square is small. */
static double polished(Seeker *seeker, double *place, double near)
{
    Index d = seeker->dimension;
    const double *value = seeker->value, *slope = value + d + seeker->rational;
    double at = *place, square = offset_at(seeker, at);
    for (int turn = 0; turn < POLISH && square < near; turn++) {
        double speed = squared_norm(slope, d), along = 0.0;
        for (Index c = 0; c < d; c++)
            along += value[c] * slope[c];
        if (!(speed > 0.0))
            break;
        double next = smaller(larger(at - along / speed, 0.0), 1.0);
        double moved = offset_at(seeker, next);
        if (!(moved < square))
            break;
        square = moved;
        at = next;
    }
    *place = at;
    return sqrt(square);
}

/* Room for one more part: where it starts, how long it is, where to begin, its coefficients. */
static double *pushed(Call *call, Seeker *seeker)
{
    Index size = seeker->size + 3;
    if (seeker->depth == seeker->room) {
        Index room = 2 * seeker->room + 16;
        double *parts = realloc(seeker->parts, (size_t)(room * size) * sizeof(double));
        if (!parts) {
            PyErr_NoMemory();
            call->failed = 1;
            return NULL;
        }
        seeker->parts = parts;
        seeker->room = room;
    }
    return seeker->parts + size * seeker->depth++;
}

/* Whether the piece at hand has a place nearer than `best`: then both become its own. */
int seeker_finds(Call *call, Seeker *seeker, double u, double slack, double *best, double *place)
{
    Index n = 2 * seeker->degree, size = seeker->size;
    size_t bytes = (size_t)size * sizeof(double);
    double noise = seeker->noise;
    int found = 0;
    seeker->depth = 0;
    double *part = pushed(call, seeker);
    if (!part)
        return 0;
    part[0] = 0.0;
    part[1] = 1.0;
    part[2] = u;
    memcpy(part + 3, seeker->f, bytes);
    while (seeker->depth && *best > slack) {
        part = seeker->parts + (size + 3) * --seeker->depth;
        double start = part[0], length = part[1], reach = larger(*best - slack, 0.0);
        memcpy(seeker->high, part + 3, bytes);
        if (least_above(seeker, seeker->high, reach * reach) >= noise)
            continue;
        double at = newton(seeker, seeker->high, part[2]), there = start + length * at;
        double distance = polished(seeker, &there, NEAR * noise);
        if (distance < *best) {
            found = 1;
            *best = distance;
            *place = there;
            reach = larger(distance - slack, 0.0);
        }
        double least = least_above(seeker, seeker->high, reach * reach);
        if (!(at > FROM_END && at < 1.0 - FROM_END)) {
            /* the nearest place stands at an end: try the part itself again, then divide it */
            if (least >= noise)
                continue;
            at = 0.5;
        }
        divide(seeker->above, n, at, seeker->low);
        double clear[2] = {least_of(seeker->low, n + 1), least_of(seeker->above, n + 1)};
        if (clear[0] >= noise && clear[1] >= noise)
            continue;
        divide(seeker->high, n, at, seeker->low);
        if (seeker->rational)
            divide(seeker->high + n + 1, n, at, seeker->low + n + 1);
        double lengths[2] = {length * at, length * (1.0 - at)};
        for (int k = 0; k < 2; k++) {
            if (!(clear[k] < noise && lengths[k] > SHORTEST))
                continue;
            const double *half = k ? seeker->high : seeker->low;
            Index lowest = 0;
            for (Index j = 1; j <= n; j++)
                if (half[j] < half[lowest])
                    lowest = j;
            double *next = pushed(call, seeker);
            if (!next)
                return 0;
            next[0] = k ? start + lengths[0] : start;
            next[1] = lengths[k];
            next[2] = (double)lowest / (double)n;
            memcpy(next + 3, half, bytes);
        }
    }
    return found;
}
