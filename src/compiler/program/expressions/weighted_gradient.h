/*
 * The gradient of one number, a weighted sum of the derivatives of the state and of the outputs, by all that these depend
 * on: what a reverse sweep gives in the time of a few evaluations, however many parameters there are.
 */
#pragma once

#include "interface/interface.h"
#include "mechanics/equations.h"

struct WeightedGradient {
  Node *side; /* of each row of K: what the sum depends on its acceleration or force by */
  Node
      *multiplier; /* of each row: the solution of K multiplier = side; symbols in blocks that are solved at run time */
  Node *elements;  /* by the state, the inputs, the parameters and modes, and time */
  size_t count;    /* of these */
};

/*
 * The weights are seeds: those of the state for its derivatives, and new symbols for results, of which result holds the
 * nodes. seeds: of each symbol of the graph. NULL where forces follow from others, so that K is not symmetric.
 */
struct WeightedGradient *weighted_gradient_create(const struct Model *model, const struct Equations *equations,
                                                  const struct Interface *interface, const Node *result,
                                                  const Node *seeds);
