/* Capsules as columns; see multirep.capsules. */
#ifndef MULTIREP_CAPSULES_H
#define MULTIREP_CAPSULES_H

#include "core.h"

#include <math.h>

/* Start (d), chord (d), 1 / length**2, radius of each. */
typedef struct {
    double *at;
    Index count, dimension;
} Nodes;

static inline Nodes nodes_of(Call *call, Table table, Index dimension)
{
    expect(call, dimension > 0 && table.rows == 2 * dimension + 2 && table.columns > 0,
           "capsules are columns of 2 d + 2 numbers");
    return (Nodes){table.at, table.columns, dimension};
}

/* The squared distance of a point from the chord of a capsule; u is the place on it. */
static inline double square_of(const Nodes *nodes, Index k, const double *point, Index dimension,
                               double *u)
{
    Index count = nodes->count;
    const double *start = nodes->at + k, *chord = start + dimension * count;
    double along = 0.0, square = 0.0;
    for (Index c = 0; c < dimension; c++)
        along += (point[c] - start[c * count]) * chord[c * count];
    along = smaller(larger(along * chord[dimension * count], 0.0), 1.0);
    for (Index c = 0; c < dimension; c++) {
        double offset = point[c] - start[c * count] - along * chord[c * count];
        square += offset * offset;
    }
    *u = along;
    return square;
}

static inline double distance_of(const Nodes *nodes, Index k, const double *point)
{
    double u;
    return sqrt(square_of(nodes, k, point, nodes->dimension, &u));
}

static inline double *radius_of(const Nodes *nodes, Index k)
{
    return nodes->at + (2 * nodes->dimension + 1) * nodes->count + k;
}

#endif
