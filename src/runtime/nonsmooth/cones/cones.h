/* Impulses of contacts and frictions: the problem of cone_search.c. */
#pragma once

#include "nonsmooth/cones/impulses.h"
#include "nonsmooth/resolution.h"

struct ConePath;

/* The problem, with the rows of `impulses`: contacts, then frictions, of which those in a plane have two rows. */
struct Cones {
  const struct Resolution *resolution; /* not used without frictions */
  const struct ConePath *path;         /* NULL for contacts without friction */
  const struct ContactImpulses *impulses;
  const double *rate; /* of each row, before the impact; of contacts times 1 + e */
  double *impulse;
  double *scale; /* change of the own rate by a unit impulse, in a plane the larger eigenvalue; 0 if there is none */
  double *best, *swept; /* impulses with the least residual, and those where the last sweeps ended */
  double *work;         /* workspace of the methods */
};

/* The interior-point method (cone_interior.h). FMUs whose contacts have no friction do not link it. */
struct ConePath {
  size_t (*work_count)(size_t n);
  double (*find)(struct Cones *cones, double enough, bool is_centered, double *work);
};

/* Returns rate + W impulse of a row, the quantity that is complementary to the impulse of a contact. */
double cones_rate_behind(const struct Cones *cones, size_t row);

/* Fills rate + W impulse of all rows. Returns the size of the largest term in them. */
double fill_rates_behind(const struct ContactImpulses *impulses, const double *rate, const double *impulse,
                         double *behind);

/* Returns the friction limit of a row by a unit impulse of a row that decides on limits. */
double cones_coefficient(const struct Cones *cones, size_t row, size_t deciding);

/* Returns the friction limit of a row. */
double cones_limit(const struct Cones *cones, size_t row);

/* Returns the number of rows of the impulse at a row: 2 for a friction in a plane. */
size_t cones_row_count(const struct Cones *cones, size_t row);

/* Returns the largest impulse, as the rate that it makes alone. */
double cones_largest(const struct Cones *cones);

/* Returns a residual relative to the largest impulse: 0 if it is a rounding error of the rates, INFINITY if large. */
double cones_relative_miss(const struct Cones *cones, double miss);
