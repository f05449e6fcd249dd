/* The gradient of a weighted sum of state derivatives and outputs, in reverse mode. */
#pragma once

#include "interface/interface.h"
#include "mechanics/equations.h"

/* The solution of the adjoint equations, and the gradient. */
struct WeightedGradient {
  Node *right_side; /* of each row of K: the partial derivative of the sum by its acceleration or force */
  /* of each row: the solution of K multiplier = right_side; symbols in blocks that are solved at run time */
  Node *multiplier;
  Node *elements; /* by state, inputs, parameters and modes, and time, in this order */
  size_t count;   /* number of elements */
};

/*
 * Derives the gradient. Weights are the seeds of the state, for its derivatives, and new symbols SEED_RESULT for the
 * outputs. seeds: for each symbol of the graph. Returns NULL if some forces depend on others, as K is not symmetric
 * then.
 */
struct WeightedGradient *weighted_gradient_create(const struct Model *model, const struct Equations *equations,
                                                  const struct Interface *interface, const Node *result,
                                                  const Node *seeds);
