/* What depends on parameters alone is computed once, when parameters change: the prepared values. */
#pragma once

#include "algebra/node_list.h"

struct Prepared {
  Node *nodes; /* ascending */
  size_t count;
  size_t *slot; /* for each node of the graph: 1 + its place in nodes, 0 for none */
};

/* Whether the node is an operation on parameters and numbers alone. */
bool is_of_parameters(const struct Graph *graph, Node node);

/* The prepared values that the targets need, directly or as operands of what changes in time. */
struct Prepared *prepared_create(const struct Graph *graph, struct NodeList targets);
