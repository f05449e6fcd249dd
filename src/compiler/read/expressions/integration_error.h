/* Errors of quadrature rules for an integral, at states near the start values and further away. */
#pragma once

#include <stdint.h>

#include "algebra/quadrature.h"
#include "names/scope.h"

/* A quadrature rule: nodes in (0, 1), ascending, and their weights, whose sum is 1. */
struct Rule {
  size_t count;
  double nodes[QUADRATURE_LIMIT], weights[QUADRATURE_LIMIT];
};

/* Returns the Gauss-Legendre rule of this number of nodes. */
struct Rule rule_of(size_t count);

/*
 * The integrand and its derivatives by the moving symbols, as functions of a share from 0 to 1 of the interval of
 * the scope's last dummy. The struct also has the present sample state and reference integrals by many nodes.
 */
struct Sampling {
  struct Scope *scope;
  const Node *targets;
  size_t count;
  double *start, *symbols, *values;   /* the last of all nodes of the graph */
  double *sums, *sizes;               /* one for each target: of its values, and of their magnitudes */
  double *reference, *reference_size; /* value and size by many nodes */
  uint64_t random;
};

/* Returns a sampling of an integrand over the last dummy of the scope. */
struct Sampling sampling_create(struct Scope *scope, Node value);

/* True if the motion or the user may change the symbol. */
bool sampling_varies(const struct Symbol *symbol);

/*
 * Draws a random state within a share of the spreads about the start values. False if the integral has no value there.
 */
bool sampling_near(struct Sampling *sampling, double share);

/* Does the same, with one symbol at a number of spreads from its start value. */
bool sampling_at(struct Sampling *sampling, size_t symbol, double spreads);

/* Returns the value of a symbol at a number of spreads: for parameters a factor, for time a share of the experiment. */
double sampling_value(const struct Sampling *sampling, size_t symbol, double spreads);

/*
 * Returns the rounding error bound of each target at the present state, in units of DBL_EPSILON. The caller releases
 * it.
 */
double *sampling_rounding_bounds(const struct Sampling *sampling);

/*
 * Returns the largest error of a rule at the present state beyond the rounding error bounds; NULL for none. It is
 * relative to the integral of the magnitude.
 */
double sampling_error(struct Sampling *sampling, const struct Rule *rule, const double *rounding_bounds);
