/* What finds the nearest place of a piece; see closest.c. */
#ifndef MULTIREP_CLOSEST_H
#define MULTIREP_CLOSEST_H

#include "core.h"

typedef struct {
    Index degree, dimension, size;
    int rational;
    double noise;
    /* of the piece at hand: offsets (p + 1, D), and f (2p + 1,) with g behind it */
    double *offsets, *f;
    double *cast, *value, *low, *high, *above, *powers, *single, *twice;
    double *parts;
    Index depth, room;
} Seeker;

Seeker seeker_of(Call *call, Index degree, Index dimension, int rational);
void seeker_end(Seeker *seeker);
void seeker_take(Seeker *seeker, const double *hulls, Index count, Index at, const double *point);
int seeker_may(Seeker *seeker, double best, double slack);
int seeker_finds(Call *call, Seeker *seeker, double u, double slack, double *best, double *place);

#endif
