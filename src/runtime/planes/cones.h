/* The law of impacts with Coulomb's friction cone (cone_impulses.c). */
#ifndef CONES_H
#define CONES_H

#include "contacts/pushes.h"

struct Cones {
  const struct Settlement *settlement;
  const struct Pushes *pushes;
  const double *rate; /* of each impulse, before the impact */
  double *impulse;
  double *scale; /* change of the own rate by each unit impulse, in a plane the largest; 0 if there is none */
};

/* Returns the rate of an impulse after the impact. */
double cones_rate_behind(const struct Cones *cones, size_t row);

/* Returns the friction limit, from the impulses of the contacts. */
double cones_limit(const struct Cones *cones, size_t row);

/* Returns the number of rows of the impulse at a row: 2 for a friction in a plane. */
size_t cones_row_count(const struct Cones *cones, size_t row);

/* Returns the largest impulse, as the rate that it makes alone. */
double cones_largest(const struct Cones *cones);

#endif
