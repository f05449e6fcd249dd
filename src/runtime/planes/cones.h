/* The law of impacts with Coulomb's cone, for pushes that contacts and frictions share; see cone_impulses.c. */
#ifndef CONES_H
#define CONES_H

#include "contacts/pushes.h"

struct Cones {
  const struct Settlement *settlement;
  const struct Pushes *pushes;
  const double *rate; /* of each push before the impact */
  double *impulse;
  double *
      scale; /* of each push: what an impulse of 1 changes its own rate by, in a plane the most that it does; 0 for none */
};

/* The rate of a push behind the impact. */
double cones_rate_behind(const struct Cones *cones, size_t row);

/* What the contacts let a friction push. */
double cones_limit(const struct Cones *cones, size_t row);

/* How many rows the push at a row has that are one in the law: 2 for a friction in a plane. */
size_t cones_row_count(const struct Cones *cones, size_t row);

/* The largest impulse, as the rate that it makes by itself. */
double cones_largest(const struct Cones *cones);

#endif
