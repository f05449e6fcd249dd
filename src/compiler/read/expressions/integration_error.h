/* How far a rule is from an integral, at states near the start values and further away. */
#pragma once

#include <stdint.h>

#include "algebra/quadrature.h"
#include "read/names/scope.h"

struct Rule {
  size_t count;
  double nodes[QUADRATURE_LIMIT], weights[QUADRATURE_LIMIT];
};

struct Rule rule_of(size_t count);

/*
 * The integrand over the last dummy of the scope as a function of a share from 0 to 1 of its interval, and the derivatives by
 * what moves; beside them the last state, and integrals by many nodes.
 */
struct Sampling {
  struct Scope *scope;
  const Node *targets;
  size_t count;
  double *start, *symbols, *values;   /* the last of all nodes of the graph */
  double *sums, *sizes;               /* one for each target: of its values, and of their magnitudes */
  double *reference, *reference_size; /* the same by many nodes */
  uint64_t random;
};

struct Sampling sampling_create(struct Scope *scope, Node value);

/* Whether a symbol is one that a motion, or whoever runs the system, may change. */
bool sampling_varies(const struct Symbol *symbol);

/* The symbols at random, as far from their start values as a share of their spread says; false where the integral has no value. */
bool sampling_near(struct Sampling *sampling, double share);

/* The same with one symbol at a number of spreads from its start value. */
bool sampling_at(struct Sampling *sampling, size_t symbol, double spreads);

/* A value at so many spreads; of parameters these are factors, of time shares of the experiment. */
double sampling_value(const struct Sampling *sampling, size_t symbol, double spreads);

/* What rounding may make of each target at the last state, in units of DBL_EPSILON; the caller releases it. */
double *sampling_rounding_bounds(const struct Sampling *sampling);

/* The largest error of a rule at the last state, relative to the integral of the magnitude, beyond these roundings; NULL for none. */
double sampling_error(struct Sampling *sampling, const struct Rule *rule, const double *rounding_bounds);
