/* Parameter constants: expressions of parameters only, computed once when parameters change. */
#pragma once

#include "algebra/node_list.h"

/* The nodes that prepare() computes, in the order of its results. */
struct ParameterConstants {
  Node *nodes; /* ascending */
  size_t count;
  size_t *slot; /* for each node of the graph: 1 + its index in nodes, 0 for none */
};

/* True if the node is an operation on parameters and numbers only. */
bool is_of_parameters(const struct Graph *graph, Node node);

/* Returns the largest expressions of parameters in the targets, and in operands of nodes that change in time. */
struct ParameterConstants *parameter_constants_create(const struct Graph *graph, struct NodeList targets);
