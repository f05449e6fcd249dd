/* The principle of virtual work: a force F on a coordinate r of a point has the generalized force F dr/ds along s. */
#pragma once

#include "algebra/graph.h"

/* Pairs of a moved quantity, a position or velocity, and the force along it. */
struct VirtualWork {
  Node *moved, *forces;
  size_t count;
};

/* Adds a pair, unless one of its nodes is ZERO. */
void virtual_work_add(struct VirtualWork *work, Node moved, Node force);

/* Returns the generalized forces along all count symbols of the kind. */
Node *virtual_work_along(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind, size_t count);

/* Adds the generalized forces along rates to those along their symbols. Each symbol is followed by its rate. */
void virtual_work_add_along_rates(struct Graph *graph, const struct VirtualWork *work, enum SymbolKind kind,
                                  size_t count, Node *forces);
